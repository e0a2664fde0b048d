//! Accepts, restarts or damps increments.

use crate::model::least;
use crate::step::iterate::Iterate;
use crate::step::jump::AcceptanceNotes;
use crate::{Fallback, Mode, Norms, Outcome, Status, SubIncrement, Verdict};
use std::sync::Arc;

/// Minimum fraction of its load to which a major iteration is damped.
const SMALLEST_PART: f64 = 1e-6;

impl Iterate {
    /// Restarts the increment, up to the end of this part.
    pub(super) fn restart(&mut self, part: SubIncrement) {
        self.state.sub_increment = part;
        self.drop_factors();
        self.state.start_again();
        self.forget_workspace();
    }

    /// Restarts the minor iterations of this major iteration with half the load; false if the remaining load is too small.
    pub(super) fn damp(&mut self) -> bool {
        if self.state.way.is_some() {
            return false;
        }
        let left = self.state.major.target - self.state.major.last_target;
        let whole = self.state.load_factor - self.state.start.load_factor;
        let target = self.state.major.last_target + left / 2.0;
        // A damped motion keeps its load, and the rest of a small increment may be round-off: no half is left then.
        if left.abs() < SMALLEST_PART * whole.abs() || target == self.state.major.target {
            return false;
        }
        self.state.major.target = target;
        self.linearised = false;
        self.state.begin_again();
        true
    }

    /// Makes the current state the start of the next increment.
    pub(super) fn accept(
        &mut self,
        after: Norms,
        verdict: Verdict,
        landing: AcceptanceNotes,
    ) -> Outcome {
        let unsettled = self.state.attempt.unsettled;
        let leg = self.leg_reached();
        let bounded = self.go_along(leg);
        self.settle_contacts();
        let motion = self.state.recovery.motion.take();
        let found = self
            .state
            .recovery
            .fallback
            .map(|fallback| fallback.by)
            .filter(|by| *by != Fallback::Back);
        let stretch = self.deformation.map(|found| found.smallest.stretch);
        let left_range = self.take_range_left();
        let start = Arc::make_mut(&mut self.state.start);
        start.load_factor = self.state.load_factor;
        let turned = leg != start.leg;
        start.leg = leg;
        self.renew_start(verdict);
        let last = bounded || leg + 1 == self.model.path.len();
        if last {
            self.state.status = Status::Finished;
        } else {
            if turned && !self.model.increments.is_empty() {
                self.take_size(leg);
            }
            self.next_increment();
        }
        Outcome::Increment {
            after,
            unsettled,
            marked: landing.marked,
            jumped: landing.jumped,
            unstable: landing.unstable,
            motion,
            found,
            left_range,
            stretch,
            last,
        }
    }

    /// Stores the current displacements and contacts as the accepted ones.
    pub(super) fn renew_start(&mut self, verdict: Verdict) {
        let start = Arc::make_mut(&mut self.state.start);
        start.verdict = Some(verdict);
        self.source
            .accept(&self.state.u, &start.u, &mut start.history);
        Arc::make_mut(&mut start.u).copy_from_slice(&self.state.u);
        start.nodes.clone_from(&self.state.nodes);
    }

    /// Resets slip, and moves stick points to the accepted state.
    pub(super) fn settle_contacts(&mut self) {
        for (node, slave) in self.state.nodes.iter_mut().zip(&self.model.contacts) {
            (node.slip, node.left, node.kept) = (0.0, None, false);
            if node.mode == Mode::Sliding {
                node.anchor_at(node.spot, slave.bond.give()[1]);
                node.drift = 0.0;
            } else if node.corner.is_some() {
                node.anchor = node.spot;
            } else if node.mode == Mode::Free {
                (node.anchor, node.drift, node.stretched) = (None, 0.0, 0.0);
            }
        }
    }

    /// Leg of the path that the load factor has reached.
    fn leg_reached(&self) -> usize {
        let (path, mut leg) = (&self.model.path, self.state.start.leg);
        while leg + 1 < path.len() && self.state.load_factor == path[leg + 1] {
            leg += 1;
        }
        leg
    }

    /// Sets the increment size that the scene lists for a leg of the path.
    fn take_size(&mut self, leg: usize) {
        let controls = Arc::make_mut(&mut self.state.controls);
        controls.increment = self.model.on_leg(leg);
        controls.least = least(self.model.least, controls.increment);
    }

    fn next_increment(&mut self) {
        // The next increment starts with the stiffness at its own start, or with the last factors.
        let carries = self.keeps_factors() && self.state.start.history.is_empty();
        let stands = carries || self.drop_factors();
        let factored = self.state.major.factored.take();
        let next = &mut self.state.next;
        (next.increment, next.attempt) = (next.increment + 1, 1);
        let helped = self
            .state
            .recovery
            .fallback
            .take()
            .map(|fallback| fallback.by);
        if let Some(by) = helped.filter(|by| matches!(by, Fallback::Deeper | Fallback::Release)) {
            self.state.record.searched.adopted = Some(by);
        }
        self.state.record.searched.geometry |= helped == Some(Fallback::Geometry);
        self.state.record.searched.origin = None;
        let rest = self.state.sub_increment.next();
        self.state.sub_increment = rest.unwrap_or_else(|| {
            let (start, increment) = (&self.state.start, self.state.controls.increment);
            SubIncrement::whole(&self.model, start.place(), increment)
        });
        if rest.is_none() {
            self.state.recovery.cuts.clear();
        }
        self.state.begin();
        self.state.major.factored = factored;
        self.linearised = self.linearised && stands && self.source.aim(&self.state.at());
    }
}
