//! Warnings about the places of bodies after a run: those of `run` are those of the debugger's report.

use crate::program::{code, err, out, ran};
use std::path::Path;
use stickslip::record::command::{Command, Unit};
use stickslip::scene::Scene;
use stickslip::session::Session;

const WEDGE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/tests/findings/wedge-let-go.ron"
);

/// The warnings of `run --quiet` about bodies.
fn warnings(scene: &str, ends: i32) -> Vec<String> {
    let output = ran(Path::new("."), &["run", scene, "--quiet"]);
    assert_eq!(code(&output), ends, "{}", err(&output));
    let lines = err(&output);
    let lines = lines
        .lines()
        .filter_map(|line| line.strip_prefix("warning: "));
    let of_places =
        lines.filter(|line| line.starts_with("bod") || line.contains("past the end of surface"));
    of_places.map(str::to_owned).collect()
}

/// The lines of the debugger's diagnosis after the same run.
fn report(scene: &str) -> Vec<String> {
    let mut session = Session::new(Scene::open(scene, &[]).unwrap());
    let run = Command::Forward {
        unit: Unit::Run,
        count: 1,
    };
    session.submit(run).unwrap();
    session.wait();
    session.submit(Command::Census(Vec::new())).unwrap();
    session.wait();
    session.background_mut().wait();
    let page = session.background().examination(session.timeline().place());
    page.flatten().unwrap().lines()
}

#[track_caller]
fn agree(scene: &str, ends: i32, parts: &[&str]) {
    let warnings = warnings(scene, ends);
    let report = report(scene);
    assert_eq!(warnings.len(), parts.len(), "{warnings:#?}");
    for (warning, part) in warnings.iter().zip(parts) {
        assert!(warning.contains(part), "{warning}");
        assert!(
            report.iter().any(|line| line.trim() == *warning),
            "{warning}\n{report:#?}"
        );
    }
}

#[test]
fn the_report_warns_of_bodies_that_move_without_a_force() {
    agree(WEDGE, 0, &["body wedge moved by up to"]);
}

/// The ram comes down again on a wedge that has moved, too far for the elements.
#[test]
fn the_diagnosis_of_a_failed_run_has_its_warnings() {
    let directory = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(WEDGE).unwrap();
    let crushed = text
        .replace(
            "scale: [(0.0, 0.0), (1.0, 1.0)]",
            "scale: [(0.0, 0.0), (1.0, 1.0), (3.0, 1.0), (4.0, 200.0)]",
        )
        .replace("3.0], increment", "3.0, 4.0], increment");
    assert_ne!(text, crushed);
    let scene = directory.path().join("crushed.ron");
    std::fs::write(&scene, crushed).unwrap();
    let parts = [
        "body wedge moved by up to",
        "bodies base and ram overlap in the last accepted state",
    ];
    agree(scene.to_str().unwrap(), 3, &parts);
}

#[test]
fn nodes_that_face_no_surface_and_runs_without_contact_are_named() {
    let directory = tempfile::tempdir().unwrap();
    let text = |floor: f64, load: f64| {
        format!(
            r#"(title: "t", nodes: [Line(id: "b", from: (0, 0.1), to: (2, 0.1), elements: 2, per_element: 2),
            Line(id: "f", from: ({floor}, 0), to: (-1, 0), elements: 1, per_element: 2)],
            materials: [Section(id: "m", EA: 1000, EI: 1)], bodies: [Beam(id: "b", along: "b", material: "m")],
            surfaces: [(id: "f", along: "f")], slaves: [(nodes: ["b.2", "b.3"], on: ["f"])],
            supports: [(node: "b.start", fix: [x, y, rotation])], loads: [Force(node: "b.end", y: {load})],
            history: (path: [0, 1], increment: 0.5))"#
        )
    };
    let told = |floor: f64, load: f64, command: &str| {
        let scene = directory.path().join("s.ron");
        std::fs::write(scene, text(floor, load)).unwrap();
        let output = ran(directory.path(), &[command, "s.ron"]);
        assert_eq!(code(&output), 0, "{}", err(&output));
        out(&output) + &err(&output)
    };
    assert!(told(3.0, -0.5, "check").contains("gaps      f 0.1\n"));
    let some = told(1.5, -0.5, "check");
    let line = "f 0.1\n          off all surfaces: b.3 (1 of 2 slave nodes)\n";
    assert!(some.contains(line) && !some.contains("warning"), "{some}");
    let none = told(0.5, -0.5, "check");
    assert!(
        none.contains("warning: no slave node faces a surface at the start (b.2, b.3)"),
        "{none}"
    );
    const NEVER: &str = "note: no slave node touched a surface";
    assert!(!told(3.0, -0.5, "run").contains(NEVER));
    assert!(told(3.0, 0.5, "run").contains(NEVER));
}

