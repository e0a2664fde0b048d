//! Gaps that a scene starts with: shown, warned of, adjusted without stress, or closed like a press fit.

use crate::common::{self, finished, read, run, scene};
use stickslip::scene::Scene;
use stickslip::scene::gaps::{start_gaps, warnings};
use stickslip::step::event::Outcome;

/// A bar of length 2 and EA = 10 between a fixed end and a floor that its other end starts `depth` inside of.
pub fn bar(depth: f64, law: &str, settings: &str, path: &str) -> Scene {
    let text = format!(
        r#"(
    title: "A bar that starts inside a floor",
    nodes: [
        Line(id: "bar", from: (0.0, {top}), to: (0.0, {bottom}), elements: 2, per_element: 3),
        Line(id: "floor", from: (1.0, 0.0), to: (-1.0, 0.0), elements: 1, per_element: 2),
    ],
    materials: [Section(id: "rod", EA: 10.0, EI: 1.0)],
    bodies: [Beam(id: "bar", along: "bar", material: "rod")],
    surfaces: [(id: "floor", along: "floor")],
    slaves: [(nodes: ["bar.end"], on: ["floor"]{law})],
    friction: (angle: 20.0),
    supports: [(node: "bar.start", fix: [x, y, rotation])],
    loads: [],
    history: (path: {path}, increment: 0.25),
    settings: ({settings}),
    monitors: [(name: "F_n", of: Contact(component: y)), (name: "y", of: Displacement(node: "bar.end", component: y))],
)"#,
        top = 2.0 - depth,
        bottom = -depth,
    );
    Scene::from_text("bar.ron", &text, &[]).unwrap()
}

fn forces(scene: &Scene) -> Vec<(f64, f64)> {
    let run = run(scene);
    assert!(run.failure.is_none(), "{:?}", run.failure);
    let of = |a: &common::Accepted| (a.load, a.monitors["F_n"]);
    run.accepted.iter().map(of).collect()
}

/// Force of a bar of length 2 and EA = 10 that is shortened by `by`: EA by the engineering strain, which the beams of the
/// paper have.
fn shortened(by: f64) -> f64 {
    10.0 * by / 2.0
}

#[test]
fn a_bar_that_starts_inside_is_pushed_out_by_the_first_increment_unless_told_otherwise() {
    let kept = forces(&bar(0.1, "", "", "[0.0, 1.0]"));
    for (load, force) in kept {
        assert!((force - shortened(0.1)).abs() < 1e-9, "{load}: {force}");
    }
}

#[test]
fn a_press_fit_is_closed_over_the_first_leg_in_proportion_and_stays_closed_afterwards() {
    let ramped = forces(&bar(0.1, "", "initial_gaps: ramp", "[0.0, 1.0, 0.0]"));
    assert_eq!(ramped.len(), 8);
    for (k, (load, force)) in ramped.iter().enumerate() {
        let part = if k < 4 { *load } else { 1.0 };
        let expected = shortened(0.1 * part);
        assert!(
            (force - expected).abs() < 1e-9,
            "{k}: {load}: {force} for {expected}"
        );
    }
}

#[test]
fn the_states_of_a_press_fit_are_judged_and_no_law_is_broken_on_the_way() {
    let run = run(&bar(0.1, "", "initial_gaps: ramp", "[0.0, 1.0]"));
    for accepted in &run.accepted {
        let Outcome::Increment { marked, .. } = &accepted.event.outcome else {
            panic!("accepted");
        };
        assert_eq!(*marked, None);
    }
}

