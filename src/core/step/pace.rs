//! How fast a scene moves, and by that which increments are suspected to have jumped.

use crate::step::sub_increment::SubIncrement;
use serde::{Deserialize, Serialize};

/// How many times what is expected an increment may move without being suspected.
pub const RATIO: f64 = 4.0;

/// The same where the halves of a suspected increment have failed: there is less doubt.
const RATIO_OVER: f64 = 2.0;

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
    pub(super) fn expected(&self, size: f64) -> f64 {
        if self.fastest > 0.0 {
            self.predicted.min(self.fastest * size)
        } else {
            self.predicted
        }
    }

    /// Whether a motion over an increment of this size is beyond what is expected.
    pub(super) fn is_exceeded(&self, motion: f64, size: f64) -> bool {
        let ratio = if self.over { RATIO_OVER } else { RATIO };
        motion > ratio * self.expected(size)
    }
}

impl Suspect {
    /// Whether a part of it has moved so far that this is a jump.
    pub(super) fn jumps(&self, motion: f64, size: f64) -> bool {
        motion > self.motion * (size / self.size).sqrt().sqrt()
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
