//! Beams alone, against closed forms: no surface, no slave node.

use crate::common::{Run, finished, order, read};
use std::f64::consts::PI;
use stickslip::scene::Scene;

/// A clamped beam of length 1 with EI = 1 along +x, or along an arc, loaded at its end.
fn cantilever(shape: &str, material: &str, loads: &str, increment: f64) -> Run {
    let text = format!(
        "(title: \"t\", nodes: [{shape}], materials: [Section(id: \"m\", {material})],
          bodies: [Beam(id: \"b\", along: \"b\", material: \"m\")],
          supports: [(node: \"b.start\", fix: [x, y, rotation])], loads: [{loads}],
          history: (path: [0.0, 1.0], increment: {increment}),
          monitors: [(name: \"x\", of: Displacement(node: \"b.end\", component: x)),
                     (name: \"y\", of: Displacement(node: \"b.end\", component: y)),
                     (name: \"r\", of: Displacement(node: \"b.end\", component: rotation)),
                     (name: \"m\", of: Reaction(node: \"b.start\", component: rotation))])"
    );
    finished(&read(&text))
}

fn line(elements: usize, m: usize) -> String {
    format!(
        "Line(id: \"b\", from: (0.0, 0.0), to: (1.0, 0.0), elements: {elements}, per_element: {m})"
    )
}

fn end(run: &Run, monitor: &str) -> f64 {
    run.accepted.last().unwrap().monitors[monitor]
}

#[test]
fn an_end_moment_rolls_a_straight_beam_into_a_full_circle() {
    for m in 2..=9 {
        for material in ["EA: 1e4, EI: 1.0", "EA: 1e4, EI: 1.0, GA: 5e3"] {
            let elements = 24 / (m - 1);
            let load = format!("Moment(node: \"b.end\", value: {})", 2.0 * PI);
            let run = cantilever(&line(elements, m), material, &load, 0.1);
            // Constant curvature turns every element alike, so that the nodes close exactly, whatever the elements' order.
            assert!((end(&run, "r") - 2.0 * PI).abs() < 1e-8, "m {m}");
            assert!(
                (end(&run, "x") + 1.0).abs() < 1e-12 && end(&run, "y").abs() < 1e-12,
                "m {m}"
            );
            assert!((end(&run, "m") + 2.0 * PI).abs() < 1e-8);
        }
    }
}

#[test]
fn a_slender_beam_does_not_lock_and_a_shear_rigid_one_is_its_limit() {
    // Transverse tip load of one thousandth: u = P L^3 / 3 EI + P L / GA to first order.
    let load = "Force(node: \"b.end\", y: 0.001)";
    for m in 2..=9 {
        let bending = 0.001 / 3.0;
        let rigid = cantilever(&line(8, m), "EA: 1e8, EI: 1.0", load, 1.0);
        let nearly = cantilever(&line(8, m), "EA: 1e8, EI: 1.0, GA: 1e8", load, 1.0);
        let soft = cantilever(&line(8, m), "EA: 1e8, EI: 1.0, GA: 10.0", load, 1.0);
        // Two-node elements with one Gauss point err by h^2/4 of the bending part; the others are exact.
        let limit = if m == 2 { 0.005 } else { 1e-6 };
        assert!(
            (end(&rigid, "y") / bending - 1.0).abs() < limit,
            "m {m}: {}",
            end(&rigid, "y")
        );
        assert!(
            (end(&nearly, "y") / end(&rigid, "y") - 1.0).abs() < 1e-6,
            "m {m}"
        );
        let shear = 0.001 / 10.0;
        assert!(
            (end(&soft, "y") - end(&rigid, "y") - shear).abs() < 1e-8,
            "m {m}"
        );
    }
}

#[test]
fn a_curved_reference_shape_straightens_under_the_moment_that_its_curvature_asks_for() {
    // A quarter circle of radius 2/pi has length 1; the moment EI kappa straightens it.
    let radius = 2.0 / PI;
    let off = |elements: usize, m: usize| {
        let shape = format!(
            "Arc(id: \"b\", center: (0.0, {radius}), radius: {radius}, from: -90.0, to: 0.0, elements: {elements}, per_element: {m})"
        );
        let load = format!("Moment(node: \"b.end\", value: {})", -1.0 / radius);
        let run = cantilever(&shape, "EA: 1e4, EI: 1.0", &load, 0.25);
        let (x, y) = (radius + end(&run, "x"), radius + end(&run, "y"));
        (x - 1.0).hypot(y)
    };
    // The reference shape is a polynomial through points of the arc: of order p + 1 for elements of degree p, at least.
    for m in 2..=6 {
        let (coarse, fine) = (off(4, m), off(8, m));
        let rate = order(coarse, fine, 2.0);
        assert!(
            rate > m as f64 - 0.2,
            "m {m}: order {rate}, {coarse:e} {fine:e}"
        );
        assert!(fine < 1e-2);
    }
    for m in 7..=9 {
        assert!(off(4, m) < 1e-9, "m {m}");
    }
}

#[test]
fn a_prescribed_end_displacement_gives_the_force_that_gives_the_displacement() {
    let shape = line(2, 5);
    let material = "EA: 1e3, EI: 1.0, GA: 500.0";
    let pushed = cantilever(&shape, material, "Force(node: \"b.end\", y: 2.5)", 0.2);
    let (x, y) = (end(&pushed, "x"), end(&pushed, "y"));
    let moved = cantilever(
        &shape,
        material,
        &format!(
            "Displacement(node: \"b.end\", component: y, value: {y}), Displacement(node: \"b.end\", component: x, value: {x})"
        ),
        0.2,
    );
    assert!((end(&moved, "r") - end(&pushed, "r")).abs() < 1e-7);
    assert!((end(&moved, "m") - end(&pushed, "m")).abs() < 1e-6);
}

#[test]
fn newton_is_quadratic_at_the_end() {
    use stickslip::step::event::Outcome;
    use stickslip::step::stepper::Stepper;
    let text = "(title: \"t\", nodes: [Line(id: \"b\", from: (0.0, 0.0), to: (1.0, 0.0), elements: 4, per_element: 3)],
        materials: [Section(id: \"m\", EA: 1e3, EI: 1.0)], bodies: [Beam(id: \"b\", along: \"b\", material: \"m\")],
        supports: [(node: \"b.start\", fix: [x, y, rotation])], loads: [Force(node: \"b.end\", y: 1.0)],
        history: (path: [0.0, 1.0], increment: 1.0))";
    let scene = Scene::from_text("test.ron", text, &[]).unwrap();
    let mut stepper = Stepper::new(std::sync::Arc::new(scene.model));
    let mut residuals = Vec::new();
    while let Some(event) = stepper.step() {
        match &event.outcome {
            Outcome::Major { after, .. } => residuals.push(after.relative),
            Outcome::Failed(failure) => panic!("{failure:?}"),
            _ => {}
        }
    }
    // The order from three residuals that fall; the last is still well above round-off.
    let [a, b, c] = *residuals.last_chunk().unwrap();
    let order = (c / b).ln() / (b / a).ln();
    println!("{residuals:?}: order {order}");
    assert!(a < 0.1 && c > 1e-13, "{residuals:?}");
    assert!((1.8..2.5).contains(&order), "{residuals:?}: order {order}");
}
