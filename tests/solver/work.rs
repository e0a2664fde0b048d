//! What is assembled and factored, and what is not done twice.

use crate::common::{finished, scene};
use std::sync::Arc;
use stickslip::model::Mode;
use stickslip::step::event::Outcome;
use stickslip::step::intervene::Intervention;
use stickslip::step::state::State;
use stickslip::step::stepper::Stepper;

const BLOCKS: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/tests/benches/two-blocks-pressed-sheared.ron"
);

fn stepper(name: &str, set: &[(&str, &str)]) -> Stepper {
    Stepper::new(Arc::new(scene(name, set).model))
}

/// A stepper in the middle of a major iteration of many minor ones, and the state before its last minor iteration.
fn in_a_major(solver: &str) -> (Stepper, State) {
    let mut stepper = stepper(BLOCKS, &[("settings.solver", solver)]);
    loop {
        let before = stepper.state().clone();
        let event = stepper.step().expect("the scene goes on");
        if event.outcome == Outcome::Minor && event.position.minor > 1 {
            return (stepper, before);
        }
    }
}

#[test]
fn a_state_that_was_only_looked_at_leaves_no_factors_for_the_next() {
    let set = [
        ("settings.solver", "condensed"),
        ("settings.factor", "needed"),
        ("refine", "2"),
    ];
    let mut first = stepper(BLOCKS, &set);
    // The states at the start of major iterations, and those after their first minor iteration.
    let mut starts = vec![];
    loop {
        let before = first.state().clone();
        if first.step().is_none() || before.next.increment > 4 {
            break;
        }
        if before.next.minor == 1 {
            starts.push((before, first.state().clone()));
        }
    }
    let mut compared = 0;
    for pair in starts.windows(2) {
        let [(looked_at, _), (before, after)] = pair else {
            unreachable!()
        };
        if looked_at.next.increment == before.next.increment {
            let mut other = stepper(BLOCKS, &set);
            other.step().expect("the scene starts");
            other.restore(looked_at);
            assert!(other.norms().is_some());
            other.restore(before);
            other.step().expect("it went on from there");
            assert!(other.state() == after, "{:?}", before.next);
            compared += 1;
        }
    }
    assert!(compared > 5, "{compared}");
}

#[test]
fn within_a_major_iteration_going_back_assembles_and_factors_nothing() {
    for solver in ["condensed", "augmented"] {
        let (mut stepper, before) = in_a_major(solver);
        let (after, done) = (stepper.state().clone(), stepper.work());
        let mut others = Vec::new();
        for _ in 0..3 {
            stepper.restore(&before);
            stepper.step().expect("it went on from there");
            assert_eq!(*stepper.state(), after);
            stepper.restore(&before);
            let force = Intervention::Force {
                slave: 3,
                mode: Mode::Free,
                hold: false,
            };
            stepper.intervene(&force).expect("a node can be forced");
            stepper.step().expect("it goes on");
            others.push(stepper.state().clone());
        }
        assert!(others.iter().all(|other| *other == others[0]));
        let more = stepper.work();
        assert_eq!(more.assemblies, done.assemblies, "{solver}");
        // The whole system is factored for every assumption of modes.
        let factored = if solver == "condensed" { 0 } else { 6 };
        assert_eq!(more.factorizations, done.factorizations + factored);
    }
}

#[test]
fn a_step_after_going_back_and_forth_between_increments_has_the_bits_of_one_that_never_left() {
    for factor in ["each", "needed"] {
        let set = [("settings.factor", factor), ("refine", "2")];
        let mut first = stepper(BLOCKS, &set);
        let mut states = vec![first.state().clone()];
        while states.len() < 24 {
            first.step().expect("the scene goes on");
            states.push(first.state().clone());
        }
        let mut other = stepper(BLOCKS, &set);
        // To and fro: each step from a state of another major iteration, or increment.
        for k in (1..states.len()).rev().chain([7, 2, 19, 3, 20, 4]) {
            other.restore(&states[k - 1]);
            other.step().expect("it went on from there");
            assert_eq!(*other.state(), states[k], "{factor}, step {k}");
        }
    }
}

#[test]
fn every_major_iteration_assembles_once_and_what_is_watched_nothing() {
    // Prescribed motions, dead loads, and elements that remember what was accepted: those start anew from there.
    for (name, set, remembers) in [
        (BLOCKS, ("refine", "1"), false),
        (
            "04-cantilever-rigid-circle",
            ("history.increment", "0.25"),
            false,
        ),
        (
            "05-cantilever-elastic-block",
            ("history.path[1]", "0.3"),
            false,
        ),
        (
            "05-cantilever-elastic-block",
            ("materials.upper.update", "updated"),
            true,
        ),
    ] {
        let set = [
            set,
            ("settings.strategy", "table2"),
            ("history.increment", "0.1"),
        ];
        let set = if name == BLOCKS { &set[..1] } else { &set[..] };
        let mut stepper = stepper(name, set);
        let (mut majors, mut increments, mut values) = (0, 0, Vec::new());
        while let Some(event) = stepper.step() {
            let accepted = matches!(event.outcome, Outcome::Increment { .. });
            majors += u64::from(accepted || matches!(event.outcome, Outcome::Major { .. }));
            if matches!(event.outcome, Outcome::Failed(_)) {
                break;
            }
            if accepted {
                increments += 1;
                stepper.monitors(&mut values);
            }
        }
        let anew = if remembers { increments } else { 1 };
        let made = stepper.work().assemblies;
        assert!(increments > 2, "{name}");
        assert!(
            made <= majors + anew,
            "{name}: {made} for {majors}, {increments}"
        );
    }
}

