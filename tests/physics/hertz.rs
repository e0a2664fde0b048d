//! A rigid cylinder on a block, against Hertz.

use crate::common::{finished, last, number, order, scene, table};

/// Half width and peak pressure of the contact of `hertz-cylinder-on-block`, and the force on the whole cylinder.
///
/// The middle node of a side carries two thirds of what presses on it. Half an ellipse of pressure is a line in p²
/// over x²; that of least squares gives both numbers without asking which node is the last that touches.
fn line_contact(set: &[(&str, &str)]) -> (f64, f64, f64, u32) {
    let run = finished(&scene("hertz-cylinder-on-block", set));
    let (state, model) = (run.stepper.state(), run.stepper.model());
    let at = |s: usize| model.nodes[model.contacts[s].node].at[0];
    let spacing = (at(1) - at(0)).abs();
    let points: Vec<(f64, f64)> = (0..model.contacts.len())
        .filter(|&s| state.nodes[s].f_n > 0.0)
        .filter(|&s| (at(s) / spacing).round() as usize % 2 == 1)
        .map(|s| (s, state.nodes[s].f_n / (4.0 / 3.0 * spacing)))
        .map(|(s, pressure)| (at(s).powi(2), pressure.powi(2)))
        .collect();
    let count = points.len() as f64;
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / count;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let slope = mean(&|p| (p.0 - x) * (p.1 - y)) / mean(&|p| (p.0 - x).powi(2));
    let top = y - slope * x;
    let force = -2.0 * last(&run, "contact_y");
    println!("{set:?}: {count} middles touch");
    let majors = run.accepted.iter().map(|a| a.majors).sum();
    ((-top / slope).sqrt(), top.sqrt(), force, majors)
}

/// Errors of half width and peak pressure, relative to Hertz's for the force that was found; and major iterations.
pub fn hertz_errors(set: &[(&str, &str)]) -> ([f64; 2], u32) {
    let (width, peak, force, majors) = line_contact(set);
    let (a, p0) = hertz(force);
    println!("force {force} width {width} {a} peak {peak} {p0}");
    ([(width / a - 1.0).abs(), (peak / p0 - 1.0).abs()], majors)
}

/// Half width and peak pressure: both go with the root of the force.
fn hertz(force: f64) -> (f64, f64) {
    let rows = table("07-hertz.csv");
    let row = rows.iter().rev().find(|r| r["R"] == "8").unwrap();
    let root = (force / number(row, "F")).sqrt();
    (number(row, "a") * root, number(row, "p0") * root)
}

#[test]
fn a_rigid_cylinder_presses_a_block_as_hertz_says_within_second_order_of_the_mesh() {
    let errors = ["1", "2", "4"].map(|refine| hertz_errors(&[("refine", refine)]).0);
    println!("{errors:?}");
    // The pressure of half an ellipse, seen by elements of side h: within (h / a)².
    let a = hertz(line_contact(&[("refine", "1")]).2).0;
    for (error, refine) in errors.iter().zip([1.0, 2.0, 4.0]) {
        let limit = (1.0 / 16.0 / refine / a).powi(2);
        assert!(error.iter().all(|e| *e < limit), "{limit}: {errors:?}");
    }
    // Where contact ends is known to a part of an element's side; the line through all pressures knows it better.
    let rate = order(errors[0][0], errors[2][0], 4.0);
    assert!((1.5..2.5).contains(&rate), "order {rate}: {errors:?}");
    // The peak comes as near as Hertz's theory is true of this block, and no nearer: a is no small part of its depth.
    assert!(
        errors[0][1] > errors[1][1] && errors[1][1] > errors[2][1],
        "{errors:?}"
    );
}
