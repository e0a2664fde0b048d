//! Interface problems with many contacts: packings of discs, whose forces are not unique, judged by their natural map.

use crate::common::{Run, finished, run};
use crate::packing::{global, local, natural_map};
use crate::siconos::in_blocks;
use std::fs;
use stickslip::contact::laws::JudgedLaw;
use stickslip::contact::table2::Rule;
use stickslip::explain::failures::describe;
use stickslip::explain::{accuracy, report};
use stickslip::linear::sparse_contacts::FEW;
use stickslip::scene::Scene;
use stickslip::step::event::Outcome;
use stickslip::step::stepper::Stepper;
use stickslip_exchange::matrix_market;
use stickslip_exchange::problem::{Global, Local, Matrix};

/// The problem as Matrix Market files.
fn scene(problem: &Local) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, text: String| fs::write(folder.path().join(name), text).unwrap();
    put("p_W.mtx", matrix_market::write(&problem.w, &[]));
    put("p_q.mtx", matrix_market::write_column(&problem.q, &[]));
    put("p_mu.mtx", matrix_market::write_column(&problem.mu, &[]));
    let file = folder.path().join("p_W.mtx");
    Scene::open(&file.display().to_string(), &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn forces(run: &Run) -> Vec<f64> {
    let state = run.stepper.state();
    state.nodes.iter().flat_map(|n| [n.f_n, n.f_t]).collect()
}

#[test]
fn forces_of_packings_obey_the_laws_and_are_said_not_to_be_unique() {
    for (columns, rows) in [(8, 8), (10, 10), (24, 16)] {
        let problem = local(columns, rows, 0.4);
        assert!(problem.mu.len() > FEW);
        let run = finished(&scene(&problem));
        let error = natural_map(&problem, &forces(&run));
        assert!(error <= 1e-8, "{} contacts: {error:e}", problem.mu.len());
        let [accepted] = run.accepted.as_slice() else {
            panic!("{} increments", run.accepted.len());
        };
        let said = accuracy::natural_map(&accepted.event).expect("not unique");
        assert!(said <= 1e-9, "{said:e}");
        let text = report::outcome(run.stepper.model(), &accepted.event);
        assert!(text.contains("the modes do not determine"), "{text}");
        assert!(run.steps < 60, "{} minor iterations", run.steps);
    }
}

#[test]
fn a_packing_goes_on_from_any_state_with_the_same_bits() {
    let scene = scene(&local(8, 8, 0.4));
    let model = std::sync::Arc::new(scene.model);
    let mut stepper = Stepper::new(model.clone());
    let mut states = vec![stepper.state().clone()];
    while stepper.step().is_some() {
        states.push(stepper.state().clone());
    }
    let last = stepper.state().clone();
    assert!(states.len() > 6);
    for state in &states[..states.len() - 1] {
        let mut again = Stepper::new(model.clone());
        again.restore(state);
        while again.step().is_some() {}
        assert_eq!(*again.state(), last);
    }
}

/// The problem as Siconos writes it, sparse: W has six digits.
fn in_six_digits(problem: &Local) -> String {
    let Local { w, q, mu } = problem;
    let entries = w.clone().merged().entries;
    let rows = entries
        .iter()
        .map(|(i, j, w)| format!("{i} {j} : {w:.5e}\n"));
    let (size, count) = (q.len(), entries.len());
    let numbers = q.iter().chain(mu).map(|x| format!("{x:e}\n"));
    format!(
        "2\n{}\n2\n{size}\n{size}\n2\nCSparse\ntriplet: {size}-by-{size}, nzmax: {count} nnz: {count}\n{}{}",
        mu.len(),
        rows.collect::<String>(),
        numbers.collect::<String>()
    )
}

/// Rounding makes a singular W indefinite, and sweeps reach the laws only as far as its digits.
#[test]
fn forces_of_a_rounded_matrix_are_accepted_to_its_digits_and_not_without() {
    let problem = local(14, 12, 0.4);
    let text = in_six_digits(&problem);
    let open = |set: &[(String, String)]| Scene::from_text("p.dat", &text, set).unwrap();
    let solved = finished(&open(&[]));
    let error = natural_map(&problem, &forces(&solved));
    assert!((1e-9..5e-6).contains(&error), "{error:e}");
    let said = report::outcome(solved.stepper.model(), solved.stepper.event());
    assert!(said.contains("settings.matrix_accuracy allows"), "{said}");

    // Many forces together are larger than each, and their error in parts of the largest as well. That of lengths is not.
    let verdict = solved.stepper.state().start.verdict.unwrap();
    let allowed = |law: JudgedLaw| verdict.worst[law as usize].map_or(0.0, |worst| worst.allowed);
    let [lengths, forces] = [JudgedLaw::Gap, JudgedLaw::Cone].map(allowed);
    assert!(lengths < 0.5 * forces, "{lengths:e} {forces:e}");

    let exact = [("settings.matrix_accuracy".to_owned(), "0".to_owned())];
    let run = run(&open(&exact));
    let (_, failure) = run.failure.expect("six digits do not suffice");
    let why = describe(run.stepper.model(), &failure);
    assert!(why.contains("do not converge; the natural map"), "{why}");
}

/// A chain of contacts, each coupled to its neighbours by a regular matrix.
fn chain(contacts: usize) -> Local {
    let mut entries = Vec::new();
    for k in 0..contacts {
        let own = [(0, 0, 1.0), (1, 1, 0.8), (0, 1, 0.15), (1, 0, 0.15)];
        entries.extend(own.map(|(a, b, w)| (2 * k + a, 2 * k + b, w)));
        if k + 1 < contacts {
            for (a, w) in [(0, 0.3), (1, 0.25)] {
                entries.extend([(2 * k + a, 2 * k + 2 + a, w), (2 * k + 2 + a, 2 * k + a, w)]);
            }
        }
    }
    let x = (0..contacts).map(|k| k as f64);
    let size = 2 * contacts;
    Local {
        w: Matrix {
            rows: size,
            columns: size,
            entries,
        },
        q: x.flat_map(|x| [(0.37 * x).sin() - 0.4, 0.8 * (0.23 * x).cos()])
            .collect(),
        mu: (0..contacts).map(|k| 0.2 + 0.4 * (k % 3) as f64).collect(),
    }
}

#[test]
fn modes_that_determine_the_forces_are_solved_for() {
    let problem = chain(400);
    let run = finished(&scene(&problem));
    let error = natural_map(&problem, &forces(&run));
    assert!(error <= 1e-14, "{error:e}");
    assert_eq!(accuracy::natural_map(run.stepper.event()), None);
}

#[test]
fn independent_parts_settle_each_by_itself() {
    let (one, other) = (local(8, 8, 0.4), chain(150));
    let first = one.q.len();
    let mut both = one.clone();
    let shifted = other
        .w
        .entries
        .iter()
        .map(|&(i, j, w)| (first + i, first + j, w));
    both.w.entries.extend(shifted);
    both.w.rows += other.w.rows;
    both.w.columns += other.w.columns;
    both.q.extend(&other.q);
    both.mu.extend(&other.mu);
    let run = finished(&scene(&both));
    let forces = forces(&run);
    assert!(natural_map(&both, &forces) <= 1e-8);
    // Each part alone: the small one must not hide behind the forces of the large one.
    assert!(natural_map(&one, &forces[..first]) <= 1e-8);
    assert!(natural_map(&other, &forces[first..]) <= 1e-7);
}

/// A global problem as Siconos writes it, dense.
fn siconos(problem: &Global) -> String {
    let dense = |matrix: &Matrix| {
        let rows = matrix.dense();
        let columns = (0..matrix.columns).flat_map(|j| rows.iter().map(move |row| row[j]));
        let numbers: Vec<String> = columns.map(|x| format!("{x:?}")).collect();
        let (m, n) = (matrix.rows, matrix.columns);
        format!("0\n{m}\n{n}\n{m} {n}\n{}\n", numbers.join(" "))
    };
    let list = |numbers: &[f64]| {
        let numbers: Vec<String> = numbers.iter().map(|x| format!("{x:?}")).collect();
        numbers.join(" ")
    };
    format!(
        "2\n{}\n{}{}{}\n{}\n{}\n",
        problem.mu.len(),
        dense(&problem.m),
        dense(&problem.h),
        list(&problem.f),
        list(&problem.b),
        list(&problem.mu)
    )
}

#[test]
fn many_contacts_are_read_alike_from_every_file() {
    let problem = local(7, 7, 0.3);
    assert!(problem.mu.len() > FEW);
    let from_market = scene(&problem);
    let text = in_blocks(&problem);
    let from_siconos = Scene::from_text("p.dat", &text, &[]).unwrap();
    assert_eq!(from_market.model.bodies, from_siconos.model.bodies);
    assert_eq!(from_market.model.loads, from_siconos.model.loads);
    let text = siconos(&global(7, 7, 0.3));
    let condensed = Scene::from_text("g.dat", &text, &[]).unwrap();
    let run = finished(&condensed);
    assert!(natural_map(&problem, &forces(&run)) <= 1e-8);
}

#[test]
fn many_contacts_that_do_not_fit_are_refused_before_they_start() {
    let problem = local(24, 16, 0.4);
    let text = in_blocks(&problem);
    let set = |memory: &str| [("settings.memory".to_owned(), memory.to_owned())];
    assert!(Scene::from_text("p.dat", &text, &set("0.03")).is_ok());
    let error = Scene::from_text("p.dat", &text, &set("0.011")).unwrap_err();
    assert!(error.to_string().contains("memory"), "{error}");
}

#[test]
fn a_sweep_is_a_minor_iteration_and_reports_its_error() {
    let mut stepper = Stepper::new(std::sync::Arc::new(scene(&local(8, 8, 0.4)).model));
    let mut errors = Vec::new();
    while let Some(event) = stepper.step() {
        if event.nodes.iter().any(|n| n.decision.rule == Rule::Sweeps) {
            assert_eq!(event.outcome, Outcome::Minor);
            errors.push(event.nodes[0].decision.tests[0].unwrap().value);
        }
    }
    assert!(errors.len() >= 3);
    assert!(
        errors.windows(2).all(|pair| pair[1] < pair[0]),
        "{errors:?}"
    );
}
