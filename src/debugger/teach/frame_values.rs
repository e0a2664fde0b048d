//! Quantities of a state: now, some minor iterations later, or at the end of the increment.

use super::runs::Runs;
use crate::Frame;
use crate::history::strip::norms_after;
use crate::refusal::{Refusal, refusal};
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::Arc;
use stickslip_core::interface::census::census;
use stickslip_core::{
    ContactRecord, ContactState, Cycle, Event, Failure, InterfaceProblem, Intervention, Mode,
    Model, Outcome, RunEnd, Stability, Stepper, Trials, Until, Verdict, counted,
};

/// Why the interface is not known.
const NOT_CONDENSED: &str = "the bodies of this state cannot be condensed";
/// Why nothing follows.
const DONE: &str = "the history is complete";
/// Why there is no lag.
const NO_LAG: &str = "no T_max lags here";

/// Decimal digits of an increment to which the load of a change of mode is found.
const DIGITS: u32 = 4;

/// Number of minor iterations after which an increment counts as endless.
const ENDLESS: u32 = 20_000;

/// A frame of the history with its model.
#[derive(Debug, Clone)]
pub struct FrameValues {
    /// The scene's model.
    pub model: Arc<Model>,
    /// The shown iteration.
    pub frame: Frame,
    /// The runs of the lesson's chart, if it has one.
    pub runs: Option<Arc<Runs>>,
}

/// The end of an increment.
#[derive(Debug, Clone, PartialEq)]
pub struct IncrementEnd {
    /// Minor iterations until the end.
    pub minors: u32,
    /// Whether the increment is accepted.
    pub accepted: bool,
    /// The cycle that ends it, if there is one.
    pub cycle: Option<Cycle>,
    /// Number of major iterations of the increment, including earlier ones.
    pub majors: u32,
    /// Relative residuals: the latest one here, and those at the end of each later major iteration.
    pub residuals: Vec<f64>,
}

/// The condensed problem at a slave node while all others are free: with the forces F on the node, S* moves relative to
/// it by v = free − W F along n and t.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CondensedNode {
    /// Motion without forces (length).
    pub free: [f64; 2],
    /// Compliance W (length per force), by rows.
    pub compliance: [[f64; 2]; 2],
}

/// Only residuals below this are used for a rate of convergence; larger ones are far from the solution.
const NEAR: f64 = 1e-2;
const FAR: f64 = 1e-7;
/// Convergence counts as quadratic if a major iteration leaves less than this power of the residual.
const DOUBLING: f64 = 1.5;

impl IncrementEnd {
    /// Whether the residuals near the solution converge quadratically rather than linearly.
    ///
    /// # Errors
    /// If none are near the solution.
    pub fn is_quadratic(&self) -> Result<bool, Refusal> {
        let mut pairs = self
            .residuals
            .windows(2)
            .filter(|pair| (FAR..NEAR).contains(&pair[0]))
            .peekable();
        pairs.peek().ok_or_else(|| {
            refusal!("the residuals of the increment do not show a rate of convergence")
        })?;
        Ok(pairs.any(|pair| pair[1] < pair[0].powf(DOUBLING)))
    }
}

impl FrameValues {
    /// The frame after this many more minor iterations.
    ///
    /// # Errors
    /// If the history ends earlier.
    pub fn ahead(&self, minors: u32) -> Result<FrameValues, Refusal> {
        let mut look = self.clone();
        if minors == 0 {
            return Ok(look);
        }
        let mut stepper = self.stepper();
        let until = Until::end().minors(minors.into()).past_failures();
        let end = stepper.drive(until, |_| ControlFlow::<Infallible>::Continue(()));
        if end == RunEnd::Finished {
            return Err(Refusal::new(DONE));
        }
        look.frame.event = Some(Arc::new(stepper.event().clone()));
        look.frame.state = stepper.state().clone();
        look.frame.intervention = None;
        Ok(look)
    }

    /// How this increment ends without interventions.
    ///
    /// # Errors
    /// If it does not end within the limit.
    pub fn end(&self) -> Result<IncrementEnd, Refusal> {
        let mut stepper = self.stepper();
        let mut minors = 0;
        let (mut majors, mut residuals) = (0, Vec::new());
        residuals.extend(self.residual().ok());
        let end = stepper.drive(Until::end().minors(ENDLESS.into()), |stepper| {
            minors += 1;
            majors = stepper.event().position.major;
            residuals.extend(norms_after(&stepper.event().outcome).map(|after| after.relative));
            match stepper.event().outcome {
                Outcome::Increment { .. } => ControlFlow::Break(()),
                _ => ControlFlow::Continue(()),
            }
        });
        let (accepted, cycle) = match end {
            RunEnd::Stopped(()) => (true, None),
            RunEnd::Failed(Failure::Cycle(cycle)) => (false, Some(cycle)),
            RunEnd::Failed(_) => (false, None),
            RunEnd::Finished | RunEnd::Interrupted => {
                return Err(Refusal::new(DONE));
            }
            RunEnd::Spent => {
                return Err(refusal!(
                    "the increment does not end within {}",
                    counted(ENDLESS, "minor iteration")
                ));
            }
        };
        Ok(IncrementEnd {
            minors,
            accepted,
            cycle,
            majors,
            residuals,
        })
    }

    /// The judge's verdict on the last accepted increment.
    ///
    /// # Errors
    /// If no increment has been accepted.
    pub fn verdict(&self) -> Result<&Verdict, Refusal> {
        self.frame
            .state
            .start
            .verdict
            .as_ref()
            .ok_or_else(|| refusal!("no increment has been accepted yet"))
    }

