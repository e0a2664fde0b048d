//! The search after a failed increment: scenes that fail without it, and the limit of its cost.

use std::sync::Arc;
use stickslip::linear::singular::Singular;
use stickslip::scene::Scene;
use stickslip::step::event::{Failure, Outcome};
use stickslip::step::recovery::fallback::Fallback;
use stickslip::step::state::Status;
use stickslip::step::stepper::Stepper;

/// A run: how it ends, the fallbacks by which an increment was accepted, accepted jumps, factorizations spent on searches, and the
/// last displacements.
struct Run {
    failure: Option<Failure>,
    found: Vec<Fallback>,
    jumps: usize,
    spent: u32,
    u: Vec<f64>,
}

/// A solver of a scene in the folder of the tests, with changed values.
fn open(file: &str, set: &[(&str, &str)]) -> Stepper {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/").to_owned() + file;
    let set: Vec<_> = set
        .iter()
        .map(|(path, value)| ((*path).to_owned(), (*value).to_owned()))
        .collect();
    let scene = Scene::open(&file, &set).unwrap_or_else(|error| panic!("{error}"));
    Stepper::new(Arc::new(scene.model))
}

fn run(name: &str, set: &[(&str, &str)]) -> Run {
    let mut stepper = open(&format!("findings/{name}.ron"), set);
    let (mut tried, mut found, mut jumps, mut failure) = (None, Vec::new(), 0, None);
    while let Some(event) = stepper.step() {
        match &event.outcome {
            Outcome::Fallback { by, .. } => tried = Some(*by),
            Outcome::Increment { jumped, .. } => {
                found.extend(tried.take());
                jumps += usize::from(*jumped);
            }
            Outcome::Failed(why) => {
                failure = Some(why.clone());
                break;
            }
            _ => {}
        }
    }
    let spent = stepper.state().record.searched.spent;
    let u = stepper.state().u.to_vec();
    Run {
        failure,
        found,
        jumps,
        spent,
        u,
    }
}

/// Increments, major and minor iterations, and jumps of the bouncing block of MOOSE's contact module.
fn bouncing_block(which: &str, set: &[(&str, &str)]) -> [u32; 4] {
    let mut stepper = open(&format!("benches/bouncing-block-{which}.ron"), set);
    let [mut increments, mut majors, mut minors, mut jumps] = [0; 4];
    while let Some(event) = stepper.step() {
        minors += 1;
        majors += u32::from(event.outcome.ends_major());
        if let Outcome::Increment { jumped, .. } = event.outcome {
            increments += 1;
            jumps += u32::from(jumped);
        }
        assert!(!matches!(event.outcome, Outcome::Failed(_)), "{which}");
    }
    [increments, majors, minors, jumps]
}

#[test]
fn the_bouncing_block_needs_no_cuts() {
    let [increments, majors, minors, jumps] = bouncing_block("rough", &[]);
    assert_eq!([increments, jumps], [40, 0]);
    assert!(majors <= 150 && minors <= 1000, "{majors} {minors}");
    let [increments, majors, minors, jumps] = bouncing_block("smooth", &[]);
    assert_eq!([increments, jumps], [40, 0]);
    assert!(majors <= 106 && minors <= 160, "{majors} {minors}");
}

#[test]
fn with_its_tolerance_and_a_smooth_surface_the_bouncing_block_takes_fewer_iterations_than_moose() {
    let set = [
        ("settings.tolerance", "1e-8"),
        ("surfaces.base.smooth", "true"),
    ];
    let [increments, majors, _, jumps] = bouncing_block("smooth", &set);
    assert_eq!([increments, jumps], [40, 0]);
    // 93 with its best mortar formulation, 104 to 149 with nodal ones.
    assert!(majors < 93, "{majors}");
}

const OFF: &[(&str, &str)] = &[("settings.search", "off")];

