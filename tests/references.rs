//! The scenes against solutions that were found without any contact algorithm (`tests/references/`).
//!
//! Errors are differences over the largest reference value of their kind in the whole history.

mod common;

use common::{Run, force, go_on, number, run, scene, table};
use std::collections::HashMap;
use stickslip::scene::Mode;
use stickslip::solve::Failure;

type Row = HashMap<String, String>;

/// Largest error of a monitor over the rows of a reference whose load factor an increment met.
fn error(run: &Run, rows: &[Row], load: &str, ours: &str, theirs: &str) -> f64 {
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
                let here: HashMap<u64, &common::Accepted> = part(branch == "load")
                    .map(|(_, a)| ((a.load * 1e6).round() as u64, a))
                    .collect();
                for row in &rows {
                    let Some(a) = here.get(&((number(row, "P") * 1e6).round() as u64)) else {
                        continue;
                    };
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
    for (refine, limit) in [("1", 3.1e-3), ("2", 6e-4)] {
        let run = run(&scene("02-two-cantilevers-smooth", &[("refine", refine)]));
        finished(&run);
        let e = error(&run, &cantilevers("phi0"), "P", "u_x", "u_tip");
        assert!(e < limit, "refine {refine}: {e}");
    }
}

#[test]
fn problem_02_rough_sticks_and_converges_at_the_elements_full_rate() {
    let errors: Vec<f64> = ["1", "2", "4"]
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
fn problem_03_meets_its_reference_with_one_and_with_two_contacts() {
    // Stage 0: free; 1: the short tip on the long beam; 2: also the long tip on the short one's flank.
    for (refine, limits) in [("1", [1e-12, 1e-3, 5e-4]), ("2", [1e-12, 3e-4, 3e-5])] {
        let run = run(&scene("03-distant-cantilevers", &[("refine", refine)]));
        finished(&run);
        assert_eq!(run.accepted.len(), 100);
        for (stage, limit) in limits.iter().enumerate() {
            let rows: Vec<Row> = table("03-distant-cantilevers.csv")
                .into_iter()
                .filter(|r| r["stage"] == stage.to_string())
                .collect();
            let e = error(&run, &rows, "M", "u_x", "u_tip");
            println!("refine {refine} stage {stage} {e}");
            assert!(e < *limit, "refine {refine} stage {stage}: {e}");
        }
    }
}

#[test]
fn problem_04_converges_to_the_elastica_on_the_circle() {
    // Increments do not matter here (smooth, elastic); larger ones save time.
    let errors: Vec<f64> = ["1", "2", "4"]
        .iter()
        .map(|refine| {
            let set = [("refine", *refine), ("history.increment", "0.05")];
            let run = run(&scene("04-cantilever-rigid-circle", &set));
            finished(&run);
            let rows: Vec<Row> = table("04-rigid-circle.csv")
                .into_iter()
                .filter(|r| r["L"] == "1" && r["R"] == "1")
                .collect();
            error(&run, &rows, "P", "u_x", "u_ext")
        })
        .collect();
    println!("{errors:?}");
    assert!(
        errors[0] < 4e-4 && errors[1] < 2e-4 && errors[2] < 4e-5,
        "{errors:?}"
    );
}
