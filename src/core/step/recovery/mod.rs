//! Recoveries: ways to retry a failed increment.
//!
//! A recovery examines a failure and the failed state, and may propose how to restart the increment. They are asked in this
//! order; the first proposal is used.
//!
//! ```text
//! major iteration      frozen      the ladder again, with the contact geometry frozen in the tangent (`search`)
//! damped motion        Slower      the step again, with more viscosity
//! along a path         Turn        behind the corner of the path at which the increment starts
//!                      ShorterArc  half the arc, or the arc to the next corner
//!                      TurnAtLast  at the minimum arc: behind the first corner where contacts changed
//! at a given load      Halve       half the increment
//!                      Whole       the whole increment, if the halves that check it for a jump have failed
//!                      Release     constant loads: a damped motion to the next equilibrium
//! then, at any size    Fallback    other parts, other interpretations of the laws, sliding held back, and the search
//! ([`fallback`])
//! ```
//!
//! The increment fails if a node causes the failure of more than 300 of its parts: the state of that node does not depend on the
//! size. Of the search, only the contact geometry in the tangent is tried then, with as many cuts again.

mod cut;
mod damped;
mod fall_back;
pub mod fallback;
pub mod left_out;
pub mod motion;
mod path_corner;
pub mod proximal;
mod retry;
mod slip_step;
mod stalled;
mod whole;

pub(super) use slip_step::PATIENCE;

use crate::step::iterate::Iterate;
use crate::{Failure, Mode, Model, Outcome, Source, State, Stepper};
use fallback::Fallback;
use left_out::OmittedStep;
use proximal::SlipStiffness;
use retry::{Effect, Recovery, Retry};
use stalled::FailedIncrement;
use std::sync::Arc;

/// Maximum number of cuts of a whole increment because of the same node, before the increment fails.
const MOST_CUTS: u32 = 300;

/// Name of the major iteration that the ladder repeats without the change of the contact geometry.
pub(super) const FROZEN: &str = "frozen";

const MOVING: [&dyn Recovery; 1] = [&damped::SlowerMotion];
const ALONG: [&dyn Recovery; 3] = [
    &path_corner::CornerRestart,
    &cut::ShorterArc,
    &path_corner::LastCornerRestart,
];
const LOADED: [&dyn Recovery; 3] = [&cut::IncrementCut, &whole::WholeIncrement, &damped::Release];
const FALLBACKS: [&dyn Recovery; 9] = [
    &Fallback::Touching,
    &Fallback::Section,
    &Fallback::Consistent,
    &Fallback::Start,
    &Fallback::Held,
    &Fallback::Geometry,
    &Fallback::Deeper,
    &Fallback::Release,
    &Fallback::Back,
];

/// Names of all recoveries, in the order in which they are tried.
pub fn names() -> impl Iterator<Item = &'static str> {
    let lists: [&[&dyn Recovery]; 4] = [&MOVING, &ALONG, &LOADED, &FALLBACKS];
    let listed = lists.into_iter().flatten().map(|recovery| recovery.name());
    [FROZEN].into_iter().chain(listed)
}

impl Stepper {
    /// Disables a recovery or a strategy, to find out whether a scene needs it. This is not part of the state.
    pub fn leave_out(&mut self, left_out: OmittedStep) {
        self.left_out = Some(left_out);
    }

    /// Restarts the increment if a recovery applies; otherwise it fails.
    pub(super) fn fail(&mut self, mut why: Failure) -> Outcome {
        if let Failure::LadderEnded { scales, .. } = &mut why {
            *scales = self.now.stalled().scales();
        }
        if let Some(stop) = self.now.state.cut_too_often(&why) {
            // Smaller parts or a motion that helped came after the geometry, which had not.
            let helped = self.now.state.record.searched.adopted.is_some();
            let again = (!helped).then(|| self.recover(&[&Fallback::Geometry], &why));
            return again.flatten().unwrap_or(Outcome::Failed(stop));
        }
        let again = self.cut(&why).or_else(|| self.fall_back(&why));
        again.unwrap_or(Outcome::Failed(why))
    }

    /// Restarts the increment with another size. `None` if no recovery applies.
    pub(super) fn cut(&mut self, why: &Failure) -> Option<Outcome> {
        let state = &self.now.state;
        let recoveries: &[&dyn Recovery] = match (&state.recovery.motion, &state.way) {
            (Some(_), _) => &MOVING,
            (None, Some(_)) => &ALONG,
            (None, None) => &LOADED,
        };
        self.recover(recoveries, why)
    }

