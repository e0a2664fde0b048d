//! The census finds every consistent state of a frozen interface problem.

use crate::common::{self, run, scene};
use std::sync::Arc;
use stickslip::interface::census::census;
use stickslip::step::event::Failure;
use stickslip::step::stepper::Stepper;

#[test]
fn where_free_and_fixed_take_turns_sliding_is_the_one_answer() {
    for solver in ["augmented", "condensed"] {
        let set = [
            ("settings.solver", solver),
            ("settings.t_max", "consistent"),
        ];
        let scene = scene("osc-inclined-cantilever", &set);
        let mut failed = run(&scene);
        assert!(matches!(failed.failure, Some((_, Failure::Cycle(_)))));
        let frozen = failed.stepper.interface_problem().unwrap();
        let census = census(&frozen).unwrap();
        let answers: Vec<_> = census.answers.iter().map(|a| a.answer.letters()).collect();
        assert_eq!((census.tried, answers), (4, vec!["-".to_string()]));
        let slides = census.answers[0].answer.nodes[0];
        // What the solver finds once the tip is forced to slide.
        common::force(&mut failed, 0, stickslip::model::Mode::Sliding, false);
        let mut stepper = failed.stepper;
        let first = loop {
            let event = stepper.step().unwrap();
            if !event.nodes[0].decision.changes() {
                break event.nodes[0];
            }
        };
        assert!(
            (first.f_n - slides.f_n).abs() < 1e-9 * slides.f_n,
            "{first:?} {slides:?}"
        );
        assert!((first.f_t - slides.f_t).abs() < 1e-9 * slides.f_n);
    }
}

#[test]
fn where_nothing_touches_the_free_state_is_the_one_answer() {
    let scene = scene("04-cantilever-rigid-circle", &[]);
    let mut stepper = Stepper::new(Arc::new(scene.model));
    let frozen = stepper.interface_problem().unwrap();
    let count = frozen.nodes.len();
    let found = census(&frozen);
    if count > stickslip::interface::census::MOST {
        assert!(found.unwrap_err().to_string().contains("core"));
    } else {
        assert_eq!(
            found.unwrap().answers[0].answer.letters(),
            "F".repeat(count)
        );
    }
}
