//! Concave corners and convex vertices, against closed forms: a node in a valley, on a ridge and over it, a block between a
//! floor and a wall, a wheel at a step; and problem 02, whose bent elements make small corners everywhere.

use crate::common::{Run, finished, last, read, run, scene};
use stickslip::contact::table2::Rule;
use stickslip::model::Mode;
use stickslip::scene::Scene;
use stickslip::step::event::Outcome;

fn corner(name: &str, set: &[(&str, &str)]) -> Scene {
    let root = env!("CARGO_MANIFEST_DIR");
    scene(&format!("{root}/tests/corners/{name}.ron"), set)
}

fn tan(degrees: f64) -> f64 {
    degrees.to_radians().tan()
}

fn force(run: &Run) -> [f64; 2] {
    run.stepper.state().nodes[0].force()
}

fn close(a: [f64; 2], b: [f64; 2], tolerance: f64) -> bool {
    (a[0] - b[0]).abs() < tolerance && (a[1] - b[1]).abs() < tolerance
}

/// The springs hold the node in the corner: F = K u − P.
#[test]
fn a_node_comes_to_rest_in_the_bottom_of_a_valley() {
    for strategy in ["ladder", "table2", "newton", "census", "lemke"] {
        for increment in ["0.25", "0.1", "0.03"] {
            let set = [
                ("settings.strategy", strategy),
                ("history.increment", increment),
            ];
            let smooth = finished(&scene("osc-valley", &set));
            let at = [last(&smooth, "u_x"), last(&smooth, "u_y")];
            assert!(close(at, [0.05, -0.042], 1e-12), "{set:?}: {at:?}");
            let f = force(&smooth);
            assert!(
                close(f, [2.0 * 0.05 - 1.0, -5.0 * 0.042 + 2.0], 1e-9),
                "{set:?}: {f:?}"
            );
            let rough = finished(&corner("valley-friction", &set));
            let f = force(&rough);
            let exact = [3.0 * 0.05 - 0.8, -4.0 * 0.028868 + 3.0];
            assert!(close(f, exact, 1e-9), "{set:?}: {f:?} {exact:?}");
        }
    }
}

#[test]
fn in_a_corner_each_side_gives_a_force_within_its_own_friction() {
    let run = finished(&corner("valley-friction", &[]));
    let friction = run.stepper.model().contacts[0].friction;
    let event = &run.accepted.last().unwrap().event;
    assert_eq!(event.nodes[0].decision.rule, Rule::CornerStays);
    let sides = event.nodes[0].sides(&friction).unwrap();
    // Walked towards −x: first the slope on the right, whose normal leans to the left.
    let lean = (1.154701_f64 / 2.0).atan();
    let mut sum = [0.0; 2];
    for (side, angle) in sides.iter().zip([lean, -lean]) {
        assert!(
            side.f_n > 0.0 && side.f_t.abs() <= side.limit + 1e-12,
            "{sides:?}"
        );
        let (s, c) = angle.sin_cos();
        let (n, t) = ([-s, c], [-c, -s]);
        sum = [0, 1].map(|k| sum[k] + side.f_n * n[k] + side.f_t * t[k]);
    }
    assert!(close(sum, force(&run), 1e-12), "{sum:?}");
}

#[test]
fn a_node_on_a_vertex_stays_while_neither_side_lets_it_slide() {
    for (angle, increment) in [
        ("30", "0.05"),
        ("30", "0.013"),
        ("45", "0.05"),
        ("24", "0.02"),
    ] {
        let set = [("friction.angle", angle), ("history.increment", increment)];
        let run = finished(&corner("vertex", &set));
        let held = 1.0 + 0.75 * tan(angle.parse::<f64>().unwrap() - 20.0);
        for accepted in &run.accepted {
            let (load, u_x) = (accepted.load, accepted.monitors["u_x"]);
            assert_eq!(
                u_x.abs() < 1e-12,
                load < held,
                "{set:?}: {load} {held}: {u_x}"
            );
            let node = &accepted.state.nodes[0];
            let stands = node.mode == Mode::Fixed && node.corner.is_some();
            let on_top = load > 0.25 && load < held;
            assert_eq!(on_top, stands, "{set:?} {load}");
        }
    }
}

