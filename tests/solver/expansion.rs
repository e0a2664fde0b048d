//! Thermal expansion in decks: free of stress where it is free, and the closed forms where it is not.

use crate::common::{finished, read};
use std::sync::Arc;
use stickslip::fem::recovery::{Configuration, nodal_stresses};
use stickslip::scene::Scene;
use stickslip::step::state::Status;
use stickslip::step::stepper::Stepper;

const E: f64 = 1000.0;
const NU: f64 = 0.3;
/// Coefficient of expansion; the block is heated from 20 to 120.
const ALPHA: f64 = 1e-4;
const STRAIN: f64 = 100.0 * ALPHA;

/// A distorted mesh of 4 elements in a rectangle from x = 1 to 3 and y = 0 to 2, with these supports and steps.
fn deck(kind: &str, supports: &str, nlgeom: bool, temperature: &str) -> String {
    let nlgeom = if nlgeom { ", NLGEOM" } else { "" };
    format!(
        "*NODE, NSET=ALL\n1, 1., 0.\n2, 2., 0.\n3, 3., 0.\n4, 1., 1.\n5, 2.2, 0.9\n6, 3., 1.\n7, 1., 2.\n8, 2., 2.\n9, 3., 2.\n\
         *ELEMENT, TYPE={kind}, ELSET=BLOCK\n1, 1, 2, 5, 4\n2, 2, 3, 6, 5\n3, 4, 5, 8, 7\n4, 5, 6, 9, 8\n\
         *NSET, NSET=BOTTOM\n1, 2, 3\n*NSET, NSET=TOP\n7, 8, 9\n*NSET, NSET=LEFT\n1, 4, 7\n*NSET, NSET=RIGHT\n3, 6, 9\n\
         *MATERIAL, NAME=M\n*ELASTIC\n{E}, {NU}\n*EXPANSION\n{ALPHA}\n*SOLID SECTION, ELSET=BLOCK, MATERIAL=M\n\
         *INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 20.\n*BOUNDARY\n{supports}\n*STEP{nlgeom}\n*STATIC\n0.5, 1.\n{temperature}\n*END STEP"
    )
}

/// Largest difference from these displacements and from these stresses (σ11, σ22, σ33), the latter relative to E.
fn errors(text: &str, moved: impl Fn([f64; 2]) -> [f64; 2], stress: [f64; 3]) -> [f64; 2] {
    let scene = Scene::from_text("job.inp", text, &[]).unwrap_or_else(|error| panic!("{error}"));
    let model = Arc::new(scene.model);
    let mut stepper = Stepper::new(model.clone());
    while stepper.step().is_some() {
        let status = &stepper.state().status;
        assert!(!matches!(status, Status::Failed(_)), "{status:?}");
    }
    let state = stepper.state();
    let at = Configuration {
        u: &state.u,
        before: &state.start.u,
        history: &state.start.history,
        load_factor: state.load_factor,
    };
    let mut worst = [0.0_f64; 2];
    for (node, found) in model.nodes.iter().zip(&nodal_stresses(&model, at)[0]) {
        let place = model.nodes.iter().position(|other| other == node).unwrap();
        let u = &state.u[model.dofs.first[place]..];
        let expected = moved(node.at);
        for k in 0..2 {
            worst[0] = worst[0].max((u[k] - expected[k]).abs());
        }
        let found = found.unwrap();
        for k in 0..3 {
            worst[1] = worst[1].max((found[k] - stress[k]).abs() / E);
        }
    }
    worst
}

/// The strain of a free body, as Green's with NLGEOM.
fn green(nlgeom: bool) -> f64 {
    STRAIN + if nlgeom { 0.5 * STRAIN * STRAIN } else { 0.0 }
}

const HEATED: &str = "*TEMPERATURE\nALL, 120.";

#[test]
fn free_expansion_causes_no_stress() {
    let supports = "LEFT, 1\nBOTTOM, 2";
    for nlgeom in [false, true] {
        let moved = |[x, y]: [f64; 2]| [STRAIN * (x - 1.0), STRAIN * y];
        let found = errors(&deck("CPS4", supports, nlgeom, HEATED), moved, [0.0; 3]);
        assert!(found.into_iter().all(|error| error < 1e-12), "{found:?}");
        let ring = |[x, y]: [f64; 2]| [STRAIN * x, STRAIN * y];
        let found = errors(&deck("CAX4", "BOTTOM, 2", nlgeom, HEATED), ring, [0.0; 3]);
        assert!(found.into_iter().all(|error| error < 1e-12), "{found:?}");
        // A long body is held along its length.
        let green = green(nlgeom);
        let long = match nlgeom {
            true => (1.0 + 2.0 * (1.0 + NU) * green).sqrt() - 1.0,
            false => (1.0 + NU) * green,
        };
        let moved = |[x, y]: [f64; 2]| [long * (x - 1.0), long * y];
        let across = -E * green / if nlgeom { (1.0 + long).powi(2) } else { 1.0 };
        let stress = [0.0, 0.0, across];
        let found = errors(&deck("CPE4", supports, nlgeom, HEATED), moved, stress);
        assert!(found.into_iter().all(|error| error < 1e-12), "{found:?}");
    }
}

