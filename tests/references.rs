//! The scenes against solutions that were found without any contact algorithm (`tests/references/`).

mod common;

use common::{number, run, scene, table};

/// Largest difference of monitors from a reference, over the largest reference displacement.
fn errors(
    name: &str,
    overrides: &[(&str, &str)],
    file: &str,
    keep: impl Fn(&std::collections::HashMap<String, String>) -> bool,
    columns: &[(&str, &str)],
    load: &str,
) -> Vec<(f64, Vec<f64>)> {
    let run = run(&scene(name, overrides));
    if let Some((e, f)) = &run.failure {
        println!("{name}: {:?} {f:?}", e.position);
    }
    println!(
        "{name}: {} accepted, {} steps",
        run.accepted.len(),
        run.steps
    );
    for a in &run.accepted {
        println!("  {} majors {} minors {}", a.load, a.majors, a.minors);
    }
    let mut out = Vec::new();
    for row in table(file).iter().filter(|r| keep(r)) {
        let Some(a) = run
            .accepted
            .iter()
            .find(|a| (a.load - number(row, load)).abs() < 1e-12)
        else {
            continue;
        };
        let diffs = columns
            .iter()
            .map(|(ours, theirs)| a.monitors[*ours] - number(row, theirs))
            .collect();
        out.push((a.load, diffs));
    }
    out
}

#[test]
fn explore() {
    for (n, case) in [
        ("02-two-cantilevers-smooth", "phi0"),
        ("02-two-cantilevers-rough", "stick"),
    ] {
        for refine in ["1", "2"] {
            let e = errors(
                n,
                &[("refine", refine)],
                "02-two-cantilevers.csv",
                |r| r["model"] == "TIM" && r["case"] == case,
                &[
                    ("u_x", "u_tip"),
                    ("u_y", "v_tip"),
                    ("rotation", "rot_tip"),
                    ("contact_x", "Rx"),
                    ("contact_y", "Ry"),
                ],
                "P",
            );
            for (l, d) in e {
                println!("{l} {d:?}");
            }
        }
    }
}
