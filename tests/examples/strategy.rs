//! A strategy of its own, tried where Table 2 cycles, and its answer handed to the stepper.
//!
//! In this scene Table 2 lets the tip of a cantilever stick when it penetrates and open when it is pulled, for ever; the only
//! consistent mode is the third one. The strategy below is Table 2 with one change: a fixed node does not open, it slides
//! first.
//!
//! `cargo run --example strategy`

use std::convert::Infallible;
use std::error::Error;
use std::io::Write;
use std::ops::ControlFlow;
use std::sync::Arc;
use stickslip::contact::table2::{Numbers, Rule, decide};
use stickslip::interface::method::{Choice, Known, Method};
use stickslip::interface::trials::Trials;
use stickslip::model::Mode;
use stickslip::scene::Scene;
use stickslip::step::drive::{RunEnd, Until};
use stickslip::step::intervene::{Intervention, Start};
use stickslip::step::{Outcome, Stepper};

/// Table 2, but no node goes from fixed to free at once.
struct SlidesFirst;

impl Method for SlidesFirst {
    fn choose(&self, numbers: &Numbers, known: &Known<'_>) -> Choice {
        let mut decision = decide(numbers, known.ties);
        if (decision.before, decision.next) == (Mode::Fixed, Mode::Free) {
            (decision.next, decision.wanted) = (Mode::Sliding, Mode::Sliding);
            decision.rule = Rule::FixedSlides;
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

/// Writes where Table 2 ends, the minor iterations of the strategy, and where the stepper gets with its answer.
pub fn run(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let set = [
        ("settings.strategy", "table2"),
        ("settings.t_max", "consistent"),
    ];
    let set = set.map(|(path, value)| (path.to_owned(), value.to_owned()));
    let scene = Scene::open("osc-inclined-cantilever", &set)?;
    let mut stepper = Stepper::new(Arc::new(scene.model));
    let end: RunEnd<Infallible> = stepper.drive(Until::end(), |_| ControlFlow::Continue(()));
    writeln!(out, "Table 2: {end:?}")?;

    // The interface problem of the major iteration that failed: geometry and stiffness frozen, no bodies.
    let problem = stepper.interface_problem().ok_or("not condensed")?;
    let mut trials = Trials::new(&problem).ok_or("no memory")?;
    let mut nodes = problem.states();
    loop {
        let (records, settled) = trials.minor(&mut nodes, &SlidesFirst).ok_or("singular")?;
        let decision = &records[0].decision;
        writeln!(out, "{:?} -> {:?}", decision.before, decision.next)?;
        if settled {
            break;
        }
    }

    // What was found is where the next minor iteration starts.
    let starts = nodes.iter().zip(&problem.nodes).map(|(state, node)| Start {
        slave: node.slave,
        mode: state.mode,
        t_max: state.t_max,
    });
    stepper.intervene(&Intervention::Assume(starts.collect()))?;
    let accepted = stepper.drive(Until::end(), |stepper| match stepper.event().outcome {
        Outcome::Increment { .. } => ControlFlow::Break(stepper.event().load_factor),
        _ => ControlFlow::Continue(()),
    });
    writeln!(out, "the stepper goes on: {accepted:?}")?;
    Ok(())
}