    /// Restarts the increment with the next fallback: first the one of the search that helped last. `None` if none applies.
    pub(super) fn fall_back(&mut self, why: &Failure) -> Option<Outcome> {
        let adopted = self.now.state.record.searched.adopted;
        let again = adopted
            .filter(|_| self.now.state.recovery.fallback.is_none())
            .and_then(|by| self.recover(&[&by], why));
        again.or_else(|| self.recover(&FALLBACKS, why))
    }

    fn recover(&mut self, recoveries: &[&dyn Recovery], why: &Failure) -> Option<Outcome> {
        let left_out = self.left_out;
        let kept =
            |recovery: &&&dyn Recovery| Some(OmittedStep::Recovery(recovery.name())) != left_out;
        recoveries.iter().filter(kept).find_map(|recovery| {
            let retry = recovery.propose(why, &self.now.stalled())?;
            self.now.try_again(retry)
        })
    }
}

impl Iterate {
    /// The state of a failed increment, for the recoveries.
    pub(super) fn stalled(&self) -> FailedIncrement<'_> {
        let source: &dyn Source = &*self.source;
        let model: &Model = &self.model;
        FailedIncrement {
            model,
            state: &self.state,
            source,
        }
    }

    /// Restarts the increment. `None` if a damped motion cannot start.
    pub(super) fn try_again(&mut self, retry: Retry) -> Option<Outcome> {
        let Retry {
            part,
            effect,
            outcome,
        } = retry;
        let state = &mut self.state;
        let mut by = None;
        match effect {
            Effect::Cut(slave) => {
                if let Some(slave) = slave {
                    *state.recovery.cuts.entry(slave).or_default() += 1;
                }
            }
            Effect::Path(way) => state.way = Some(way),
            Effect::Whole => (state.record.pace.suspect, state.record.pace.over) = (None, true),
            Effect::Release => self.release(part)?,
            Effect::Motion(motion) => state.recovery.motion = Some(motion),
            Effect::Fallback(fallback) => {
                by = Some(fallback.by);
                state.recovery.fallback = Some(fallback);
            }
        }
        if let Some(by) = by {
            self.state.leave_motion();
            self.state
                .record
                .searched
                .adopted
                .take_if(|adopted| *adopted != by);
        }
        if by == Some(Fallback::Touching) {
            self.hold_near();
        }
        if by == Some(Fallback::Release) {
            self.state.record.searched.released = Some(self.state.start.load_factor);
            self.state.record.searched.origin = Some(self.state.start.clone());
            self.release(part)?;
        } else {
            self.restart(part);
        }
        if by == Some(Fallback::Held) {
            self.state.recovery.brake = Some(SlipStiffness::new(self.source.spring()));
        }
        Some(outcome)
    }

    /// Makes the near free contacts start closed: sliding without friction, otherwise fixed.
    fn hold_near(&mut self) {
        let near: Vec<usize> = self.stalled().near().collect();
        let start = Arc::make_mut(&mut self.state.start);
        for contact in near {
            let smooth = self.state.controls.friction[contact].is_smooth();
            start.nodes[contact].mode = if smooth { Mode::Sliding } else { Mode::Fixed };
        }
    }
}

impl State {
    /// Failure of an increment that was cut [`MOST_CUTS`] times because of the same node: each part is accepted, and the next part
    /// fails at the same node. With the contact geometry in the tangent by the search, it is twice that number.
    pub(super) fn cut_too_often(&self, why: &Failure) -> Option<Failure> {
        let slave = why.culprit()?;
        let cuts = *self.recovery.cuts.get(&slave)?;
        let fallback = self.recovery.fallback.map(|route| route.by);
        let geometry = self.record.searched.geometry || fallback == Some(Fallback::Geometry);
        let most = if geometry { 2 * MOST_CUTS } else { MOST_CUTS };
        (cuts >= most).then(|| Failure::CutTooOften {
            slave,
            cuts,
            last: Box::new(why.clone()),
        })
    }

    /// Returns from a damped motion of the search to its start.
    fn leave_motion(&mut self) {
        if let Some(origin) = self.record.searched.origin.take() {
            (self.start, self.recovery.motion) = (origin, None);
        }
    }
}
