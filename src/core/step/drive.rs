//! Runs a solver: the loop over minor iterations, and how it ended.

use crate::{Failure, Outcome, Solver, SolverLost, Stepper};
use std::convert::Infallible;
use std::ops::ControlFlow;

/// Limits of a run. A run always ends with the history, and by default at the first failure.
#[derive(Clone, Copy)]
pub struct Until<'a> {
    /// Maximum number of minor iterations.
    minors: u64,
    /// Whether to continue from a failed state.
    past_failures: bool,
    /// Called before every minor iteration; `true` stops the run.
    interrupted: &'a dyn Fn() -> bool,
}

impl<'a> Until<'a> {
    /// Runs to the end of the history, or to its first failure.
    pub fn end() -> Self {
        Until {
            minors: u64::MAX,
            past_failures: false,
            interrupted: &|| false,
        }
    }

    /// Limits the number of minor iterations.
    pub fn minors(self, minors: u64) -> Self {
        Until { minors, ..self }
    }

    /// Continues after failures.
    pub fn past_failures(self) -> Self {
        Until {
            past_failures: true,
            ..self
        }
    }

    /// Stops as soon as this returns true; it is called before every minor iteration.
    pub fn interrupted_by(self, interrupted: &'a dyn Fn() -> bool) -> Self {
        Until {
            interrupted,
            ..self
        }
    }
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum RunEnd<S> {
    /// The history is done.
    Finished,
    /// The increment failed.
    Failed(Failure),
    /// The limit of minor iterations was reached.
    Spent,
    /// It was interrupted.
    Interrupted,
    /// The observer stopped it.
    Stopped(S),
}

/// Steps until the end, and calls the observer, which may intervene, after every minor iteration.
///
/// # Errors
/// [`SolverLost`] if the solver cannot continue.
pub fn drive<T: Solver + ?Sized, S>(
    solver: &mut T,
    until: Until<'_>,
    observe: impl FnMut(&mut T) -> ControlFlow<S>,
) -> Result<RunEnd<S>, SolverLost> {
    drive_by(solver, T::step, until, observe)
}

fn drive_by<T: Solver + ?Sized, S, E>(
    solver: &mut T,
    step: impl Fn(&mut T) -> Result<bool, E>,
    until: Until<'_>,
    mut observe: impl FnMut(&mut T) -> ControlFlow<S>,
) -> Result<RunEnd<S>, E> {
    for _ in 0..until.minors {
        if (until.interrupted)() {
            return Ok(RunEnd::Interrupted);
        }
        if !step(solver)? {
            return Ok(RunEnd::Finished);
        }
        let failed = match &solver.event().outcome {
            Outcome::Failed(failure) if !until.past_failures => Some(failure.clone()),
            _ => None,
        };
        if let ControlFlow::Break(why) = observe(solver) {
            return Ok(RunEnd::Stopped(why));
        }
        if let Some(failure) = failed {
            return Ok(RunEnd::Failed(failure));
        }
    }
    Ok(RunEnd::Spent)
}

impl Stepper {
    /// Steps until the end, and calls the observer, which may intervene, after every minor iteration.
    pub fn drive<S>(
        &mut self,
        until: Until<'_>,
        observe: impl FnMut(&mut Stepper) -> ControlFlow<S>,
    ) -> RunEnd<S> {
        let step = |stepper: &mut Stepper| Ok::<bool, Infallible>(stepper.step().is_some());
        let Ok(end) = drive_by(self, step, until, observe);
        end
    }
}
