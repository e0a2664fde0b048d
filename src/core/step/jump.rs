//! Jumps: an increment that passes a limit point ends on another branch of equilibrium, far from its start, and its end state
//! alone does not reveal it.
//!
//! A jump is a motion that does not shrink as the increment is halved. An increment is suspected if it moves more than expected
//! ([`crate::step::pace`]) or ends in an unstable state ([`crate::step::watch`]); the ladder then tries its halves, down to the
//! least increment. A smooth motion shrinks in proportion to the increment, and with its square root where the tangent only
//! softens. The motion of a jump hardly shrinks: only the part before the jump gets smaller. A motion that has shrunk by less
//! than the fourth root is a jump, and the increment is accepted and marked. Motions due to a change of modes, to a node that
//! opens, slides or touches, or to the onset of a load do shrink. If increments are not cut, suspected increments are marked.
//!
//! A fallback ([`crate::step::recovery::fallback`]) must not jump: a state on another branch does not replace halves that failed,
//! and the load at which a structure jumps must not depend on the increment. Only held-back sliding may, and longer increments,
//! which skip loads and are always marked.
//!
//! Near a limit point the halves may have no equilibrium although the whole increment has one beyond it. If the halves fail, the
//! suspected increment is taken as a whole, and is a jump if it still moves more than expected.

use crate::model::Jumps;
use crate::step::iterate::Iterate;
use crate::step::pace::SuspectIncrement;
use crate::step::watch::FAR;
use crate::strategy;
use crate::{
    Failure, Fallback, Finding, Norms, Outcome, Pace, Stability, StabilityLoss, Stepper, Verdict,
};

/// Motions below this fraction of the scene's length are not jumps: round-off can be as large.
const NOTHING: f64 = 1e-9;

/// Reservations with which a state is accepted.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct AcceptanceNotes {
    /// Law that the state violates.
    pub marked: Option<Finding>,
    /// Whether the increment leaves the branch of stable equilibrium.
    pub jumped: bool,
    /// Loss of stability: set if the state is unstable and the start state was not known to be unstable.
    pub unstable: Option<StabilityLoss>,
}

/// Motion of an increment and the data to judge it.
#[derive(Clone, Copy)]
struct IncrementMotion {
    /// Largest displacement (length).
    motion: f64,
    /// Load factors at its start and end.
    span: [f64; 2],
    /// Record of the whole increment when it was first suspected; of this increment if it was not suspected before.
    suspect: SuspectIncrement,
    /// Whether the motion exceeds the expected motion.
    exceeds: bool,
    /// Stability of the end state, if it was checked.
    found: Option<Stability>,
}

impl AcceptanceNotes {
    /// A landing that violates this law, if any, without other reservations.
    pub fn marked(marked: Option<Finding>) -> Self {
        AcceptanceNotes {
            marked,
            ..AcceptanceNotes::default()
        }
    }
}

impl IncrementMotion {
    fn size(&self) -> f64 {
        (self.span[1] - self.span[0]).abs()
    }

    /// Whether this is a part of a suspected increment whose motion has shrunk like a smooth motion.
    fn follows(&self) -> bool {
        let size = self.size();
        self.suspect.size > size && !self.suspect.jumps(self.motion, size)
    }
}

impl Stepper {
    /// Accepts a state that satisfies the laws or is `marked` with a violation; cuts the increment instead if it may have jumped.
    pub(super) fn land(
        &mut self,
        after: Norms,
        verdict: Verdict,
        marked: Option<Finding>,
    ) -> Outcome {
        if self.now.state.way.is_some() {
            return self.land_on_way(after, verdict, marked);
        }
        let (mut trip, why) = self.now.trip();
        let mut landing = AcceptanceNotes {
            unstable: self.now.state.record.watch.loss(trip.found),
            ..AcceptanceNotes::marked(marked)
        };
        let cuts = matches!(self.now.model.jumps, Jumps::Cut | Jumps::Stop);
        if trip.exceeds || landing.unstable.is_some() && cuts {
            // A state that violates a law is marked, not cut.
            if landing.marked.is_none()
                && let Some(tried) = self.try_parts(&trip, &why)
            {
                return tried;
            }
            landing.jumped = trip.exceeds && (self.now.state.record.pace.over || !trip.follows());
            let found = trip.found.unwrap_or_else(|| self.now.look());
            trip.found = Some(found);
            landing.unstable = self.now.state.record.watch.loss(trip.found);
        }
        // It may skip loads without equilibrium.
        let fallback = self.now.state.recovery.fallback;
        landing.jumped |= fallback.is_some_and(|route| route.by == Fallback::Longer);
        self.now.touch_down(after, verdict, landing, &trip)
    }