/// A block of `elements` elements at this gap above a floor, pressed down by a traction of 10.
fn above_a_floor(elements: usize, gap: f64, strategy: &str) -> Stepper {
    let text = format!(
        "(title: \"t\", nodes: [Block(id: \"b\", corners: [(-5, {gap}), (5, {gap}), (5, 6), (-5, 6)], elements: ({elements}, 1)),
                              Line(id: \"f\", from: (20, 0), to: (-20, 0), elements: 1, per_element: 2)],
          materials: [Elastic(id: \"m\", E: 210000, nu: 0.3)], bodies: [Solid(id: \"b\", mesh: \"b\", material: \"m\")],
          surfaces: [(id: \"f\", along: \"f\")], slaves: [(nodes: [\"b.bottom\"], on: [\"f\"])], friction: (angle: 10), supports: [],
          loads: [Traction(along: \"b.top\", y: -10)], history: (path: [0, 1], increment: 0.1), settings: (strategy: {strategy}))"
    );
    let scene = Scene::from_text("t.ron", &text, &[]).unwrap_or_else(|error| panic!("{error}"));
    Stepper::new(Arc::new(scene.model))
}

#[test]
fn a_loose_body_with_many_contacts_starts_with_its_nearest_ones_closed() {
    let mut stepper = above_a_floor(40, 0.01, "ladder");
    while stepper.step().is_some() {}
    let state = stepper.state();
    assert_eq!(state.status, Status::Finished);
    let force: f64 = state.nodes.iter().map(|node| node.f_n).sum();
    assert!((force - 100.0).abs() < 1e-6, "{force}");
}

/// The diagnosis looks ahead from the failed state, whose minor iterations are no longer recorded.
#[test]
fn a_look_ahead_from_a_failed_search_finds_no_cycle() {
    let mut stepper = above_a_floor(100, 0.1, "lemke");
    while let Some(event) = stepper.step() {
        if matches!(event.outcome, Outcome::Failed(_)) {
            break;
        }
    }
    assert!(matches!(stepper.state().status, Status::Failed(_)));
    assert_eq!(stepper.cycle_ahead(), None);
}

#[test]
fn bodies_that_touch_without_a_gap_are_held_from_the_start() {
    for name in ["die", "stack-of-50-blocks"] {
        let searched = run(name, &[]);
        assert_eq!(searched.failure, None, "{name}");
        assert_eq!(searched.found.first(), Some(&Fallback::Touching), "{name}");
        let without = run(name, OFF).failure;
        assert!(
            matches!(without, Some(Failure::Singular(_))),
            "{name}: {without:?}"
        );
    }
}

#[test]
fn a_loose_start_with_many_contacts_tries_no_strategy() {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/findings/stack-of-50-blocks.ron"
    );
    let mut ends = Vec::new();
    for set in [&[][..], OFF] {
        let set: Vec<_> = set
            .iter()
            .map(|(path, value): &(&str, &str)| ((*path).to_owned(), (*value).to_owned()))
            .collect();
        let scene = Scene::open(file, &set).unwrap_or_else(|error| panic!("{error}"));
        let mut stepper = Stepper::new(Arc::new(scene.model));
        ends.extend(stepper.step().map(|event| event.outcome.clone()));
    }
    let loose = |why: &Failure| match why {
        Failure::Singular(Singular::Rigid { motions }) => motions.len(),
        _ => 0,
    };
    match &ends[..] {
        [Outcome::Fallback { why, by, .. }, Outcome::Failed(without)] => {
            assert_eq!(*by, Fallback::Touching);
            // Three rigid motions of each of the 48 blocks between the supported one and the one that is pressed.
            assert_eq!([loose(why), loose(without)], [144; 2]);
        }
        _ => panic!("{ends:?}"),
    }
}

#[test]
fn modes_that_cycle_at_the_least_increment_settle_in_smaller_parts() {
    let searched = run("modes-cycle-at-the-least-increment", &[]);
    assert_eq!(searched.failure, None);
    assert!(
        searched.found.contains(&Fallback::Deeper),
        "{:?}",
        searched.found
    );
    assert_eq!(searched.jumps, 0);
}

/// Without the change of the contact geometry in the tangent, the major iterations do not converge however small the increment: the
/// search uses it from then on and finds the state of `geometry: consistent`.
#[test]
fn increments_that_diverge_with_frozen_geometry_are_found_with_the_consistent_one() {
    let name = "frozen-geometry-diverges";
    let searched = run(name, &[]);
    assert_eq!(searched.failure, None);
    let kept = searched
        .found
        .iter()
        .filter(|by| **by == Fallback::Geometry);
    assert_eq!(kept.count(), 1, "{:?}", searched.found);
    assert_eq!(searched.jumps, 0);
    assert!(run(name, OFF).failure.is_some());
    let consistent = run(name, &[("settings.geometry", "consistent")]);
    assert_eq!((consistent.failure, consistent.spent), (None, 0));
    for (found, wanted) in searched.u.iter().zip(&consistent.u) {
        assert!((found - wanted).abs() < 1e-9, "{found} {wanted}");
    }
}

/// The path ends where a node gets behind the end of its surface; at higher loads other nodes touch.
#[test]
fn an_increment_past_the_end_of_the_path_is_a_marked_jump() {
    let name = "path-ends-behind-the-end-of-a-surface";
    let searched = run(name, &[]);
    assert_eq!(searched.failure, None);
    let longer = searched.found.iter().filter(|by| **by == Fallback::Longer);
    assert_eq!(longer.count(), 1, "{:?}", searched.found);
    // The other one is a loss of stability during unloading.
    assert_eq!(searched.jumps, 2);
    let limited = run(name, &[("settings.search", "1")]);
    assert!(limited.failure.is_some());
    assert!(limited.spent < 20_000, "{}", limited.spent);
}

#[test]
fn a_damped_motion_finds_the_next_equilibrium() {
    let searched = run("moves-to-another-equilibrium", &[]);
    assert_eq!(searched.failure, None);
    assert!(
        searched.found.contains(&Fallback::Release),
        "{:?}",
        searched.found
    );
    assert!(run("moves-to-another-equilibrium", OFF).failure.is_some());
}

#[test]
fn a_damped_motion_in_which_nodes_slide_and_stick_again_is_a_jump() {
    let searched = run("slides-and-sticks-again-in-motion", &[]);
    assert_eq!(searched.failure, None);
    let motions = searched.found.iter();
    let motions = motions.filter(|by| **by == Fallback::Release).count();
    assert!(motions > 0, "{:?}", searched.found);
    assert!(searched.jumps >= motions, "{} of {motions}", searched.jumps);
}

#[test]
fn no_search_spends_more_than_its_limit() {
    let name = "moves-to-another-equilibrium";
    let whole = run(name, &[]).spent;
    let limit = whole / 2;
    let limited = run(name, &[("settings.search", &limit.to_string())]);
    assert!(limited.failure.is_some());
    // Under the name of earlier revisions, too.
    let renamed = run(name, &[("settings.search_limit", &limit.to_string())]);
    assert_eq!(renamed.spent, limited.spent);
    // The attempt in which the limit is reached is finished: at most 60 major iterations, here with one minor iteration each.
    assert!(limited.spent <= limit + 120, "{} of {limit}", limited.spent);
}