/// Off the vertex it stands on a slope of 20 degrees, with the force at the friction angle from the slope's normal.
#[test]
fn where_friction_is_too_weak_a_node_goes_down_one_side_of_the_vertex() {
    for angle in ["0", "10", "19.9"] {
        let run = finished(&corner(
            "vertex",
            &[("friction.angle", angle), ("history.path[2]", "1.1")],
        ));
        for accepted in run
            .accepted
            .iter()
            .filter(|a| a.load > 0.25 && a.load <= 1.0)
        {
            let (u_x, u_y) = (accepted.monitors["u_x"], accepted.monitors["u_y"]);
            assert!(
                (u_y + 0.05 + tan(20.0) * u_x.abs()).abs() < 1e-12,
                "{angle}: {u_x} {u_y}"
            );
            let f = accepted.state.nodes[0].force();
            let lean = 20.0 - angle.parse::<f64>().unwrap();
            assert!(
                (f[0].abs() - tan(lean) * f[1]).abs() < 1e-6,
                "{angle}: {f:?}"
            );
        }
    }
}

/// On the way up the spring's end is at least W tan(20° + φ) / k ahead; there the node slides off the top.
#[test]
fn a_node_is_drawn_over_a_ridge_and_back_and_lets_go_at_the_top() {
    for angle in ["0", "10", "30"] {
        for increment in ["0.05", "0.02", "0.013"] {
            let set = [("friction.angle", angle), ("history.increment", increment)];
            let run = finished(&corner("ridge", &set));
            let ahead = 1.16 * tan(20.0 + angle.parse::<f64>().unwrap()) / 4.0;
            let side = |k: usize| run.accepted[k].monitors["u_x"] - 0.5;
            let changes: Vec<usize> = (1..run.accepted.len())
                .filter(|&k| side(k - 1) * side(k) < 0.0)
                .collect();
            assert_eq!(changes.len(), 2, "{set:?}");
            let least = increment.parse::<f64>().unwrap() / 64.0;
            for (k, exact) in changes.into_iter().zip([0.5 + ahead, 0.5 - ahead]) {
                let (before, after) = (run.accepted[k - 1].load, run.accepted[k].load);
                let (low, high) = (before.min(after), before.max(after));
                assert!(
                    low <= exact && exact <= high && high - low < 2.0 * least,
                    "{set:?}: {before} {after} {exact}"
                );
                let outcome = &run.accepted[k].event.outcome;
                assert!(
                    matches!(outcome, Outcome::Increment { jumped: true, .. }),
                    "{set:?}: the jump is marked"
                );
            }
        }
    }
}

#[test]
fn a_block_in_a_corner_is_the_same_whether_floor_and_wall_are_one_surface_or_two() {
    let text = std::fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/corners/block-in-a-corner.ron"
    ))
    .unwrap();
    let lines = text
        .lines()
        .filter(|line| !line.trim_start().starts_with("Line("));
    let one = lines.collect::<Vec<_>>().join("\n");
    let one = one
        .replace(
            "Block(id:",
            "Through(id: \"rail\", points: [(1.1, 3.0), (1.1, 0.0), (-1.0, 0.0)], per_element: 2),\n        Block(id:",
        )
        .replace(
            "(id: \"floor\", along: \"floor\"), (id: \"wall\", along: \"wall\")",
            "(id: \"rail\", along: \"rail\")",
        )
        .replace("\"floor\", \"wall\"", "\"rail\"");
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("rail.ron");
    std::fs::write(&path, one).unwrap();
    for angle in ["0", "20", "50"] {
        for increment in ["0.1", "0.04", "0.25"] {
            let set = [("friction.angle", angle), ("history.increment", increment)];
            let two = finished(&corner("block-in-a-corner", &set));
            let one = finished(&scene(path.to_str().unwrap(), &set));
            for name in ["contact_x", "contact_y"] {
                let (a, b) = (last(&two, name), last(&one, name));
                assert!((a - b).abs() < 1e-9, "{set:?} {name}: {a} {b}");
            }
            // No node has gone through floor or wall.
            let state = two.stepper.state();
            for contact in &two.stepper.model().contacts {
                let at = two.stepper.model().place(&state.u, contact.node);
                assert!(at[0] < 1.1 + 1e-9 && at[1] > -1e-9, "{set:?}: {at:?}");
            }
            if angle == "0" {
                // Square block, square corner: both push the same.
                assert!((last(&two, "contact_x") + last(&two, "contact_y")).abs() < 1e-9);
                assert!(
                    state
                        .nodes
                        .iter()
                        .any(|node| node.corner.is_some() && node.mode == Mode::Fixed)
                );
            }
        }
    }
}

