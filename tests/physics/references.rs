//! The scenes against solutions that were found without any contact algorithm (`tests/references/`).
//!
//! Errors are differences over the largest reference value of their kind in the whole history.

use crate::common::{Run, force, go_on, number, order, run, scene, table};
use std::collections::HashMap;
use stickslip::model::Mode;
use stickslip::scene::Scene;
use stickslip::step::event::Failure;

pub type Row = HashMap<String, String>;

/// Largest error of a monitor over the rows of a reference whose load factor an increment met.
pub fn error(run: &Run, rows: &[Row], load: &str, ours: &str, theirs: &str) -> f64 {
    let scale = rows
        .iter()
        .map(|r| number(r, theirs).abs())
        .fold(0.0, f64::max);
    let mut met = 0;
    let mut worst = 0.0_f64;
    for row in rows {
        let at = number(row, load);
        let Some(a) = run.accepted.iter().find(|a| (a.load - at).abs() < 1e-12) else {
            continue;
        };
        met += 1;
        worst = worst.max((a.monitors[ours] - number(row, theirs)).abs() / scale);
    }
    assert!(met > 2, "only {met} rows met");
    worst
}

fn finished(run: &Run) {
    assert!(run.failure.is_none(), "{:?}", run.failure);
}

#[test]
fn problem_01_meets_the_closed_form_over_the_whole_loop() {
    for (t_max, limit) in [("lagged", 1e-9), ("consistent", 1e-10)] {
        for increment in ["0.01", "0.005", "0.05"] {
            let run = run(&scene(
                "01-pinned-beam-rough-floor",
                &[("settings.t_max", t_max), ("history.increment", increment)],
            ));
            finished(&run);
            let rows = table("01-pinned-beam.csv");
            for branch in ["load", "unload"] {
                let rows: Vec<Row> = rows
                    .iter()
                    .filter(|r| r["branch"] == branch)
                    .cloned()
                    .collect();
                let legs = run.accepted.iter().position(|a| a.load == 0.25).unwrap();
                let part = |keep: bool| {
                    run.accepted
                        .iter()
                        .enumerate()
                        .filter(move |(k, _)| (*k <= legs) == keep)
                };
                let here: HashMap<u64, &crate::common::Accepted> = part(branch == "load")
                    .map(|(_, a)| ((a.load * 1e6).round() as u64, a))
                    .collect();
                let mut met = 0;
                for row in &rows {
                    let Some(a) = here.get(&((number(row, "P") * 1e6).round() as u64)) else {
                        continue;
                    };
                    met += 1;
                    // In the loop's own scale, and relative to each value itself.
                    let (u, exact) = (a.monitors["u_x"], number(row, "u_ENG"));
                    let wrong = (u - exact).abs();
                    assert!(
                        wrong < limit * 0.0127,
                        "{t_max} {branch} {}: {u} {exact}",
                        a.load
                    );
                    assert!(wrong < 1e-8 * exact.abs() || exact == 0.0);
                    let f_n = number(row, "Fn_ENG");
                    assert!((a.event.nodes[0].f_n - f_n).abs() < 1e-8 * 0.16);
                    // The reference's tangential force is against the load, along +x; t points along -x.
                    let f_t = number(row, "Ft_ENG");
                    assert!(
                        (a.event.nodes[0].f_t + f_t).abs() < 1e-8 * 0.16,
                        "{} {f_t}",
                        a.event.nodes[0].f_t
                    );
                }
                assert!(met > 2, "{increment} {branch}: only {met} rows met");
            }
        }
    }
}

#[test]
fn problem_01_reverses_within_one_increment_of_the_exact_load() {
    const REVERSAL: f64 = 0.0664648;
    for increment in [0.01, 0.001] {
        let text = increment.to_string();
        let run = run(&scene(
            "01-pinned-beam-rough-floor",
            &[("history.increment", &text)],
        ));
        finished(&run);
        let peak = run.accepted.iter().position(|a| a.load == 0.25).unwrap();
        let back = run.accepted[peak + 1..]
            .iter()
            .find(|a| a.event.nodes[0].decision.next == Mode::Sliding)
            .unwrap();
        assert!(
            back.load <= REVERSAL && back.load > REVERSAL - increment,
            "{}",
            back.load
        );
    }
}

