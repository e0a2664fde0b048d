//! Hyperstatic structures: singular compliances, strong friction, dozens of contacts, forces that are not unique.

use crate::common::run;
use crate::common::stepped;
use crate::hyperstatic::{broken, forces, problem};
use stickslip::contact::table2::Rule;

use std::sync::Arc;
use stickslip::model::Strategy;
use stickslip::scene::Scene;
use stickslip::step::event::Failure;
use stickslip::step::stepper::Stepper;
use stickslip::strategy::{next_rung, rungs};
use stickslip_exchange::problem::{Local, Matrix};
use stickslip_exchange::siconos::write;

/// What forces may break at most, relative to the largest motion and force: far above round-off, far below a wrong mode.
const TOLERANCE: f64 = 1e-9;

fn scene(problem: &Local, strategy: &str) -> Scene {
    let set = [("settings.strategy".to_owned(), strategy.to_owned())];
    Scene::from_text("hyperstatic.dat", &write(problem), &set).unwrap()
}

/// The first twelve with 30 to 50 contacts. Gauss-Seidel need not come to an end where friction is strong; what it comes to is
/// right.
#[test]
fn structures_with_forces_that_are_not_unique_are_solved() {
    let small = (0..).map(|k| (k, problem(k)));
    let mut by_sweeps = 0;
    for (k, problem) in small.filter(|(_, p)| p.mu.len() <= 50).take(12) {
        for strategy in ["ladder", "copositive", "gauss_seidel"] {
            let run = run(&scene(&problem, strategy));
            if strategy == "gauss_seidel" {
                by_sweeps += usize::from(run.failure.is_none());
            } else {
                assert!(run.failure.is_none(), "{strategy}, {k}: {:?}", run.failure);
            }
            if run.failure.is_none() {
                let broken = broken(&problem, &forces(&run.stepper));
                assert!(broken < TOLERANCE, "{strategy}, {k}: {broken:e}");
            }
        }
    }
    assert!(by_sweeps >= 10, "{by_sweeps}");
}

/// Discs whose bases make much of small shifts, and matrices on which sweeps go round: 50, 30, 80 and 30 contacts.
#[test]
fn what_sweeps_do_not_come_to_an_end_of_is_solved_by_pivoting() {
    for k in [68, 78, 165, 180] {
        let problem = problem(k);
        let run = run(&scene(&problem, "ladder"));
        assert!(run.failure.is_none(), "{k}: {:?}", run.failure);
        let broken = broken(&problem, &forces(&run.stepper));
        assert!(broken < TOLERANCE, "{k}: {broken:e}");
    }
}

/// Rungs by number are what snapshots keep, so that only their order may depend on how many contacts there are.
#[test]
fn with_many_contacts_sweeps_come_before_what_changes_one_node_at_a_time() {
    let climb = |contacts: usize| {
        let mut way = vec![Strategy::Table2];
        let mut rung = 0;
        while let Some((next, strategy)) = next_rung(Strategy::Ladder, rung, contacts) {
            rung = next;
            way.push(strategy);
        }
        way
    };
    use Strategy::{Census, Copositive, GaussSeidel, Lemke, Sliding, SlidingLeast, Table2};
    assert_eq!(climb(20), rungs(Strategy::Ladder));
    assert_eq!(
        climb(21),
        [
            Table2,
            Sliding,
            GaussSeidel,
            Copositive,
            SlidingLeast,
            Lemke,
            Census
        ]
    );
    assert_eq!(
        climb(65),
        [
            Table2,
            Sliding,
            GaussSeidel,
            Copositive,
            SlidingLeast,
            Census
        ]
    );
    assert_eq!(
        climb(1001),
        [Table2, Sliding, GaussSeidel, SlidingLeast, Census]
    );
}

/// Contacts that nothing can move apart: no force answers q_n < 0, and no part of the load does better.
#[test]
fn an_increment_that_scales_with_its_load_is_not_cut() {
    let contacts = 10;
    let stuck = Local {
        w: Matrix {
            rows: 2 * contacts,
            columns: 2 * contacts,
            ..Matrix::default()
        },
        q: [-1.0, 0.25].repeat(contacts),
        mu: vec![0.5; contacts],
    };
    let run = run(&scene(&stuck, "ladder"));
    let (event, failure) = run.failure.expect("there is no answer");
    assert_eq!(event.position.attempt, 1, "{failure:?}");
    assert!(
        matches!(failure, Failure::LadderEnded { scales: true, .. }),
        "{failure:?}"
    );
}

/// The way to the answer can be left and taken up anywhere, with the same bits.
#[test]
fn both_searches_go_on_with_the_same_bits_after_a_restore() {
    let problem = problem(1);
    for (strategy, rule) in [("copositive", Rule::Pivots), ("gauss_seidel", Rule::Sweeps)] {
        let model = Arc::new(scene(&problem, strategy).model);
        let (states, events) = stepped(&model);
        let of_search = |n: &&stickslip::contact::record::ContactRecord| n.decision.rule == rule;
        assert!(events.iter().any(|e| e.nodes.iter().any(|n| of_search(&n))));
        let some = states.iter().zip(&events).step_by(1 + events.len() / 20);
        for (state, event) in some {
            let mut other = Stepper::new(model.clone());
            other.restore(state);
            assert_eq!(other.step().unwrap(), event, "{strategy}");
        }
    }
}