/// A wheel of radius 1 and weight 1 at a step of height h: its hub, spokes to the lower rim, the step's edge and a point of
/// the floor as slave nodes on the rim.
fn wheel(h: f64, hub: &str, to: f64) -> (tempfile::TempDir, String) {
    const RIM: usize = 25;
    let edge = (1.0 - (1.0 - h) * (1.0 - h)).sqrt();
    let k = 1e6;
    let spokes: String = (1..=RIM)
        .map(|i| format!("Matrix(id: \"s{i}\", nodes: [\"hub\", \"rim.{i}\"], stiffness: [[{k}, 0, -{k}, 0], [0, {k}, 0, -{k}], [-{k}, 0, {k}, 0], [0, -{k}, 0, {k}]]),\n"))
        .collect();
    let text = format!(
        "(title: \"wheel\", nodes: [Node(id: \"hub\", at: (0, 1)),
        Arc(id: \"rim\", center: (0, 1), radius: 1, from: -170, to: -10, elements: 12, per_element: 3),
        Node(id: \"edge\", at: ({edge:.17}, {h})), Node(id: \"floor\", at: (0, 0))],
    materials: [], bodies: [{spokes}], surfaces: [(id: \"rim\", along: \"rim\")],
    slaves: [(nodes: [\"edge\", \"floor\"], on: [\"rim\"], start: sliding)],
    supports: [(node: \"edge\", fix: [x, y]), (node: \"floor\", fix: [x, y])],
    loads: [Force(node: \"hub\", y: -1, scale: [(0, 1), (1, 1)]), {hub}],
    history: (path: [0, {to}], increment: 0.05),
    monitors: [(name: \"x\", of: Displacement(node: \"hub\", component: x)), (name: \"y\", of: Displacement(node: \"hub\", component: y))])"
    );
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("wheel.ron");
    std::fs::write(&path, text).unwrap();
    let path = path.to_str().unwrap().to_owned();
    (directory, path)
}

/// Moments about the edge, with the lever a = √(r² − (r − h)²): the floor carries W − P (r − h) / a, which vanishes at
/// P = W a / (r − h).
#[test]
fn a_wheel_that_is_pushed_against_a_step_leaves_the_floor_at_the_load_of_the_closed_form() {
    for h in [0.2, 0.3, 0.5_f64] {
        let (_directory, path) = wheel(h, "Force(node: \"hub\", x: 1)", 2.0);
        let run = run(&scene(&path, &[("history.jumps", "stop")]));
        let lever = (1.0 - (1.0 - h) * (1.0 - h)).sqrt();
        let exact = lever / (1.0 - h);
        let end = run.accepted.last().unwrap().load;
        assert!(
            end <= exact * (1.0 + 1e-4) && exact < end + 2.0 * 0.05 / 64.0,
            "{h}: {end} {exact}"
        );
        for accepted in &run.accepted {
            let floor = accepted.state.nodes[1].force()[1].abs();
            let wanted = 1.0 - accepted.load * (1.0 - h) / lever;
            assert!(
                (floor - wanted).abs() < 2e-3,
                "{h} at {}: {floor} {wanted}",
                accepted.load
            );
        }
    }
}

/// Once it is off the floor the hub goes round the edge, on a circle of the wheel's radius.
#[test]
fn a_wheel_that_is_drawn_over_a_step_goes_round_its_edge() {
    let h = 0.3;
    let (_directory, path) = wheel(
        h,
        "Displacement(node: \"hub\", component: x, value: 1)",
        0.7,
    );
    let run = finished(&scene(&path, &[]));
    let edge = (1.0 - (1.0 - h) * (1.0 - h)).sqrt();
    for accepted in &run.accepted {
        let left = edge - accepted.monitors["x"];
        let height = h + (1.0 - left * left).sqrt() - 1.0;
        assert!(
            (accepted.monitors["y"] - height).abs() < 1e-3,
            "{}",
            accepted.load
        );
        let push = accepted.state.nodes[0].force();
        let wanted = left / (1.0 - left * left).sqrt();
        assert!(
            (push[0].abs() - wanted * push[1].abs()).abs() < 5e-3,
            "{}: {push:?} {wanted}",
            accepted.load
        );
    }
}

/// Shear-flexible elements that are bent by a point force meet at small angles, and between two of them the branch that the
/// load follows may end: the next one begins a little further on.
#[test]
fn problem_02_gets_past_the_kinks_between_its_elements_with_any_increment() {
    for (refine, increments) in [
        ("3", ["0.05", "0.0125"]),
        ("5", ["0.05", "0.01"]),
        ("8", ["0.05", "0.02"]),
        ("16", ["0.05", "0.02"]),
    ] {
        for (name, angle) in [
            ("02-two-cantilevers-smooth", "0"),
            ("02-two-cantilevers-rough", "2"),
        ] {
            let ends = increments.map(|increment| {
                let set = [
                    ("refine", refine),
                    ("history.increment", increment),
                    ("friction.angle", angle),
                ];
                last(&finished(&scene(name, &set)), "u_x")
            });
            assert!(
                (ends[0] - ends[1]).abs() < 1e-7,
                "{name} {refine}: {ends:?}"
            );
        }
    }
}

/// A node on two soft springs, pressed into a valley of slopes β by 1 and pulled aside by H. It stays at the bottom until
/// H = tan(β + φ); what it slides to beyond the ends of the surface is no answer before.
#[test]
fn a_node_at_the_bottom_of_a_valley_stays_there_while_both_sides_hold_it() {
    let text = std::fs::read_to_string("tests/findings/valley-soft-springs.ron").unwrap();
    for slope in [5.0, 10.0, 20.0, 30.0, 40.0] {
        for friction in [2.0, 5.0, 10.0, 25.0] {
            let height = format!("{:?}", 5.0 * tan(slope));
            let text = text.replace("0.8816349035423249", &height).replace(
                "friction: (angle: 5.0)",
                &format!("friction: (angle: {friction:?})"),
            );
            let valley = Scene::from_text("valley.ron", &text, &[]).unwrap();
            let run = run(&valley);
            let limit = tan(slope + friction);
            for step in &run.accepted {
                let (pull, x) = (3.0 * (step.load - 1.0), step.monitors["x"]);
                assert!(
                    pull > limit - 1e-9 || x.abs() < 1e-9,
                    "{slope}, {friction}: x = {x} at {pull}, held to {limit}"
                );
                if pull > 0.0 && pull < limit {
                    assert!((step.monitors["fx"] + pull).abs() < 1e-9);
                }
            }
            let held = run
                .accepted
                .iter()
                .filter(|step| 3.0 * (step.load - 1.0) < limit);
            assert!(
                held.count() >= 100 + (limit / 0.03) as usize,
                "{slope}, {friction}"
            );
        }
    }
}

/// A node on springs, pressed onto two lines and pushed along them, alternatively onto the chain of both.
fn groove(lines: &str, surfaces: &str, on: &str) -> Scene {
    read(&format!(
        "(title: \"t\", nodes: [Node(id: \"p\", at: (0.2, 0.6)), {lines}], materials: [],
          bodies: [Springs(id: \"k\", bars: [(nodes: [\"p\"], angle: 0, stiffness: 1), (nodes: [\"p\"], angle: 90, stiffness: 1)])],
          surfaces: [{surfaces}], slaves: [(nodes: [\"p\"], on: [{on}])], friction: (angle: 10),
          loads: [Force(node: \"p\", y: -3), Force(node: \"p\", x: -1, scale: [(0, 0), (1, 0), (2, 3)])],
          history: (path: [0, 1, 2, 0], increment: 0.1),
          monitors: [(name: \"x\", of: Contact(component: x)), (name: \"y\", of: Contact(component: y)),
                     (name: \"u\", of: Displacement(node: \"p\", component: x))])"
    ))
}

#[test]
fn surfaces_that_end_in_one_point_hold_a_node_like_one_chain() {
    let line = |id: &str, from: &str, to: &str| {
        format!("Line(id: \"{id}\", from: {from}, to: {to}, elements: 1, per_element: 2)")
    };
    let l = line("l", "(0, 0)", "(-1, 1)");
    let r = line("r", "(1, 1)", "(0, 0)");
    let two = groove(
        &format!("{l}, {r}"),
        "(id: \"l\", along: \"l\"), (id: \"r\", along: \"r\")",
        "\"l\", \"r\"",
    );
    let one = groove(
        "Through(id: \"v\", points: [(1, 1), (0, 0), (-1, 1)], per_element: 2)",
        "(id: \"v\", along: \"v\")",
        "\"v\"",
    );
    let [two, one] = [two, one].map(|scene| finished(&scene).accepted);
    assert_eq!(two.len(), 40);
    for (a, b) in two.iter().zip(&one) {
        for name in ["x", "y", "u"] {
            let error = (a.monitors[name] - b.monitors[name]).abs();
            assert!(error < 1e-9, "{} {name}: {error}", a.load);
        }
    }
}

/// A block pressed by p = 1 on two others, ν = 0: a state of constant stress, in which each joint node transmits half the force of an
/// inner node to each side.
#[test]
fn a_node_over_a_joint_presses_equally_on_the_ends_of_both_surfaces() {
    for (past_ends, law) in [
        ("0", "Hard"),
        ("0.002", "Hard"),
        ("0.1", "Penalty(stiffness: 1000)"),
    ] {
        let scene = read(&format!(
            "(title: \"t\", materials: [Elastic(id: \"m\", E: 100, nu: 0, plane: strain, update: small)],
              nodes: [Block(id: \"l\", element: quad4, elements: (2, 1), corners: [(-1, 0), (0, 0), (0, 1), (-1, 1)]),
                      Block(id: \"r\", element: quad4, elements: (2, 1), corners: [(0, 0), (1, 0), (1, 1), (0, 1)]),
                      Block(id: \"u\", element: quad4, elements: (4, 1), corners: [(-1, 1), (1, 1), (1, 2), (-1, 2)])],
              bodies: [Solid(id: \"l\", mesh: \"l\", material: \"m\"), Solid(id: \"r\", mesh: \"r\", material: \"m\"),
                       Solid(id: \"u\", mesh: \"u\", material: \"m\")],
              surfaces: [(id: \"l\", along: \"l.top\", past_ends: {past_ends}), (id: \"r\", along: \"r.top\", past_ends: {past_ends})],
              slaves: [(nodes: [\"u.bottom\"], on: [\"l\", \"r\"], law: {law})], friction: (angle: 30),
              supports: [(node: \"l.bottom\", fix: [x, y]), (node: \"r.bottom\", fix: [x, y])],
              loads: [Traction(along: \"u.top\", y: -1)], history: (path: [0, 1], increment: 0.5))"
        ));
        let run = finished(&scene);
        let model = run.stepper.model();
        let names = model.contacts.iter().map(|c| &model.nodes[c.node].name);
        let names: Vec<_> = names.collect();
        assert_eq!(names, ["u.1", "u.2", "u.3", "u.3~r", "u.4", "u.5"]);
        let state = run.stepper.state();
        for (node, exact) in state.nodes.iter().zip([0.25, 0.5, 0.25, 0.25, 0.5, 0.25]) {
            assert!((node.f_n - exact).abs() < 1e-9, "{past_ends}: {node:?}");
        }
        let top = model.place(&state.u, model.contacts[2].node)[1];
        let gap = if law == "Hard" { 0.0 } else { 1e-3 };
        assert!(
            (top - (1.0 - 0.01 - gap)).abs() < 1e-9,
            "{past_ends}: {top}"
        );
    }
}

#[test]
fn a_chain_that_returns_to_its_start_is_closed() {
    for (arc, reverse) in [("from: 0, to: 360", false), ("from: 360, to: 0", true)] {
        let scene = read(&format!(
        "(title: \"t\", nodes: [Node(id: \"p\", at: (1.05, -0.5)),
            Arc(id: \"c\", center: (0, 0), radius: 1, {arc}, elements: 12, per_element: 3)], materials: [],
          bodies: [Springs(id: \"k\", bars: [(nodes: [\"p\"], angle: 0, stiffness: 10), (nodes: [\"p\"], angle: 90, stiffness: 0.01)])],
          surfaces: [(id: \"c\", along: \"c\", reverse: {reverse})], slaves: [(nodes: [\"p\"], on: [\"c\"])], friction: (angle: 5),
          loads: [Force(node: \"p\", x: -4, scale: [(0, 0), (1, 1)]),
                  Displacement(node: \"p\", component: y, value: 1, scale: [(0, 0), (1, 0), (2, 1)])],
          history: (path: [0, 1, 2], increment: 0.1),
          monitors: [(name: \"x\", of: Displacement(node: \"p\", component: x)), (name: \"y\", of: Displacement(node: \"p\", component: y)),
                     (name: \"free\", of: Modes(mode: free))])",
    ));
        let accepted = finished(&scene).accepted;
        let touching = accepted
            .iter()
            .filter(|state| state.monitors["free"] == 0.0);
        assert!(touching.clone().count() > 10);
        for state in touching {
            let [x, y] = ["x", "y"].map(|name| state.monitors[name]);
            let radius = (1.05 + x).hypot(y - 0.5);
            assert!((radius - 1.0).abs() < 3e-4, "{}: {radius}", state.load);
        }
    }
}
