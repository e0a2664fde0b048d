//! Paths of equilibrium are followed past limit points and turning points: closed forms, corners met exactly, and what
//! cannot be followed is said.

use crate::common::{self, Accepted, Run, finished, read, run};
use crate::program::{program, rows, well};
use std::sync::Arc;
use stickslip::scene::Scene;
use stickslip::step::event::{Failure, Outcome};
use stickslip::step::stepper::Stepper;

/// Half of a shallow two-bar truss (von Mises): a pinned bar from (0, 0) to (1, 0.2), whose upper end moves up and down.
///
/// ```text
///          | P
///     b    v
///   -----  o       N = EA (l / L - 1),   P = EA (h - d) (1/l - 1/L),   l² = b² + (h - d)²
///       ·´ |  h
///   o ´    |
/// ```
const BAR: &str = r#"Beam(id: "bar", along: "bar", material: "rod")"#;

fn truss(history: &str) -> Scene {
    let text = format!(
        r#"(
    title: "Half of a shallow two-bar truss",
    nodes: [Line(id: "bar", from: (0.0, 0.0), to: (1.0, 0.2), elements: 1, per_element: 2)],
    materials: [Section(id: "rod", EA: 100.0, EI: 1.0, GA: 50.0)],
    bodies: [{BAR}],
    supports: [(node: "bar.start", fix: [x, y]), (node: "bar.end", fix: [x])],
    loads: [Force(node: "bar.end", y: -1.0)],
    history: {history},
    monitors: [
        (name: "u", of: Displacement(node: "bar.end", component: y)),
        (name: "held", of: Displacement(node: "bar.end", component: x)),
    ],
)"#
    );
    read(&text)
}

/// The load that holds the truss where its upper end has gone down by `d`.
fn truss_load(d: f64) -> f64 {
    let (length, left) = (1.04_f64.sqrt(), 0.2 - d);
    100.0 * left * (1.0 / (1.0 + left * left).sqrt() - 1.0 / length)
}

/// The same truss pressed down by a hand on a spring of stiffness 0.8.
fn with_spring(load: &str, history: &str) -> Scene {
    let text = format!(
        r#"(
    title: "A shallow truss is pressed through a soft spring",
    nodes: [
        Line(id: "bar", from: (0.0, 0.0), to: (1.0, 0.2), elements: 1, per_element: 2),
        Node(id: "hand", at: (1.0, 0.5)),
    ],
    materials: [Section(id: "rod", EA: 100.0, EI: 1.0, GA: 50.0)],
    bodies: [
        {BAR},
        Springs(id: "spring", bars: [(nodes: ["bar.end", "hand"], angle: 90.0, stiffness: 0.8)]),
    ],
    supports: [(node: "bar.start", fix: [x, y]), (node: "bar.end", fix: [x]), (node: "hand", fix: [x])],
    loads: [{load}],
    history: {history},
    monitors: [
        (name: "u", of: Displacement(node: "bar.end", component: y)),
        (name: "w", of: Displacement(node: "hand", component: y)),
    ],
)"#
    );
    read(&text)
}

/// A node on springs (0.5 along x, 10 along y) is drawn over the rough ridge y = −x² from x = −0.5 on, where it just touches.
///
/// With N the normal force, s² = 1 + 4 x², friction against the motion, and F_y = N (1 + 2 µ x) / s = 10 (y + 0.25),
///
/// ```text
/// P = 0.5 (x + 0.5) − 10 (y + 0.25) (2 x − µ) / (1 + 2 µ x)
/// ```
fn ridge(history: &str) -> Scene {
    ridge_towards(1.0, history)
}

