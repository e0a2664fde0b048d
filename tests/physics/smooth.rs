//! Masters as smooth curves (`smooth: true`), beside the polygons and Lagrange curves that they are without.
//!
//! The curve itself is tested where it is made (`src/core/contact/smooth.rs`), the tangent beside
//! `src/core/contact/geometric_tangent.rs`, and accepted states by the judge from outside, which blends parabolas of its own
//! (`random_scenes.rs`).

use crate::common::{Run, run, scene, table};
use crate::hertz::hertz_errors;
use crate::references::{Row, error};

/// A scene run with its surface as it is, and smooth.
fn both(name: &str, surface: &str, set: &[(&str, &str)]) -> [Run; 2] {
    ["false", "true"].map(|smooth| {
        let path = format!("surfaces.{surface}.smooth");
        let mut set = set.to_vec();
        set.push((&path, smooth));
        run(&scene(name, &set))
    })
}

fn majors(run: &Run) -> u32 {
    assert!(run.failure.is_none(), "{:?}", run.failure);
    run.accepted.iter().map(|a| a.majors).sum()
}

#[test]
fn the_two_cantilevers_slide_as_well_on_a_smooth_column() {
    let rows: Vec<Row> = table("02-two-cantilevers.csv")
        .into_iter()
        .filter(|r| r["model"] == "TIM" && r["case"] == "phi0")
        .collect();
    // The curve does not follow the column's own line between its nodes, but for O(h³).
    for (refine, limit) in [("1", 4.1e-3), ("2", 2.2e-3), ("4", 9.5e-4), ("8", 5.5e-4)] {
        let runs = both("02-two-cantilevers-smooth", "face", &[("refine", refine)]);
        let found = runs.map(|run| (error(&run, &rows, "P", "u_x", "u_tip"), majors(&run)));
        println!("02 refine {refine}: {found:?}");
        let [(_, without), (wrong, with)] = found;
        assert!(wrong < limit, "refine {refine}: {wrong}");
        assert!(with <= without + 5, "refine {refine}: {found:?}");
    }
}

/// Elements of a column that shears meet in kinks, and a node that slides over them may hop to and fro. A smooth one has none.
#[test]
fn a_smooth_column_is_passed_with_every_increment() {
    for (refine, increment) in [("8", "0.02"), ("8", "0.01"), ("16", "0.05"), ("16", "0.01")] {
        let set = [
            ("refine", refine),
            ("history.increment", increment),
            ("surfaces.face.smooth", "true"),
        ];
        let run = run(&scene("02-two-cantilevers-smooth", &set));
        println!("02 refine {refine} by {increment}: {}", majors(&run));
        assert!(
            // Where the column gives way, some increments are halved to see whether they jump.
            run.accepted.len() < 260,
            "{} increments",
            run.accepted.len()
        );
    }
}

#[test]
fn a_circle_of_straight_lines_is_one_when_it_is_smooth() {
    let rows: Vec<Row> = table("04-rigid-circle.csv")
        .into_iter()
        .filter(|r| r["L"] == "1" && r["R"] == "1")
        .collect();
    let found = |elements: &str, per_element: &str| {
        let set = [
            ("nodes.circle.elements", elements),
            ("nodes.circle.per_element", per_element),
            ("history.increment", "0.25"),
            ("refine", "4"),
        ];
        let runs = both("04-cantilever-rigid-circle", "circle", &set);
        let found = runs.map(|run| (error(&run, &rows, "P", "u_x", "u_ext"), majors(&run)));
        println!("04 refine 4, circle of {elements} elements of {per_element}: {found:?}");
        found
    };
    let [(curved, _), (smooth, _)] = found("6", "5");
    assert!(curved < 4e-5 && smooth < 4e-5);
    // What is left is the beam's own error; that of the polygon is its circle's.
    for elements in ["24", "48"] {
        let [(polygon, before), (smooth, now)] = found(elements, "2");
        assert!(polygon > 5.0 * smooth && smooth < 4e-5 && now <= before);
    }
}

#[test]
fn hertz_is_met_by_a_cylinder_of_straight_lines_when_it_is_smooth() {
    let found = |elements: &str, per_element: &str| {
        let found = ["false", "true"].map(|smooth| {
            hertz_errors(&[
                ("nodes.cylinder.elements", elements),
                ("nodes.cylinder.per_element", per_element),
                ("surfaces.cylinder.smooth", smooth),
                ("refine", "2"),
            ])
        });
        println!("Hertz refine 2, cylinder of {elements} elements of {per_element}: {found:?}");
        found
    };
    let [(curved, _), (smooth, _)] = found("8", "5");
    assert!((curved[0] / smooth[0] - 1.0).abs() < 1e-3);
    for elements in ["8", "16"] {
        let [(polygon, _), (rounded, _)] = found(elements, "2");
        assert!(polygon[0] > 0.05 && polygon[1] > 5e-3, "{polygon:?}");
        assert!((curved[0] / rounded[0] - 1.0).abs() < 1e-2, "{rounded:?}");
    }
}