#[test]
fn a_press_fit_in_which_either_side_is_slave_of_the_other_is_accepted_and_presses_like_one_block() {
    // Two unit blocks side by side between walls, 0.02 too wide together: a strain of 0.01 in the end.
    let text = r#"(
    title: "Two blocks that are too wide",
    nodes: [
        Block(id: "a", corners: [(0, 0), (1.02, 0), (1.02, 1), (0, 1)], elements: (2, 2)),
        Block(id: "b", corners: [(1, 0), (2, 0), (2, 1), (1, 1)], elements: (2, 3)),
    ],
    materials: [Elastic(id: "steel", E: 100.0, nu: 0.0)],
    bodies: [Solid(id: "a", mesh: "a", material: "steel"), Solid(id: "b", mesh: "b", material: "steel")],
    surfaces: [(id: "right", along: "a.right"), (id: "left", along: "b.left")],
    slaves: [(nodes: ["b.left"], on: ["right"]), (nodes: ["a.right"], on: ["left"])],
    supports: [(node: "a.left", fix: [x, y]), (node: "b.right", fix: [x, y])],
    loads: [],
    history: (path: [0.0, 1.0], increment: 0.25),
    settings: (initial_gaps: ramp),
)"#;
    let scene = Scene::from_text("blocks.ron", text, &[]).unwrap();
    let run = finished(&scene);
    for accepted in &run.accepted {
        let Outcome::Increment { marked, .. } = &accepted.event.outcome else {
            panic!("accepted");
        };
        assert_eq!(*marked, None);
    }
    // What presses is all of it: the stress of 1 or so over a height of 1, and no more where the sides are slaves of each
    // other.
    let pressed: f64 = run.stepper.state().nodes.iter().map(|node| node.f_n).sum();
    assert!((pressed - 1.0).abs() < 0.03, "{pressed}");
}

#[test]
fn an_adjusted_node_stands_on_its_surface_without_stress() {
    let scene = bar(0.1, "", "initial_gaps: adjust", "[0.0, 1.0]");
    let found = start_gaps(&scene.model);
    assert_eq!(found[0].range, [0.0, 0.0]);
    assert!(warnings(&scene.model).is_empty());
    for (load, force) in forces(&scene) {
        assert!(force.abs() < 1e-12, "{load}: {force}");
    }
}

#[test]
fn nodes_are_adjusted_up_to_the_gap_that_is_stated_and_no_further() {
    for (within, gap) in [(0.04, 0.05), (0.06, 0.0)] {
        let settings = format!("initial_gaps: adjust, adjust_gap: {within:?}");
        let scene = bar(-0.05, "", &settings, "[0.0, 1.0]");
        let found = start_gaps(&scene.model)[0].range[0];
        assert!((found - gap).abs() < 1e-15, "{within}: {found}");
    }
}

#[test]
fn a_strip_on_a_floor_that_is_drawn_the_other_way_round_is_warned_of() {
    let strip = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/failures/nothing-holds.ron"
    );
    let sound = scene(strip, &[]);
    assert_eq!(warnings(&sound.model), [""; 0]);
    let turned = scene(strip, &[("surfaces.floor.reverse", "true")]);
    let told = warnings(&turned.model);
    assert!(
        told[0].contains("faces away from all its slave nodes"),
        "{told:?}"
    );
    assert!(told[0].contains("reverse"), "{told:?}");
    let text = std::fs::read_to_string(strip).unwrap();
    let lower = text
        .replace("to: (-3.0, 0.0)", "to: (-3.0, 0.1)")
        .replace("from: (9.0, 0.0)", "from: (9.0, 0.1)");
    let inside = Scene::from_text("inside.ron", &lower, &[]).unwrap();
    let told = warnings(&inside.model);
    assert!(
        told[0].starts_with("61 of 61 slave nodes start inside surface floor"),
        "{told:?}"
    );
}

#[test]
fn a_surface_that_all_nodes_of_a_beam_start_inside_of_may_look_the_wrong_way() {
    let scene = bar(0.1, "", "", "[0.0, 1.0]");
    let told = warnings(&scene.model);
    assert!(
        told[0].starts_with("1 of 1 slave nodes starts inside surface floor"),
        "{told:?}"
    );
    assert!(told[0].contains("reverse"), "{told:?}");
}

#[test]
fn bodies_without_any_hold_and_bodies_that_overlap_are_warned_of() {
    let text = r#"(
    title: "Two blocks",
    nodes: [
        Block(id: "a", corners: [(0, 0), (1, 0), (1, 1), (0, 1)], elements: (2, 2)),
        Block(id: "b", corners: [(0.4, 0.5), (2, 0.5), (2, 1.5), (0.4, 1.5)], elements: (2, 2)),
        Line(id: "floor", from: (9.0, 0.0), to: (-3.0, 0.0), elements: 1, per_element: 2),
    ],
    materials: [Elastic(id: "rubber", E: 100.0, nu: 0.3)],
    bodies: [Solid(id: "a", mesh: "a", material: "rubber"), Solid(id: "b", mesh: "b", material: "rubber")],
    surfaces: [(id: "floor", along: "floor")],
    slaves: [(nodes: ["a.bottom"], on: ["floor"])],
    supports: [(node: "a.top", fix: [x, y])],
    loads: [],
    history: (path: [0.0, 1.0], increment: 0.1),
)"#;
    let scene = Scene::from_text("blocks.ron", text, &[]).unwrap();
    let told = warnings(&scene.model).join("\n");
    assert!(
        told.contains("body b has neither a support nor a contact"),
        "{told}"
    );
    assert!(told.contains("bodies a and b overlap"), "{told}");
    // Each has nodes inside the other: one warning is enough.
    assert_eq!(told.matches("overlap").count(), 1, "{told}");
}

