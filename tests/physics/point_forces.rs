//! Slave nodes that press on beams with a shear stiffness: the line has a kink where they stand, wherever in an element that is.
//!
//! ```text
//!   o ---> P         02 with GA; friction 0 or 2 degrees. Exact: the node slips from P = 0.153076 on (a shooting solution of both
//!   |                beams with the point force at s*, whose tangent there is the mean of both sides).
//!   |o======|
//!   |
//!  ===
//! ```

use crate::common::{Run, order, read, run, scene, table};
use crate::references::{Row, error};
use std::path::Path;
use stickslip::model::Mode;
use stickslip::scene::Scene;

const SMOOTH: &str = "02-two-cantilevers-smooth";
const ROUGH: &str = "02-two-cantilevers-rough";
/// Load at which the node slips at 2 degrees of friction.
const ONSET: f64 = 0.153076;

fn finished(run: Run) -> Run {
    assert!(run.failure.is_none(), "{:?}", run.failure);
    run
}

fn smooth_rows() -> Vec<Row> {
    let rows = table("02-two-cantilevers.csv").into_iter();
    rows.filter(|r| r["model"] == "TIM" && r["case"] == "phi0")
        .collect()
}

/// Load after which the node first slid.
fn onset(run: &Run) -> f64 {
    let slides = |mode: Mode| mode == Mode::Sliding;
    let first = run
        .accepted
        .iter()
        .find(|a| slides(a.event.nodes[0].decision.next));
    first.unwrap_or_else(|| panic!("it never slides")).load
}

#[test]
fn the_smooth_column_is_exact_to_1e_5_with_4_elements_and_converges() {
    let rows = smooth_rows();
    let errors = ["2", "3", "4", "5", "8"].map(|refine| {
        let run = finished(run(&scene(SMOOTH, &[("refine", refine)])));
        error(&run, &rows, "P", "u_x", "u_tip")
    });
    println!("refine 2, 3, 4, 5, 8: {errors:?}");
    let limits = [4e-5, 7e-6, 3e-6, 1.5e-6, 4e-7];
    assert!(
        errors.iter().zip(limits).all(|(e, limit)| *e < limit),
        "{errors:?}"
    );
    let rate = order(errors[0], errors[4], 4.0);
    assert!(rate > 2.0, "order {rate}: {errors:?}");
}

#[test]
fn shear_alone_leaves_what_bending_leaves_out_and_the_plain_element_stalls() {
    let rows = smooth_rows();
    let errors = |point_force: &str| {
        ["2", "4", "8"].map(|refine| {
            let set = [("refine", refine), ("settings.point_force", point_force)];
            error(
                &finished(run(&scene(SMOOTH, &set))),
                &rows,
                "P",
                "u_x",
                "u_tip",
            )
        })
    };
    let (shear, plain) = (errors("shear"), errors("plain"));
    println!("shear {shear:?}, plain {plain:?}");
    let limits = [1e-4, 3e-5, 5e-6];
    assert!(
        shear.iter().zip(limits).all(|(e, limit)| *e < limit),
        "{shear:?}"
    );
    assert!(plain.iter().all(|e| (3e-4..6e-4).contains(e)), "{plain:?}");
}

/// `border_5_2.ron`: with an even number of elements the node starts on a border.
#[test]
fn at_2_degrees_the_node_slips_at_the_same_load_on_every_mesh() {
    for refine in ["2", "3", "4", "8"] {
        let set = [
            ("refine", refine),
            ("friction.angle", "2"),
            ("history.path[1]", "0.16"),
            ("history.increment", "0.0005"),
        ];
        let load = onset(&finished(run(&scene(ROUGH, &set))));
        println!("refine {refine}: {load}");
        // It slides in the first increment that ends beyond the load.
        assert!(
            (ONSET..ONSET + 5e-4).contains(&load),
            "refine {refine}: {load}"
        );
    }
}

#[test]
fn at_2_degrees_the_column_converges_too() {
    let reference = table("02-two-degrees.csv");
    let errors = ["2", "3", "4", "8"].map(|refine| {
        let set = [("refine", refine), ("friction.angle", "2")];
        let run = finished(run(&scene(ROUGH, &set)));
        let off = reference.iter().map(|row| {
            let (load, u): (f64, f64) = (row["P"].parse().unwrap(), row["u_tip"].parse().unwrap());
            let at = run.accepted.iter().find(|a| (a.load - load).abs() < 1e-9);
            (at.unwrap_or_else(|| panic!("no load {load}")).monitors["u_x"] - u).abs()
        });
        off.fold(0.0, f64::max)
    });
    println!("refine 2, 3, 4, 8: {errors:?}");
    assert!(
        errors[2] < 1e-5 && errors[1] < 2e-5 && errors[0] < 1.2e-4,
        "{errors:?}"
    );
    let rate = order(errors[0], errors[3], 4.0);
    assert!(rate > 2.0, "order {rate}: {errors:?}");
}

