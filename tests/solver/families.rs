//! Where the compliance is singular, states that differ in their forces alone are told as families; where it is indefinite
//! by rounding, that is told, and what comes of it.

use crate::census::drawn;
use crate::common::run;
use std::sync::Arc;
use stickslip::explain::indefinite::{IndefiniteOutcome, indefinite};
use stickslip::explain::page;
use stickslip::interface::census::census;
use stickslip::interface::definite::Compliance;
use stickslip::interface::family::{Family, families};
use stickslip::interface::problem::InterfaceProblem;
use stickslip::interface::uniqueness::{Inapplicable, Uniqueness, uniqueness};
use stickslip::scene::Scene;
use stickslip::step::stepper::Stepper;
use stickslip_exchange::problem::{Local, Matrix};
use stickslip_exchange::siconos::write;

/// A scene of this compliance, these motions without forces, and this friction at all contacts.
fn scene(w: &[&[f64]], q: &[f64], mu: f64, set: &[(&str, &str)]) -> Scene {
    let rows: Vec<Vec<f64>> = w.iter().map(|row| row.to_vec()).collect();
    let problem = Local {
        w: Matrix::from_rows(&rows),
        q: q.to_vec(),
        mu: vec![mu; q.len() / 2],
    };
    let set: Vec<(String, String)> = set
        .iter()
        .map(|(path, value)| ((*path).to_owned(), (*value).to_owned()))
        .collect();
    Scene::from_text("given.dat", &write(&problem), &set).unwrap()
}

fn frozen(scene: Scene) -> InterfaceProblem {
    Stepper::new(Arc::new(scene.model))
        .interface_problem()
        .unwrap()
}

fn of(problem: &InterfaceProblem) -> Vec<Family> {
    families(problem, &census(problem).unwrap())
}

fn assert_ranges(family: &Family, expected: &[[[f64; 2]; 2]]) {
    assert_eq!(family.ranges.len(), expected.len(), "{family:?}");
    for ((_, found), wanted) in family.ranges.iter().zip(expected) {
        let all = found.iter().flatten().zip(wanted.iter().flatten());
        for (found, wanted) in all {
            assert!(
                found == wanted || (found - wanted).abs() < 1e-7,
                "{family:?}"
            );
        }
    }
}

#[test]
fn two_rough_nodes_on_one_spring_share_its_force_as_friction_lets_them() {
    // r_n + r'_n = 1 and r_t + r'_t = -0.1, both within mu = 0.5: r_t is highest at r_n = 0.4, and lowest at 0.6.
    let one = [1.0, 0.0, 1.0, 0.0];
    let other = [0.0, 1.0, 0.0, 1.0];
    let w: [&[f64]; 4] = [&one, &other, &one, &other];
    let problem = frozen(scene(&w, &[-1.0, 0.1, -1.0, 0.1], 0.5, &[]));
    let found = of(&problem);
    let [family] = found.as_slice() else {
        panic!("{found:?}");
    };
    assert_eq!(family.dimension, 2);
    let semidefinite = Uniqueness::Not(Inapplicable::Semidefinite(2));
    assert_eq!(uniqueness(&problem), semidefinite);
    assert_ranges(family, &[[[0.0, 1.0], [-0.3, 0.2]]; 2]);
    assert!(family.states.len() > 1, "{family:?}");
}

#[test]
fn a_rigid_body_on_three_contacts_in_a_row_has_one_force_to_spare() {
    // Springs carry its sinking and its turning: W of the normals is 1 + x x' at x = -1, 0, 1.
    let x = [-1.0, 0.0, 1.0];
    let row = |i: usize| -> Vec<f64> {
        let of = |j: usize| {
            let (i_t, j_t) = (i % 2 == 1, j % 2 == 1);
            match (i_t, j_t) {
                (false, false) => 1.0 + x[i / 2] * x[j / 2],
                _ => f64::from(u8::from(i == j)),
            }
        };
        (0..6).map(of).collect()
    };
    let rows: Vec<Vec<f64>> = (0..6).map(row).collect();
    let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    let q = [-1.0, 0.0, -1.0, 0.0, -1.0, 0.0];
    let found = of(&frozen(scene(&rows, &q, 0.0, &[])));
    let [family] = found.as_slice() else {
        panic!("{found:?}");
    };
    assert_eq!(family.dimension, 1);
    let none = [0.0, 0.0];
    let (ends, middle) = ([[0.0, 0.5], none], [[0.0, 1.0], none]);
    assert_ranges(family, &[ends, middle, ends]);
}

