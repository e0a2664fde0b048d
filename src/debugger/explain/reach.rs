//! Up to which load there is an answer: the increment that failed is walked again from the last equilibrium in steps
//! that are cut as long as they fail, whatever the strategy.

use super::report;
use std::mem::discriminant;
use std::ops::ControlFlow;
use stickslip_core::linear::singular::Singular;
use stickslip_core::model::Model;
use stickslip_core::step::drive::{RunEnd, Until};
use stickslip_core::step::event::{Failure, Moves, Outcome};
use stickslip_core::step::intervene::Intervention;
use stickslip_core::step::state::State;
use stickslip_core::step::stepper::Stepper;
use stickslip_scene::number::six;

/// Steps are cut to no less than this part of the increment.
const FINEST: f64 = 1.0 / 4096.0;
/// Most steps that are tried.
const TRIALS: u32 = 60;
/// Most minor iterations of a step.
const MINORS: u64 = 400;

/// How far it goes.
#[derive(Debug, Clone, PartialEq)]
pub struct Reach {
    /// Load factor that was come to.
    pub load: f64,
    /// The last equilibrium from which it set out, by its load factor.
    pub from: f64,
    /// Load factor that failed.
    pub wanted: f64,
    /// The state that was reached.
    pub at: Box<State>,
    /// Size of the step that failed last, and of what. `None` where the load that failed was come to, or the number of
    /// trials was used up.
    pub ends: Option<(f64, Failure)>,
}

impl Reach {
    /// In words; `first` is what the increment failed of.
    pub fn words(&self, model: &Model, first: &Failure) -> String {
        let Reach { load, wanted, .. } = self;
        match &self.ends {
            None if load == wanted => {
                format!("in smaller steps load {wanted} is reached")
            }
            None => format!("in smaller steps it comes to load {load} at least"),
            Some((size, failure)) => {
                let why = match discriminant(failure) == discriminant(first) {
                    true => "the same".to_owned(),
                    false => report::describe_failure(model, failure),
                };
                let far = match *load == self.from {
                    true => format!("not even a step of {size:.1e} beyond load {load} succeeds"),
                    false => format!("in smaller steps it comes to load {}", six(*load)),
                };
                format!("{far}; there: {why}")
            }
        }
    }
}

/// Walks the increment that failed in a state, in steps that are cut. `None` where that was stopped. The stepper is left
/// anywhere.
pub fn reach(stepper: &mut Stepper, state: &State, stop: &dyn Fn() -> bool) -> Option<Reach> {
    let (from, wanted) = (state.start.load_factor, state.load_factor);
    let whole = (wanted - from).abs();
    let mut good = state.attempt_again();
    let (mut load, mut size) = (from, whole / 2.0);
    let mut ends = None;
    for _ in 0..TRIALS {
        if load == wanted || size < FINEST * whole {
            break;
        }
        match step(stepper, &good, size.min((wanted - load).abs()), stop)? {
            Ok(accepted) => {
                (good, ends) = (accepted, None);
                load = good.start.load_factor;
                if good.start.leg > state.start.leg {
                    break;
                }
            }
            Err(why) => {
                ends = Some((size, why));
                size /= 2.0;
            }
        }
    }
    Some(Reach {
        at: Box::new(good),
        load,
        from,
        wanted,
        ends,
    })
}

/// One step of this size from an accepted state: what is accepted, or why not.
fn step(
    stepper: &mut Stepper,
    from: &State,
    size: f64,
    stop: &dyn Fn() -> bool,
) -> Option<Result<State, Failure>> {
    stepper.restore(from);
    stepper.intervene(&Intervention::Increment(size)).ok()?;
    let until = Until::end().minors(MINORS).interrupted_by(stop);
    let end = stepper.drive(until, |stepper| match &stepper.event().outcome {
        Outcome::Increment { jumped: false, .. } => ControlFlow::Break(Ok(stepper.state().clone())),
        // A state that has left the branch is no answer near the last state.
        Outcome::Increment { .. } => {
            ControlFlow::Break(Err(Failure::Singular(Singular::Unexplained)))
        }
        // Cutting is done here.
        Outcome::Cut { why, .. }
        | Outcome::Leaps { why, .. }
        | Outcome::Fallback { why, .. }
        | Outcome::Turns { why, .. } => ControlFlow::Break(Err(why.clone())),
        Outcome::Moves(Moves::LetsGo { why, .. }) => ControlFlow::Break(Err(why.clone())),
        _ => ControlFlow::Continue(()),
    });
    match end {
        RunEnd::Stopped(end) => Some(end),
        RunEnd::Failed(why) => Some(Err(why)),
        RunEnd::Spent => Some(Err(Failure::MinorLimit {
            limit: MINORS as u32,
            changing: Vec::new(),
        })),
        RunEnd::Finished | RunEnd::Interrupted => None,
    }
}
