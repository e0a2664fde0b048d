//! Jumps: where the loads pass a limit point, the increment that does so ends on another branch of equilibrium, far from where
//! it began, and nothing in that state says so.
//!
//! A jump is a motion that does not shrink as the increment is halved. So an increment that moves beyond [`RATIO`] times
//! what is expected of it is suspected, and the ladder tries its halves: it is cut, down to the least increment. What is
//! expected is the motion of its first major iteration, with the tangent of its start, and that of the fastest increment
//! so far; at a limit point the tangent itself is soft, and predicts anything. Smooth motion shrinks with the
//! increment, and where a tangent only goes soft with its square root. Of a jump all is left but the part that led there; what
//! has shrunk by less than the fourth root is one, and is accepted marked. A change of modes, a node that opens
//! or slides or touches, or a load that sets in, shrinks.
//!
//! Near a limit point the halves may have no end at all, where the whole increment has one beyond. Where they fail, the suspected
//! increment is taken whole after all, and is a jump if it still moves beyond what is expected.

use crate::contact::laws::Verdict;
use crate::linear::norms::Norms;
use crate::model::Jumps;
use crate::step::event::{Failure, Outcome};
use crate::step::stepper::Stepper;
use crate::step::sub_increment::SubIncrement;
use crate::strategy;
use serde::{Deserialize, Serialize};

/// How many times what is expected an increment may move without being suspected.
pub const RATIO: f64 = 4.0;
/// The same where the halves of a suspected increment have failed: there is less doubt.
const RATIO_OVER: f64 = 2.0;
/// Motions below this part of the scene's length are no jumps: round-off makes as much of them.
const NOTHING: f64 = 1e-9;

/// What is known of how fast the scene moves.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Pace {
    /// Largest displacement of the present attempt's first major iteration.
    pub predicted: f64,
    /// Largest displacement over size of the accepted increments since the last jump.
    pub fastest: f64,
    /// The increment that is suspected, of which the present one is a part.
    pub suspect: Option<Suspect>,
    /// Whether its halves have failed, so that it is not cut for being suspected any more.
    pub over: bool,
}

/// An increment that moved beyond what was expected.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Suspect {
    /// Its largest displacement.
    pub motion: f64,
    /// Its size.
    pub size: f64,
    /// Where it ends.
    #[serde(rename = "piece")]
    pub sub_increment: SubIncrement,
}

impl Pace {
    /// The motion that is expected of an increment of this size.
    fn expected(&self, size: f64) -> f64 {
        if self.fastest > 0.0 {
            self.predicted.min(self.fastest * size)
        } else {
            self.predicted
        }
    }

    /// Whether a motion over an increment of this size is beyond what is expected.
    fn is_exceeded(&self, motion: f64, size: f64) -> bool {
        let ratio = if self.over { RATIO_OVER } else { RATIO };
        motion > ratio * self.expected(size)
    }
}

impl Suspect {
    /// Whether a part of it has moved so far that this is a jump.
    fn jumps(&self, motion: f64, size: f64) -> bool {
        motion > self.motion * (size / self.size).sqrt().sqrt()
    }
}

impl Stepper {
    /// Accepts a state that the judge finds right, or cuts the increment where it may have jumped.
    pub(super) fn land(&mut self, after: Norms, verdict: Verdict) -> Outcome {
        let state = self.state();
        let size = (state.load_factor - state.start.load_factor).abs();
        let motion = self.source.moved(&state.u, &state.start.u);
        let looks = !strategy::rungs(state.controls.settings.strategy).is_empty();
        let beyond =
            looks && motion > NOTHING * self.model().length && state.pace.is_exceeded(motion, size);
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
        if jumps != Jumps::Accept && !state.pace.over {
            if let Some(cut) = self.cut(&why) {
                self.state.pace.suspect = Some(suspect);
                return cut;
            }
            if suspect.size > size && !suspect.jumps(motion, size) {
                return self.settle(after, verdict, motion / size);
            }
            if jumps == Jumps::Stop {
                self.next_major();
                return Outcome::Failed(why);
            }
        }
        // The other branch has a pace of its own.
        self.state.pace = Pace::default();
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_shrinks_with_the_increment_or_its_root_is_no_jump_and_what_stays_is_one() {
        let whole = Suspect {
            motion: 1.0,
            size: 1.0,
            sub_increment: SubIncrement::default(),
        };
        for halvings in 1..=10 {
            let size = 0.5_f64.powi(halvings);
            assert!(!whole.jumps(size, size) && !whole.jumps(size.sqrt(), size));
            assert!(whole.jumps(0.9, size) && whole.jumps(1.0, size));
        }
    }

    #[test]
    fn an_increment_is_suspected_by_its_tangent_or_by_those_before_it() {
        let pace = |predicted, fastest| Pace {
            predicted,
            fastest,
            suspect: None,
            over: false,
        };
        assert!(
            !pace(1.0, 0.0).is_exceeded(3.9, 0.1),
            "nothing moved before"
        );
        assert!(pace(1.0, 0.0).is_exceeded(4.1, 0.1));
        assert!(pace(5.0, 1.0).is_exceeded(0.5, 0.1), "a soft tangent");
        assert!(!pace(5.0, 2.0).is_exceeded(0.5, 0.1));
    }
}