/// The same drawn towards +x (`way` 1) or, mirrored, towards −x (−1).
fn ridge_towards(way: f64, history: &str) -> Scene {
    let (start, load) = (-0.5 * way, way);
    let text = format!(
        r#"(
    title: "A node on springs is drawn over a rough ridge",
    nodes: [
        Node(id: "tip", at: ({start:?}, -0.25)),
        Through(id: "ridge", points: [(2.0, -4.0), (0.0, 0.0), (-2.0, -4.0)], per_element: 3),
    ],
    materials: [],
    bodies: [Springs(id: "springs", bars: [
        (nodes: ["tip"], angle: 0.0, stiffness: 0.5),
        (nodes: ["tip"], angle: 90.0, stiffness: 10.0),
    ])],
    surfaces: [(id: "ridge", along: "ridge")],
    slaves: [(nodes: ["tip"], on: ["ridge"], start: sliding)],
    friction: (angle: 11.309932474020213),
    loads: [Force(node: "tip", x: {load:?})],
    history: {history},
    monitors: [
        (name: "u_x", of: Displacement(node: "tip", component: x)),
        (name: "u_y", of: Displacement(node: "tip", component: y)),
    ],
)"#
    );
    read(&text)
}

/// How often a sequence turns round.
fn turns(values: impl Iterator<Item = f64>) -> usize {
    let values: Vec<f64> = values.collect();
    let steps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps
        .windows(2)
        .filter(|pair| pair[0] * pair[1] < 0.0)
        .count()
}

fn of<'a>(run: &'a Run, name: &'a str) -> impl Iterator<Item = f64> + 'a {
    run.accepted
        .iter()
        .map(move |accepted| accepted.monitors[name])
}

fn last(run: &Run) -> &Accepted {
    run.accepted.last().unwrap()
}

#[test]
fn a_shallow_truss_snaps_through_along_its_closed_form_whatever_is_measured() {
    let histories = [
        "(path: [0.0, 1.0], increment: 0.02, control: arc)",
        r#"(path: [0.0, 1.0], increment: 0.02, control: arc, arc: (monitor: "u"))"#,
    ];
    for history in histories {
        let run = finished(&truss(history));
        for accepted in &run.accepted {
            let exact = truss_load(-accepted.monitors["u"]);
            assert!((accepted.load - exact).abs() < 1e-9, "{history}: {exact}");
        }
        assert_eq!(last(&run).load, 1.0, "{history}");
        let loads = || run.accepted.iter().map(|accepted| accepted.load);
        assert_eq!(turns(loads()), 2, "{history}");
        assert_eq!(turns(of(&run, "u")), 0, "{history}");
        assert_eq!(turns(of(&run, "arc")), 0, "{history}");
    }
}

#[test]
fn load_control_stops_short_of_the_limit_load_that_the_path_goes_over() {
    let scene = truss("(path: [0.0, 1.0], increment: 0.02, jumps: stop)");
    let short = run(&scene);
    assert!(short.failure.is_some());
    let limit = (0..2000)
        .map(|k| truss_load(1e-4 * f64::from(k)))
        .fold(0.0, f64::max);
    assert!(last(&short).load < limit && last(&short).load > limit - 0.02);
}

#[test]
fn a_snap_back_is_followed_though_load_and_loaded_displacement_turn_both() {
    let force = r#"Force(node: "hand", y: -1.0)"#;
    let run = finished(&with_spring(
        force,
        "(path: [0.0, 0.5], increment: 0.01, control: arc, arc: (largest: 0.05))",
    ));
    for accepted in &run.accepted {
        let [u, w] = ["u", "w"].map(|name| accepted.monitors[name]);
        assert!((accepted.load - truss_load(-u)).abs() < 1e-9);
        assert!((w - (u - accepted.load / 0.8)).abs() < 1e-9);
    }
    assert_eq!(last(&run).load, 0.5);
    let loads = run.accepted.iter().map(|accepted| accepted.load);
    assert_eq!(
        [turns(loads), turns(of(&run, "w")), turns(of(&run, "u"))],
        [2, 2, 0]
    );
}

#[test]
fn a_prescribed_motion_turns_round_as_a_load_does() {
    // λ is the way of the hand now, and λ = d + P(d) / 0.8 turns twice.
    let moved = r#"Displacement(node: "hand", component: y, value: -1.0)"#;
    let run = finished(&with_spring(
        moved,
        "(path: [0.0, 0.8], increment: 0.01, control: arc, arc: (largest: 0.03))",
    ));
    for accepted in &run.accepted {
        let d = -accepted.monitors["u"];
        let exact = d + truss_load(d) / 0.8;
        assert!(
            (accepted.load - exact).abs() < 1e-9,
            "{} {exact}",
            accepted.load
        );
        assert!((accepted.monitors["w"] + accepted.load).abs() < 1e-12);
    }
    assert_eq!(last(&run).load, 0.8);
    assert_eq!(turns(run.accepted.iter().map(|accepted| accepted.load)), 2);
}

