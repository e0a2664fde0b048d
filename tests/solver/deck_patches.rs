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
    // The groups of nodes have sides whose nodes are those of the other.
    let by_nodes = shared.replace("SURFACE TO SURFACE", "NODE TO SURFACE");
    Scene::from_text("job.inp", &by_nodes, &[]).unwrap_or_else(|error| panic!("{error}"));
    let fixed: String = (1..=10).map(|node| format!("{node}, 1, 2\n")).collect();
    let fixed = whole.replace("*STEP", &format!("{fixed}101, 1, 2\n*STEP"));
    let by_nodes = fixed.replace("SURFACE TO SURFACE", "NODE TO SURFACE");
    Scene::from_text("job.inp", &by_nodes, &[]).unwrap_or_else(|error| panic!("{error}"));
    let scene = Scene::from_text("job.inp", &fixed, &[]).unwrap_or_else(|error| panic!("{error}"));
    let areas = scene.model.contacts.iter().filter_map(|point| point.area);
    assert!((areas.sum::<f64>() - WIDTH).abs() < 1e-12);
}

/// Blocks of one row of elements, with the first element's label, the left end, the height and the number of elements of each.
fn blocks(rows: &[(usize, f64, f64, f64, usize)]) -> String {
    let mut text = "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.\n".to_owned();
    for &(first, left, low, width, count) in rows {
        text.push_str("*NODE\n");
        for j in 0..2 {
            for i in 0..=count {
                let x = left + width * i as f64 / count as f64;
                let label = first + j * (count + 1) + i;
                writeln!(text, "{label}, {x:?}, {:?}", low + j as f64).unwrap();
            }
        }
        writeln!(text, "*ELEMENT, TYPE=CPE4, ELSET=E{first}").unwrap();
        for k in first..first + count {
            let up = k + count + 1;
            writeln!(text, "{k}, {k}, {}, {}, {up}", k + 1, up + 1).unwrap();
        }
        writeln!(text, "*SOLID SECTION, ELSET=E{first}, MATERIAL=M\n1.").unwrap();
    }
    text
}

/// The deck with this law of these pairs, supports and step.
fn contact(
    text: &str,
    surfaces: &str,
    law: &str,
    pairs: &str,
    supports: &str,
    step: &str,
) -> String {
    format!(
        "{text}*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE={law}\n1000., 1e-9\n{surfaces}\
         *CONTACT PAIR, INTERACTION=I, {pairs}*BOUNDARY\n{supports}*STEP\n*STATIC\n1., 1.\n{step}*END STEP\n"
    )
}

/// Areas of the slave nodes by name, and displacements along y of these nodes at the end.
fn solved(text: &str, nodes: &[&str]) -> (Vec<(String, f64)>, Vec<f64>) {
    let scene = Scene::from_text("job.inp", text, &[]).unwrap_or_else(|error| panic!("{error}"));
    let nodes: Vec<usize> = nodes.iter().map(|name| scene.node(name).unwrap()).collect();
    let model = Arc::new(scene.model);
    let areas = model.contacts.iter().map(|point| {
        let name = model.nodes[point.node].name.clone();
        (name, point.area.unwrap())
    });
    let areas = areas.collect();
    let mut stepper = Stepper::new(model.clone());
    while stepper.step().is_some() {
        let status = &stepper.state().status;
        assert!(!matches!(status, Status::Failed(_)), "{status:?}");
    }
    let u = &stepper.state().u;
    let down = nodes.iter().map(|&node| u[model.dofs.first[node] + 1]);
    (areas, down.collect())
}

fn near(found: &[f64], expected: &[f64], off: f64) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() < off, "{found:?} is not {expected:?}");
    }
}

const BY_NODE: &str = "TYPE=NODE TO SURFACE\n";
const BY_FACE: &str = "TYPE=SURFACE TO SURFACE\n";

