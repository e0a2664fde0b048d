//! Any pairing of slaves and masters: nodes of beams and of solids on chains of 2 to 9 nodes that belong to beams, to
//! solids or to nobody, over borders of elements and corners of surfaces, from one body to the next.

use crate::common::{Run, read, run, two_blocks};
use stickslip::contact::projection::{project, projection_at};
use stickslip::model::Mode;

/// A stated scene, run to its end.
fn solved(text: &str) -> Run {
    let scene = read(text);
    let done = run(&scene);
    if let Some((event, failure)) = &done.failure {
        panic!("load {}: {failure:?}", event.load_factor);
    }
    done
}

/// Current positions of all nodes at an accepted increment.
fn positions(run: &Run, k: usize) -> Vec<[f64; 2]> {
    let model = run.stepper.model();
    let u = &run.accepted[k].state.u;
    let moved = |(n, node): (usize, &stickslip::model::Node)| {
        let d = model.dofs.first[n];
        [node.at[0] + u[d], node.at[1] + u[d + 1]]
    };
    model.nodes.iter().enumerate().map(moved).collect()
}

/// What must hold at every accepted increment: no slave node is inside of what it may touch, measured with a
/// projection of its own that knows nothing of the run; what touches is on the surface; no force pulls.
fn assert_sound(run: &Run) {
    let model = run.stepper.model();
    let near = 1e-8 * model.length;
    for (k, accepted) in run.accepted.iter().enumerate() {
        let x = positions(run, k);
        let scale = accepted
            .event
            .nodes
            .iter()
            .fold(1e-12, |m: f64, n| m.max(n.f_n.abs()));
        for (slave, state) in model.contacts.iter().zip(&accepted.state.nodes) {
            let name = &model.nodes[slave.node].name;
            let at = x[slave.node];
            let load = accepted.load;
            assert!(
                state.f_n >= -1e-8 * scale,
                "load {load}: {name} pulls with {}",
                state.f_n
            );
            if let Some(spot) = project(at, &model.surfaces, &slave.surfaces, &x, None) {
                let gap = projection_at(&model.surfaces, spot, &x, at).gap;
                // Inside means a little: a node deep behind a surface is on the other side of a body.
                assert!(
                    gap > -near || gap < -0.2 * model.length,
                    "load {load}: {name} penetrates by {gap}"
                );
                if state.mode != Mode::Free {
                    assert!(
                        gap.abs() < near,
                        "load {load}: {name} touches at a gap of {gap}"
                    );
                }
            } else {
                assert_eq!(
                    state.mode,
                    Mode::Free,
                    "load {load}: {name} touches nothing"
                );
            }
        }
    }
}

/// A monitor over the run.
fn monitor(run: &Run, name: &str) -> Vec<f64> {
    run.accepted.iter().map(|a| a.monitors[name]).collect()
}

/// Surfaces and elements that slave node 0 touched, one after the other.
fn visited(run: &Run) -> Vec<(usize, usize)> {
    let touching = run
        .accepted
        .iter()
        .map(|a| &a.state.nodes[0])
        .filter(|n| n.mode != Mode::Free);
    let mut all: Vec<(usize, usize)> = touching
        .filter_map(|n| n.spot.map(|s| (s.surface, s.element)))
        .collect();
    all.dedup();
    all
}