#[test]
fn a_node_slides_over_a_rough_ridge_along_its_closed_form_and_ends_at_its_bound() {
    let mu = 11.309932474020213_f64.to_radians().tan();
    let bound = r#"ends: [(monitor: "u_x", at: 0.9)]"#;
    for along in ["", r#"monitor: "u_x", "#, r#"slip: "tip", "#] {
        let history =
            format!("(path: [0.0, 2.0], increment: 0.05, control: arc, arc: ({along}{bound}))");
        let run = finished(&ridge(&history));
        for accepted in &run.accepted {
            let x = accepted.monitors["u_x"] - 0.5;
            let y = -x * x;
            let exact = 0.5 * (x + 0.5) - 10.0 * (y + 0.25) * (2.0 * x - mu) / (1.0 + 2.0 * mu * x);
            assert!((accepted.load - exact).abs() < 1e-8, "{along}{x}: {exact}");
            assert!(
                (accepted.monitors["u_y"] - (y + 0.25)).abs() < 1e-12,
                "{along}{x}"
            );
        }
        assert!((last(&run).monitors["u_x"] - 0.9).abs() < 1e-12, "{along}");
        let highest = run.accepted.iter().map(|a| a.load).fold(0.0, f64::max);
        assert!(highest > 1.5 && last(&run).load < 0.0, "{along}");
    }
}

