//! Patch tests: two blocks whose meshes do not match, under constant pressure or tension across SURFACE TO SURFACE contact.
//!
//! ```text
//!    p p p p p p p
//!   ┌────┬────┬───┐  upper block, 3 elements, its face is the slave
//!   ├──┬──┴┬──┴┬──┤
//!   └──┴───┴───┴──┘  lower block, 4 elements
//!    △ △   △   △ △
//! ```

use std::fmt::Write;
use std::sync::Arc;
use stickslip::scene::Scene;
use stickslip::step::state::Status;
use stickslip::step::stepper::Stepper;

const E: f64 = 1000.0;
const NU: f64 = 0.3;
const K: f64 = 5000.0;
const WIDTH: f64 = 4.0;

/// Nodes and elements of a row of `count` elements between two heights, numbered from `first`; the nodes of its lower side.
fn row(kind: &str, count: usize, heights: [f64; 2], first: usize, text: &mut String) -> Vec<usize> {
    let step = if kind == "CPE8" { 2 } else { 1 };
    let (wide, high) = (count * step, step);
    let label = |i: usize, j: usize| first + j * (wide + 1) + i;
    text.push_str("*NODE\n");
    for j in 0..=high {
        // The middle of an element of 8 nodes has none.
        for i in (0..=wide).filter(|i| step == 1 || i % 2 == 0 || j % 2 == 0) {
            let x = WIDTH * i as f64 / wide as f64;
            let y = heights[0] + (heights[1] - heights[0]) * j as f64 / high as f64;
            writeln!(text, "{}, {x:?}, {y:?}", label(i, j)).unwrap();
        }
    }
    writeln!(text, "*ELEMENT, TYPE={kind}, ELSET=E{first}").unwrap();
    for k in 0..count {
        let (a, b) = (k * step, (k + 1) * step);
        let mut nodes = vec![label(a, 0), label(b, 0), label(b, high), label(a, high)];
        if step == 2 {
            nodes.extend([label(a + 1, 0), label(b, 1), label(a + 1, 2), label(a, 1)]);
        }
        let nodes: Vec<String> = nodes.iter().map(usize::to_string).collect();
        writeln!(text, "{}, {}", first + k, nodes.join(", ")).unwrap();
    }
    writeln!(text, "*SOLID SECTION, ELSET=E{first}, MATERIAL=M\n1.").unwrap();
    (0..=wide).map(|i| label(i, 0)).collect()
}

/// The deck with this pair, under this pressure on the upper block.
fn deck(kind: &str, pair: &str, law: &str, pressure: f64) -> String {
    let mut text = format!("*MATERIAL, NAME=M\n*ELASTIC\n{E}, {NU}\n");
    let bottom = row(kind, 4, [0.0, 1.0], 1, &mut text);
    row(kind, 3, [1.0, 2.0], 101, &mut text);
    text.push_str("*SURFACE, NAME=UPPER\nE101, S1\n*SURFACE, NAME=LOWER\nE1, S3\n");
    writeln!(
        text,
        "*CONTACT PAIR, INTERACTION=I, TYPE={pair}\nUPPER, LOWER"
    )
    .unwrap();
    writeln!(
        text,
        "*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE={law}\n{K}"
    )
    .unwrap();
    text.push_str("*BOUNDARY\n");
    bottom
        .iter()
        .for_each(|node| writeln!(text, "{node}, 2, 2").unwrap());
    writeln!(
        text,
        "1, 1, 1\n101, 1, 1\n*STEP\n*STATIC\n1., 1.\n*DLOAD\nE101, P3, {pressure}\n*END STEP"
    )
    .unwrap();
    text
}

/// Largest difference from the exact displacements, relative to the jump between the blocks; infinite if the run fails.
fn error(text: &str, pressure: f64) -> f64 {
    let scene = Scene::from_text("job.inp", text, &[]).unwrap_or_else(|error| panic!("{error}"));
    let model = Arc::new(scene.model);
    let mut stepper = Stepper::new(model.clone());
    while stepper.step().is_some() {
        if matches!(stepper.state().status, Status::Failed(_)) {
            return f64::INFINITY;
        }
    }
    let (across, along) = (
        -pressure * (1.0 - NU * NU) / E,
        pressure * NU * (1.0 + NU) / E,
    );
    let bodies = model.bodies.iter().flat_map(|body| &body.nodes);
    let worst = bodies.map(|&node| {
        let ([x, y], u) = (
            model.nodes[node].at,
            &stepper.state().u[model.dofs.first[node]..],
        );
        let upper = model.bodies[1].nodes.contains(&node);
        let jump = if upper { -pressure / K } else { 0.0 };
        (u[0] - along * x)
            .abs()
            .max((u[1] - across * y - jump).abs())
    });
    worst.fold(0.0, f64::max) / (pressure / K).abs()
}

#[test]
fn constant_pressure_passes_between_meshes_that_do_not_match() {
    for kind in ["CPE4", "CPE8"] {
        let faces = deck(kind, "SURFACE TO SURFACE", "LINEAR", 100.0);
        let off = error(&faces, 100.0);
        assert!(off < 1e-10, "{kind}: {off}");
        let nodes = error(&deck(kind, "NODE TO SURFACE", "LINEAR", 100.0), 100.0);
        assert!(nodes > 1e-2, "{kind}: {nodes}");
    }
}

#[test]
fn constant_pressure_and_tension_pass_through_a_tied_pair() {
    for kind in ["CPE4", "CPE8"] {
        for pressure in [100.0, -100.0] {
            let off = error(
                &deck(kind, "SURFACE TO SURFACE", "TIED", pressure),
                pressure,
            );
            assert!(off < 1e-10, "{kind} {pressure}: {off}");
        }
    }
}

/// Pairs that share a node of their slave surfaces, and a fixed slave node over a fixed master, keep all sides.
#[test]
fn sides_with_shared_or_fixed_nodes_are_integrated() {
    let whole = deck("CPE4", "SURFACE TO SURFACE", "LINEAR", 100.0);
    let two = "*SURFACE, NAME=LEFT\n101, S1\n102, S1\n*SURFACE, NAME=RIGHT\n103, S1\n";
    let shared = whole.replace("*SURFACE, NAME=UPPER\nE101, S1\n", two);
    let shared = shared.replace("UPPER, LOWER", "LEFT, LOWER\nRIGHT, LOWER");
    assert!(error(&shared, 100.0) < 1e-10);
    let fixed: String = (1..=10).map(|node| format!("{node}, 1, 2\n")).collect();
    let fixed = whole.replace("*STEP", &format!("{fixed}101, 1, 2\n*STEP"));
    let scene = Scene::from_text("job.inp", &fixed, &[]).unwrap_or_else(|error| panic!("{error}"));
    let areas = scene.model.contacts.iter().filter_map(|point| point.area);
    assert!((areas.sum::<f64>() - WIDTH).abs() < 1e-12);
}

#[test]
fn hard_contact_of_faces_is_solved_at_nodes_with_a_warning() {
    let text =
        deck("CPE4", "SURFACE TO SURFACE", "HARD", 1.0).replace(&format!("HARD\n{K}"), "HARD");
    let scene = Scene::from_text("job.inp", &text, &[]).unwrap();
    let warned =
        |remark: &String| remark.contains("SURFACE TO SURFACE is solved as node to surface");
    assert!(scene.remarks.iter().any(warned), "{:?}", scene.remarks);
    assert!(
        scene
            .model
            .contacts
            .iter()
            .all(|contact| contact.weights.is_empty())
    );
}
