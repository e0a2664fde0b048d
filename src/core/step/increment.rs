//! Increments: accepted, cut into halves, led round, damped, or failed.

use crate::contact::laws::{Finding, Verdict};
use crate::linear::norms::Norms;
use crate::linear::singular::Singular;
use crate::model::{BodyKind, Mode};
use crate::step::detour::{Detour, Way};
use crate::step::event::{Failure, Outcome};
use crate::step::state::Status;
use crate::step::stepper::Stepper;
use crate::step::sub_increment::SubIncrement;
use crate::strategy;
use std::sync::Arc;

/// Sums of halves of an increment are this exact.
const ROUNDING: f64 = 1e-9;
/// A major iteration is not damped below this part of its load.
const SMALLEST_PART: f64 = 1e-6;

impl Stepper {
    /// The increment fails; on the ladder it is cut, where that can help and it is not at its smallest yet.
    pub(super) fn fail(&mut self, why: Failure) -> Outcome {
        let cut = self.cut(&why).or_else(|| self.detour(&why));
        cut.unwrap_or(Outcome::Failed(why))
    }

    /// Whether an increment that failed so may succeed with another size.
    pub(super) fn size_helps(&self, why: &Failure) -> bool {
        match why {
            Failure::OverConstrained { .. } | Failure::RoundOff { .. } => false,
            Failure::Singular(Singular::Rigid { .. }) => !self.starts_loose(),
            _ => true,
        }
    }

    /// Starts the increment again with half its size. `None` where the strategy does not cut, where that cannot help, and
    /// where the increment is at its smallest.
    pub(super) fn cut(&mut self, why: &Failure) -> Option<Outcome> {
        let controls = &self.state.controls;
        let helps = self.size_helps(why);
        let half = self.state.sub_increment.halved();
        let least = controls.least * (1.0 - ROUNDING);
        if strategy::rungs(controls.settings.strategy).is_empty()
            || !helps
            || half.size() < least
            || half.size() == 0.0
        {
            return if helps { self.leap_over(why) } else { None };
        }
        self.restart(half);
        let (why, size) = (why.clone(), half.size());
        Some(Outcome::Cut { why, size })
    }

    /// Starts the increment again on the next detour. `None` where the strategy cuts nothing, where smaller increments cannot
    /// help, where all detours have been tried, and where all bodies are given by numbers: what fails there is the
    /// interface problem itself, of which the ladder has tried all that it knows.
    pub(super) fn detour(&mut self, why: &Failure) -> Option<Outcome> {
        let state = &self.state;
        let chosen = &state.controls.settings;
        if strategy::rungs(chosen.strategy).is_empty()
            || matches!(why, Failure::Leapt { .. }) && state.detour.is_none()
            || !self.size_helps(why)
            || self.is_given()
        {
            return None;
        }
        let last = state.detour.map(|way| way.by);
        let from = state.detour.map_or(state.sub_increment, |way| way.from);
        let by = Detour::after(last, chosen)?;
        let start = state.start.load_factor;
        let part = match by {
            Detour::Section => from.rest(start).section(),
            Detour::Back => from,
            _ => from.rest(start),
        };
        self.state.detour = Some(Way { by, from });
        self.restart(part);
        let (why, size) = (why.clone(), part.size());
        Some(Outcome::Detour { why, by, size })
    }

    /// Whether all bodies are given by numbers.
    fn is_given(&self) -> bool {
        let mut bodies = self.model.bodies.iter();
        bodies.all(|body| matches!(body.kind, BodyKind::Linear(_)))
    }

    /// Starts the increment again, up to the end of this part.
    pub(super) fn restart(&mut self, part: SubIncrement) {
        self.state.sub_increment = part;
        self.state.start_again();
        self.forget_workspace();
    }

    /// Whether nothing holds a body in the modes that the increment starts with, whatever its size.
    fn starts_loose(&self) -> bool {
        let found = self.source.explain(&self.state.start.nodes);
        matches!(found, Singular::Rigid { .. })
    }

    /// Starts the minor iterations of this major one again, with half the load; false if too little is left of it.
    pub(super) fn damp(&mut self) -> bool {
        let left = self.state.target - self.state.last_target;
        let whole = self.state.load_factor - self.state.start.load_factor;
        if left.abs() < SMALLEST_PART * whole.abs() {
            return false;
        }
        self.state.target = self.state.last_target + left / 2.0;
        self.linearised = false;
        self.begin_again();
        true
    }

    /// Makes the present state the start of the next increment.
    pub(super) fn accept(
        &mut self,
        after: Norms,
        verdict: Verdict,
        marked: Option<Finding>,
        jumped: bool,
    ) -> Outcome {
        let unsettled = self.state.unsettled;
        self.settle_contacts();
        let leg = self.leg_reached();
        let start = Arc::make_mut(&mut self.state.start);
        start.load_factor = self.state.load_factor;
        start.leg = leg;
        start.verdict = Some(verdict);
        self.source
            .accept(&self.state.u, &start.u, &mut start.history);
        Arc::make_mut(&mut start.u).copy_from_slice(&self.state.u);
        start.nodes.clone_from(&self.state.nodes);
        let last = leg + 1 == self.model.path.len();
        if last {
            self.state.status = Status::Finished;
        } else {
            self.next_increment();
        }
        Outcome::Increment {
            after,
            unsettled,
            marked,
            jumped,
            last,
        }
    }

    /// Slip is counted from here on, and stick points are those of the accepted state.
    fn settle_contacts(&mut self) {
        for node in &mut self.state.nodes {
            (node.slip, node.left, node.kept) = (0.0, None, false);
            if node.mode == Mode::Sliding {
                (node.anchor, node.drift) = (node.spot, 0.0);
            } else if node.corner.is_some() {
                node.anchor = node.spot;
            } else if node.mode == Mode::Free {
                (node.anchor, node.drift) = (None, 0.0);
            }
        }
    }

    /// The leg of the path that the load factor has come to.
    fn leg_reached(&self) -> usize {
        let (path, mut leg) = (&self.model.path, self.state.start.leg);
        while leg + 1 < path.len() && self.state.load_factor == path[leg + 1] {
            leg += 1;
        }
        leg
    }

    fn next_increment(&mut self) {
        let next = &mut self.state.next;
        (next.increment, next.attempt) = (next.increment + 1, 1);
        let whole = || {
            let (start, increment) = (&self.state.start, self.state.controls.increment);
            SubIncrement::whole(&self.model, start.place(), increment)
        };
        self.state.detour = None;
        self.state.sub_increment = self.state.sub_increment.next().unwrap_or_else(whole);
        self.state.begin();
        self.linearised = self.linearised && self.source.aim(&self.state.at());
    }
}
