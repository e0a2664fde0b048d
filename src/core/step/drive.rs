//! Driving a solver: the one loop over minor iterations, and how it ended.

use crate::step::event::{Failure, Outcome};
use crate::step::solver::{Lost, Solver};
use crate::step::stepper::Stepper;
use std::convert::Infallible;
use std::ops::ControlFlow;

/// How far a drive goes at most. It always ends with the history, and unless told otherwise at the first failure.
#[derive(Clone, Copy)]
pub struct Until<'a> {
    /// Most minor iterations.
    minors: u64,
    /// Whether it goes on from a failed state, as a user does.
    past_failures: bool,
    /// Asked before every minor iteration.
    interrupted: &'a dyn Fn() -> bool,
}

impl<'a> Until<'a> {
    /// To the end of the history, or its first failure.
    pub fn end() -> Self {
        Until {
            minors: u64::MAX,
            past_failures: false,
            interrupted: &|| false,
        }
    }

    /// So many minor iterations at most.
    pub fn minors(self, minors: u64) -> Self {
        Until { minors, ..self }
    }

    /// Not ended by failures.
    pub fn past_failures(self) -> Self {
        Until {
            past_failures: true,
            ..self
        }
    }

    /// Until this says so; it is asked before every minor iteration.
    pub fn interrupted_by(self, interrupted: &'a dyn Fn() -> bool) -> Self {
        Until {
            interrupted,
            ..self
        }
    }
}

/// How a drive ended.
#[derive(Debug, Clone, PartialEq)]
pub enum RunEnd<S> {
    /// The history is done.
    Finished,
    /// The increment failed.
    Failed(Failure),
    /// The minor iterations that it had are used up.
    Spent,
    /// It was interrupted.
    Interrupted,
    /// The observer stopped it.
    Stopped(S),
}

/// Steps until the end, with the observer looking (and, if it wants, intervening) after every minor iteration.
///
/// # Errors
/// [`Lost`] where the solver cannot go on.
pub fn drive<T: Solver + ?Sized, S>(
    solver: &mut T,
    until: Until<'_>,
    observe: impl FnMut(&mut T) -> ControlFlow<S>,
) -> Result<RunEnd<S>, Lost> {
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
    /// Steps until the end, with the observer looking (and, if it wants, intervening) after every minor iteration.
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
