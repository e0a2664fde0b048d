//! Free mode: decisions of Table 2 are hidden until the user has predicted them.

use crate::action::{Action, HiddenDecisions, mode};
use crate::explain::names;
use crate::explain::report;
use crate::refusal::{Refusal, refusal};
use crate::{Command, Frame};
use std::collections::{BTreeMap, BTreeSet};
use stickslip_core::{Mode, Model};

/// Predictions, and which decisions are hidden.
#[derive(Debug, Clone)]
pub struct Guess {
    whose: HiddenDecisions,
    /// Frames up to this one have been seen.
    start: usize,
    seen: BTreeSet<usize>,
    /// The frame being predicted, and the nodes predicted so far.
    at: usize,
    said: BTreeMap<usize, Mode>,
    /// Predictions that were right.
    pub right: u32,
    /// Predictions that were wrong.
    pub wrong: u32,
}

impl Guess {
    /// Hides decisions after this frame.
    pub fn new(whose: HiddenDecisions, cursor: usize) -> Self {
        Guess {
            whose,
            start: cursor,
            seen: BTreeSet::new(),
            at: cursor,
            said: BTreeMap::new(),
            right: 0,
            wrong: 0,
        }
    }

    /// Whether this frame has a hidden decision.
    pub fn is_open(&self, cursor: usize, frame: &Frame) -> bool {
        let decided = frame
            .event
            .as_ref()
            .is_some_and(|event| !event.nodes.is_empty());
        decided
            && frame.intervention.is_none()
            && cursor > self.start
            && !self.seen.contains(&cursor)
    }

    /// Whether the decision at this slave node is hidden.
    pub fn hides(&self, cursor: usize, frame: &Frame, slave: usize) -> bool {
        let said = self.at == cursor && self.said.contains_key(&slave);
        self.is_open(cursor, frame) && !said
    }

    /// Checks whether an action is allowed: moving forward is not, while a decision is hidden. An intervention
    /// discards what was known about later frames.
    ///
    /// # Errors
    /// If something has to be predicted first.
    pub fn permits(
        &mut self,
        action: &Action,
        cursor: usize,
        frame: &Frame,
    ) -> Result<(), Refusal> {
        match action {
            Action::Session(Command::Forward { .. }) if self.is_open(cursor, frame) => Err(
                refusal!("predict first: a, then f free, s sliding, x fixed (p ends predicting)"),
            ),
            Action::Session(Command::Forward { .. } | Command::Back { .. }) => Ok(()),
            Action::Session(_) => {
                self.forget_after(cursor);
                Ok(())
            }
            Action::Ui(_) => Ok(()),
        }
    }

    /// Discards what was known about frames after an intervention.
    fn forget_after(&mut self, cursor: usize) {
        self.start = self.start.min(cursor);
        self.seen.retain(|frame| *frame <= cursor);
        // Frames seen before stay visible in any branch.
        if self.at > cursor {
            self.said.clear();
        }
    }

    /// Takes a prediction of a slave node's next mode. Returns the decision in words, and whether the
    /// prediction was right.
    ///
    /// # Errors
    /// If there is nothing to predict, or the word is not a mode.
    pub fn predict(
        &mut self,
        model: &Model,
        cursor: usize,
        frame: &Frame,
        slave: usize,
        word: &str,
    ) -> Result<(bool, String), Refusal> {
        let said = mode(word).ok_or_else(|| Refusal::no_mode(word))?;
        let event = frame.event.as_ref().filter(|_| self.is_open(cursor, frame));
        let Some(record) = event.and_then(|event| event.nodes.get(slave)) else {
            return Err(refusal!(
                "no decision is hidden here; step forward and predict the next one"
            ));
        };
        if self.at != cursor {
            self.at = cursor;
            self.said.clear();
        }
        if self.said.insert(slave, said).is_some() {
            return Err(refusal!(
                "{} has been predicted already",
                names::slave(model, slave)
            ));
        }
        let (next, reason) = (
            record.decision.next,
            report::reason(&record.decision, record.t_max != 0.0),
        );
        let right = said == next;
        self.right += u32::from(right);
        self.wrong += u32::from(!right);
        let nodes = event
            .into_iter()
            .flat_map(|event| event.nodes.iter().enumerate());
        let left = nodes
            .filter(|&(_, node)| node.decision.changes())
            .filter(|(slave, _)| !self.said.contains_key(slave));
        let more = self.whose == HiddenDecisions::Changed && left.count() > 0;
        if !more {
            self.seen.insert(cursor);
        }
        let verdict = if right { "right" } else { "no" };
        let more = if more { " Other nodes change too." } else { "" };
        Ok((
            right,
            format!("{verdict}: {}: {reason}{more}", names::slave(model, slave)),
        ))
    }
}