fn cantilevers(case: &str) -> Vec<Row> {
    table("02-two-cantilevers.csv")
        .into_iter()
        .filter(|r| r["model"] == "TIM" && r["case"] == case)
        .collect()
}

#[test]
fn problem_02_smooth_slides_along_the_reference() {
    for (refine, limit) in [("1", 2e-4), ("2", 4e-5)] {
        let run = run(&scene("02-two-cantilevers-smooth", &[("refine", refine)]));
        finished(&run);
        let e = error(&run, &cantilevers("phi0"), "P", "u_x", "u_tip");
        assert!(e < limit, "refine {refine}: {e}");
    }
}

/// Largest errors of problem 02 smooth for each refinement, with plain elements.
fn smooth_errors(rows: &[Row], refine: &[&str], shear_rigid: bool, per_element: &str) -> Vec<f64> {
    let name = "02-two-cantilevers-smooth";
    let text = stickslip::scene::builtin::find(name)
        .unwrap()
        .text
        .to_owned();
    let text = if shear_rigid {
        let without = text.replace(", GA: 32.0512820513", "");
        assert_ne!(without, text);
        without
    } else {
        text
    };
    let one = |refine: &&str| {
        let set = [
            ("refine", *refine),
            ("nodes.column.per_element", per_element),
            ("nodes.beam.per_element", per_element),
            ("settings.point_force", "plain"),
        ]
        .map(|(path, value)| (path.to_owned(), value.to_owned()));
        let run = run(&Scene::from_text(name, &text, &set).unwrap());
        finished(&run);
        error(&run, rows, "P", "u_x", "u_tip")
    };
    let errors = refine.iter().map(one).collect();
    println!("{per_element} nodes, shear-rigid {shear_rigid}: {errors:?}");
    errors
}

/// The shear strain of the column jumps where the beam pushes it, so its exact line has a kink at S*, wherever that
/// is; the reference takes the mean of both sides for the tangent, as stationary energy wants it. A polynomial has no
/// kink: its slope at S* misses the mean by a part of the jump that depends on where in the element S* lies, not on
/// the element's size. So refinement of plain elements alone stalls; elements of higher degree follow the kink better. Without shear
/// strain there is no kink and nothing stalls. What puts the kink back is tested in `point_forces.rs`.
#[test]
fn problem_02_smooth_converges_where_the_columns_line_has_no_kink() {
    let rows: Vec<Row> = table("02-two-cantilevers.csv")
        .into_iter()
        .filter(|r| r["model"] == "EB" && r["case"] == "phi0")
        .collect();
    let e = smooth_errors(&rows, &["1", "2", "4", "8"], true, "5");
    let limits = [1.5e-3, 6e-5, 3e-5, 8e-6];
    assert!(e.iter().zip(limits).all(|(e, limit)| *e < limit), "{e:?}");
    // Single errors depend on where in an element S* lies; over all, second order at least.
    let rate = order(e[0], e[3], 8.0);
    assert!(rate > 2.0, "order {rate}: {e:?}");
}

#[test]
fn problem_02_smooth_stalls_with_5_nodes_a_plain_element_at_a_kink_and_converges_with_9() {
    let rows = cantilevers("phi0");
    let five = smooth_errors(&rows, &["2", "4", "8"], false, "5");
    assert!(five.iter().all(|e| (3e-4..6e-4).contains(e)), "{five:?}");
    let stalled = order(five[0], five[2], 4.0);
    assert!(stalled < 0.5, "order {stalled}: {five:?}");
    let nine = smooth_errors(&rows, &["1", "2", "4", "8"], false, "9");
    let limits = [1.2e-3, 6e-4, 3e-4, 1e-4];
    assert!(
        nine.iter().zip(limits).all(|(e, limit)| *e < limit),
        "{nine:?}"
    );
    let rate = order(nine[0], nine[3], 8.0);
    assert!(rate > 1.0, "order {rate}: {nine:?}");
}