    /// The latest relative residual: after the major iteration if it ended here, otherwise before it.
    ///
    /// # Errors
    /// If no iteration has been solved.
    pub fn residual(&self) -> Result<f64, Refusal> {
        let event = self.event()?;
        Ok(norms_after(&event.outcome)
            .unwrap_or(&event.before)
            .relative)
    }

    /// The factor by which a sliding node's lagged T_max approaches the value for its pressure in the next
    /// solve, or departs from it.
    ///
    /// # Errors
    /// If the node does not slide with a lagged T_max both now and after the next solve.
    pub fn lag(&self, slave: usize) -> Result<f64, Refusal> {
        let off = |look: &FrameValues| -> Result<f64, Refusal> {
            let record = look.record(slave)?;
            let slides = record.decision.before == Mode::Sliding;
            slides
                .then_some(record.t_max - record.t_max_used)
                .ok_or_else(|| Refusal::new(NO_LAG))
        };
        let lag = off(&self.ahead(1)?)? / off(self)?;
        Some(lag)
            .filter(|lag| lag.is_finite())
            .ok_or_else(|| Refusal::new(NO_LAG))
    }

    /// The runs of the lesson's chart.
    ///
    /// # Errors
    /// If the lesson has no chart.
    pub fn runs(&self) -> Result<&Runs, Refusal> {
        self.runs
            .as_deref()
            .ok_or_else(|| refusal!("this lesson has no chart: [\"PATH=A,B\"]"))
    }

    /// The number of consistent states of the frozen problem of this major iteration.
    ///
    /// # Errors
    /// If the bodies cannot be condensed, or there are too many nodes for a census.
    pub fn answers(&self) -> Result<usize, Refusal> {
        let frozen = self.frozen()?;
        Ok(census(&frozen).map_err(Refusal::new)?.answers.len())
    }

    /// Stability of the shown equilibrium under a constant load.
    pub fn stability(&self) -> Stability {
        self.stepper().stability()
    }

    /// The condensed problem of the next minor iteration at a slave node.
    ///
    /// # Errors
    /// If the bodies cannot be condensed, or a body is loose without contact.
    pub fn interface(&self, slave: usize) -> Result<CondensedNode, Refusal> {
        let frozen = self.frozen()?;
        let condensed = || {
            let at = frozen.nodes.iter().position(|node| node.slave == slave)?;
            let mut trials = Trials::new(&frozen)?;
            let free: Vec<_> = frozen.nodes.iter().map(|node| node.state).collect();
            let free = free.into_iter().map(|state| ContactState {
                mode: Mode::Free,
                ..state
            });
            let free = trials
                .solve_states(&free.collect::<Vec<_>>())?
                .get(at)?
                .motion;
            let [_, _, normal, tangential] = trials.answers_of(at)?;
            let row = |of: Vec<f64>| [-of[2 * at], -of[2 * at + 1]];
            Some(CondensedNode {
                free,
                compliance: [row(normal), row(tangential)],
            })
        };
        condensed().ok_or_else(|| Refusal::new(NOT_CONDENSED))
    }

    /// The load factor at which a slave node leaves its mode, by shorter and shorter increments: within a 10000th of the
    /// increment.
    ///
    /// # Errors
    /// If the node keeps its mode to the end of the history, or an increment fails.
    pub fn leaves(&self, slave: usize) -> Result<f64, Refusal> {
        let mut stepper = self.stepper();
        let mut state = self.frame.state.clone();
        let before = self.next(slave);
        let mut load = state.start.load_factor;
        let mut size = state.controls.increment;
        for _ in 0..=DIGITS {
            stepper.restore(&state);
            stepper
                .intervene(&Intervention::Increment(size))
                .map_err(|_| Refusal::new(DONE))?;
            let end = stepper.drive(Until::end().minors(ENDLESS.into()), |stepper| {
                if !stepper.event().outcome.is_accepted() {
                    return ControlFlow::Continue(());
                }
                let accepted = stepper.state();
                load = accepted.start.load_factor;
                if accepted.nodes[slave].mode != before {
                    return ControlFlow::Break(());
                }
                state = accepted.clone();
                ControlFlow::Continue(())
            });
            if !matches!(end, RunEnd::Stopped(())) {
                return Err(Refusal::new(DONE));
            }
            size /= 10.0;
        }
        Ok(load)
    }

    /// The frozen problem of this major iteration.
    fn frozen(&self) -> Result<InterfaceProblem, Refusal> {
        let frozen = self.stepper().interface_problem();
        frozen.ok_or_else(|| Refusal::new(NOT_CONDENSED))
    }

    fn stepper(&self) -> Stepper {
        let mut stepper = Stepper::new(self.model.clone());
        stepper.restore(&self.frame.state);
        stepper
    }

    /// The last minor iteration.
    ///
    /// # Errors
    /// If there is none.
    pub fn event(&self) -> Result<&Event, Refusal> {
        let event = self.frame.event.as_deref();
        event.ok_or_else(|| refusal!("no iteration has been solved yet"))
    }

    /// The record of a slave node in it.
    ///
    /// # Errors
    /// If there is none.
    pub fn record(&self, slave: usize) -> Result<&ContactRecord, Refusal> {
        let record = self.event()?.nodes.get(slave);
        record.ok_or_else(|| refusal!("the solve failed before this was known"))
    }

    /// The mode of a slave node in it; at the start, the initial mode.
    pub fn before(&self, slave: usize) -> Mode {
        let record = self.record(slave);
        record.map_or(self.next(slave), |record| record.decision.before)
    }

    /// The next mode of a slave node.
    pub fn next(&self, slave: usize) -> Mode {
        self.frame.state.nodes[slave].mode
    }
}
