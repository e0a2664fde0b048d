//! What round-off leaves: nodes that press from a distance, springs so soft that their force is nothing, scenes far from the
//! origin, and bodies far stiffer than others.

use crate::common::{Run, last, read, run, scene};
use stickslip::scene::{Scene, precision};

fn opened(name: &str, set: &[(&str, &str)]) -> Scene {
    scene(&format!("tests/findings/{name}"), set)
}

fn solved(scene: &Scene) -> Run {
    let run = run(scene);
    assert!(run.failure.is_none(), "{:?}", run.failure);
    assert_eq!(
        run.accepted.last().unwrap().load,
        *scene.model.path.last().unwrap()
    );
    run
}

/// A block on another, with a penalty and a stick slope. With ties as printed no increment is refused for elastic slip, so
/// nothing is cut there.
#[test]
fn soft_friction_takes_the_increments_of_its_deck_and_converges_quadratically() {
    let [kept, printed] = ["keep", "printed"]
        .map(|ties| solved(&opened("soft-friction.inp", &[("settings.ties", ties)])));
    assert_eq!((kept.accepted.len(), printed.accepted.len()), (15, 15));
    for monitor in ["contact x", "contact y"] {
        let [a, b] = [&kept, &printed].map(|run| last(run, monitor));
        assert!((a - b).abs() <= 1e-11 * b.abs(), "{monitor}: {a} {b}");
    }
    let majors: u32 = kept
        .accepted
        .iter()
        .map(|step| step.event.position.major)
        .sum();
    assert!(majors <= 6 * 15, "{majors}");
}

#[test]
fn press_fits_are_solved_where_nodes_stand_inside_their_surface() {
    let pulled = solved(&opened("press-fit-pulled.ron", &[]));
    // Pulled back and forth, the whole shaft slides: F_t = tan φ F_n at every node, along a bore that has bent by about 1e-5.
    let [f_x, f_y] = ["fx", "fy"].map(|name| last(&pulled, name));
    assert!(((f_y / f_x).abs() - 0.1).abs() < 1e-5, "{f_x} {f_y}");
    assert!(pulled.accepted.len() < 40, "{}", pulled.accepted.len());
    let pushed = solved(&opened("overlap-pushed-out.ron", &[]));
    assert!(pushed.accepted.len() < 40, "{}", pushed.accepted.len());
    assert!(last(&pushed, "f_y") > 50.0);
}

/// Pressed by 10 over a circle of radius 8.
#[test]
fn a_ball_on_its_axis_presses_a_block_by_its_load() {
    let run = solved(&opened("ball-on-axis.inp", &[]));
    let force = last(&run, "contact y");
    let exact = 10.0 * std::f64::consts::PI * 64.0;
    assert!((force / exact - 1.0).abs() < 2e-4, "{force} {exact}");
    // The node on the axis bears nothing, and its area is not lost.
    let model = run.stepper.model();
    assert!(
        model
            .contacts
            .iter()
            .all(|c| model.nodes[c.node].at[0] > 0.0)
    );
    let areas: f64 = model.contacts.iter().filter_map(|c| c.area).sum();
    let cap = 2.0 * std::f64::consts::PI * 50.0 * (50.0 - (2500.0_f64 - 64.0).sqrt());
    assert!((areas / cap - 1.0).abs() < 1e-5, "{areas} {cap}");
}

/// The same ball with its faces integrated: at gap 0 none of the integration points touches, and the ball is loose.
#[test]
fn a_ball_integrated_over_its_faces_finds_its_block() {
    let nodes = std::fs::read_to_string("tests/findings/ball-on-axis.inp").unwrap();
    assert!(nodes.contains("NODE TO SURFACE"));
    let folder = tempfile::tempdir().unwrap();
    let deck = folder.path().join("ball-on-axis.inp");
    std::fs::write(
        &deck,
        nodes.replace("NODE TO SURFACE", "SURFACE TO SURFACE"),
    )
    .unwrap();
    let run = solved(&scene(deck.to_str().unwrap(), &[]));
    let force = last(&run, "contact y");
    let exact = 10.0 * std::f64::consts::PI * 64.0;
    assert!((force / exact - 1.0).abs() < 2e-4, "{force} {exact}");
    let contacts = &run.stepper.model().contacts;
    assert!(contacts.iter().all(|contact| !contact.weights.is_empty()));
}