#[test]
fn problem_02_rough_sticks_all_along_and_meets_the_reference() {
    let errors: Vec<f64> = ["1", "2"]
        .iter()
        .map(|refine| {
            let run = run(&scene("02-two-cantilevers-rough", &[("refine", refine)]));
            finished(&run);
            assert!(
                run.accepted
                    .iter()
                    .all(|a| a.event.nodes[0].decision.next == Mode::Fixed)
            );
            error(&run, &cantilevers("stick"), "P", "u_x", "u_tip")
        })
        .collect();
    assert!(errors[0] < 2e-2 && errors[1] < 5e-7, "{errors:?}");
}

/// With even refinement the tip sticks where a node of the column is, so that the exact line is smooth within elements. The
/// displacements at nodes of elements of degree p then converge with order 2p.
#[test]
fn problem_02_rough_converges_at_the_full_rate_of_elements_of_every_degree() {
    for (per_element, coarse, fine) in [
        ("2", "8", "16"),
        ("3", "4", "8"),
        ("4", "4", "8"),
        ("5", "4", "8"),
    ] {
        let errors = [coarse, fine].map(|refine| {
            let set = [
                ("refine", refine),
                ("nodes.column.per_element", per_element),
                ("nodes.beam.per_element", per_element),
                ("history.increment", "0.1"),
            ];
            let run = run(&scene("02-two-cantilevers-rough", &set));
            finished(&run);
            error(&run, &cantilevers("stick"), "P", "u_x", "u_tip")
        });
        let rate = order(errors[0], errors[1], 2.0);
        println!("{per_element} nodes: {errors:?}, order {rate}");
        let wanted = 2.0 * (per_element.parse::<f64>().unwrap() - 1.0);
        assert!(
            (rate - wanted).abs() < 0.3,
            "{per_element} nodes: order {rate}, not {wanted}: {errors:?}"
        );
    }
}

#[test]
fn problem_02_separates_under_the_opposite_load() {
    let run = run(&scene(
        "02-two-cantilevers-smooth",
        &[("history.path[1]", "-2.5"), ("refine", "2")],
    ));
    finished(&run);
    assert!(
        run.accepted
            .iter()
            .all(|a| a.event.nodes[0].decision.next == Mode::Free)
    );
    let rows = cantilevers("free");
    let e = error(&run, &rows, "P", "u_x", "u_tip");
    assert!(e < 1e-6, "{e}");
}

#[test]
fn the_lifted_cantilever_cycles_and_reaches_the_reference_once_its_tip_is_forced_to_slide() {
    let mut run = run(&scene("osc-inclined-cantilever", &[]));
    let (event, failure) = run.failure.as_ref().unwrap();
    let Failure::Cycle(cycle) = failure else {
        panic!("{failure:?}")
    };
    assert_eq!((event.position.increment, cycle.period), (1, 2));
    assert_eq!(cycle.members, [(0, vec![Mode::Free, Mode::Fixed])]);
    force(&mut run, 0, Mode::Sliding, false);
    let run = go_on(run);
    finished(&run);
    let rows = table("06-inclined-cantilever-lifted.csv");
    for (ours, theirs) in [
        ("u_x", "u_x"),
        ("rotation", "rot"),
        ("contact_y", "Fn"),
        ("contact_x", "Ft"),
    ] {
        let e = error(&run, &rows, "P", ours, theirs);
        println!("{ours} {e:e}");
        assert!(e < 1e-6, "{ours}: {e}");
    }
}

