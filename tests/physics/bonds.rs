//! Laws of pairs together with what else a scene may ask for: an axis, press fits, arcs, changes by hand, snapshots.

use crate::common::{finished, read, run};
use crate::start_gaps::bar;
use std::sync::Arc;
use stickslip::format::spec::LoadSpec;
use stickslip::model::{Friction, Mode};
use stickslip::record::snapshot::Snapshot;
use stickslip::scene::Scene;
use stickslip::scene::cost::Cost;
use stickslip::step::intervene::Intervention;
use stickslip::step::stepper::Stepper;

/// A cylinder of radius 2 and height 1 on a penalty floor, pressed by its top.
const CYLINDER: &str = r#"(
    title: "A cylinder on a floor that gives way",
    nodes: [
        Block(id: "k", corners: [(0, 0), (2, 1)], elements: (4, 2), element: quad8),
        Line(id: "floor", from: (3, 0), to: (-1, 0), elements: 1, per_element: 2),
    ],
    materials: [Elastic(id: "m", E: 1000, nu: 0, plane: axisymmetric, update: small)],
    bodies: [Solid(id: "k", mesh: "k", material: "m")],
    surfaces: [(id: "floor", along: "floor")],
    slaves: [(nodes: ["k.bottom"], on: ["floor"], law: Penalty(stiffness: 500.0))],
    supports: [(node: "k.left", fix: [x])],
    loads: [Displacement(node: "k.top", component: y, value: -0.001)],
    history: (path: [0, 1], increment: 0.5),
    monitors: [(name: "y", of: Contact(component: y)), (name: "pressure", of: Pressure())],
)"#;

#[test]
fn a_corner_on_the_axis_has_no_area_and_is_left_out_of_the_penalty_and_named() {
    let scene = read(CYLINDER);
    let on_axis = |node: usize| scene.model.nodes[node].at == [0.0, 0.0];
    assert!(
        scene
            .model
            .contacts
            .iter()
            .all(|slave| !on_axis(slave.node))
    );
    assert_eq!(scene.model.contacts.len(), 8, "of 9 nodes of the bottom");
    let told = Cost::from_scene(&scene).to_string();
    assert!(told.contains("A = 0") && told.contains("k.1"), "{told}");
    let run = finished(&scene);
    // p = u / (h / E + 1 / K) on the whole circle.
    let pressure = 1e-3 / (1.0 / 1000.0 + 1.0 / 500.0);
    let monitors = &run.accepted.last().unwrap().monitors;
    for (found, exact) in [
        (monitors["y"], pressure * std::f64::consts::PI * 4.0),
        (monitors["pressure"], pressure),
    ] {
        assert!((found / exact - 1.0).abs() < 1e-9, "{found} {exact}");
    }
}

#[test]
fn an_overlap_that_is_closed_step_by_step_ends_where_one_closed_at_once_does() {
    let ends = ["initial_gaps: ramp", "initial_gaps: keep"].map(|settings| {
        // On a spring of 5 · 2, from 0.1 inside.
        let law = ", law: Penalty(stiffness: 5.0), stick: 7.0, area: 2.0";
        let run = run(&bar(0.1, law, settings, "[0.0, 1.0]"));
        assert!(run.failure.is_none(), "{settings}: {:?}", run.failure);
        let monitors = &run.accepted.last().unwrap().monitors;
        ["F_n", "y"].map(|name| monitors[name])
    });
    let ([f, y], [f_other, y_other]) = (ends[0], ends[1]);
    assert!(
        (f - f_other).abs() < 1e-9 && (y - y_other).abs() < 1e-9,
        "{ends:?}"
    );
    // g + c F_n = 0 with c = 1 / (5 · 2).
    assert!(f > 0.0 && (-0.1 + y + f / 10.0).abs() < 1e-9, "{ends:?}");
}