#[test]
fn old_factors_lead_to_the_same_answers_with_fewer_factorizations() {
    let circle = [("history.increment", "0.25")];
    for (name, set) in [
        (BLOCKS, &[("refine", "2")][..]),
        (BLOCKS, &[("settings.solver", "augmented")]),
        (BLOCKS, &[("materials.m.update", "updated")]),
        ("04-cantilever-rigid-circle", &circle),
        // Bodies that give under point forces are not condensed by themselves, and have no factors to keep.
        (
            "02-two-cantilevers-smooth",
            &[
                ("history.increment", "0.1"),
                ("settings.point_force", "plain"),
            ],
        ),
    ] {
        let with = |factor| {
            let set: Vec<_> = set
                .iter()
                .copied()
                .chain([("settings.factor", factor)])
                .collect();
            finished(&scene(name, &set))
        };
        let [each, needed] = ["each", "needed"].map(with);
        assert!(each.failure.is_none() && needed.failure.is_none(), "{name}");
        assert_eq!(each.accepted.len(), needed.accepted.len(), "{name}");
        let length = each.stepper.model().length;
        for (a, b) in each.accepted.iter().zip(&needed.accepted) {
            let modes = |state: &State| state.nodes.iter().map(|n| n.mode).collect::<Vec<_>>();
            assert_eq!(modes(&a.state), modes(&b.state), "{name} at {}", a.load);
            let apart = a.state.u.iter().zip(b.state.u.iter());
            let apart = apart.fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
            assert!(apart < 1e-8 * length, "{name} at {}: {apart:e}", a.load);
        }
        if !each.stepper.condenses() {
            continue;
        }
        let [each, needed] = [&each, &needed].map(|run| run.stepper.work());
        let least = if name == BLOCKS { 2 } else { 1 };
        assert!(
            least * needed.factorizations < each.factorizations,
            "{name}: {each:?} {needed:?}"
        );
    }
}

/// Increments, minor iterations and factorizations of the blocks.
fn blocks(set: &[(&str, &str)]) -> [u64; 3] {
    let run = finished(&scene(BLOCKS, set));
    let counts = [run.accepted.len(), run.steps].map(|count| count as u64);
    [counts[0], counts[1], run.stepper.work().factorizations]
}

#[test]
fn condensed_solids_keep_old_factors_and_augmented_ones_do_not() {
    let factorizations = |solver, factor| {
        let [_, _, done] = blocks(&[("settings.solver", solver), ("settings.factor", factor)]);
        done
    };
    assert!(2 * factorizations("condensed", "auto") < factorizations("condensed", "each"));
    let augmented = ["auto", "each"].map(|factor| factorizations("augmented", factor));
    assert_eq!(augmented[0], augmented[1]);
}

#[test]
fn an_increment_starts_with_the_factors_of_the_one_before_and_is_factored_once() {
    let [increments, _, factorizations] = blocks(&[("settings.factor", "needed")]);
    assert!(
        factorizations <= increments,
        "{factorizations} in {increments} increments"
    );
}

#[test]
fn a_constant_stiffness_is_factored_once_and_needs_no_more_iterations() {
    let small = |factor| blocks(&[("materials.m.update", "small"), ("settings.factor", factor)]);
    let [kept, anew] = ["auto", "each"].map(small);
    assert_eq!(kept[..2], anew[..2]);
    assert_eq!(kept[2], 1);
}

#[test]
fn a_borrowed_interface_problem_is_the_one_that_would_have_been_found() {
    let (mut lender, before) = in_a_major("condensed");
    let mut borrower = stepper(BLOCKS, &[("settings.solver", "condensed")]);
    let lent = lender.lend(&before).expect("it is at hand");
    borrower.borrow(lent);
    lender.step().expect("it goes on");
    let state = lender.state().clone();
    borrower.restore(&state);
    let own = lender.interface_problem().expect("bodies can be condensed");
    assert_eq!(borrower.interface_problem(), Some(own));
    assert_eq!(borrower.work().assemblies, 0);
    let start = stepper(BLOCKS, &[]).state().clone();
    assert!(lender.lend(&start).is_none());
}