/// Two bars that cross: all nodes of each are outside the other.
#[test]
fn bodies_that_cross_without_a_node_inside_each_other_overlap() {
    let text = r#"(
    title: "A cross",
    nodes: [
        Block(id: "p", corners: [(-2, -0.25), (2, 0.25)], elements: (1, 1), element: quad4),
        Block(id: "q", corners: [(-0.25, BOTTOM), (0.25, 2)], elements: (1, 1), element: quad4),
    ],
    materials: [Elastic(id: "m", E: 100.0, nu: 0.3)],
    bodies: [Solid(id: "p", mesh: "p", material: "m"), Solid(id: "q", mesh: "q", material: "m")],
    supports: [(node: "p.all", fix: [x, y]), (node: "q.all", fix: [x, y])],
    history: (path: [0.0, 1.0], increment: 0.5),
)"#;
    let told = |bottom: &str| {
        let text = text.replace("BOTTOM", bottom);
        let scene = Scene::from_text("cross.ron", &text, &[]).unwrap();
        warnings(&scene.model)
    };
    assert_eq!(
        told("-2"),
        [
            "bodies p and q overlap: the side of the second from q.2 to q.4 lies partly inside the first"
        ]
    );
    // It ends inside, and on the side of the other.
    let inside = told("0.1");
    assert!(
        inside[0].contains("q.1 of the second lies inside"),
        "{inside:?}"
    );
    assert_eq!(told("0.25"), Vec::<String>::new());
}

#[test]
fn second_order_sides_over_borders_of_second_order_masters_are_warned_of() {
    let text = r#"(
    title: "A block on a block",
    nodes: [
        Block(id: "low", corners: [(0, 0), (1, 1)], elements: (LOW, 1)),
        Block(id: "top", corners: [(0, 1), (1, 2)], elements: (TOP, 1)),
    ],
    materials: [Elastic(id: "m", E: 100.0, nu: 0.3)],
    bodies: [Solid(id: "low", mesh: "low", material: "m"), Solid(id: "top", mesh: "top", material: "m")],
    surfaces: [(id: "low", along: "low.top")],
    slaves: [(nodes: ["top.bottom"], on: ["low"])],
    supports: [(node: "low.bottom", fix: [x, y]), (node: "top.top", fix: [x])],
    loads: [Traction(along: "top.top", y: -1)],
    history: (path: [0.0, 1.0], increment: 0.5),
)"#;
    let told = |low: u32, top: u32, kind: &str, by: &str| {
        let text = text
            .replace("LOW", &low.to_string())
            .replace("TOP", &top.to_string())
            .replace(", 1))", &format!(", 1){kind})"))
            .replace("on: [\"low\"]", &format!("on: [\"low\"]{by}"));
        let scene = Scene::from_text("blocks.ron", &text, &[]).unwrap();
        warnings(&scene.model).join("\n")
    };
    let points = ", law: Penalty(stiffness: 1e4), by: surface";
    assert!(
        told(10, 9, "", "").starts_with("9 of 9 slave sides near surface low lie over a border")
    );
    assert!(told(10, 5, "", "").starts_with("5 of 5 slave sides"));
    for (low, top, kind, by) in [
        (10, 10, "", ""),
        (5, 10, "", ""),
        (10, 9, ", element: quad4", ""),
        (10, 9, "", points),
    ] {
        assert_eq!(told(low, top, kind, by), "", "{low} {top} {kind} {by}");
    }
}