    /// Cuts an increment that may have jumped, or fails if jumps are not allowed. `None` if the increment is accepted.
    fn try_parts(&mut self, trip: &IncrementMotion, why: &Failure) -> Option<Outcome> {
        let (jumps, size) = (self.now.model.jumps, trip.size());
        let smallest = size <= self.now.state.controls.least;
        if jumps == Jumps::Dynamic && smallest && trip.follows() {
            return None;
        }
        if jumps != Jumps::Accept
            && self.now.state.recovery.fallback.is_some_and(|route| {
                !matches!(route.by, Fallback::Held | Fallback::Longer | Fallback::Back)
            })
        {
            self.now.state.next_major();
            return Some(self.fail(why.clone()));
        }
        if jumps == Jumps::Accept || self.now.state.record.pace.over {
            return None;
        }
        if let Some(cut) = self.cut(why) {
            self.now.state.record.pace.suspect = Some(trip.suspect);
            return Some(cut);
        }
        let ends = matches!(jumps, Jumps::Stop | Jumps::Dynamic);
        if !ends || trip.exceeds && trip.follows() {
            return None;
        }
        self.now.state.next_major();
        Some(Outcome::Failed(why.clone()))
    }
}

impl Iterate {
    /// Motion of the current increment, and the failure to report if the motion is too large.
    fn trip(&mut self) -> (IncrementMotion, Failure) {
        let state = &self.state;
        let span = [state.start.load_factor, state.load_factor];
        let motion = self.source.moved(&state.u, &state.start.u);
        let expected = state.record.pace.expected(&self.model, span);
        let length = self.model.length;
        let cuts = !strategy::rungs(state.controls.settings.strategy).is_empty()
            && self.model.jumps != Jumps::Accept;
        let far = motion > FAR * length;
        let sudden = motion > NOTHING * length && expected.is_exceeded(motion, cuts);
        let exceeds = sudden || far && self.stalled().can_move();
        let (majors, cost) = (state.next.major, self.source.stability_cost());
        let looks = !exceeds && (far || state.record.watch.is_due(majors, cost));
        let here = SuspectIncrement {
            motion,
            size: (span[1] - span[0]).abs(),
            sub_increment: state.sub_increment,
        };
        let suspect = state.record.pace.suspect.unwrap_or(here);
        let found = looks.then(|| self.look());
        let unstable = self
            .state
            .record
            .watch
            .loss(found)
            .map(|loss| loss.stability);
        let why = Failure::BranchJump {
            motion,
            predicted: expected.least(),
            unstable,
        };
        let trip = IncrementMotion {
            motion,
            span,
            suspect,
            exceeds,
            found,
        };
        (trip, why)
    }

    /// Checks the stability of the state that is about to be accepted.
    fn look(&mut self) -> Stability {
        self.source.stability(&self.state.at())
    }

    /// Accepts the state.
    fn touch_down(
        &mut self,
        after: Norms,
        verdict: Verdict,
        mut landing: AcceptanceNotes,
        trip: &IncrementMotion,
    ) -> Outcome {
        let (state, model) = (&mut self.state, &self.model);
        state
            .record
            .watch
            .take(trip.span[1], state.next.major, trip.found);
        if landing.jumped {
            // The pace of the previous branch does not apply to the new branch.
            state.record.pace = Pace::default();
        } else if trip.size() > 0.0 {
            state.record.pace.take(model, trip.motion, trip.span);
        }
        landing.jumped |= landing.unstable.is_some();
        self.accept(after, verdict, landing)
    }
}