/// A block of 2 by 1, pressed on a floor and dragged.
fn dragged(friction: &str, history: &str) -> Scene {
    read(&format!(
        r#"(
    title: "A block dragged over a floor that gives way",
    nodes: [
        Block(id: "b", corners: [(0.0, 0.0), (2.0, 1.0)], elements: (2, 1)),
        Line(id: "floor", from: (9.0, 0.0), to: (-7.0, 0.0), elements: 1, per_element: 2),
    ],
    materials: [Elastic(id: "m", E: 1000.0, nu: 0.0)],
    bodies: [Solid(id: "b", mesh: "b", material: "m")],
    surfaces: [(id: "floor", along: "floor")],
    slaves: [(nodes: ["b.bottom"], on: ["floor"], start: fixed, law: Penalty(stiffness: 800.0), stick: 600.0)],
    friction: {friction},
    loads: [
        Displacement(node: "b.top", component: y, value: -0.01, scale: [(0.0, 0.0), (1.0, 1.0), (2.0, 1.0)]),
        Displacement(node: "b.top", component: x, value: 0.4, scale: [(0.0, 0.0), (1.0, 0.0), (2.0, 1.0)]),
    ],
    history: {history},
    monitors: [(name: "x", of: Contact(component: x)), (name: "y", of: Contact(component: y))],
)"#
    ))
}

#[test]
fn an_arc_follows_the_path_that_steps_of_the_load_do() {
    let ends = ["", ", control: arc"].map(|control| {
        // Both motions from the start, straight: an arc does not go round corners of loads.
        let history = format!("(path: [0.0, 1.0], increment: 0.125{control})");
        let mut spec = dragged("(angle: 10.0)", &history).spec;
        for load in &mut spec.loads {
            if let LoadSpec::Displacement { scale, .. } = load {
                scale.clear();
            }
        }
        let run = run(&Scene::from_spec("dragged", spec).unwrap());
        assert!(run.failure.is_none(), "{control}: {:?}", run.failure);
        let last = run.accepted.last().unwrap();
        assert!((last.load - 1.0).abs() < 1e-12);
        ["x", "y"].map(|name| last.monitors[name])
    });
    for (one, other) in ends[0].iter().zip(ends[1]) {
        assert!((one - other).abs() < 1e-6 * one.abs(), "{ends:?}");
    }
}

#[test]
fn friction_that_is_changed_by_hand_takes_the_place_of_adhesion() {
    let scene = dragged("(adhesion: 0.5)", "(path: [0.0, 2.0], increment: 0.25)");
    let model = Arc::new(scene.model);
    let mut stepper = Stepper::new(model.clone());
    // 0.5 by area is a cohesion by node; half of each node's.
    let half: Vec<Friction> = model
        .contacts
        .iter()
        .map(|slave| {
            assert_eq!(slave.friction.cohesion, 0.5 * slave.area.unwrap());
            Friction {
                cohesion: 0.5 * slave.friction.cohesion,
                ..slave.friction
            }
        })
        .collect();
    stepper.intervene(&Intervention::Frictions(half)).unwrap();
    while stepper.step().is_some() {}
    let event = stepper.event();
    for (slave, node) in model.contacts.iter().zip(&event.nodes) {
        assert_eq!(node.decision.next, Mode::Sliding);
        let [_, shear] = slave.pressure(node.f_n, node.f_t).unwrap();
        assert!((shear.abs() - 0.25).abs() < 1e-9, "{shear}");
    }
}

#[test]
fn a_snapshot_of_bonds_reads_back_to_the_same_bits_and_is_reached_again() {
    let scene = dragged(
        "(angle: 10.0, adhesion: 0.5)",
        "(path: [0.0, 2.0], increment: 0.25)",
    );
    let mut stepper = Stepper::new(Arc::new(scene.model.clone()));
    for _ in 0..12 {
        stepper.step().expect("the scene goes on");
    }
    let (state, event) = (stepper.state(), Some(stepper.event()));
    let snapshot = Snapshot::take(&scene, &[], 12, state, event);
    let text = snapshot.to_text().unwrap();
    let again = Snapshot::from_text("again", &text).unwrap();
    assert_eq!(again, snapshot);
    let replayed = again.replay().unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(replayed.state, snapshot.state);
}