/// The points of faces are nodes of their own, which belong to no body.
#[test]
fn points_of_faces_hold_their_body_and_tell_a_surface_that_is_turned() {
    let text = r#"(
    title: "A pad on a base",
    nodes: [
        Block(id: "base", corners: [(0.0, 0.0), (2.0, 1.0)], elements: (2, 1)),
        Block(id: "pad", corners: [(0.5, 1.0), (1.5, 2.0)], elements: (1, 1)),
    ],
    materials: [Elastic(id: "rubber", E: 100.0, nu: 0.3)],
    bodies: [Solid(id: "base", mesh: "base", material: "rubber"), Solid(id: "pad", mesh: "pad", material: "rubber")],
    surfaces: [(id: "top", along: "base.top", reverse: false)],
    slaves: [(nodes: ["pad.bottom"], on: ["top"], law: Penalty(stiffness: 1e4), by: surface)],
    supports: [(node: "base.bottom", fix: [x, y])],
    history: (path: [0.0, 1.0], increment: 0.5),
)"#;
    let told = |text: &str| {
        let scene = Scene::from_text("pad.ron", text, &[]).unwrap();
        warnings(&scene.model)
    };
    assert_eq!(told(text), Vec::<String>::new());
    let turned = told(&text.replace("reverse: false", "reverse: true"));
    assert!(
        turned[0].starts_with("surface top faces away from all its slave nodes"),
        "{turned:?}"
    );
}