/// A pad is pressed through a strip on a base: the contact of the strip with the pad is defined the wrong way round.
fn pressed(strip: f64, law: [&str; 2], by: f64) -> String {
    format!(
        r#"(
    title: "Pads on a base",
    nodes: [
        Block(id: "base", corners: [(-1.0, -{strip}), (2.0, 0.0)], elements: (1, 1), element: quad4),
        Block(id: "pad", corners: [(0.0, 0.0), (1.0, 1.0)], elements: (1, 1), element: quad4),
        Block(id: "floor", corners: [(4.0, -1.0), (6.0, 0.0)], elements: (1, 1), element: quad4),
        Block(id: "block", corners: [(4.5, 0.0), (5.5, 1.0)], elements: (1, 1), element: quad4),
    ],
    materials: [Elastic(id: "soft", E: 100.0, nu: 0.2)],
    bodies: [
        Solid(id: "base", mesh: "base", material: "soft"),
        Solid(id: "pad", mesh: "pad", material: "soft"),
        Solid(id: "floor", mesh: "floor", material: "soft"),
        Solid(id: "block", mesh: "block", material: "soft"),
    ],
    surfaces: [(id: "below", along: "pad.bottom"), (id: "ground", along: "floor.top")],
    slaves: [
        (nodes: ["base.top"], on: ["below"]{}),
        (nodes: ["block.bottom"], on: ["ground"]{}),
    ],
    supports: [
        (node: "base.bottom", fix: [x, y]), (node: "pad.top", fix: [x]),
        (node: "floor.bottom", fix: [x, y]), (node: "block.top", fix: [x]),
    ],
    loads: [
        Displacement(node: "pad.top", component: y, value: -{by}),
        Displacement(node: "block.top", component: y, value: -0.1),
    ],
    history: (path: [0.0, 1.0], increment: 0.5),
)"#,
        law[0], law[1]
    )
}

#[test]
fn overlaps_of_thin_bodies_are_found_and_are_in_the_report() {
    let directory = tempfile::tempdir().unwrap();
    let scene = directory.path().join("pads.ron");
    let scene = scene.to_str().unwrap();
    for (strip, by) in [(1.0, 0.1), (0.03, 0.02), (0.002, 0.0009)] {
        std::fs::write(scene, pressed(strip, ["", ""], by)).unwrap();
        agree(
            scene,
            0,
            &["bodies base and pad overlap in the last accepted state"],
        );
    }
    std::fs::write(scene, pressed(0.03, ["", ""], 0.002)).unwrap();
    assert!(warnings(scene, 0).is_empty());
}

/// The soft contact of block and floor says nothing about pad and base.
#[test]
fn a_soft_contact_excuses_only_its_own_bodies() {
    let directory = tempfile::tempdir().unwrap();
    let scene = directory.path().join("pads.ron");
    let scene = scene.to_str().unwrap();
    let soft = ", law: Penalty(stiffness: 50.0)";
    std::fs::write(scene, pressed(1.0, ["", soft], 0.05)).unwrap();
    agree(
        scene,
        0,
        &["bodies base and pad overlap in the last accepted state"],
    );
}

