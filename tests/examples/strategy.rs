//! A strategy from outside the solver, used where Table 2 cycles.
//!
//! In this scene Table 2 lets the tip of a cantilever stick when it penetrates and open when it is pulled, endlessly; only sliding
//! is consistent. The strategy below is Table 2 with one change: a fixed node does not open, it slides first.
//!
//! `cargo run --example strategy`

use std::convert::Infallible;
use std::error::Error;
use std::io::Write;
use std::ops::ControlFlow;
use std::sync::Arc;
use stickslip::contact::table2::{Numbers, Reason, Rule, decide};
use stickslip::interface::method::{Choice, Method, NodeContext};
use stickslip::model::Mode;
use stickslip::scene::Scene;
use stickslip::step::Stepper;
use stickslip::step::drive::{RunEnd, Until};

/// Table 2, but no node goes from fixed to free at once.
struct SlidesFirst;

impl Method for SlidesFirst {
    fn choose(&self, numbers: &Numbers, known: &NodeContext<'_>) -> Choice {
        let mut decision = decide(numbers, known.ties);
        if (decision.before, decision.next) == (Mode::Fixed, Mode::Free) {
            (decision.next, decision.wanted) = (Mode::Sliding, Mode::Sliding);
            decision.rule =
                Rule::Custom(Reason("fixed → sliding: a fixed node never opens at once"));
        }
        Choice {
            decision,
            sign: None,
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    run(&mut std::io::stdout())
}

/// Writes how Table 2 ends, the decisions that the strategy changes, and how it ends.
pub fn run(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let set = [
        ("settings.strategy", "table2"),
        ("settings.t_max", "consistent"),
    ];
    let set = set.map(|(path, value)| (path.to_owned(), value.to_owned()));
    let scene = Scene::open("osc-inclined-cantilever", &set)?;
    let model = Arc::new(scene.model);
    let mut stepper = Stepper::new(model.clone());
    let end: RunEnd<Infallible> = stepper.drive(Until::end(), |_| ControlFlow::Continue(()));
    writeln!(out, "Table 2: {end:?}")?;

    let mut stepper = Stepper::new(model).with_strategy(Arc::new(SlidesFirst));
    let end: RunEnd<Infallible> = stepper.drive(Until::end(), |stepper| {
        let decision = &stepper.event().nodes[0].decision;
        if let Rule::Custom(reason) = decision.rule {
            // What cannot be written to is found out below.
            let _ = writeln!(out, "{}", reason.0);
        }
        ControlFlow::Continue(())
    });
    writeln!(out, "the strategy: {end:?}")?;
    Ok(())
}