/// Two rings whose ends are flush. Lamé's pressure of half the interference is 0.586; the elements of the arcs are straight.
#[test]
fn a_press_fit_warns_of_nodes_past_the_ends_and_with_past_ends_all_are_ramped() {
    let ring = |id: &str, from: f64, to: f64| {
        format!(
            "Block(id: \"{id}\", elements: (2, 8), corners: [({from:?}, 0), ({to:?}, 0), (0, {to:?}), (0, {from:?})],
               sides: (left: Arc(center: (0, 0)), right: Arc(center: (0, 0))))"
        )
    };
    let fit = |past: &str, smooth: bool, increment: f64| {
        read(&format!(
            "(title: \"t\", nodes: [{}, {}], materials: [Elastic(id: \"m\", E: 1000, nu: 0.3, plane: stress, update: small)],
              bodies: [Solid(id: \"in\", mesh: \"in\", material: \"m\"), Solid(id: \"out\", mesh: \"out\", material: \"m\")],
              surfaces: [(id: \"bore\", along: \"out.left\", smooth: {smooth}{past})], slaves: [(nodes: [\"in.right\"], on: [\"bore\"])],
              supports: [(node: \"in.bottom\", fix: [y]), (node: \"out.bottom\", fix: [y]), (node: \"in.top\", fix: [x]),
                         (node: \"out.top\", fix: [x])],
              history: (path: [0, 1], increment: {increment}), settings: (initial_gaps: ramp), monitors: [(name: \"p\", of: Pressure())])",
            ring("in", 1.0, 2.0),
            ring("out", 1.99, 3.0),
        ))
    };
    let missed = |scene: &Scene| {
        let all = warnings(&scene.model).into_iter();
        all.filter(|text| text.contains("past its ends")).count()
    };
    assert_eq!(missed(&fit(", past_ends: 0", true, 0.5)), 1);
    // Unless told otherwise, the surface continues past its ends on the axes of symmetry.
    for past in ["", ", past_ends: 0.5"] {
        for smooth in [true, false] {
            for increment in [0.5, 0.02] {
                let scene = fit(past, smooth, increment);
                let what = format!("{past} {smooth} {increment}");
                assert_eq!(missed(&scene), 0);
                let run = finished(&scene);
                let half = run.accepted.iter().find(|a| a.load > 0.49).unwrap();
                let p = half.monitors["p"];
                assert!((p / 0.586 - 1.0).abs() < 0.02, "{what}: {p}");
                assert!(run.accepted.len() < 60, "{what}");
            }
        }
    }
}

/// A node on springs of stiffness 1 and 10, pushed out of a valley: until the overlap is closed, it is on a circle around the corner, and
/// the force points to the corner.
#[test]
fn a_node_of_a_press_fit_below_a_corner_turns_around_it() {
    let from = [1e-4, -0.01];
    let scene = read(
        "(title: \"t\", nodes: [Node(id: \"a\", at: (0.0001, -0.01)), Through(id: \"v\", points: [(1, 0.1), (0, 0), (-1, 0.1)], per_element: 2)],
          materials: [], bodies: [Springs(id: \"k\", bars: [(nodes: [\"a\"], angle: 0, stiffness: 1), (nodes: [\"a\"], angle: 90, stiffness: 10)])],
          surfaces: [(id: \"v\", along: \"v\")], slaves: [(nodes: [\"a\"], on: [\"v\"])], loads: [],
          history: (path: [0, 1], increment: 0.25), settings: (initial_gaps: ramp),
          monitors: [(name: \"x\", of: Displacement(node: \"a\", component: x)), (name: \"y\", of: Displacement(node: \"a\", component: y))])",
    );
    let overlap = f64::hypot(from[0], from[1]);
    let run = finished(&scene);
    assert_eq!(run.accepted.len(), 4);
    for state in &run.accepted {
        let moved = ["x", "y"].map(|name| state.monitors[name]);
        let at = [from[0] + moved[0], from[1] + moved[1]];
        let radius = f64::hypot(at[0], at[1]);
        assert!(
            (radius - (1.0 - state.load) * overlap).abs() < 1e-10,
            "{at:?}"
        );
        // The springs balance a force along the radius.
        let off = moved[0] * at[1] - 10.0 * moved[1] * at[0];
        assert!(off.abs() < 1e-9 * radius.max(1e-3), "{off}");
    }
}

/// The lower block is as wide as the upper one, which is softer and bulges past it.
#[test]
fn blocks_that_end_flush_are_pressed_on_each_other_without_an_increment_cut() {
    let press = |law: &str, angle: &str| {
        read(&format!(
            "(title: \"t\", nodes: [Block(id: \"a\", corners: [(0, 0), (10, 0), (10, 5), (0, 5)], elements: (2, 1)),
                                  Block(id: \"b\", corners: [(0, 5), (10, 5), (10, 10), (0, 10)], elements: (1, 1))],
              materials: [Elastic(id: \"m\", E: 1000, nu: 0.3), Elastic(id: \"s\", E: 200, nu: 0.3)],
              bodies: [Solid(id: \"a\", mesh: \"a\", material: \"m\"), Solid(id: \"b\", mesh: \"b\", material: \"s\")],
              surfaces: [(id: \"t\", along: \"a.top\")],
              slaves: [(nodes: [\"b.bottom\"], on: [\"t\"], law: {law})], friction: (angle: {angle}),
              supports: [(node: \"a.bottom\", fix: [x, y])],
              loads: [Displacement(node: \"b.top\", component: y, value: -0.5), Displacement(node: \"b.top\", component: x, value: 0)],
              history: (path: [0, 1], increment: 0.1), monitors: [(name: \"F\", of: Contact(component: y))])"
        ))
    };
    for law in ["Hard", "Penalty(stiffness: 1e5)"] {
        for angle in ["0", "10", "30"] {
            let run = finished(&press(law, angle));
            assert_eq!(run.accepted.len(), 10, "{law} {angle}");
            let force = run.accepted[9].monitors["F"];
            // Between free sliding and full adhesion.
            assert!((150.0..190.0).contains(&force), "{law} {angle}: {force}");
        }
    }
}

#[test]
fn a_surface_continues_only_where_the_slave_surface_ends_with_it() {
    let ends = |slave: &str| {
        let scene = read(&format!(
            "(title: \"t\", nodes: [Block(id: \"b\", corners: {slave}, elements: (2, 1)), Line(id: \"f\", from: (4, 0), to: (0, 0), elements: 2, per_element: 2),
                                  Line(id: \"side\", from: (0, 0), to: (0, -2), elements: 1, per_element: 2)],
              materials: [Elastic(id: \"m\", E: 1, nu: 0)], bodies: [Solid(id: \"b\", mesh: \"b\", material: \"m\")],
              surfaces: [(id: \"f\", along: \"f\"), (id: \"side\", along: \"side\")], slaves: [(nodes: [\"b.bottom\"], on: [\"f\", \"side\"])],
              supports: [(node: \"b.top\", fix: [x, y])], loads: [], history: (path: [0, 1], increment: 1))"
        ));
        [0, 1].map(|k| scene.model.surfaces[k].past_ends)
    };
    assert_eq!(
        ends("[(0, 0), (4, 0), (4, 1), (0, 1)]"),
        [[0.2, 0.2], [0.0; 2]]
    );
    assert_eq!(
        ends("[(0, 0), (5, 0), (5, 1), (0, 1)]"),
        [[0.0, 0.2], [0.0; 2]]
    );
    assert_eq!(ends("[(1, 0), (3, 0), (3, 1), (1, 1)]"), [[0.0; 2]; 2]);
}