/// Also between the points of an amplitude, beyond them, and where two expansions act.
#[test]
fn a_free_body_is_longer_by_the_sum_of_its_strains_at_every_load() {
    let text = "(title: \"t\", nodes: [Block(id: \"a\", corners: [(0, 0), (1, 1)], elements: (1, 1), element: quad4)],
        materials: [Elastic(id: \"m\", E: 100, nu: 0.3, law: svk, plane: stress)], bodies: [Solid(id: \"a\", mesh: \"a\", material: \"m\")],
        supports: [(node: \"a.left\", fix: [x]), (node: \"a.bottom\", fix: [y])],
        loads: [Expansion(on: \"a\", strain: 0.05, scale: [(0, 0), (1, -1), (2, 2)]), Expansion(on: \"a\", strain: 0.1)],
        history: (path: [0, 2, -0.5], increment: 0.25),
        monitors: [(name: \"x\", of: Displacement(node: \"a.right.1\", component: x))])";
    let run = finished(&read(text));
    assert_eq!(run.accepted.len(), 18);
    for accepted in &run.accepted {
        let load = accepted.load;
        let first = if load < 1.0 {
            -load.max(0.0)
        } else {
            3.0 * load - 4.0
        };
        let strain = 0.05 * first + 0.1 * load;
        assert!((accepted.monitors["x"] - strain).abs() < 1e-10, "{load}");
    }
}

#[test]
fn a_restrained_block_is_under_the_pressure_of_its_closed_form() {
    let supports = "ALL, 1, 2";
    for nlgeom in [false, true] {
        let green = green(nlgeom);
        let full = -E * green / (1.0 - 2.0 * NU);
        for kind in ["CPE4", "CAX4"] {
            let found = errors(
                &deck(kind, supports, nlgeom, HEATED),
                |_| [0.0; 2],
                [full; 3],
            );
            assert!(
                found.into_iter().all(|error| error < 1e-12),
                "{kind} {found:?}"
            );
        }
        // A sheet becomes thicker, which makes its Cauchy stress smaller.
        let thicker = green * (1.0 + NU) / (1.0 - NU);
        let thin = -E * green / (1.0 - NU);
        let thin = thin
            / if nlgeom {
                (1.0 + 2.0 * thicker).sqrt()
            } else {
                1.0
            };
        let found = errors(
            &deck("CPS4", supports, nlgeom, HEATED),
            |_| [0.0; 2],
            [thin, thin, 0.0],
        );
        assert!(found.into_iter().all(|error| error < 1e-12), "{found:?}");
    }
}

#[test]
fn a_bar_between_walls_is_compressed_and_free_again_when_it_has_cooled() {
    let supports = "LEFT, 1\nRIGHT, 1\nBOTTOM, 2";
    let up = (1.0 + NU) * STRAIN;
    let heated = deck("CPS4", supports, false, HEATED);
    let found = errors(&heated, |[_, y]| [0.0, up * y], [-E * STRAIN, 0.0, 0.0]);
    assert!(found.into_iter().all(|error| error < 1e-12), "{found:?}");
    let cooled = format!("{heated}\n*STEP\n*STATIC\n0.5, 1.\n*TEMPERATURE\nALL, 20.\n*END STEP");
    let found = errors(&cooled, |_| [0.0; 2], [0.0; 3]);
    assert!(found.into_iter().all(|error| error < 1e-12), "{found:?}");
}

#[test]
fn temperatures_that_cannot_be_read_are_refused_with_their_line() {
    let why = |text: &str| {
        Scene::from_text("job.inp", text, &[])
            .unwrap_err()
            .to_string()
    };
    let supports = "ALL, 1, 2";
    let uneven = why(&deck("CPE4", supports, false, "*TEMPERATURE\nTOP, 120."));
    assert!(uneven.contains("it must be uniform in a body"), "{uneven}");
    let whole = deck("CPE4", supports, false, HEATED);
    let none = why(&whole.replace(&format!("*EXPANSION\n{ALPHA}\n"), ""));
    assert!(none.contains("material M has no *EXPANSION"), "{none}");
    let cold = why(&whole.replace("*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 20.\n", ""));
    assert!(cold.contains("node 1 has no *INITIAL CONDITIONS"), "{cold}");
}