/// A shaft in a ring with flush ends: its corner slips off the end of the bore as both expand.
#[test]
fn a_corner_that_slips_off_a_flush_end_is_named_with_what_helps() {
    let fit = |past_ends: f64, overhang: f64, end: f64| {
        format!(
            r#"(
    title: "Press fit",
    nodes: [
        Block(id: "shaft", corners: [(0, 0), (1, 0.5)], elements: (3, 3)),
        Block(id: "ring", corners: [(1, 0), (2, {})], elements: (4, 3)),
    ],
    materials: [Elastic(id: "m", E: 1000, nu: 0.3, update: small, plane: axisymmetric)],
    bodies: [Solid(id: "shaft", mesh: "shaft", material: "m"), Solid(id: "ring", mesh: "ring", material: "m")],
    surfaces: [(id: "bore", along: "ring.left", past_ends: {past_ends})],
    slaves: [(nodes: ["shaft.right"], on: ["bore"])],
    supports: [(node: "shaft.left", fix: [x]), (node: "shaft.bottom", fix: [y]), (node: "ring.bottom", fix: [y])],
    loads: [Expansion(on: "shaft", strain: 0.001, scale: [(0, 0), (1, 1), (2, -1)])],
    history: (path: [0, {end}], increment: 0.5),
)"#,
            0.5 + overhang
        )
    };
    let directory = tempfile::tempdir().unwrap();
    let scene = directory.path().join("fit.ron");
    let scene = scene.to_str().unwrap();
    std::fs::write(scene, fit(0.0, 0.0, 1.0)).unwrap();
    agree(scene, 0, &["surfaces.bore.past_ends=0.5"]);
    let told = warnings(scene, 0);
    assert!(
        told[0].contains("past the end of surface bore, first in increment 1 (load 0.5)"),
        "{told:?}"
    );
    // Also if the parts are loose at the end.
    std::fs::write(scene, fit(0.0, 0.0, 2.0)).unwrap();
    assert_eq!(warnings(scene, 0), told);
    // The surface continues, or the node is over it, or far outside.
    for (past_ends, overhang) in [(0.5, 0.0), (0.0, 0.1), (0.0, -0.1)] {
        std::fs::write(scene, fit(past_ends, overhang, 1.0)).unwrap();
        assert_eq!(
            warnings(scene, 0),
            Vec::<String>::new(),
            "{past_ends} {overhang}"
        );
    }
}

#[test]
fn loose_bodies_are_named_in_the_order_of_the_scene() {
    let block = |id: &str, x: f64| {
        format!(
            "Block(id: \"{id}\", corners: [({x}, 0.0), ({}, 1.0)], elements: (1, 1)),",
            x + 1.0
        )
    };
    let ids = ["b2", "b10"];
    let [nodes, bodies, slaves, loads] = [
        ids.iter()
            .zip([0.0, 2.0])
            .map(|(id, x)| block(id, x))
            .collect::<String>(),
        ids.map(|id| format!("Solid(id: \"{id}\", mesh: \"{id}\", material: \"soft\"),"))
            .concat(),
        ids.map(|id| {
            format!("(nodes: [\"{id}.bottom\"], on: [\"ground\"], friction: (angle: 30.0)),")
        })
        .concat(),
        ids.map(|id| format!("Force(node: \"{id}.top.2\", y: -1.0),"))
            .concat(),
    ];
    let text = format!(
        r#"(title: "Blocks above the ground",
    nodes: [Block(id: "base", corners: [(-1.0, -1.0), (4.0, -0.01)], elements: (2, 1)), {nodes}],
    materials: [Elastic(id: "soft", E: 1000.0, nu: 0.2)],
    bodies: [Solid(id: "base", mesh: "base", material: "soft"), {bodies}],
    surfaces: [(id: "ground", along: "base.top")],
    slaves: [{slaves}],
    supports: [(node: "base.bottom", fix: [x, y])],
    loads: [{loads}],
    history: (path: [0.0, 1.0], increment: 0.5),
)"#
    );
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("blocks.ron"), text).unwrap();
    let output = ran(directory.path(), &["run", "blocks.ron"]);
    let line = "note: loose until first contact: b2, b10, increment 1";
    assert!(err(&output).contains(line), "{}", err(&output));
}