/// Slip is positive where the node is drawn to the right, and negative where it is drawn to the left.
#[test]
fn an_arc_measured_by_slip_grows_whichever_way_the_node_slides() {
    let arcs = [1.0, -1.0].map(|way| {
        let bound = format!(r#"ends: [(monitor: "u_x", at: {:?})]"#, 0.9 * way);
        let history = format!(
            r#"(path: [0.0, 2.0], increment: 0.05, control: arc, arc: (slip: "tip", {bound}))"#
        );
        let run = finished(&ridge_towards(way, &history));
        assert!((last(&run).monitors["u_x"] - 0.9 * way).abs() < 1e-12);
        let arcs: Vec<f64> = of(&run, "arc").collect();
        assert!(arcs.windows(2).all(|pair| pair[0] < pair[1]), "{arcs:?}");
        arcs
    });
    assert_eq!(arcs[0].len(), arcs[1].len());
    for (right, left) in arcs[0].iter().zip(&arcs[1]) {
        assert!((right - left).abs() < 1e-9, "{right} {left}");
    }
}

/// Measured by w, which turns where the path snaps back, one increment can only jump to where w goes on.
#[test]
fn a_jump_along_the_path_is_marked() {
    let history =
        r#"(path: [0.0, 0.5], increment: 0.01, control: arc, jumps: accept, arc: (monitor: "w"))"#;
    let run = finished(&with_spring(r#"Force(node: "hand", y: -1.0)"#, history));
    let w = |d: f64| d + truss_load(d) / 0.8;
    let downs: Vec<f64> = (0..400).map(|k| 1e-3 * f64::from(k)).collect();
    let turns = |of: &dyn Fn(f64) -> f64| -> Vec<f64> {
        let turn = |d: &[f64]| (of(d[1]) - of(d[0])) * (of(d[2]) - of(d[1])) < 0.0;
        let around = downs.windows(3).filter(|d| turn(d));
        around.map(|d| d[1]).collect()
    };
    let (limit, turns) = (turns(&truss_load)[0], turns(&w));
    assert_eq!(turns.len(), 2);
    let (mut before, mut jumps) = (0.0, 0);
    for accepted in &run.accepted {
        let d = -accepted.monitors["u"];
        let outcome = &accepted.event.outcome;
        let marked = matches!(outcome, Outcome::Increment { jumped: true, .. });
        if before < turns[0] && d > turns[1] {
            assert!(marked, "from {before} to {d}");
            jumps += 1;
        } else if d < limit {
            assert!(!marked, "from {before} to {d}");
        }
        before = d;
    }
    assert_eq!(jumps, 1);
}

/// Where the tip of problem 04 touches the circle, the equations of the arc have a second solution: the way back.
#[test]
fn no_increment_goes_back_the_way_of_the_one_before() {
    let set = [("history.control", "arc"), ("history.arc.length", "1.0")];
    let run = run(&common::scene("04-cantilever-rigid-circle", &set));
    assert!(last(&run).load > 1.1, "{}", last(&run).load);
    assert_eq!(turns(of(&run, "u_x")), 0);
}

#[test]
fn a_leg_ends_when_the_load_first_meets_its_corner() {
    let run = finished(&truss(
        "(path: [0.0, 0.1, -0.05, 0.12], increment: 0.02, control: arc)",
    ));
    let loads: Vec<f64> = run.accepted.iter().map(|accepted| accepted.load).collect();
    let at = |corner: f64| loads.iter().position(|&load| load == corner);
    let [first, second, third] = [0.1, -0.05, 0.12].map(|corner| at(corner).unwrap());
    assert!(
        first < second && second < third && third + 1 == loads.len(),
        "{loads:?}"
    );
    for accepted in &run.accepted {
        assert!((accepted.load - truss_load(-accepted.monitors["u"])).abs() < 1e-9);
    }
    // Each corner is met on the branch that begins unloaded, short of the limit point.
    assert!(of(&run, "u").all(|u| u > -0.085));
}

#[test]
fn a_history_ends_at_its_arc() {
    let run = finished(&truss(
        "(path: [0.0, 1.0], increment: 0.02, control: arc, arc: (length: 0.3))",
    ));
    assert!((last(&run).monitors["arc"] - 0.3).abs() < 1e-12);
    assert!((last(&run).monitors["u"] + 0.3).abs() < 1e-9);
}

#[test]
fn problem_02_is_followed_past_the_limit_at_which_load_control_ends() {
    for (angle, finest) in [("10", "0.02"), ("20", "0.02")] {
        let rough = |more: &[(&str, &str)]| {
            let all = [&[("friction.angle", angle)], more].concat();
            common::scene("02-two-cantilevers-rough", &all)
        };
        // It jumps, or ends.
        let loaded = run(&rough(&[]));
        let jumps = |accepted: &Accepted| {
            matches!(
                accepted.event.outcome,
                Outcome::Increment { jumped: true, .. }
            )
        };
        let jump = loaded.accepted.iter().position(jumps);
        assert!(jump.is_some() || loaded.failure.is_some(), "{angle}");
        let reached = loaded.accepted[jump.unwrap_or(loaded.accepted.len()) - 1].load;
        let followed = finished(&rough(&[
            ("history.control", "arc"),
            ("history.arc.largest", finest),
            ("settings.t_max", "consistent"),
        ]));
        assert_eq!(last(&followed).load, 2.5);
        let loads: Vec<f64> = followed.accepted.iter().map(|a| a.load).collect();
        let turn = loads.windows(2).position(|pair| pair[1] < pair[0]).unwrap();
        let limit = loads[turn];
        // The peak is a corner between two increments of 0.02, and the load rises by about as much on the way to it.
        assert!(limit < reached + 0.05 / 64.0, "{angle}: {limit} {reached}");
        assert!(limit > reached - 0.03, "{angle}: {limit} {reached}");
        // Where load control lands after its jump, the path comes, too.
        if jump.is_some() {
            let ends = [&followed, &loaded].map(|run| last(run).monitors["u_x"]);
            assert!((ends[0] - ends[1]).abs() < 1e-9, "{ends:?}");
        }
        assert!(loads[turn + 1..].iter().any(|&load| load < 0.9 * limit));
        for accepted in &followed.accepted {
            let verdict = accepted.state.start.verdict.as_ref().unwrap();
            assert_eq!(verdict.broken().count(), 0, "{angle}: {}", accepted.load);
            assert!(matches!(
                accepted.event.outcome,
                Outcome::Increment { jumped: false, .. }
            ));
        }
    }
}

#[test]
fn a_state_on_the_path_goes_on_with_the_same_bits() {
    let model = Arc::new(ridge("(path: [0.0, 2.0], increment: 0.05, control: arc)").model);
    let mut whole = Stepper::new(model.clone());
    let mut states = Vec::new();
    for _ in 0..400 {
        states.push(whole.state().clone());
        if whole.step().is_none() {
            break;
        }
    }
    let end = whole.state().clone();
    let steps = states.len();
    for from in [1, steps / 3, steps / 2 + 1] {
        let text = ron::to_string(&states[from]).unwrap();
        let read: stickslip::step::State = ron::from_str(&text).unwrap();
        assert_eq!(read, states[from]);
        let mut again = Stepper::new(model.clone());
        again.restore(&read);
        let left = if *whole.state() == states[steps - 1] {
            steps - 1
        } else {
            steps
        };
        for _ in from..left {
            again.step();
        }
        assert_eq!(*again.state(), end, "{from}");
    }
}

#[test]
fn what_does_not_move_cannot_measure_a_path() {
    let scene =
        truss(r#"(path: [0.0, 1.0], increment: 0.02, control: arc, arc: (monitor: "held"))"#);
    let failure = run(&scene).failure.map(|(_, failure)| failure);
    assert_eq!(failure, Some(Failure::ZeroMeasure));
}

#[test]
fn what_cannot_be_followed_is_refused_with_a_reason() {
    let told = |set: &[(&str, &str)], arc: &str| {
        let text = format!(
            r#"(
    title: "A spring",
    nodes: [Node(id: "a", at: (0, 0)), Node(id: "b", at: (1, 0))],
    materials: [],
    bodies: [Springs(id: "s", bars: [(nodes: ["a", "b"], angle: 0, stiffness: 1)])],
    supports: [(node: "a", fix: [x, y]), (node: "b", fix: [y])],
    loads: [Force(node: "b", x: 1)],
    history: (path: [0, 1], increment: 0.1, control: arc, arc: ({arc})),
    monitors: [
        (name: "u", of: Displacement(node: "b", component: x)),
        (name: "r", of: Reaction(node: "a", component: x)),
    ],
)"#
        );
        let set: Vec<_> = set
            .iter()
            .map(|(p, v)| (p.to_string(), v.to_string()))
            .collect();
        Scene::from_text("spring", &text, &set).map_or_else(|e| e.to_string(), |_| String::new())
    };
    assert_eq!(told(&[], r#"monitor: "u""#), "");
    assert!(told(&[], r#"monitor: "v""#).contains("\"v\" is not a monitor (displacements: \"u\")"));
    assert!(told(&[], r#"monitor: "r""#).contains("does not monitor a displacement"));
    assert!(told(&[], r#"slip: "b""#).contains("is not a slave node"));
    assert!(told(&[], "step: 0.0").contains("step is 0.0; it must be a positive number"));
    assert!(told(&[], "iterations: 0").contains("at least 1"));
    assert!(told(&[("settings.solver", "augmented")], "").contains("condensed interface"));
}

/// A scene along its path; the arc after which it ends.
fn along(name: &str, set: &[(&str, &str)]) -> Run {
    let all = [&[("history.control", "arc")], set].concat();
    finished(&common::scene(name, &all))
}

#[test]
fn the_arch_of_osc_snap_snaps_through_under_its_cantilever() {
    let sound = [
        ("settings.strategy", "ladder"),
        ("settings.sticking", "anchored"),
        ("settings.slip", "increment"),
        ("settings.geometry", "consistent"),
        ("settings.majors", "60"),
        ("history.increment", "0.1"),
    ];
    let run = along("osc-snap", &sound);
    assert_eq!(last(&run).load, 6.0);
    let loads = || run.accepted.iter().map(|accepted| accepted.load);
    assert_eq!(turns(loads()), 2, "{:?}", loads().collect::<Vec<_>>());
    assert_eq!(turns(of(&run, "u_y")), 0);
}

#[test]
fn the_block_that_is_thrown_over_its_edge_is_let_down_along_its_path() {
    let edge = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/scales/block-over-its-edge.ron"
    );
    let run = along(edge, &[("history.arc.length", "1.0")]);
    let loads: Vec<f64> = run.accepted.iter().map(|accepted| accepted.load).collect();
    let highest = loads.iter().copied().fold(0.0, f64::max);
    // Under load control it jumps between 0.43 and 0.46 (tests/solver/jumps.rs).
    assert!((0.43..0.46).contains(&highest), "{highest}");
    assert!(*loads.last().unwrap() < 0.0, "{loads:?}");
}

#[test]
fn tables_have_the_arc_where_the_path_is_followed_and_snapshots_replay() {
    let folder = tempfile::tempdir().unwrap();
    let scene = "02-two-cantilevers-rough";
    let follow = ["--set", "friction.angle=20", "--set", "history.control=arc"];
    let told = |arguments: &[&str]| well(&program(folder.path(), arguments).output().unwrap());
    let csv = told(&[&["run", scene, "--quiet", "--csv", "-"], &follow[..]].concat());
    assert!(csv.starts_with("increment,load,majors,minors,") && csv.contains(",arc,jumped\n"));
    let trace = told(&[&["run", scene, "--quiet", "--trace", "-"], &follow[..]].concat());
    assert!(
        trace
            .lines()
            .next()
            .unwrap()
            .ends_with(",residual,contact,arc")
    );
    let loaded = told(&["run", scene, "--quiet", "--trace", "-"]);
    assert!(
        loaded
            .lines()
            .next()
            .unwrap()
            .ends_with(",residual,contact")
    );
    // Rows of the last increment's last minor iteration end with the arc of the table.
    let arcs: Vec<String> = rows(&csv).iter().map(|row| row["arc"].clone()).collect();
    let ends = rows(&trace).last().unwrap()["arc"].clone();
    assert_eq!(Some(&ends), arcs.last());
    told(
        &[
            &["record", scene, "--at", "9.2", "-o", "past.snap"],
            &follow[..],
        ]
        .concat(),
    );
    told(&["replay", "past.snap"]);
}

/// With finer elements the path turns by more than a right angle where the node begins to slide, and at their borders.
#[test]
fn sharp_corners_of_the_path_are_turned_and_its_end_is_that_of_load_control() {
    for (angle, refine) in [("5", "4"), ("10", "2"), ("10", "4"), ("20", "2")] {
        let set = [("friction.angle", angle), ("refine", refine)];
        let path = along("02-two-cantilevers-rough", &set);
        let end = path.accepted.last().unwrap();
        assert!((end.load - 2.5).abs() < 1e-12, "{set:?}: {}", end.load);
        let loaded = run(&common::scene("02-two-cantilevers-rough", &set));
        let other = loaded.accepted.last().unwrap();
        let (a, b) = (end.monitors["u_x"], other.monitors["u_x"]);
        assert!((a - b).abs() < 1e-7, "{set:?}: {a} {b}");
    }
}

/// Without shear flexibility the slave node starts to slide at a border whose kink is about 1e-8: no increment ends in that corner. The
/// path goes through it, and back with the load at first.
#[test]
fn a_path_passes_the_onset_of_slip_at_a_border_that_is_nearly_straight() {
    let file = "problems/02-two-cantilevers-rough.ron";
    let text = std::fs::read_to_string(file).unwrap_or_else(|e| panic!("{file}: {e}"));
    let text = text
        .replace(", GA: 32.0512820513", "")
        .replace("per_element: 5", "per_element: 9");
    let mut ends = Vec::new();
    for refine in ["2", "3", "6", "8"] {
        let set = [
            ("refine", refine),
            ("friction.angle", "10"),
            ("history.control", "arc"),
            ("history.increment", "0.02"),
            ("history.arc.largest", "0.03"),
            ("settings.t_max", "consistent"),
        ];
        let set = set.map(|(path, value)| (path.to_owned(), value.to_owned()));
        let scene = Scene::from_text("slender", &text, &set).unwrap_or_else(|e| panic!("{e}"));
        let path = finished(&scene);
        let end = path.accepted.last().unwrap();
        assert!(
            (end.load - 2.5).abs() < 1e-12,
            "refine {refine}: {}",
            end.load
        );
        let loads: Vec<f64> = path.accepted.iter().map(|accepted| accepted.load).collect();
        assert!(loads.windows(2).any(|pair| pair[1] < pair[0]), "{loads:?}");
        ends.push(end.monitors["u_x"]);
    }
    assert!(ends.iter().all(|u| (u - ends[3]).abs() < 1e-5), "{ends:?}");
}
