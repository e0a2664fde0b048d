//! Random mesh scenes, judged from outside: `cargo bench --bench random_scenes -- 10000` runs many more. The judge itself is
//! tried on states made wrong on purpose, one law at a time.

use crate::common::read;
use crate::outside::chain::{Chain, Place, Point, Seen as Sight};
use crate::outside::families::{FAMILIES, draw};
use crate::outside::judge::{Law, Pull, Scales, Seen, Verdict, judge};
use crate::outside::tally;
use crate::outside::trial::{End, attempt};
use stickslip::model::Friction;
use stickslip::scene::Scene;
use stickslip::step::recovery::fallback::Fallback;

/// As many as a few seconds allow.
const SCENES: u64 = 60;

#[test]
fn no_accepted_increment_of_a_random_scene_is_wrong() {
    let rows = tally::run(1, 0..SCENES, &[], |_| {});
    let wrong: Vec<String> = rows
        .iter()
        .filter(|row| row.is_wrong())
        .map(|row| row.line())
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let ended = |row: &&tally::Row| matches!(row.trial.end, End::Finished | End::Failed { .. });
    assert_eq!(rows.iter().filter(ended).count() as u64, SCENES);
    let accepted: usize = rows.iter().map(|row| row.trial.increments).sum();
    assert!(accepted > 500, "only {accepted} increments were judged");
}

/// From its start to its end, a damped motion in which nodes slide and stick again breaks the law of friction; no step does.
#[test]
fn damped_motions_are_judged_step_by_step() {
    for name in [
        "slides-and-sticks-again-in-motion",
        "slips-off-in-several-motions",
    ] {
        let file = format!("{}/tests/findings/{name}.ron", env!("CARGO_MANIFEST_DIR"));
        let trial = attempt(&Scene::open(&file, &[]).unwrap());
        assert_eq!(trial.end, End::Finished, "{name}");
        assert!(trial.fallbacks.contains(&Fallback::Release), "{name}");
        assert!(trial.wrong.is_empty(), "{name}: {:?}", trial.wrong);
    }
}

#[test]
fn none_is_wrong_on_smooth_surfaces_either() {
    let smooth = [("surfaces.*.smooth".to_owned(), "true".to_owned())];
    let rows = tally::run(1, 0..SCENES, &smooth, |_| {});
    let wrong = rows.iter().filter(|row| row.is_wrong());
    let wrong: Vec<String> = wrong.map(|row| row.line()).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let accepted: usize = rows.iter().map(|row| row.trial.increments).sum();
    assert!(accepted > 500, "only {accepted} increments were judged");
}

/// Halves of an increment all fail; the scene gets through on another way round.
#[test]
fn an_increment_whose_halves_all_fail_is_finished_on_a_way_round_and_is_not_wrong() {
    let rows = tally::run(1, 39..40, &[], |_| {});
    let row = &rows[0];
    assert_eq!(row.trial.end, End::Finished, "{}", row.line());
    assert!(
        row.trial.fallbacks.contains(&Fallback::Section),
        "{}",
        row.line()
    );
    assert!(!row.is_wrong(), "{}", row.line());
}

#[test]
fn random_scenes_are_sound_and_depend_on_seed_and_number_alone() {
    for number in 0..20 * FAMILIES.len() as u64 {
        let (drawn, _) = tally::scene(3, number, &[]).unwrap_or_else(|(_, why)| panic!("{why}"));
        assert_eq!(drawn, draw(3, number));
        assert_ne!(drawn.text, draw(4, number).text);
    }
}