#[test]
fn problem_03_converges_with_one_and_with_two_contacts() {
    // Stage 0: free; 1: the short tip on the long beam; 2: also the long tip on the short one's flank. What errors
    // there are come from the short beam, whose tip turns by a radian, past its Euler load: the largest stand
    // at M = 4.5 and 4.75, and fall with the mesh. Up to M = 2.5 the paper's mesh is within 6e-6.
    let rows = table("03-distant-cantilevers.csv");
    let cases = [
        ("5", "1", [1e-12, 5.2e-4, 3e-4]),
        ("5", "2", [1e-12, 1.3e-4, 1e-5]),
        ("5", "4", [1e-12, 6e-6, 1e-5]),
        ("9", "1", [1e-12, 1.5e-5, 2e-5]),
        ("9", "2", [1e-12, 2e-6, 3e-6]),
    ];
    let mut found = HashMap::new();
    for (per_element, refine, limits) in cases {
        let set = [
            ("nodes.long.per_element", per_element),
            ("nodes.short.per_element", per_element),
            ("refine", refine),
        ];
        let run = run(&scene("03-distant-cantilevers", &set));
        finished(&run);
        assert_eq!(run.accepted.len(), 100);
        for (stage, limit) in limits.iter().enumerate() {
            let e = stage_error(&run, &rows, |r| r["stage"] == stage.to_string());
            println!("{set:?} stage {stage} {e:e}");
            assert!(e < *limit, "{set:?} stage {stage}: {e}");
            found.insert((per_element, refine, stage), e);
        }
        let early = |r: &Row| r["stage"] == "1" && number(r, "M") <= 2.5;
        let e = stage_error(&run, &rows, early);
        assert!(e < 6e-6, "{set:?} {e}");
    }
    // A contact point wanders through elements, so single errors waver; over all, second order at least.
    for (per_element, finest, finer) in [("5", "4", 4.0), ("9", "2", 2.0)] {
        for stage in [1, 2] {
            let [coarse, fine] = ["1", finest].map(|refine| found[&(per_element, refine, stage)]);
            let rate = order(coarse, fine, finer);
            assert!(
                rate > 2.0,
                "{per_element} nodes, stage {stage}: order {rate}"
            );
        }
    }
}

/// Largest error of problem 03's tip over some rows, over the largest displacement of all.
fn stage_error(run: &Run, rows: &[Row], of: impl Fn(&Row) -> bool) -> f64 {
    let size = |r: &Row| number(r, "u_tip").abs();
    let part: Vec<Row> = rows.iter().filter(|r| of(r)).cloned().collect();
    let largest = |rows: &[Row]| rows.iter().map(size).fold(0.0, f64::max);
    error(run, &part, "M", "u_x", "u_tip") * largest(&part) / largest(rows)
}

#[test]
fn problem_04_converges_to_the_elastica_on_the_circle_at_second_order() {
    // Increments do not matter here (smooth, elastic); larger ones save time.
    let rows: Vec<Row> = table("04-rigid-circle.csv")
        .into_iter()
        .filter(|r| r["L"] == "1" && r["R"] == "1")
        .collect();
    let errors: Vec<f64> = ["1", "2", "4", "8"]
        .iter()
        .map(|refine| {
            let set = [("refine", *refine), ("history.increment", "0.25")];
            let run = run(&scene("04-cantilever-rigid-circle", &set));
            finished(&run);
            error(&run, &rows, "P", "u_x", "u_ext")
        })
        .collect();
    println!("{errors:?}");
    let limits = [4e-4, 2e-4, 4e-5, 5e-6];
    assert!(
        errors.iter().zip(limits).all(|(e, limit)| *e < limit),
        "{errors:?}"
    );
    // The wrapped length ends between two nodes: single errors depend on where, their envelope falls with h².
    let rate = order(errors[0], errors[3], 8.0);
    assert!((1.8..2.5).contains(&rate), "{rate}");
}

#[test]
fn problem_04_owes_its_error_to_the_wrapped_nodes_and_not_to_the_circles_mesh() {
    let rows: Vec<Row> = table("04-rigid-circle.csv")
        .into_iter()
        .filter(|r| r["L"] == "1" && r["R"] == "1")
        .collect();
    let (touched, free): (Vec<Row>, Vec<Row>) = rows.into_iter().partition(|r| r["wrapped"] == "1");
    let with = |circle: &str| {
        let set = [
            ("nodes.circle.elements", circle),
            ("history.increment", "0.25"),
        ];
        let run = run(&scene("04-cantilever-rigid-circle", &set));
        finished(&run);
        let e = error(&run, &free, "P", "u_x", "u_ext");
        assert!(e < 1e-9, "before it wraps: {e}");
        error(&run, &touched, "P", "u_x", "u_ext")
    };
    let (coarse, fine) = (with("6"), with("24"));
    println!("{coarse:e} {fine:e}");
    assert!(coarse > 1e-4 && (coarse - fine).abs() < 2e-3 * coarse);
}