/// A soft vertical spring of two bars (axial and bending stiffness of a beam) whose foot is dragged over a profile.
///
/// ```text
///    arm.start  o------ arm, clamped at its start, dragged to +x
///                  \___ o arm.end, the slave
///    ______/\______/    the profile, walked towards −x
/// ```
fn dragged(profile: &str, friction: f64, from: f64, by: f64, steps: f64) -> String {
    format!(
        "(title: \"dragged\", nodes: [
            Line(id: \"arm\", from: ({}, 0.3), to: ({from}, 0.0), elements: 4, per_element: 3), {profile}],
        materials: [Section(id: \"m\", EA: 1000, EI: 1, GA: 400)],
        bodies: [Beam(id: \"arm\", along: \"arm\", material: \"m\")],
        surfaces: [(id: \"floor\", along: \"floor\")],
        slaves: [(nodes: [\"arm.end\"], on: [\"floor\"], start: sliding)],
        friction: (angle: {friction}),
        supports: [(node: \"arm.start\", fix: [y, rotation])],
        loads: [Displacement(node: \"arm.start\", component: x, value: {by}),
            Displacement(node: \"arm.start\", component: y, value: -0.05, scale: [(0, 0), (0.1, 1)])],
        history: (path: [0, 1], increment: {}),
        monitors: [(name: \"x\", of: Displacement(node: \"arm.end\", component: x)),
            (name: \"y\", of: Displacement(node: \"arm.end\", component: y)),
            (name: \"f_x\", of: Contact(component: x)), (name: \"f_y\", of: Contact(component: y)),
            (name: \"r_x\", of: Reaction(node: \"arm.start\", component: x)),
            (name: \"r_y\", of: Reaction(node: \"arm.start\", component: y))])",
        from - 2.0,
        1.0 / steps
    )
    .replace("supports: [(node: \"arm.start\", fix: [y, rotation])]", "supports: [(node: \"arm.start\", fix: [rotation])]")
}

/// Over the dragged arm, contact and support are in balance, the foot only goes forward, and it never sinks in.
fn assert_drags(done: &Run) {
    assert_sound(done);
    for axis in ["x", "y"] {
        let (f, r) = (
            monitor(done, &format!("f_{axis}")),
            monitor(done, &format!("r_{axis}")),
        );
        let scale = f.iter().chain(&r).fold(0.0_f64, |m, v| m.max(v.abs()));
        for (f, r) in f.iter().zip(&r) {
            assert!((f + r).abs() < 1e-7 * scale, "{axis}: {f} against {r}");
        }
    }
    let x = monitor(done, "x");
    assert!(
        x.windows(2).all(|w| w[1] > w[0]),
        "the foot went back: {x:?}"
    );
}

#[test]
fn a_node_slides_over_the_borders_of_elements_of_2_to_9_nodes() {
    for m in 2..=9 {
        // A gentle arch of three elements.
        let floor = format!(
            "Arc(id: \"floor\", center: (0.7, -8), radius: 8, from: 80, to: 100, elements: 3, per_element: {m})"
        );
        let done =
            solved(&dragged(&floor, 0.0, 0.0, 1.5, 60.0).replace("start: sliding", "start: free"));
        assert_drags(&done);
        let elements: Vec<usize> = visited(&done).iter().map(|v| v.1).collect();
        assert!(
            elements.len() >= 2 && elements.windows(2).all(|w| w[0] > w[1]),
            "{m}: {elements:?}"
        );
    }
}

#[test]
fn a_node_slides_down_into_a_valley_and_up_again() {
    let floor = "Through(id: \"floor\", points: [(4, 0.3), (1, 0), (-2, 0.1)], per_element: 2)";
    let done = solved(
        &dragged(floor, 5.0, 0.0, 1.8, 60.0).replace("(0, 0.0), elements", "(0, 0.07), elements"),
    );
    assert_drags(&done);
    assert_eq!(visited(&done), [(0, 1), (0, 0)]);
}

#[test]
fn a_node_slides_over_a_ridge() {
    let floor = "Through(id: \"floor\", points: [(4, -0.4), (0.7, 0), (-2, 0)], per_element: 2)";
    let done = solved(&dragged(floor, 5.0, 0.0, 1.5, 60.0));
    assert_drags(&done);
    assert_eq!(visited(&done), [(0, 1), (0, 0)]);
}

#[test]
fn a_node_passes_from_one_body_s_surface_to_another_s() {
    let text = dragged(
        "Line(id: \"floor\", from: (0.8, 0), to: (-1, 0), elements: 2, per_element: 3),
         Line(id: \"next\", from: (4, 0), to: (0.8, 0), elements: 2, per_element: 2),
         Line(id: \"far\", from: (4, -3), to: (-1, -3), elements: 1, per_element: 2)",
        8.0,
        0.0,
        1.5,
        40.0,
    )
    .replace("(id: \"floor\", along: \"floor\")", "(id: \"far\", along: \"far\"), (id: \"floor\", along: \"floor\"), (id: \"next\", along: \"next\")")
    .replace("on: [\"floor\"]", "on: [\"far\", \"floor\", \"next\"]");
    let done = solved(&text);
    assert_drags(&done);
    let surfaces: Vec<usize> = visited(&done).iter().map(|v| v.0).collect();
    assert!(
        surfaces.starts_with(&[1]) && surfaces.ends_with(&[2]),
        "{surfaces:?}"
    );
    assert!(surfaces.windows(2).all(|w| w[0] <= w[1]), "{surfaces:?}");
}

/// A strip of a solid over another, and what else: the lower one is held below.
fn strips(slaves: &str, masters: &str, extra: &str) -> String {
    format!(
        "(title: \"strips\", nodes: [
            Block(id: \"low\", corners: [(0, 0), (4, 1)], elements: (4, 1)),
            Block(id: \"up\", corners: [(0.7, 1), (3.1, 2)], elements: (3, 1))],
        materials: [Elastic(id: \"e\", E: 100, nu: 0.3)],
        bodies: [Solid(id: \"low\", mesh: \"low\", material: \"e\"), Solid(id: \"up\", mesh: \"up\", material: \"e\")],
        surfaces: [{masters}], slaves: [{slaves}],
        supports: [(node: \"low.bottom\", fix: [x, y]), (node: \"up.top\", fix: [x])],
        loads: [Traction(along: \"up.top\", normal: -1), {extra}],
        history: (path: [0, 1], increment: 0.25),
        monitors: [(name: \"f_x\", of: Contact(component: x)), (name: \"f_y\", of: Contact(component: y))])"
    )
}

#[test]
fn solids_press_on_each_other_in_either_role_with_the_same_force() {
    let roles = [
        (
            "(nodes: [\"up.bottom\"], on: [\"low\"], start: sliding)",
            "(id: \"low\", along: \"low.top\")",
        ),
        (
            "(nodes: [\"low.top\"], on: [\"up\"], start: sliding)",
            "(id: \"up\", along: \"up.bottom\")",
        ),
    ];
    for (slaves, masters) in roles {
        let done = solved(&strips(slaves, masters, ""));
        assert_sound(&done);
        let f = monitor(&done, "f_y");
        let sign = if slaves.contains("up.bottom\"]") {
            1.0
        } else {
            -1.0
        };
        for (f, a) in f.iter().zip(&done.accepted) {
            assert!(
                (f - sign * 2.4 * a.load).abs() < 1e-8,
                "{f} at load {}",
                a.load
            );
        }
    }
}

#[test]
fn a_beam_s_nodes_rest_on_a_solid_and_a_solid_s_nodes_on_a_beam() {
    for (slaves, along) in [("rod.all", "k.top"), ("k.top", "rod")] {
        let text = format!(
            "(title: \"rod on block\", nodes: [
                Block(id: \"k\", corners: [(0, 0), (4, 1)], elements: (4, 2)),
                Line(id: \"rod\", from: (-0.5, 1), to: (4.5, 1), elements: 4, per_element: 4)],
            materials: [Elastic(id: \"e\", E: 100, nu: 0.3), Section(id: \"m\", EA: 1000, EI: 20)],
            bodies: [Solid(id: \"k\", mesh: \"k\", material: \"e\"), Beam(id: \"rod\", along: \"rod\", material: \"m\")],
            surfaces: [(id: \"s\", along: \"{along}\")], slaves: [(nodes: [\"{slaves}\"], on: [\"s\"], start: sliding)],
            supports: [(node: \"k.bottom\", fix: [x, y]), (node: \"rod.start\", fix: [x])],
            loads: [Traction(along: \"rod\", y: -1)],
            history: (path: [0, 1], increment: 0.25),
            monitors: [(name: \"f_y\", of: Contact(component: y))])"
        );
        let done = solved(&text);
        assert_sound(&done);
        let sign = if slaves == "rod.all" { 1.0 } else { -1.0 };
        for (f, a) in monitor(&done, "f_y").iter().zip(&done.accepted) {
            assert!(
                (f - sign * 5.0 * a.load).abs() < 1e-7,
                "{slaves}: {f} at load {}",
                a.load
            );
        }
    }
}

#[test]
fn a_master_of_restrained_nodes_of_a_body_bears_what_presses_on_it() {
    // The lower strip's upper edge is held: the surface is rigid, though its body is not.
    let text = strips(
        "(nodes: [\"up.bottom\"], on: [\"low\"], start: sliding)",
        "(id: \"low\", along: \"low.top\")",
        "",
    )
    .replace(
        "(node: \"low.bottom\", fix: [x, y])",
        "(node: \"low.top\", fix: [x, y]), (node: \"low.bottom.start\", fix: [x])",
    );
    let done = solved(&text);
    assert_sound(&done);
    assert!(done.stepper.model().surfaces[0].rigid);
    let f = monitor(&done, "f_y");
    assert!((f[3] - 2.4).abs() < 1e-9, "{f:?}");
    let x = positions(&done, 3);
    for &n in &done.stepper.model().bodies[0].nodes {
        let at = done.stepper.model().nodes[n].at;
        assert!(
            (x[n][0] - at[0]).hypot(x[n][1] - at[1]) < 1e-12,
            "what is behind feels nothing"
        );
    }
}

#[test]
fn both_bodies_in_both_roles_balance_with_the_load() {
    // The nodes of either strip that lie off the nodes of the other.
    let done = solved(&strips(
        "(nodes: [\"up.bottom\"], on: [\"low\"], start: sliding), (nodes: [\"low.top.4\", \"low.top.5\"], on: [\"up\"])",
        "(id: \"low\", along: \"low.top\"), (id: \"up\", along: \"up.bottom\")",
        "",
    ));
    let last = done.accepted.last().unwrap();
    let model = done.stepper.model();
    // Forces on the slaves of the upper strip less those on the slaves of the lower one bear the load.
    let mut lift = 0.0;
    for (slave, state) in model.contacts.iter().zip(&last.state.nodes) {
        let on_up = model.nodes[slave.node].name.starts_with("up");
        lift += if on_up { 1.0 } else { -1.0 } * state.force()[1];
    }
    assert!((lift - 2.4).abs() < 1e-8, "{lift}");
    assert_sound(&done);
}

/// A pile of blocks, each narrower than the one below, pressed together from above by their weight.
fn pile(count: usize, friction: f64) -> String {
    let mut text = String::from("(title: \"pile\", nodes: [");
    for k in 0..count {
        let (a, b) = (0.13 * k as f64, 3.0 - 0.11 * k as f64);
        text += &format!(
            "Block(id: \"b{k}\", corners: [({a}, {k}), ({b}, {})], elements: ({}, 1)),",
            k + 1,
            4 + k % 2
        );
    }
    text += "], materials: [Elastic(id: \"e\", E: 200, nu: 0.25)], bodies: [";
    for k in 0..count {
        text += &format!("Solid(id: \"b{k}\", mesh: \"b{k}\", material: \"e\"),");
    }
    text += "], surfaces: [";
    for k in 0..count - 1 {
        text += &format!("(id: \"s{k}\", along: \"b{k}.top\"),");
    }
    text += "], slaves: [";
    for k in 1..count {
        text += &format!(
            "(nodes: [\"b{k}.bottom\"], on: [\"s{}\"], start: fixed),",
            k - 1
        );
    }
    text += &format!(
        "], friction: (angle: {friction}), supports: [(node: \"b0.bottom\", fix: [x, y])], loads: ["
    );
    for k in 0..count {
        text += &format!("Traction(along: \"b{k}.top\", y: -1, x: 0.05),");
    }
    text += "], history: (path: [0, 1], increment: 0.25), monitors: [";
    for k in 1..count {
        text +=
            &format!("(name: \"m{k}\", of: Displacement(node: \"b{k}.top@0.5\", component: x)),");
    }
    text + "])"
}

#[test]
fn a_pile_of_four_blocks_passes_all_forces_down() {
    let done = solved(&pile(4, 30.0));
    assert_sound(&done);
    let model = done.stepper.model();
    for accepted in &done.accepted {
        for k in 1..4 {
            // What lies on the joint below block k: the tractions on the tops of k and all above it.
            let above: f64 = (k..4).map(|j| 3.0 - 0.24 * j as f64).sum();
            let mut sum = [0.0; 2];
            for (slave, state) in model.contacts.iter().zip(&accepted.state.nodes) {
                if model.nodes[slave.node].name.starts_with(&format!("b{k}.")) {
                    let f = state.force();
                    sum = [sum[0] + f[0], sum[1] + f[1]];
                }
            }
            let want = [-0.05 * above * accepted.load, above * accepted.load];
            assert!(
                (sum[0] - want[0]).hypot(sum[1] - want[1]) < 1e-8,
                "joint {k}: {sum:?}, not {want:?}"
            );
        }
    }
}

/// A small block that is pushed down and drawn over the top of one or more others, which are held below.
fn drawn(master: &str, held: &str, along: &str, surfaces: &str, on: &str, shift: f64) -> String {
    format!(
        "(title: \"drawn\", nodes: [
            Block(id: \"shoe\", corners: [(0.1, 1), (0.4, 1.3)], elements: (2, 2)), {master}],
        materials: [Elastic(id: \"e\", E: 400, nu: 0.2), Elastic(id: \"f\", E: 100, nu: 0.3)],
        bodies: [Solid(id: \"shoe\", mesh: \"shoe\", material: \"e\"), {along}],
        surfaces: [{surfaces}],
        slaves: [(nodes: [\"shoe.bottom\"], on: [{on}], start: sliding)],
        supports: [{held}],
        loads: [Displacement(node: \"shoe.top\", component: y, value: -0.02, scale: [(0, 0), (0.1, 1)]),
            Displacement(node: \"shoe.top\", component: x, value: {shift})],
        history: (path: [0, 1], increment: 0.02),
        monitors: [(name: \"x\", of: Displacement(node: \"shoe.bottom@0.5\", component: x)),
            (name: \"f_x\", of: Contact(component: x)), (name: \"f_y\", of: Contact(component: y))])"
    )
}

/// The shoe goes forward, and what acts on its sole is what its top is held with: reactions of all its upper nodes.
fn assert_draws(done: &Run) {
    assert_sound(done);
    let x = monitor(done, "x");
    assert!(
        x.windows(2).all(|w| w[1] > w[0]),
        "the shoe went back: {x:?}"
    );
    let f = monitor(done, "f_y");
    assert!(f.iter().all(|&f| f > 0.0), "the shoe lost its load: {f:?}");
    assert!(
        monitor(done, "f_x")
            .iter()
            .zip(&f)
            .all(|(t, f)| t.abs() < 0.6 * f)
    );
}

#[test]
fn a_shoe_goes_over_the_gap_between_two_elastic_blocks_and_changes_its_master() {
    let text = drawn(
        "Block(id: \"a\", corners: [(0, 0), (0.8, 1)], elements: (4, 2)),
         Block(id: \"b\", corners: [(0.8, 0), (1.6, 1)], elements: (3, 2))",
        "(node: \"a.bottom\", fix: [x, y]), (node: \"b.bottom\", fix: [x, y])",
        "Solid(id: \"a\", mesh: \"a\", material: \"f\"), Solid(id: \"b\", mesh: \"b\", material: \"f\")",
        "(id: \"a\", along: \"a.top\"), (id: \"b\", along: \"b.top\")",
        "\"a\", \"b\"",
        1.0,
    );
    let done = solved(&text);
    assert_draws(&done);
    let surfaces = |k: usize| -> Vec<usize> {
        let nodes = &done.accepted[k].state.nodes;
        nodes
            .iter()
            .filter_map(|n| n.spot.map(|s| s.surface))
            .collect()
    };
    assert_eq!(surfaces(0), [0; 5]);
    assert_eq!(surfaces(done.accepted.len() - 1), [1; 5]);
}

#[test]
fn a_shoe_goes_over_the_ridge_of_an_elastic_surface_with_a_corner() {
    // The tops of two joined blocks, bent down at the joint.
    for friction in [0, 10] {
        let text = drawn(
            "Block(id: \"a\", corners: [(0, 0), (0.8, 0), (0.8, 1), (0, 1)], elements: (4, 2)),
             Block(id: \"b\", corners: [(0.8, 0), (1.6, 0), (1.6, 0.94), (0.8, 1)], elements: (4, 2)),
             Mesh(id: \"ab\", of: [\"a\", \"b\"], joints: [(\"a.right\", \"b.left\")]),
             Chain(id: \"top\", of: [\"b.top\", \"a.top\"], per_element: 3)",
            "(node: \"a.bottom\", fix: [x, y]), (node: \"b.bottom\", fix: [x, y])",
            "Solid(id: \"ab\", mesh: \"ab\", material: \"f\")",
            "(id: \"top\", along: \"top\")",
            "\"top\"",
            0.9,
        )
        .replace("value: -0.02", "value: -0.03")
        .replace("scale: [(0, 0), (0.1, 1)]", "scale: [(0, 0), (0.1, 1), (0.5, 1), (1, 1.2)]")
        .replace("supports:", &format!("friction: (angle: {friction}), supports:"));
        let done = solved(&text);
        assert_sound(&done);
        let nodes = &done.accepted.last().unwrap().state.nodes;
        let elements: Vec<usize> = nodes
            .iter()
            .filter_map(|n| n.spot.map(|s| s.element))
            .collect();
        assert!(
            elements.len() == 5 && elements.iter().all(|e| *e < 4),
            "over the ridge: {elements:?}"
        );
    }
}

#[test]
fn the_large_scene_is_large_and_its_small_form_balances() {
    let large = two_blocks(8);
    assert_eq!(large.model.contacts.len(), 193);
    assert!((9_900..10_200).contains(&stickslip::scene::cost::Cost::from_scene(&large).unknowns()));
    let done = run(&two_blocks(1));
    assert!(done.failure.is_none());
    assert_sound(&done);
    let (x, y) = (monitor(&done, "contact_x"), monitor(&done, "contact_y"));
    let mu = 20_f64.to_radians().tan();
    assert!(y.windows(2).all(|w| w[1] > w[0]) && y[0] > 0.0, "{y:?}");
    assert!(
        x.iter().zip(&y).all(|(x, y)| *x < 0.0 && x.abs() < mu * y),
        "{x:?} {y:?}"
    );
}