/// One slave node on springs over a floor of two elements with a bend of `bend` degrees at the origin, walked towards −x:
/// a roof where it is positive, a valley where it is negative.
fn bent(bend: f64, friction: Friction) -> Scene {
    let (sin, cos) = (0.5 * bend).to_radians().sin_cos();
    let text = format!(
        "(title: \"one node\", nodes: [
            Through(id: \"f\", points: [({cos}, {low}), (0, 0), ({left}, {low})], per_element: 2),
            Node(id: \"s\", at: (0, 0.5))],
        materials: [], bodies: [Springs(id: \"k\", bars: [
            (nodes: [\"s\"], angle: 0, stiffness: 1), (nodes: [\"s\"], angle: 90, stiffness: 1)])],
        surfaces: [(id: \"f\", along: \"f\")],
        slaves: [(nodes: [\"s\"], on: [\"f\"], friction: (angle: {}, cohesion: {}))],
        history: (path: [0, 1], increment: 1))",
        friction.angle,
        friction.cohesion,
        left = -cos,
        low = -sin,
    );
    read(&text)
}

/// The same node over two surfaces of one element each, which meet or cross at the origin.
fn two(one: [Point; 2], other: [Point; 2], friction: Friction) -> Scene {
    let through = |id: &str, ends: [Point; 2]| {
        let [[a, b], [c, d]] = ends;
        format!("Through(id: \"{id}\", points: [({a:?}, {b:?}), ({c:?}, {d:?})], per_element: 2)")
    };
    let text = format!(
        "(title: \"one node\", nodes: [{}, {}, Node(id: \"s\", at: (0, 0.5))],
        materials: [], bodies: [Springs(id: \"k\", bars: [
            (nodes: [\"s\"], angle: 0, stiffness: 1), (nodes: [\"s\"], angle: 90, stiffness: 1)])],
        surfaces: [(id: \"f\", along: \"f\"), (id: \"g\", along: \"g\")],
        slaves: [(nodes: [\"s\"], on: [\"f\", \"g\"], friction: (angle: {}, cohesion: {}))],
        history: (path: [0, 1], increment: 1))",
        through("f", one),
        through("g", other),
        friction.angle,
        friction.cohesion,
    );
    read(&text)
}

/// What the judge says of a node that goes from one place to another and bears a force there; the scene's extent and largest
/// force are 1.
fn verdict(scene: &Scene, from: Point, to: Point, force: Point) -> Verdict {
    after(scene, [from, to], [[0.0; 2], force], 0.0)
}

/// The same, with the forces of both states and a slip that the node brings into the first.
fn after(scene: &Scene, [from, to]: [Point; 2], forces: [Point; 2], brought: f64) -> Verdict {
    let model = &scene.model;
    let state = |at: Point, force: Point| {
        let mut positions: Vec<Point> = model.nodes.iter().map(|n| n.at).collect();
        positions[model.contacts[0].node] = at;
        Seen {
            positions,
            forces: vec![force],
            pulls: Vec::new(),
        }
    };
    let scales = Scales {
        length: 1.0,
        force: 1.0,
    };
    let (before, now) = (state(from, forces[0]), state(to, forces[1]));
    let friction = [model.contacts[0].friction];
    judge(model, [&before, &now], &friction, &[brought], scales)
}

fn broken(verdict: &Verdict) -> Option<Law> {
    assert!(verdict.breaches.len() <= 1, "{verdict:?}");
    verdict.breaches.first().map(|b| b.law)
}

const ROUGH: Friction = Friction {
    angle: 45.0,
    cohesion: 0.0,
};
const SMOOTH: Friction = Friction {
    angle: 0.0,
    cohesion: 0.0,
};

#[test]
fn the_outside_judge_knows_each_law() {
    let rough = bent(0.0, ROUGH);
    let on = |x: f64| [x, 0.0];
    let (a, b) = (on(0.3), on(0.4));
    // The walk goes towards −x, so that a node that goes to +x slips backwards.
    let cases = [
        ("stuck", a, a, [0.3, 0.5], None),
        ("open", a, [0.4, 0.1], [0.0; 2], None),
        ("touching without force", a, b, [0.0; 2], None),
        ("slides to +x", a, b, [-0.5, 0.5], None),
        ("slides to −x", b, a, [0.5, 0.5], None),
        ("inside", a, [0.4, -1e-6], [0.0; 2], Some(Law::Gap)),
        (
            "force from afar",
            a,
            [0.3, 1e-6],
            [0.0, 0.5],
            Some(Law::Gap),
        ),
        (
            "force past the end",
            a,
            [1.1, 0.0],
            [0.0, 0.5],
            Some(Law::Gap),
        ),
        ("pulled", a, a, [0.0, -0.5], Some(Law::Tension)),
        ("beyond the cone", a, a, [0.6, 0.5], Some(Law::Cone)),
        ("stuck and slips", a, b, [-0.4, 0.5], Some(Law::Stuck)),
        ("creeps", a, on(0.3 + 1e-6), [0.1, 0.5], Some(Law::Stuck)),
        ("driven", a, b, [0.5, 0.5], Some(Law::Driven)),
        ("over the border", on(-0.1), on(0.1), [-0.5, 0.5], None),
        (
            "driven over it",
            on(-0.1),
            on(0.1),
            [0.5, 0.5],
            Some(Law::Driven),
        ),
        ("touched on its way", [0.3, 0.1], b, [0.2, 0.5], None),
    ];
    for (name, from, to, force, expected) in cases {
        let verdict = verdict(&rough, from, to, force);
        assert_eq!(broken(&verdict), expected, "{name}: {verdict:?}");
        assert_eq!((verdict.vertices, verdict.unexplained), (0, 0), "{name}");
    }
    let smooth = bent(0.0, SMOOTH);
    let slanted = verdict(&smooth, a, b, [1e-6, 0.5]);
    assert_eq!(broken(&slanted), Some(Law::Cone));
    assert_eq!(broken(&verdict(&smooth, a, b, [0.0, 0.5])), None);
    let sticky = bent(
        0.0,
        Friction {
            cohesion: 0.2,
            ..SMOOTH
        },
    );
    assert_eq!(broken(&verdict(&sticky, a, b, [-0.2, 0.5])), None);
    let lacking = verdict(&sticky, a, b, [-0.1, 0.5]);
    assert_eq!(broken(&lacking), Some(Law::Stuck));
}

#[test]
fn friction_along_the_way_of_a_node_that_touched_is_told_apart() {
    let rough = bent(0.0, ROUGH);
    let from = [0.3, 0.1];
    let driven = verdict(&rough, from, [0.4, 0.0], [0.5, 0.5]);
    assert_eq!((broken(&driven), driven.unexplained), (None, 1));
    let slid = verdict(&rough, from, [0.4, 0.0], [-0.5, 0.5]);
    assert_eq!((broken(&slid), slid.unexplained), (None, 0));
}

#[test]
fn at_a_vertex_a_force_is_held_by_both_sides() {
    let at = [0.0, 0.0];
    let on_vertex = |bend: f64, friction: Friction, force: Point| {
        let verdict = verdict(&bent(bend, friction), at, at, force);
        (broken(&verdict), verdict.vertices)
    };
    // In a valley of 2 × 30 degrees a smooth node bears what lies between the normals.
    assert_eq!(on_vertex(-60.0, SMOOTH, [0.0, 0.5]), (None, 1));
    assert_eq!(on_vertex(-60.0, SMOOTH, [0.28, 0.5]), (None, 1));
    assert_eq!(on_vertex(-60.0, SMOOTH, [0.3, 0.5]).0, Some(Law::Cone));
    // What one of the sides can bear alone needs no vertex.
    let normal = [0.5 * 0.5, 0.5 * 0.75_f64.sqrt()];
    assert_eq!(on_vertex(-60.0, SMOOTH, normal), (None, 0));
    // On a roof it slides off, unless friction holds it on either side.
    assert_eq!(on_vertex(60.0, SMOOTH, [0.0, 0.5]).0, Some(Law::Cone));
    let rough = |angle: f64| Friction {
        angle,
        cohesion: 0.0,
    };
    assert_eq!(on_vertex(60.0, rough(31.0), [0.0, 0.5]), (None, 0));
    assert_eq!(on_vertex(60.0, rough(29.0), [0.0, 0.5]).0, Some(Law::Cone));
}

/// The same law as the solver's judge has, from outside: on a kink of one surface and of two, whichever comes first.
#[test]
fn a_node_that_slid_onto_a_kink_bears_friction_at_its_limit_against_the_slip() {
    let (bend, friction) = (
        -0.02,
        Friction {
            angle: 30.0,
            cohesion: 0.0,
        },
    );
    let rise = (0.5_f64 * 0.02).to_radians();
    let (from, at) = ([0.5 * rise.cos(), 0.5 * rise.sin()], [0.0, 0.0]);
    let edge = |times: f64| {
        let (sin, cos) = (30_f64.to_radians() + times * rise).sin_cos();
        [0.5 * sin, 0.5 * cos]
    };
    let ends = |right: f64, left: f64| {
        let (sin, cos) = rise.sin_cos();
        [[right * cos, right * sin], [left * cos, -left * sin]]
    };
    for scene in [
        bent(bend, friction),
        two(ends(1.0, 0.0), ends(0.0, -1.0), friction),
        two(ends(0.0, -1.0), ends(1.0, 0.0), friction),
        two(
            [ends(1.0, 0.0)[0], ends(-1.0, 0.0)[0]],
            [ends(0.0, 1.0)[1], ends(0.0, -1.0)[1]],
            friction,
        ),
        two(
            [ends(0.0, 1.0)[1], ends(0.0, -1.0)[1]],
            [ends(1.0, 0.0)[0], ends(-1.0, 0.0)[0]],
            friction,
        ),
    ] {
        for side in [1.0, -1.0] {
            let slid = |force: Point| {
                let turned = |p: Point| [side * p[0], p[1]];
                broken(&verdict(&scene, turned(from), at, turned(force)))
            };
            for times in [-1.0, 0.0, 1.0] {
                assert_eq!(slid(edge(times)), None, "{times}");
            }
            assert_eq!(slid(edge(1.01)), Some(Law::Cone));
            assert_eq!(slid(edge(-1.01)), Some(Law::Stuck));
            assert_eq!(slid([0.0, 0.5]), Some(Law::Stuck));
            assert_eq!(slid([-0.1, 0.5]), Some(Law::Driven));
            let stood = |force: Point| broken(&verdict(&scene, at, at, force));
            assert_eq!(stood([0.0, 0.5]), None);
            assert_eq!(stood(edge(0.0)), None);
            assert_eq!(stood([0.0, -0.5]), Some(Law::Tension));
        }
    }
}

#[test]
fn forces_from_outside_must_balance() {
    let scene = bent(0.0, SMOOTH);
    let pull = |at: Point, force: Point| Pull {
        at,
        force,
        moment: 0.0,
    };
    let said = |pulls: Vec<Pull>| {
        let positions = scene.model.nodes.iter().map(|n| n.at).collect();
        let state = Seen {
            positions,
            forces: vec![[0.0; 2]],
            pulls,
        };
        let scales = Scales {
            length: 1.0,
            force: 1.0,
        };
        let friction = [SMOOTH];
        broken(&judge(
            &scene.model,
            [&state, &state],
            &friction,
            &[0.0],
            scales,
        ))
    };
    let (up, down) = ([0.0, 1.0], [0.0, -1.0]);
    assert_eq!(
        said(vec![pull([0.2, 0.0], up), pull([0.2, 0.5], down)]),
        None
    );
    let pair = vec![pull([0.2, 0.0], up), pull([0.3, 0.5], down)];
    assert_eq!(said(pair), Some(Law::Balance));
    assert_eq!(said(vec![pull([0.2, 0.0], up)]), Some(Law::Balance));
}

#[test]
fn the_closest_point_of_a_curved_chain_is_found_and_its_length_measured() {
    // A quarter of the unit circle, anticlockwise: two elements of 9 nodes are a circle to 1e-9.
    let at = |k: usize| (k as f64 / 16.0 * std::f64::consts::FRAC_PI_2).sin_cos();
    let node = |k: usize| [at(k).1, at(k).0];
    let chain = Chain::through(vec![
        (0..=8).map(node).collect(),
        (8..=16).map(node).collect(),
    ]);
    for (degrees, radius) in [(20.0_f64, 1.3), (70.0, 0.4), (45.0, 1.1), (44.9, 0.9)] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let Sight::Over(site, gap) = chain.see([radius * cos, radius * sin]) else {
            panic!("not over the chain at {degrees}");
        };
        assert!((gap - (radius - 1.0)).abs() < 1e-8, "{degrees}: {gap}");
        assert!((site.foot[0] - cos).abs() < 1e-7, "{degrees}: {site:?}");
    }
    assert!(matches!(chain.see([1.2, -0.1]), Sight::Beyond(_, by) if (by - 0.1).abs() < 1e-6));
    let place = |element: usize, xi: f64| Place { element, xi };
    let there = chain.length(place(0, 0.0), place(1, 0.0));
    assert!((there - 0.25 * std::f64::consts::PI).abs() < 1e-8);
    assert_eq!(chain.length(place(1, 0.0), place(0, 0.0)), -there);
}

#[test]
fn slip_that_a_scene_brings_counts() {
    let scene = bent(0.0, ROUGH);
    let at = [0.3, 0.0];
    let said =
        |brought: f64, force: Point| broken(&after(&scene, [at, at], [[0.0; 2], force], brought));
    // It stands where it stands, but had come from +x before.
    assert_eq!(said(0.1, [0.3, 0.5]), Some(Law::Stuck));
    assert_eq!(said(0.1, [0.5, 0.5]), None);
    assert_eq!(said(0.1, [-0.5, 0.5]), Some(Law::Driven));
    assert_eq!(said(0.0, [0.3, 0.5]), None);
}
