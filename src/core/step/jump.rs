//! Jumps: where the loads pass a limit point, the increment that does so ends on another branch of equilibrium, far from where
//! it began, and nothing in that state says so.
//!
//! A jump is a motion that does not shrink as the increment is halved. So an increment that moves beyond [`RATIO`](crate::step::pace::RATIO) times
//! what is expected of it is suspected, and the ladder tries its halves: it is cut, down to the least increment. What is
//! expected is the motion of its first major iteration, with the tangent of its start, and that of the fastest increment
//! so far; at a limit point the tangent itself is soft, and predicts anything. Smooth motion shrinks with the
//! increment, and where a tangent only goes soft with its square root. Of a jump all is left but the part that led there; what
//! has shrunk by less than the fourth root is one, and is accepted marked. A change of modes, a node that opens
//! or slides or touches, or a load that sets in, shrinks.
//!
//! A way round ([`crate::step::detour`]) must not jump: what lies on another branch is no answer to halves that fail, and where a
//! structure lets go may not depend on the increment.
//!
//! Near a limit point the halves may have no end at all, where the whole increment has one beyond. Where they fail, the suspected
//! increment is taken whole after all, and is a jump if it still moves beyond what is expected.

use crate::contact::laws::Verdict;
use crate::linear::norms::Norms;
use crate::model::Jumps;
use crate::step::detour::{Detour, Route};
use crate::step::event::{Failure, Outcome};
use crate::step::pace::{Pace, Suspect};
use crate::step::stepper::Stepper;
use crate::strategy;

/// Motions below this part of the scene's length are no jumps: round-off makes as much of them.
const NOTHING: f64 = 1e-9;
/// Before a damped motion is to follow, no increment moves beyond this part of the scene's length without its halves being
/// looked at: on its way it may have passed a limit point.
const LONGEST: f64 = 0.03;

impl Stepper {
    /// Accepts a state that the judge finds right, or cuts the increment where it may have jumped.
    pub(super) fn land(&mut self, after: Norms, verdict: Verdict) -> Outcome {
        let state = self.state();
        let size = (state.load_factor - state.start.load_factor).abs();
        let motion = self.source.moved(&state.u, &state.start.u);
        let looks = !strategy::rungs(state.controls.settings.strategy).is_empty();
        let far = self.can_move() && motion > LONGEST * self.model().length;
        let sudden = looks && motion > NOTHING * self.model().length;
        let beyond = far || sudden && state.pace.is_exceeded(motion, size);
        if !beyond {
            return self.settle(after, verdict, motion / size);
        }
        let jumps = self.model().jumps;
        let here = Suspect {
            motion,
            size,
            sub_increment: state.sub_increment,
        };
        let suspect = state.pace.suspect.unwrap_or(here);
        let why = Failure::Leapt {
            motion,
            predicted: state.pace.expected(size),
        };
        if jumps == Jumps::Dynamic
            && size <= state.controls.least
            && suspect.size > size
            && !suspect.jumps(motion, size)
        {
            return self.settle(after, verdict, motion / size);
        }
        let round = |route: Route| !matches!(route.by, Detour::Held | Detour::Back);
        if jumps != Jumps::Accept && self.state.detour.is_some_and(round) {
            self.next_major();
            return self.fail(why);
        }
        if jumps != Jumps::Accept && !self.state.pace.over {
            if let Some(cut) = self.cut(&why) {
                self.state.pace.suspect = Some(suspect);
                return cut;
            }
            if suspect.size > size && !suspect.jumps(motion, size) {
                return self.settle(after, verdict, motion / size);
            }
            if matches!(jumps, Jumps::Stop | Jumps::Dynamic) {
                self.next_major();
                return Outcome::Failed(why);
            }
        }
        // The other branch has a pace of its own.
        self.state.pace = Pace::default();
        #[cfg(mutants)]
        if crate::mutants::is_active("jump-unmarked") {
            return self.accept(after, verdict, None, false);
        }
        self.accept(after, verdict, None, true)
    }

    /// Takes an increment whole whose halves have failed that were to tell whether it jumps.
    pub(super) fn leap_over(&mut self, why: &Failure) -> Option<Outcome> {
        let rungs = strategy::rungs(self.state.controls.settings.strategy);
        let cuts = !rungs.is_empty() && self.model().jumps == Jumps::Cut;
        if !cuts || matches!(why, Failure::Leapt { .. }) {
            return None;
        }
        let suspect = self.state.pace.suspect.take()?;
        self.state.pace.over = true;
        self.restart(suspect.sub_increment);
        let size = (self.state.load_factor - self.state.start.load_factor).abs();
        let why = why.clone();
        Some(Outcome::Leaps { why, size })
    }

    /// Accepts a state that is no jump.
    fn settle(&mut self, after: Norms, verdict: Verdict, rate: f64) -> Outcome {
        let pace = &mut self.state.pace;
        if rate.is_finite() {
            pace.fastest = pace.fastest.max(rate);
        }
        if self.state.sub_increment.next().is_none() {
            (pace.suspect, pace.over) = (None, false);
        }
        self.accept(after, verdict, None, false)
    }
}