/// A cube between two blocks touches both with one surface of two sides: three springs of 1000 in series are shortened by 0.03
/// together, or lengthened where they are tied.
#[test]
fn sides_that_are_not_on_the_surface_have_no_contact() {
    let text = blocks(&[
        (1, 0.0, 0.0, 1.0, 1),
        (11, -1.0, -1.0, 3.0, 1),
        (21, -1.0, 1.0, 3.0, 1),
    ]);
    let surfaces = "*SURFACE, NAME=SL\nE1, S1\nE1, S3\n*SURFACE, NAME=MA\nE11, S3\nE21, S1\n";
    let supports = "11, 1, 2\n12, 1, 2\n13, 1, 2\n14, 1, 2\n1, 1\n2, 1\n3, 1\n4, 1\n\
                    21, 1\n22, 1\n23, 1\n24, 1\n";
    for (law, pairs, sign) in [
        ("LINEAR", BY_NODE, -1.0),
        ("LINEAR", BY_FACE, -1.0),
        ("TIED", BY_FACE, 1.0),
    ] {
        let moved: String = (21..25)
            .map(|node| format!("{node}, 2, 2, {}\n", sign * 0.03))
            .collect();
        let step = format!("*BOUNDARY\n{moved}");
        let deck = contact(
            &text,
            surfaces,
            law,
            &format!("{pairs}SL, MA\n"),
            supports,
            &step,
        );
        let (areas, down) = solved(&deck, &["n.1", "n.2", "n.3", "n.4"]);
        let whole: f64 = areas.iter().map(|(_, area)| area).sum();
        assert!((whole - 2.0).abs() < 1e-12, "{law} {pairs}: {areas:?}");
        near(&down, &[0.01, 0.01, 0.02, 0.02].map(|u| sign * u), 1e-9);
    }
}

/// Fixed node 1 over a fixed master is no slave node, and its neighbour keeps the whole area of both of its sides.
#[test]
fn a_fixed_slave_node_leaves_the_areas_of_others() {
    let text = blocks(&[(1, 0.0, 0.0, 3.0, 3), (11, -1.0, -1.0, 5.0, 1)]);
    let surfaces = "*SURFACE, NAME=SL\nE1, S1\n*SURFACE, NAME=MA\nE11, S3\n";
    let supports = "1, 1, 2\n5, 1, 2\n11, 1, 2\n12, 1, 2\n13, 1, 2\n14, 1, 2\n";
    let pairs = format!("{BY_NODE}SL, MA\n");
    let step = "*DLOAD\nE1, P3, 10.\n";
    let deck = contact(&text, surfaces, "LINEAR", &pairs, supports, step);
    let (areas, down) = solved(&deck, &["n.2", "n.3", "n.4"]);
    let areas: Vec<f64> = areas.into_iter().map(|(_, area)| area).collect();
    near(&areas, &[1.0, 1.0, 0.5], 1e-12);
    // CalculiX; with half of the area of node 2, it goes down by 9.09e-3.
    near(&down, &[-6.147467e-3, -9.966733e-3, -1.079754e-2], 2e-5);
}

/// Two pairs whose slave surfaces have a common node: each side of length 1 belongs to its nodes once.
#[test]
fn a_slave_node_of_two_pairs_has_the_area_of_its_sides() {
    let one = [(1, 0.0, 0.0, 2.0, 2), (11, -1.0, -1.0, 4.0, 1)];
    let two = [one[0], (11, -1.0, -1.0, 2.0, 1), (21, 1.0, -1.0, 2.0, 1)];
    let slaves = "*SURFACE, NAME=SA\n1, S1\n*SURFACE, NAME=SB\n2, S1\n*SURFACE, NAME=MA\nE11, S3\n";
    let along: String = (1..7).map(|node| format!("{node}, 1\n")).collect();
    let deck = |rows: &[_], master: &str, labels: &[usize]| {
        let fixed: String = labels
            .iter()
            .map(|node| format!("{node}, 1, 2\n"))
            .collect();
        let pairs = format!("{BY_NODE}SA, MA\nSB, {master}\n");
        let other = if master == "MB" {
            "*SURFACE, NAME=MB\nE21, S3\n"
        } else {
            ""
        };
        let (surfaces, supports) = (format!("{slaves}{other}"), format!("{fixed}{along}"));
        let step = "*DLOAD\nE1, P3, 10.\n";
        contact(&blocks(rows), &surfaces, "LINEAR", &pairs, &supports, step)
    };
    let areas = |text: &str| {
        let scene =
            Scene::from_text("job.inp", text, &[]).unwrap_or_else(|error| panic!("{error}"));
        let contacts = scene.model.contacts.iter();
        let mut areas: Vec<(usize, f64)> = contacts
            .map(|contact| (contact.node, contact.area.unwrap()))
            .collect();
        areas.sort_by_key(|area| area.0);
        let areas: Vec<f64> = areas.into_iter().map(|area| area.1).collect();
        near(&areas, &[0.5, 1.0, 0.5], 1e-12);
    };
    for text in [
        deck(&two, "MB", &[11, 12, 13, 14, 21, 22, 23, 24]),
        deck(&one, "MA", &[11, 12, 13, 14]),
    ] {
        areas(&text);
        near(&solved(&text, &["n.1", "n.2", "n.3"]).1, &[-0.01; 3], 1e-9);
    }
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
