//! What the solver does at the edges: singular systems, supports at the interface, limits, cycles, settings.

use crate::common::{self, Run, finished, force, force_in, go_on, number, read, run, scene, table};
use stickslip::contact::record::Forced;
use stickslip::linear::singular::{LooseMotion, Singular};
use stickslip::model::Mode;
use stickslip::step::event::{Failure, Outcome};
use stickslip::step::intervene::Intervention;
use stickslip::step::state::Status;

const TABLE_2: (&str, &str) = ("settings.strategy", "table2");

fn failure(run: &Run) -> &Failure {
    &run.failure.as_ref().expect("it must fail").1
}

#[test]
fn a_pinned_beam_that_starts_free_is_told_to_turn_about_its_pin() {
    let run = run(&scene(
        "01-pinned-beam-rough-floor",
        &[("slaves[0].start", "free"), TABLE_2],
    ));
    let Failure::Singular(Singular::Rigid { motions }) = failure(&run) else {
        panic!("{:?}", run.failure)
    };
    assert_eq!(motions.len(), 1);
    assert_eq!(motions[0].body, "beam");
    let LooseMotion::Rotation([x, y]) = motions[0].motion else {
        panic!("{motions:?}")
    };
    assert!(x.abs() < 1e-9 && (y - 8f64.sqrt()).abs() < 1e-9, "{x} {y}");
}