/// With a term of the tangent left out they would be many times as many.
#[test]
fn major_iterations_converge_quadratically() {
    for (name, angle) in [(SMOOTH, "0"), (ROUGH, "2")] {
        let majors = ["exact", "plain"].map(|point_force| {
            let set = [
                ("refine", "4"),
                ("friction.angle", angle),
                ("settings.point_force", point_force),
            ];
            let run = finished(run(&scene(name, &set)));
            run.accepted.iter().map(|a| a.majors).sum::<u32>()
        });
        println!("{name}: majors {majors:?}");
        assert!(10 * majors[0] <= 11 * majors[1], "{name}: {majors:?}");
    }
}

/// Three nodes on springs press on one clamped element: each sees what the others do.
#[test]
fn several_nodes_on_one_element_give_together() {
    // The exact deflections are those of 24 elements, on which no two nodes share one.
    let deflection = |elements: usize, point_force: &str| {
        let text = format!(
            "(title: \"three\", nodes: [
                Line(id: \"b\", from: (0, 0), to: (4, 0), elements: {elements}, per_element: 5),
                Node(id: \"p\", at: (0.7, 0)), Node(id: \"q\", at: (1.9, 0)), Node(id: \"r\", at: (2.6, 0))],
            materials: [Section(id: \"m\", EA: 100.0, EI: 8.333333333333334, GA: 32.0512820513)],
            bodies: [Beam(id: \"b\", along: \"b\", material: \"m\"),
                Springs(id: \"k\", bars: [
                    (nodes: [\"p\"], angle: 0, stiffness: 5), (nodes: [\"p\"], angle: 90, stiffness: 0.1),
                    (nodes: [\"q\"], angle: 0, stiffness: 5), (nodes: [\"q\"], angle: 90, stiffness: 0.1),
                    (nodes: [\"r\"], angle: 0, stiffness: 5), (nodes: [\"r\"], angle: 90, stiffness: 0.1)])],
            surfaces: [(id: \"b\", along: \"b\", reverse: true)],
            slaves: [(nodes: [\"p\", \"q\", \"r\"], on: [\"b\"], start: sliding)],
            friction: (angle: 0),
            supports: [(node: \"b.start\", fix: [x, y, rotation]), (node: \"b.end\", fix: [x, y, rotation])],
            loads: [Force(node: \"p\", y: -0.5), Force(node: \"q\", y: -0.3), Force(node: \"r\", y: -0.4)],
            history: (path: [0, 1], increment: 0.5),
            settings: (point_force: {point_force}),
            monitors: [(name: \"p\", of: Displacement(node: \"p\", component: y)),
                (name: \"q\", of: Displacement(node: \"q\", component: y)),
                (name: \"r\", of: Displacement(node: \"r\", component: y))])"
        );
        let scene = read(&text);
        let run = finished(run(&scene));
        let last = run.accepted.last().unwrap();
        (["p", "q", "r"].map(|name| last.monitors[name]), last.majors)
    };
    let (exact, _) = deflection(24, "exact");
    let (one, majors) = deflection(1, "exact");
    let (plain, without) = deflection(1, "plain");
    let off = |found: [f64; 3]| {
        let parts = found.iter().zip(exact).map(|(u, exact)| (u - exact).abs());
        parts.fold(0.0, f64::max)
    };
    println!("exact {exact:?}, one element {one:?}, plain {plain:?}; majors {majors} {without}");
    assert!(
        off(one) < 5e-6 && off(plain) > 100.0 * off(one),
        "{} {}",
        off(one),
        off(plain)
    );
    assert!(majors <= without, "{majors} {without}");
}

/// Without a shear stiffness there is nothing to put back.
#[test]
fn without_shear_flexibility_the_setting_changes_no_bit() {
    let text = stickslip::scene::builtin::find(SMOOTH)
        .unwrap()
        .text
        .to_owned();
    let rigid = text.replace(", GA: 32.0512820513", "");
    let ends = ["exact", "shear", "plain"].map(|point_force| {
        let set = [("settings.point_force".to_owned(), point_force.to_owned())];
        let run = finished(run(&Scene::from_text("rigid", &rigid, &set).unwrap()));
        let of = |a: &crate::common::Accepted| a.monitors["u_x"].to_bits();
        run.accepted.iter().map(of).collect::<Vec<_>>()
    });
    assert!(ends[0] == ends[1] && ends[1] == ends[2]);
}

#[test]
fn the_scene_that_was_held_at_a_border_slips_there() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/findings/border_5_2.ron");
    let scene = Scene::open(path.to_str().unwrap(), &[]).unwrap_or_else(|e| panic!("{e}"));
    let load = onset(&finished(run(&scene)));
    assert!((ONSET..ONSET + 5e-3).contains(&load), "{load}");
}
