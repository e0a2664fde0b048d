//! What the solver says about a state: now, some minor iterations on, or at the end of the increment.

use super::refusal::Unknown;
use crate::contact::record::ContactRecord;
use crate::history::frame::Frame;
use crate::interface::census::census;
use crate::interface::minor_history::Cycle;
use crate::model::{Mode, Model};
use crate::step::drive::{RunEnd, Until};
use crate::step::event::{Event, Failure, Outcome};
use crate::step::stepper::Stepper;
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Minor iterations after which an increment counts as endless.
const ENDLESS: u32 = 20_000;

/// A frame of the history, and the scene that it belongs to.
#[derive(Debug, Clone)]
pub struct Look {
    /// The scene's model.
    pub model: Arc<Model>,
    /// The iteration that is looked at.
    pub frame: Frame,
}

/// How an increment ends.
#[derive(Debug, Clone, PartialEq)]
pub struct IncrementEnd {
    /// Minor iterations to there.
    pub minors: u32,
    /// Whether it is accepted.
    pub accepted: bool,
    /// The cycle that ends it, if one does.
    pub cycle: Option<Cycle>,
}

impl Look {
    /// This frame, after so many minor iterations more.
    ///
    /// # Errors
    /// Where the history is done before.
    pub fn ahead(&self, minors: u32) -> Result<Look, Unknown> {
        let mut look = self.clone();
        if minors == 0 {
            return Ok(look);
        }
        let mut stepper = self.stepper();
        let until = Until::end().minors(minors.into()).past_failures();
        let end = stepper.drive(until, |_| ControlFlow::<Infallible>::Continue(()));
        if end == RunEnd::Finished {
            return Err(Unknown::Done);
        }
        look.frame.event = Some(Arc::new(stepper.event().clone()));
        look.frame.state = stepper.state().clone();
        look.frame.intervention = None;
        Ok(look)
    }

    /// How this increment ends, if nobody interferes.
    ///
    /// # Errors
    /// Where it does not within reason.
    pub fn end(&self) -> Result<IncrementEnd, Unknown> {
        let mut stepper = self.stepper();
        let mut minors = 0;
        let end = stepper.drive(Until::end().minors(ENDLESS.into()), |stepper| {
            minors += 1;
            match stepper.event().outcome {
                Outcome::Increment { .. } => ControlFlow::Break(()),
                _ => ControlFlow::Continue(()),
            }
        });
        let (accepted, cycle) = match end {
            RunEnd::Stopped(()) => (true, None),
            RunEnd::Failed(Failure::Cycle(cycle)) => (false, Some(cycle)),
            RunEnd::Failed(_) => (false, None),
            RunEnd::Finished | RunEnd::Interrupted => return Err(Unknown::Done),
            RunEnd::Spent => return Err(Unknown::Endless(ENDLESS)),
        };
        Ok(IncrementEnd {
            minors,
            accepted,
            cycle,
        })
    }

    /// Consistent states of the frozen problem of this major iteration.
    ///
    /// # Errors
    /// Where the bodies cannot be condensed, or there are too many nodes for a census.
    pub fn answers(&self) -> Result<usize, Unknown> {
        let frozen = self.stepper().interface_problem();
        let frozen = frozen.ok_or(Unknown::NotCondensed)?;
        Ok(census(&frozen).map_err(Unknown::NoCensus)?.answers.len())
    }

    fn stepper(&self) -> Stepper {
        let mut stepper = Stepper::new(self.model.clone());
        stepper.restore(&self.frame.state);
        stepper
    }

    /// The minor iteration that led here.
    ///
    /// # Errors
    /// Where there is none.
    pub fn event(&self) -> Result<&Event, Unknown> {
        let event = self.frame.event.as_deref();
        event.ok_or(Unknown::Unsolved)
    }

    /// What it found at a slave node.
    ///
    /// # Errors
    /// Where there is none.
    pub fn record(&self, slave: usize) -> Result<&ContactRecord, Unknown> {
        let record = self.event()?.nodes.get(slave);
        record.ok_or(Unknown::Failed)
    }

    /// The mode that a slave node had in it; at the start the one that it starts with.
    pub fn before(&self, slave: usize) -> Mode {
        let record = self.record(slave);
        record.map_or(self.next(slave), |record| record.decision.before)
    }

    /// The mode that it takes next.
    pub fn next(&self, slave: usize) -> Mode {
        self.frame.state.nodes[slave].mode
    }
}