const LOOSE: &str = "(title: \"t\", nodes: [Line(id: \"b\", from: (0.0, 1.0), to: (1.0, 1.0), elements: 1, per_element: 3)],
    materials: [Section(id: \"m\", EA: 100.0, EI: 1.0)], bodies: [Beam(id: \"b\", along: \"b\", material: \"m\")],
    SUPPORTS loads: [Force(node: \"b.end\", y: 1.0)], history: (path: [0.0, 1.0], increment: 0.5))";

#[test]
fn a_body_that_nothing_holds_is_named_with_each_of_its_motions() {
    let run = run(&read(&LOOSE.replace("SUPPORTS", "")));
    let Failure::Singular(Singular::Rigid { motions }) = failure(&run) else {
        panic!("{:?}", run.failure)
    };
    assert_eq!(motions.len(), 3, "{motions:?}");
    assert!(motions.iter().all(|m| m.body == "b"));
    // First those that the force along y moves; it does no work along x.
    assert_eq!(motions[0].motion, LooseMotion::Translation([0.0, 1.0]));
    assert_eq!(motions[2].motion, LooseMotion::Translation([1.0, 0.0]));
    let held = common::run(&read(&LOOSE.replace(
        "SUPPORTS",
        "supports: [(node: \"b.start\", fix: [y, rotation])],",
    )));
    let Failure::Singular(Singular::Rigid { motions }) = failure(&held) else {
        panic!("{:?}", held.failure)
    };
    let LooseMotion::Translation([x, y]) = motions[0].motion else {
        panic!("{motions:?}")
    };
    assert!((x.abs() - 1.0).abs() < 1e-9 && y.abs() < 1e-9);
}

#[test]
fn a_failed_increment_leaves_the_state_before_it_to_go_on_from() {
    let mut run = run(&scene(
        "01-pinned-beam-rough-floor",
        &[("slaves[0].start", "free"), TABLE_2],
    ));
    assert!(matches!(run.stepper.state().status, Status::Failed(_)));
    force(&mut run, 0, Mode::Sliding, false);
    let run = go_on(run);
    assert!(run.failure.is_none() && run.accepted.len() == 50);
}

/// A beam lies on a floor, its end held by a support in x: the support carries what friction would.
#[test]
fn a_slave_node_whose_tangential_motion_is_restrained_leaves_that_force_to_its_support() {
    for start in ["fixed", "sliding"] {
        let run = run(&read(&format!(
            "(title: \"t\", nodes: [Line(id: \"b\", from: (0.0, 2.0), to: (0.0, 0.0), elements: 1, per_element: 3),
                Line(id: \"f\", from: (1.0, 0.0), to: (-1.0, 0.0), elements: 1, per_element: 2)],
              materials: [Section(id: \"m\", EA: 100.0, EI: 1.0)], bodies: [Beam(id: \"b\", along: \"b\", material: \"m\")],
              surfaces: [(id: \"f\", along: \"f\")], slaves: [(nodes: [\"b.end\"], on: [\"f\"], start: {start})],
              friction: (angle: 20.0),
              supports: [(node: \"b.start\", fix: [x, rotation]), (node: \"b.end\", fix: [x])],
              loads: [Force(node: \"b.start\", y: -1.0)], history: (path: [0.0, 1.0], increment: 0.5),
              monitors: [(name: \"v\", of: Displacement(node: \"b.start\", component: y)),
                         (name: \"n\", of: Contact(component: y)), (name: \"t\", of: Contact(component: x))])"
        )));
        assert!(run.failure.is_none(), "{start}: {:?}", run.failure);
        let last = run.accepted.last().unwrap();
        assert!((last.monitors["v"] + 0.02).abs() < 1e-9);
        assert!((last.monitors["n"] - 1.0).abs() < 1e-9);
    }
}

#[test]
fn ties_keep_the_mode_and_let_the_inclined_cantilever_slide() {
    let parallel = [("loads[0].y", "0.0")];
    let run_ = run(&scene("osc-inclined-cantilever", &parallel));
    assert!(run_.failure.is_none(), "{:?}", run_.failure);
    let rows = table("06-inclined-cantilever.csv");
    let rows: Vec<_> = rows
        .iter()
        .filter(|r| r["branch"] == "load" && r["angle_deg"] == "45.0")
        .collect();
    let mut met = 0;
    for row in rows {
        if let Some(a) = run_
            .accepted
            .iter()
            .find(|a| (a.load - number(row, "P")).abs() < 1e-12)
        {
            met += 1;
            assert!((a.monitors["u_x"] - number(row, "u_x")).abs() < 1e-7);
            assert!((a.monitors["contact_y"] - number(row, "Fn")).abs() < 1e-6);
        }
    }
    assert!(met >= 20, "{met}");
}

#[test]
fn where_round_off_decides_the_printed_table_cycles_with_some_increments_and_keeping_ties_with_none()
 {
    let cycles = |ties: &str, increment: &str| {
        let set = [
            ("loads[0].y", "0.0"),
            ("history.increment", increment),
            ("settings.ties", ties),
        ];
        let failure = run(&scene("osc-inclined-cantilever", &set)).failure;
        failure.map(|(_, failure)| assert!(matches!(failure, Failure::Cycle(c) if c.period == 2)))
    };
    let increments = ["0.05", "0.04", "0.025", "0.02", "0.01"];
    assert!(increments.iter().all(|i| cycles("keep", i).is_none()));
    assert!(increments.iter().any(|i| cycles("printed", i).is_some()));
}

#[test]
fn limits_stop_an_increment_or_mark_it_as_the_settings_say() {
    let stopped = run(&scene(
        "01-pinned-beam-rough-floor",
        &[("settings.minors", "5"), TABLE_2],
    ));
    assert!(
        matches!(failure(&stopped), Failure::MinorLimit { limit: 5, changing } if changing == &[0])
    );
    let marked = run(&scene(
        "02-two-cantilevers-smooth",
        &[
            ("settings.majors", "3"),
            ("settings.geometry", "frozen"),
            ("settings.at_major_limit", "accept"),
        ],
    ));
    assert!(marked.failure.is_none());
    let unsettled = |a: &&common::Accepted| matches!(a.event.outcome, Outcome::Increment { unsettled, .. } if unsettled > 0);
    assert!(marked.accepted.iter().filter(unsettled).count() > 40);
    let stopped = run(&scene(
        "02-two-cantilevers-smooth",
        &[
            ("settings.majors", "3"),
            ("settings.geometry", "frozen"),
            TABLE_2,
        ],
    ));
    assert!(matches!(
        failure(&stopped),
        Failure::MajorLimit { limit: 3, .. }
    ));
}

#[test]
fn one_minor_iteration_per_major_is_a_setting_and_smooth_contact_does_not_mind() {
    let paper = [
        ("settings.minors", "1"),
        ("settings.at_minor_limit", "accept"),
    ];
    let one = run(&scene("02-two-cantilevers-smooth", &paper));
    assert!(one.failure.is_none(), "{:?}", one.failure);
    let many = run(&scene("02-two-cantilevers-smooth", &[]));
    let end = |run: &Run| run.accepted.last().unwrap().monitors["u_x"];
    assert!((end(&one) - end(&many)).abs() < 1e-8);
}

#[test]
fn a_held_mode_stays_against_table_2_and_is_marked_until_released() {
    let scene = scene("01-pinned-beam-rough-floor", &[("history.path[2]", "0.2")]);
    let mut stepper = stickslip::step::stepper::Stepper::new(std::sync::Arc::new(scene.model));
    force_in(&mut stepper, 0, Mode::Fixed, true);
    for _ in 0..5 {
        let event = stepper.step().unwrap();
        assert_eq!(event.nodes[0].forced, Forced::Held(Mode::Fixed));
        assert_eq!(event.nodes[0].decision.next, Mode::Fixed);
        assert_eq!(event.nodes[0].decision.wanted, Mode::Sliding);
    }
    stepper
        .intervene(&Intervention::Release { slave: 0 })
        .unwrap();
    stepper.step();
    assert_eq!(stepper.event().nodes[0].decision.next, Mode::Sliding);
}

#[test]
fn a_new_increment_size_starts_the_increment_again_from_its_exact_start() {
    let scene = scene("02-two-cantilevers-smooth", &[]);
    let mut stepper = stickslip::step::stepper::Stepper::new(std::sync::Arc::new(scene.model));
    while stepper.state().next.increment < 4 {
        stepper.step();
    }
    stepper.step();
    stepper.step();
    let start = stepper.state().start.clone();
    stepper.intervene(&Intervention::Increment(0.01)).unwrap();
    let state = stepper.state();
    assert_eq!(
        (state.next.increment, state.next.attempt, state.next.major),
        (4, 2, 1)
    );
    assert_eq!(state.u, start.u);
    assert_eq!(state.nodes, start.nodes);
    assert!((state.load_factor - start.load_factor - 0.01).abs() < 1e-15);
}

#[test]
fn nonsense_is_refused_and_changes_nothing() {
    let scene = scene("01-pinned-beam-rough-floor", &[]);
    let mut stepper = stickslip::step::stepper::Stepper::new(std::sync::Arc::new(scene.model));
    stepper.step();
    let before = stepper.state().clone();
    for nonsense in [
        Intervention::Force {
            slave: 7,
            mode: Mode::Free,
            hold: false,
        },
        Intervention::Release { slave: 7 },
        Intervention::Increment(0.0),
        Intervention::Increment(f64::NAN),
        Intervention::Friction(stickslip::model::Friction {
            angle: 90.0,
            cohesion: 0.0,
        }),
        Intervention::Friction(stickslip::model::Friction {
            angle: 0.0,
            cohesion: -1.0,
        }),
        Intervention::Settings(stickslip::model::Settings {
            minors: 0,
            ..Default::default()
        }),
    ] {
        assert!(stepper.intervene(&nonsense).is_err(), "{nonsense:?}");
        assert_eq!(stepper.state(), &before);
    }
}

#[test]
fn cohesion_adds_to_friction_and_both_limit_the_tangential_force() {
    let set = [
        ("friction.cohesion", "0.01"),
        ("slaves[0].start", "fixed"),
        ("history.path[2]", "0.24"),
    ];
    let run = finished(&scene("01-pinned-beam-rough-floor", &set));
    let mut slid = 0;
    for a in &run.accepted {
        let (f_n, f_t) = (a.monitors["contact_y"], a.monitors["contact_x"]);
        let limit = f_n * 30f64.to_radians().tan() + 0.01;
        assert!(f_t <= limit + 1e-9, "load {}: {f_t} {limit}", a.load);
        if a.event.nodes[0].decision.next == Mode::Sliding {
            slid += 1;
            assert!((f_t - limit).abs() < 1e-9, "load {}: {f_t} {limit}", a.load);
        }
    }
    assert!(slid > 20, "{slid}");
}

/// Major iterations in all, of a run without failure.
fn majors(run: &Run) -> u32 {
    assert!(run.failure.is_none(), "{:?}", run.failure);
    run.accepted.iter().map(|a| a.majors).sum()
}

#[test]
fn t_max_in_the_matrix_takes_a_fraction_of_the_minor_iterations_for_the_same_answer() {
    let solved = |t_max: &str| {
        let set = [
            ("friction.angle", "10"),
            ("history.path[1]", "0.4"),
            ("settings.t_max", t_max),
        ];
        run(&scene("05-cantilever-elastic-block", &set))
    };
    let (lagged, consistent) = (solved("lagged"), solved("consistent"));
    assert!(majors(&lagged).abs_diff(majors(&consistent)) <= 1);
    // A step is a minor iteration.
    assert!(
        lagged.steps > 3 * consistent.steps,
        "{} {}",
        lagged.steps,
        consistent.steps
    );
    let last = |run: &Run, name: &str| run.accepted.last().unwrap().monitors[name];
    for name in ["u_x", "u_y", "rotation", "contact_x", "contact_y"] {
        let (a, b) = (last(&lagged, name), last(&consistent, name));
        assert!((a - b).abs() < 1e-9, "{name}: {a} {b}");
    }
}

#[test]
fn the_second_residual_method_saves_majors_on_the_rough_cantilevers_with_the_papers_geometry() {
    let solved = |residual: &str| {
        let set = [
            ("settings.geometry", "frozen"),
            ("settings.residual", residual),
        ];
        run(&scene("02-two-cantilevers-rough", &set))
    };
    let (first, second) = (solved("accumulate"), solved("stress"));
    assert!(
        majors(&second) < majors(&first) - 20,
        "{} {}",
        majors(&first),
        majors(&second)
    );
    let end = |run: &Run| run.accepted.last().unwrap().monitors["u_x"];
    assert!((end(&first) - end(&second)).abs() < 1e-10);
}