#[test]
fn a_body_wedged_between_two_contacts_is_squeezed_as_much_as_one_likes() {
    let w: [&[f64]; 4] = [
        &[1.0, 0.0, -1.0, 0.0],
        &[0.0, 1.0, 0.0, 0.0],
        &[-1.0, 0.0, 1.0, 0.0],
        &[0.0, 0.0, 0.0, 1.0],
    ];
    let found = of(&frozen(scene(&w, &[-1.0, 0.0, 1.0, 0.0], 0.0, &[])));
    let [family] = found.as_slice() else {
        panic!("{found:?}");
    };
    assert_eq!((family.dimension, family.states.len()), (1, 1));
    let none = [0.0, 0.0];
    assert_ranges(
        family,
        &[[[1.0, f64::INFINITY], none], [[0.0, f64::INFINITY], none]],
    );
}

#[test]
fn a_definite_matrix_has_no_families() {
    let mut states = 0;
    for k in 0..200 {
        let problem = drawn(11, k, 1..=4);
        let all = census(&problem).unwrap();
        states += all.answers.len();
        assert_eq!(families(&problem, &all), [], "{k}");
    }
    assert!(states > 150);
}

/// The wedge, its off-diagonal rounded up by `by`: its eigenvalues are 2 + by and -by, and no state obeys.
fn rounded(by: f64, set: &[(&str, &str)]) -> Scene {
    let off = -1.0 - by;
    let w: [&[f64]; 4] = [
        &[1.0, 0.0, off, 0.0],
        &[0.0, 1.0, 0.0, 0.0],
        &[off, 0.0, 1.0, 0.0],
        &[0.0, 0.0, 0.0, 1.0],
    ];
    let set = [&[("history.least", "1")], set].concat();
    scene(&w, &[-1.0, 0.0, 1.0, 0.0], 0.0, &set)
}

#[test]
fn a_matrix_that_is_indefinite_by_rounding_is_solved_once_it_is_made_semidefinite_or_with_a_tolerance()
 {
    for by in [1e-3, 1e-6] {
        let problem = frozen(rounded(by, &[]));
        assert_eq!(census(&problem).unwrap().answers, []);
        let ends = Compliance::from_problem(&problem).unwrap().ends();
        assert!((ends[0] + by).abs() < 1e-9 && (ends[1] - 2.0 - by).abs() < 1e-9);
        let found = indefinite(&problem, &|| false).unwrap();
        let IndefiniteOutcome::Tried {
            semidefinite: Some(solved),
            tolerance,
        } = found.outcome
        else {
            panic!("{found:?}");
        };
        assert_eq!(solved.answer.letters(), "+F");
        assert!((solved.answer.nodes[0].f_n - 1.0 / (1.0 + by / 2.0)).abs() < 1e-9);
        let (_, margin) = solved.as_given.unwrap().worst().unwrap();
        assert!((margin.value + by).abs() < 1e-9, "{margin:?}");
        // What is said of the tolerance holds for the scene.
        let failed = run(&rounded(by, &[]));
        assert!(failed.failure.is_some(), "no state obeys");
        let mut stepper = failed.stepper;
        let state = stepper.state().clone();
        let page = page::page(
            &mut stepper,
            &state,
            None,
            Vec::new(),
            &|| false,
            &mut |_| {},
        );
        let told = page.unwrap().lines().join("\n");
        assert!(told.contains("indefinite, perhaps by rounding"), "{told}");
        assert!(told.contains("semidefinite"), "{told}");
        let (tolerance, _) = tolerance.expect("one of the size of the rounding");
        assert_eq!(tolerance, by);
        let value = format!("{tolerance:e}");
        let option = format!("settings.tolerance={value}");
        assert!(told.contains(&option), "{told}");
        let coarse = run(&rounded(by, &[("settings.tolerance", &value)]));
        assert!(coarse.failure.is_none(), "{:?}", coarse.failure);
    }
}

#[test]
fn a_matrix_that_is_definite_or_solved_as_it_is_is_not_blamed() {
    for k in 0..50 {
        assert_eq!(indefinite(&drawn(11, k, 1..=4), &|| false), None, "{k}");
    }
    // Two nodes on one spring, rounded up: either carries the load by itself.
    let one = [1.0, 0.0, 1.001, 0.0];
    let other = [1.001, 0.0, 1.0, 0.0];
    let (t, t_other) = ([0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]);
    let w: [&[f64]; 4] = [&one, &t, &other, &t_other];
    let problem = frozen(scene(&w, &[-1.0, 0.0, -1.0, 0.0], 0.0, &[]));
    let found = indefinite(&problem, &|| false).unwrap();
    assert!(
        matches!(found.outcome, IndefiniteOutcome::SolvedAsItIs(_)),
        "{found:?}"
    );
}
