//! The largest load that smaller steps reach: repeats the failed increment from the last equilibrium in steps
//! that are cut whenever they fail, with any strategy.

use super::failures;
use std::mem::discriminant;
use std::ops::ControlFlow;
use stickslip_core::{
    Failure, Intervention, Model, MotionEvent, Outcome, RunEnd, Singular, State, Stepper, Until,
};
use stickslip_scene::{shortest, sig2, sig6};

/// Smallest step, as a fraction of the increment.
const FINEST: f64 = 1.0 / 4096.0;
/// Maximum number of steps tried.
const TRIALS: u32 = 60;
/// Maximum number of minor iterations per step.
const MINORS: u64 = 400;

/// Result of the smaller steps.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadLimitProbe {
    /// Load factor reached.
    pub load: f64,
    /// Load factor of the last equilibrium before the failure.
    pub from: f64,
    /// Load factor of the failed increment.
    pub wanted: f64,
    /// State reached.
    pub at: Box<State>,
    /// Size and failure of the last failed step. `None` if the load was reached, or the number of trials was
    /// used up.
    pub ends: Option<(f64, Failure)>,
}

impl LoadLimitProbe {
    /// Describes the result; `first` is the failure of the increment.
    pub fn words(&self, model: &Model, first: &Failure) -> String {
        let LoadLimitProbe { load, wanted, .. } = self;
        let [at, to] = [load, wanted].map(|&load| shortest(load));
        match &self.ends {
            None if load == wanted => {
                format!("smaller steps reach load {to}")
            }
            None => format!("smaller steps reach at least load {at}"),
            Some((size, failure)) => {
                let why = if discriminant(failure) == discriminant(first) {
                    "the same failure".to_owned()
                } else {
                    failures::describe(model, failure)
                };
                let far = if *load == self.from {
                    format!(
                        "not even a step of {} beyond load {at} succeeds",
                        sig2(*size)
                    )
                } else {
                    format!("smaller steps reach load {}", sig6(*load))
                };
                format!("{far}; there: {why}")
            }
        }
    }
}

/// Repeats the increment that failed in a state, in steps that are cut when they fail. `None` if interrupted.
/// The stepper's final state is unspecified.
pub fn reach(
    stepper: &mut Stepper,
    state: &State,
    stop: &dyn Fn() -> bool,
) -> Option<LoadLimitProbe> {
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
    Some(LoadLimitProbe {
        at: Box::new(good),
        load,
        from,
        wanted,
        ends,
    })
}

/// Takes one step of this size from an accepted state.
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
        // A jump to another branch does not count as reaching the load.
        Outcome::Increment { .. } => {
            ControlFlow::Break(Err(Failure::Singular(Singular::Unexplained)))
        }
        // This function does the cutting itself.
        Outcome::Cut { why, .. }
        | Outcome::WholeIncrement { why, .. }
        | Outcome::Fallback { why, .. }
        | Outcome::PathCorner { why, .. } => ControlFlow::Break(Err(why.clone())),
        Outcome::Motion(MotionEvent::DynamicStart { why, .. }) => {
            ControlFlow::Break(Err(why.clone()))
        }
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
