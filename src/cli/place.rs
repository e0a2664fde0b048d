//! Positions in a run, as given to `--at`.

use super::base::{Error, Exit};
use super::interrupt::Interrupt;
use std::fmt;
use std::ops::ControlFlow;
use std::str::FromStr;
use stickslip_core::step::drive::drive;
use stickslip_core::{Event, Failure, Outcome, RunEnd, Solver, SolverLost, Until};
use stickslip_debugger::explain::{names, report};
use stickslip_debugger::history::breakpoints::parts;
use stickslip_scene::Scene;

/// A position in a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RunPosition {
    increment: u32,
    major: Option<u32>,
    minor: Option<u32>,
}

impl FromStr for RunPosition {
    type Err = String;

    fn from_str(text: &str) -> Result<RunPosition, String> {
        match parts(text) {
            Some([Some(increment), major, minor]) => Ok(RunPosition {
                increment,
                major,
                minor,
            }),
            _ => Err(
                "expected INC, INC.MAJOR or INC.MAJOR.MINOR, with whole numbers from 1".to_owned(),
            ),
        }
    }
}

impl fmt::Display for RunPosition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.increment)?;
        for part in [self.major, self.minor].into_iter().flatten() {
            write!(f, ".{part}")?;
        }
        Ok(())
    }
}

impl RunPosition {
    /// Whether this minor iteration ends at the position.
    fn is(&self, event: &Event) -> bool {
        let at = event.position;
        let here = at.increment == self.increment && self.major.is_none_or(|m| m == at.major);
        here && match (self.major, self.minor) {
            (None, _) => event.outcome.is_accepted(),
            (_, None) => ends_major(&event.outcome),
            (_, Some(minor)) => minor == at.minor,
        }
    }

    /// Whether this minor iteration is later than the position, so that it cannot be reached.
    fn is_past(&self, event: &Event) -> bool {
        let at = event.position;
        at.increment == self.increment
            && (event.outcome.is_accepted()
                || (Some(at.major) == self.major && ends_major(&event.outcome)))
    }
}

fn ends_major(outcome: &Outcome) -> bool {
    matches!(
        outcome,
        Outcome::Major { .. }
            | Outcome::Refused { .. }
            | Outcome::Increment { .. }
            | Outcome::Failed(
                Failure::MajorLimit { .. }
                    | Failure::MajorCycle(_)
                    | Failure::Diverged { .. }
                    | Failure::Refused(_)
            )
    )
}

/// Why a position was not reached.
pub enum SeekFailure {
    Failed(Failure),
    Interrupted,
    /// The solver was lost.
    Lost(SolverLost),
    /// The run has no such position.
    Absent,
}

/// Steps to a position, and calls `see` after each minor iteration; returns their number.
pub fn seek<T: Solver + ?Sized>(
    solver: &mut T,
    at: RunPosition,
    interrupt: &Interrupt,
    see: &mut dyn FnMut(&mut T),
) -> Result<u64, SeekFailure> {
    let mut steps = 0;
    let has_arrived = || interrupt.has_arrived();
    let until = Until::end().interrupted_by(&has_arrived);
    let end = drive(solver, until, |solver| {
        steps += 1;
        see(solver);
        let event = solver.event();
        let failed = matches!(event.outcome, Outcome::Failed(_));
        if at.is(event) {
            ControlFlow::Break(Ok(()))
        } else if at.is_past(event) && !failed {
            ControlFlow::Break(Err(SeekFailure::Absent))
        } else {
            ControlFlow::Continue(())
        }
    });
    match end {
        Err(_) if has_arrived() => Err(SeekFailure::Interrupted),
        Err(lost) => Err(SeekFailure::Lost(lost)),
        Ok(RunEnd::Interrupted) => Err(SeekFailure::Interrupted),
        Ok(RunEnd::Stopped(place)) => place.map(|()| steps),
        Ok(RunEnd::Failed(failure)) => Err(SeekFailure::Failed(failure)),
        Ok(RunEnd::Finished | RunEnd::Spent) => Err(SeekFailure::Absent),
    }
}

pub fn missed(scene: &Scene, solver: &dyn Solver, at: RunPosition, why: SeekFailure) -> Error {
    let (event, name) = (solver.event(), &scene.name);
    let (exit, text) = match why {
        SeekFailure::Failed(failure) => {
            let (at_event, load) = (event.position, event.load_factor);
            let text = report::failure(&scene.model, solver.state(), at_event, load, &failure);
            (Exit::Unconverged, format!("{at} not reached: {text}"))
        }
        SeekFailure::Lost(lost) => (Exit::Unconverged, format!("{at} not reached: {lost}")),
        SeekFailure::Interrupted => {
            let reached = names::position(event.position);
            (Exit::Interrupted, format!("interrupted after {reached}"))
        }
        SeekFailure::Absent => {
            let reached = report::outcome(&scene.model, event);
            (Exit::Bad, format!("no position {at}: {reached}"))
        }
    };
    Error::ended(exit, name, text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_parse_as_they_print() {
        for text in ["7", "12.2", "12.2.3"] {
            assert_eq!(text.parse::<RunPosition>().unwrap().to_string(), text);
        }
        for text in ["", "0", "1.0", "1.2.3.4", "1.", "-1", "a", "99999999999"] {
            assert!(text.parse::<RunPosition>().is_err(), "{text}");
        }
    }
}
