//! How far solids are deformed: principal stretches and det F against closed forms and finite differences, the range of each
//! law against its force, and what becomes of states outside.

use crate::blocks::block;
use crate::common::{Run, finished, read, run, scene};
use stickslip::explain::page;
use stickslip::explain::remedies::{TrialEnd, attempt};
use stickslip::explain::remedy::Remedy;
use stickslip::fem::deformation::{Deformation, SOFTENING, by_element, deformation};
use stickslip::model::{BodyKind, ElementKind, Model};
use stickslip::scene::Scene;
use stickslip::scene::gaps;
use stickslip::step::event::{Failure, Outcome};

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests");

/// A unit block of elements of a kind.
fn unit(kind: &str, material: &str) -> Scene {
    let text = format!(
        "(title: \"t\", nodes: [Block(id: \"k\", corners: [(1, 0), (2, 1)], elements: (2, 2), element: {kind})],
          materials: [Elastic(id: \"m\", E: 10, nu: 0.3, {material})],
          bodies: [Solid(id: \"k\", mesh: \"k\", material: \"m\")],
          supports: [(node: \"k.bottom\", fix: [x, y])],
          loads: [Displacement(node: \"k.top.all\", component: y, value: -1)],
          history: (path: [0, 1], increment: 1))"
    );
    read(&text)
}

/// Displacements of all nodes by a map of places.
fn moved(model: &Model, map: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<f64> {
    let mut u = vec![0.0; model.dofs.len()];
    for (node, &first) in model.nodes.iter().zip(&model.dofs.first) {
        let to = map(node.at);
        (u[first], u[first + 1]) = (to[0] - node.at[0], to[1] - node.at[1]);
    }
    u
}

#[test]
fn a_homogeneous_deformation_has_the_stretches_that_it_was_made_of() {
    let turned = |angle: f64, [x, y]: [f64; 2]| {
        let (s, c) = angle.sin_cos();
        [c * x - s * y, s * x + c * y]
    };
    for kind in [
        "triangle3",
        "triangle6",
        "quad4",
        "quad8",
        "quad8r",
        "quad9",
    ] {
        let model = unit(kind, "").model;
        for [a, b] in [[0.4, 1.3], [0.05, 0.9], [-0.2, 1.1], [1.2, 1.5]] {
            let map = |at: [f64; 2]| {
                let [p, q] = turned(0.7, at);
                turned(-2.1, [a * p, b * q])
            };
            let found = deformation(&model, &moved(&model, map)).unwrap();
            assert!((found.smallest.stretch - a).abs() < 1e-13, "{kind} {a}");
            assert!(
                (found.flattest.determinant - a * b).abs() < 1e-13,
                "{kind} {a}"
            );
            assert_eq!(found.inverted().is_some(), a < 0.0);
            assert_eq!(found.outside.is_some(), a < SOFTENING);
        }
    }
}

#[test]
fn rings_and_thicknesses_are_stretched_too() {
    // From radius 1 to 2: u_x = -0.4 X presses rings to 0.6, and u_x = -0.4 presses the innermost to 0.6 and radii not at all.
    let round = unit("quad8", "plane: axisymmetric").model;
    let found = deformation(&round, &moved(&round, |[x, y]| [0.6 * x, y])).unwrap();
    assert!((found.smallest.stretch - 0.6).abs() < 1e-14);
    assert!((found.flattest.determinant - 0.36).abs() < 1e-14);
    let found = deformation(&round, &moved(&round, |[x, y]| [x - 0.4, y])).unwrap();
    assert!((found.flattest.determinant - 0.6).abs() < 1e-14);
    // Pulled to twice its size in both directions, E11 = E22 = 1.5 and C33 = 1 - 2 nu / (1 - nu) (E11 + E22) is negative.
    let sheet = unit("quad8", "plane: stress").model;
    let found = deformation(&sheet, &moved(&sheet, |[x, y]| [2.0 * x, 2.0 * y])).unwrap();
    assert!(found.inverted().is_some());
    let found = deformation(&sheet, &moved(&sheet, |[x, y]| [1.1 * x, y])).unwrap();
    let thickness = (1.0_f64 - 0.3 / 0.7 * 0.21).sqrt();
    assert!((found.flattest.determinant - 1.1 * thickness).abs() < 1e-14);
}

/// x, or X, at a point of a Quad8 by the shape functions of the serendipity family, written down for this test.
fn quad8(nodes: &[[f64; 2]], xi: f64, eta: f64) -> [f64; 2] {
    let corner = |a: f64, b: f64| (1.0 + a * xi) * (1.0 + b * eta) * (a * xi + b * eta - 1.0) / 4.0;
    let n = [
        corner(-1.0, -1.0),
        corner(1.0, -1.0),
        corner(1.0, 1.0),
        corner(-1.0, 1.0),
        (1.0 - xi * xi) * (1.0 - eta) / 2.0,
        (1.0 + xi) * (1.0 - eta * eta) / 2.0,
        (1.0 - xi * xi) * (1.0 + eta) / 2.0,
        (1.0 - xi) * (1.0 - eta * eta) / 2.0,
    ];
    [0, 1].map(|k| n.iter().zip(nodes).map(|(n, x)| n * x[k]).sum())
}

/// Smallest principal stretch and det F at a point, by central differences of both maps.
fn by_differences(from: &[[f64; 2]], to: &[[f64; 2]], [xi, eta]: [f64; 2]) -> [f64; 2] {
    let h = 1e-5;
    let slope = |nodes: &[[f64; 2]]| {
        let (a, b) = (quad8(nodes, xi + h, eta), quad8(nodes, xi - h, eta));
        let (c, d) = (quad8(nodes, xi, eta + h), quad8(nodes, xi, eta - h));
        nalgebra::Matrix2::new(a[0] - b[0], c[0] - d[0], a[1] - b[1], c[1] - d[1]) / (2.0 * h)
    };
    let f = slope(to) * slope(from).try_inverse().unwrap();
    let values = (f.transpose() * f).symmetric_eigenvalues();
    let least = values.min().max(0.0).sqrt();
    [least * f.determinant().signum(), f.determinant()]
}

/// The same of all solids of a state: at the 3 by 3 Gauss points, and det F also at the nodes.
fn extremes(model: &Model, u: &[f64]) -> [f64; 2] {
    let g = 0.6_f64.sqrt();
    let mut least = [f64::INFINITY; 2];
    for body in &model.bodies {
        let BodyKind::Solid(solid) = &body.kind else {
            continue;
        };
        for element in &solid.elements {
            assert_eq!(element.kind, ElementKind::Quad8);
            let from: Vec<[f64; 2]> = element.nodes.iter().map(|&n| model.nodes[n].at).collect();
            let to: Vec<[f64; 2]> = element.nodes.iter().map(|&n| model.place(u, n)).collect();
            for a in [-1.0, -g, 0.0, g, 1.0] {
                for b in [-1.0, -g, 0.0, g, 1.0] {
                    let [stretch, determinant] = by_differences(&from, &to, [a, b]);
                    let gauss = |x: f64| x.abs() < 1.0;
                    let node = (a.abs() == 1.0 || a == 0.0)
                        && (b.abs() == 1.0 || b == 0.0)
                        && (a, b) != (0.0, 0.0);
                    if gauss(a) && gauss(b) {
                        least[0] = least[0].min(stretch);
                    }
                    if node || gauss(a) && gauss(b) {
                        least[1] = least[1].min(determinant);
                    }
                }
            }
        }
    }
    least
}

/// Checks every accepted increment of a run against finite differences; returns the smallest stretch and det F.
fn checked(run: &Run) -> [f64; 2] {
    let model = run.stepper.model();
    let mut least = [f64::INFINITY; 2];
    for a in &run.accepted {
        let u = &a.state.start.u;
        let expected = extremes(model, u);
        let Deformation {
            smallest, flattest, ..
        } = deformation(model, u).unwrap();
        assert!(
            (smallest.stretch - expected[0]).abs() < 1e-8,
            "load {}",
            a.load
        );
        assert!(
            (flattest.determinant - expected[1]).abs() < 1e-8,
            "load {}",
            a.load
        );
        let all = by_element(model, u);
        let [stretch, _] = all[smallest.body][smallest.element];
        assert_eq!(stretch, smallest.stretch);
        least = [0, 1].map(|k| least[k].min(expected[k]));
    }
    least
}

/// A unit block pressed to the stretch 1 - u along y; the force at the end of each increment.
fn pressed(material: &str, sides: &str) -> Vec<(f64, f64)> {
    let run = finished(&block(
        "(0, 0), (1, 1)",
        "(1, 1)",
        material,
        &format!(
            "supports: [(node: \"k.bottom\", fix: [y]), {sides}],
             loads: [Displacement(node: \"k.top.all\", component: y, value: -0.5)],
             history: (path: [0, 1], increment: 0.02),
             monitors: [(name: \"a\", of: Reaction(node: \"k.top.1\", component: y)),
                        (name: \"b\", of: Reaction(node: \"k.top.2\", component: y)),
                        (name: \"c\", of: Reaction(node: \"k.top.3\", component: y))]"
        ),
    ));
    let force = |a: &crate::common::Accepted| ["a", "b", "c"].map(|m| a.monitors[m]).iter().sum();
    run.accepted
        .iter()
        .map(|a| (1.0 - 0.5 * a.load, force(a)))
        .collect()
}

#[test]
fn svk_softens_below_the_limit_of_its_range_and_neo_hookean_does_not() {
    let held = "(node: \"k.left\", fix: [x]), (node: \"k.right\", fix: [x])";
    let free = "(node: \"k.left\", fix: [x])";
    for (plane, sides) in [("strain", held), ("strain", free), ("stress", free)] {
        for nu in ["0.0", "0.3", "0.45"] {
            let forces = pressed(&format!("E: 10, nu: {nu}, plane: {plane}"), sides);
            for pair in forces.windows(2) {
                let ((above, before), (below, after)) = (pair[0], pair[1]);
                if below > SOFTENING {
                    assert!(
                        after < before,
                        "{plane} nu {nu}: at {below} more force is needed"
                    );
                } else if above < SOFTENING {
                    assert!(
                        after > before,
                        "{plane} nu {nu}: at {below} less force is needed"
                    );
                }
            }
            let neo = format!("E: 10, nu: {nu}, plane: {plane}, law: neohookean");
            let forces = pressed(&neo, sides);
            assert!(
                forces.windows(2).all(|pair| pair[1].1 < pair[0].1),
                "{plane} nu {nu}"
            );
        }
    }
}

#[test]
fn no_increment_with_an_inverted_element_is_accepted() {
    let collapses = scene(&format!("{FOLDER}/failures/minimal-collapse.ron"), &[]);
    let run = run(&collapses);
    let [_, determinant] = checked(&run);
    assert!(determinant > 0.0, "{determinant}");
    assert!(run.failure.is_some());
    let left = |a: &&crate::common::Accepted| {
        matches!(
            a.event.outcome,
            Outcome::Increment {
                left_range: Some(_),
                ..
            }
        )
    };
    let left: Vec<f64> = run.accepted.iter().filter(left).map(|a| a.load).collect();
    assert_eq!(
        left,
        [0.3],
        "said once, where the stretch falls below 0.577"
    );
}

#[test]
fn a_cantilever_that_crushes_a_block_of_svk_fails_by_its_law_and_with_neo_hookean_it_ends() {
    let rough = [("refine", "2"), ("friction.angle", "30")];
    let svk = run(&scene("05-cantilever-elastic-block", &rough));
    let (_, failure) = svk.failure.as_ref().unwrap();
    assert!(matches!(failure, Failure::Inverted(_)), "{failure:?}");
    assert!(checked(&svk)[1] > 0.0);
    let mut law = rough.to_vec();
    law.extend(["materials.lower.law", "materials.upper.law"].map(|path| (path, "neohookean")));
    let neo = run(&scene("05-cantilever-elastic-block", &law));
    assert!(neo.failure.is_none());
    assert!(checked(&neo)[1] > 0.0);
}

#[test]
fn a_wheel_that_crushes_its_soil_is_told_so_and_the_law_that_helps_was_tried() {
    let here = [("settings.search", "off")];
    let wheel = scene(&format!("{FOLDER}/findings/wheel.ron"), &here);
    let mut run = run(&wheel);
    assert!(run.failure.is_some());
    assert!(checked(&run)[1] > 0.0);
    let (state, failure) = (run.stepper.state().clone(), run.failure.unwrap().1);
    let facts = page::causes(&mut run.stepper, &state, &failure, &|| false);
    for part in [
        "of soil",
        "in the last equilibrium, element 241 of soil was compressed to 0.3819",
        "softens below 0.5774",
        "law: svk",
    ] {
        assert!(facts[0].contains(part), "{facts:#?}");
    }
    let (law, certain) = Remedy::law(run.stepper.model(), &state, &failure).unwrap();
    assert!(certain);
    assert_eq!(law.how.typed(), "--set materials.soil.law=neohookean");
    let spec = Some(&wheel.spec);
    let trial = attempt(&mut run.stepper, &state, spec, &law, &|| false).unwrap();
    assert_eq!(trial.end, TrialEnd::Converged);
}

#[test]
fn the_law_of_an_inverted_element_is_the_first_that_is_tried_and_helps() {
    let collapses = scene(&format!("{FOLDER}/failures/minimal-collapse.ron"), &[]);
    let mut run = run(&collapses);
    let state = run.stepper.state().clone();
    let spec = Some(&collapses.spec);
    let found = page::page(
        &mut run.stepper,
        &state,
        spec,
        Vec::new(),
        &|| false,
        &mut |_| {},
    )
    .unwrap();
    assert!(found.why[0].contains("element 14 of g"));
    let first = &found.tries[0];
    assert_eq!(first.typed, "--set materials.rubber.law=neohookean");
    assert!(first.end.starts_with("tried from the start"), "{first:?}");
}

#[test]
fn a_motion_that_must_press_svk_out_of_its_range_is_found_before_the_run() {
    let warned = |set: &[(&str, &str)]| {
        let scene = scene(&format!("{FOLDER}/failures/minimal-collapse.ron"), set);
        let told = gaps::warnings(&scene.model);
        told.iter()
            .any(|line| line.contains("to 0.300 of its length"))
    };
    assert!(warned(&[]));
    assert!(!warned(&[("materials.rubber.law", "neohookean")]));
    assert!(!warned(&[("materials.rubber.update", "updated")]));
    assert!(!warned(&[("loads[0].value", "-0.8")]));
    assert!(!warned(&[("loads[0].value", "1.4")]), "it moves away");
    // Points of faces are pressed as well.
    let file = format!("{FOLDER}/failures/minimal-collapse.ron");
    let text = std::fs::read_to_string(file).unwrap();
    let points = text.replace(
        "start: sliding",
        "start: sliding, law: Penalty(stiffness: 1e4), by: surface",
    );
    let model = Scene::from_text("points.ron", &points, &[]).unwrap().model;
    assert!(
        model
            .contacts
            .iter()
            .all(|contact| !contact.weights.is_empty())
    );
    let told = gaps::warnings(&model);
    assert!(
        told.iter()
            .any(|line| line.contains("to 0.300 of its length")),
        "{told:?}"
    );
    // The block itself, without any contact.
    let held = unit("quad8", "").model;
    assert!(
        gaps::warnings(&held)
            .iter()
            .any(|line| line.contains("to 0.000 of its length"))
    );
}

/// A bar that is pressed by an amplitude, along an arc: it may rise in proportion within the path, but not bend there.
#[test]
fn an_arc_follows_amplitudes_in_proportion_and_refuses_bends() {
    let text = |scale: &str, path: &str| {
        format!(
            "(title: \"t\", nodes: [Block(id: \"a\", corners: [(0, 0), (1, 1)], elements: (1, 1), element: quad4),
                Line(id: \"f\", from: (2, 0), to: (-2, 0), elements: 1, per_element: 2)],
              materials: [Elastic(id: \"m\", E: 100, nu: 0, update: small)], bodies: [Solid(id: \"a\", mesh: \"a\", material: \"m\")],
              surfaces: [(id: \"f\", along: \"f\", endless: true)], slaves: [(nodes: [\"a.bottom\"], on: [\"f\"], start: sliding)],
              supports: [(node: \"a.top\", fix: [x])],
              loads: [Displacement(node: \"a.top\", component: y, value: -0.01, scale: {scale})],
              history: (path: {path}, increment: 0.25, control: arc),
              monitors: [(name: \"y\", of: Contact(component: y))])"
        )
    };
    for (scale, path) in [
        ("[(0, 0), (2, 0.5)]", "[0, 2]"),
        ("[(0, 0), (1, 0.25), (2, 0.5), (5, 9)]", "[0, 1, 2, 0.5]"),
    ] {
        let scene = read(&text(scale, path));
        let accepted = finished(&scene).accepted;
        for state in &accepted {
            let force = state.monitors["y"];
            assert!((force - 0.25 * state.load).abs() < 1e-9, "{}", state.load);
        }
    }
    for (scale, path, at) in [
        (
            "[(0, 0), (1, 1), (2, 0.25)]",
            "[0, 1, 2]",
            "bends at the load factor 1",
        ),
        (
            "[(0.5, 0), (2, 1)]",
            "[0, 2]",
            "bends at the load factor 0.5",
        ),
        (
            "[(0, 0), (1.5, 1)]",
            "[0, 2]",
            "bends at the load factor 1.5",
        ),
    ] {
        let refused = Scene::from_text("t.ron", &text(scale, path), &[]).unwrap_err();
        let refused = refused.to_string();
        assert!(
            refused.contains("loads[0].scale") && refused.contains(at),
            "{refused}"
        );
    }
}

/// All nodes move as supports and contacts say, so that the first solution is in balance. Closed forms for nu = 0, by half the side:
/// E / 2 (1 / s - s) / 2 for the neo-Hookean law, and E s (1 - s^2) / 2 / 2 for St Venant-Kirchhoff's, with the stretch s.
#[test]
fn a_pressed_square_shows_the_contact_forces_of_its_stresses() {
    for (law, force) in [("neohookean", 11.25), ("svk", 7.2)] {
        let text = format!(
            "(title: \"t\", nodes: [Block(id: \"a\", corners: [(0, 0), (1, 1)], elements: (1, 1), element: quad4),
                Line(id: \"f\", from: (2, 0), to: (-2, 0), elements: 1, per_element: 2)],
              materials: [Elastic(id: \"m\", E: 100, nu: 0, law: {law})],
              bodies: [Solid(id: \"a\", mesh: \"a\", material: \"m\")],
              surfaces: [(id: \"f\", along: \"f\")],
              slaves: [(nodes: [\"a.bottom\"], on: [\"f\"], start: sliding)],
              supports: [(node: \"a.top\", fix: [x])],
              loads: [Displacement(node: \"a.top\", component: y, value: -0.2)],
              history: (path: [0, 1], increment: 1))"
        );
        let run = finished(&read(&text));
        for node in &run.stepper.event().nodes {
            assert!(
                (node.f_n / force - 1.0).abs() < 1e-12,
                "{law}: {}",
                node.f_n
            );
        }
    }
}