/// Its force at this depth is 1e-12, where another node's is 1.
#[test]
fn a_node_on_a_spring_whose_force_is_nothing_may_be_inside() {
    let text = "(title: \"soft\", nodes: [Node(id: \"a\", at: (0.0, 0.0)), Node(id: \"b\", at: (1.0, 0.0)),
        Line(id: \"floor\", from: (3.0, 0.0), to: (-2.0, 0.0), elements: 1, per_element: 2)], materials: [],
        bodies: [Springs(id: \"k\", bars: [(nodes: [\"a\"], angle: 0.0, stiffness: 1.0), (nodes: [\"a\"], angle: 90.0, stiffness: 1.0),
            (nodes: [\"b\"], angle: 0.0, stiffness: 1.0), (nodes: [\"b\"], angle: 90.0, stiffness: 1.0)])],
        surfaces: [(id: \"floor\", along: \"floor\")],
        slaves: [(nodes: [\"a\"], on: [\"floor\"], start: fixed),
            (nodes: [\"b\"], on: [\"floor\"], law: Penalty(stiffness: 1000.0), area: 1e-12)],
        loads: [Force(node: \"a\", y: -1.0), Force(node: \"b\", y: -0.001)],
        history: (path: [0.0, 1.0], increment: 0.5),
        monitors: [(name: \"b\", of: Displacement(node: \"b\", component: y))])";
    let run = solved(&read(text));
    assert!((last(&run, "b") + 0.001).abs() < 1e-10);
}

/// The same two blocks, pushed along each other, at the origin and 100,000 lengths away from it.
#[test]
fn a_scene_far_from_the_origin_is_solved_to_its_own_round_off() {
    let text = std::fs::read_to_string("tests/findings/overlap-pushed-out.ron").unwrap();
    let text = text
        .replace("0.92", "1.0")
        .replace("1.4)", "1.48)")
        .replace("ramp", "keep");
    let at = |x: f64| {
        let moved = text
            .replace("(0.2, 1.0)", &format!("({:?}, 1.0)", 0.2 + x))
            .replace("(0.8, 1.48)", &format!("({:?}, 1.48)", 0.8 + x))
            .replace(
                "(0.0, 0.0), (1.0, 1.0)",
                &format!("({x:?}, 0.0), ({:?}, 1.0)", 1.0 + x),
            );
        solved(&read(&moved))
    };
    let near = at(0.0);
    for x in [1e5, 1e7] {
        let far = at(x);
        assert!(
            far.accepted.len() <= 2 * near.accepted.len(),
            "{}",
            far.accepted.len()
        );
        for monitor in ["f_x", "f_y"] {
            let [a, b] = [&near, &far].map(|run| last(run, monitor));
            assert!(
                (a - b).abs() < 1e-14 * x * 1e3 * a.abs(),
                "{x}, {monitor}: {a} {b}"
            );
        }
    }
}

#[test]
fn a_body_too_stiff_for_double_precision_is_warned_of_before_the_run() {
    let with = |ea: &str| {
        let scene = scene(
            "tests/failures/wrong-EA1e16.ron",
            &[("materials.steel.EA", ea)],
        );
        precision::warning(&scene.model)
    };
    let warning = with("1e16").unwrap();
    assert!(warning.contains("body strip, EA = 1e16"), "{warning}");
    assert!(with("1e12").is_some());
    assert_eq!(with("1e8"), None);
    for name in ["01-pinned-beam-rough-floor", "05-cantilever-elastic-block"] {
        assert_eq!(precision::warning(&scene(name, &[]).model), None);
    }
}
