//! When a run looks at the stability of what it accepts, and what it remembers of it.
//!
//! A look costs about a factorization. So it is taken
//!
//! - after every increment that may have jumped: one that is suspected ([`crate::step::pace`]), or moves by more than `FAR` of the
//!   scene's length;
//! - else as soon as the major iterations accepted since the last look cost 1 / `SHARE` times as much: at every increment in
//!   which a look is less than 5 % of the work, and at every n-th where increments are cheap, so that looks never come to more
//!   than 5 % of a run.
//!
//! Both costs are counted from the scene's sizes ([`crate::linear::estimate`]), never by a clock, so that the same run looks at
//! the same states on every machine. On an arc-length path nothing is looked at: it passes unstable states on purpose.

use crate::linear::stability::Stability;
use serde::{Deserialize, Serialize};

/// Largest part of the work that unasked looks may cost.
pub const SHARE: f64 = 0.05;
/// An increment that moves beyond this part of the scene's length may have passed a limit point on its way.
pub(super) const FAR: f64 = 0.03;

/// What is known of the stability of the accepted states.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct StabilityWatch {
    /// Major iterations of the increments accepted since the last look.
    pub majors: u32,
    /// Load factor of the last state that is known to be stable.
    pub stable_at: Option<f64>,
    /// Whether the last state that was looked at is unstable.
    pub unstable: bool,
}

/// An accepted increment ends in an unstable state, and began in none that is known to be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StabilityLoss {
    /// What leads away from it.
    pub stability: Stability,
    /// Load factor of the last state that is known to be stable.
    pub stable_at: Option<f64>,
}

impl StabilityWatch {
    /// Whether nothing was accepted yet.
    pub(super) fn is_new(&self) -> bool {
        *self == StabilityWatch::default()
    }

    /// Whether to look at the end of an increment of so many major iterations, where a look costs as much as `look` of them.
    pub(super) fn is_due(&self, majors: u32, look: f64) -> bool {
        f64::from(self.majors.saturating_add(majors)) * SHARE >= look
    }

    /// Whether a state with this stability is one that has lost it.
    pub(super) fn loss(&self, stability: Option<Stability>) -> Option<StabilityLoss> {
        let stability = stability.filter(|found| found.is_unstable() && !self.unstable)?;
        Some(StabilityLoss {
            stability,
            stable_at: self.stable_at,
        })
    }

    /// Takes an accepted state into account, and what was found if it was looked at.
    pub(super) fn take(&mut self, load_factor: f64, majors: u32, found: Option<Stability>) {
        let Some(found) = found else {
            self.majors = self.majors.saturating_add(majors);
            return;
        };
        (self.majors, self.unstable) = (0, found.is_unstable());
        if found == Stability::Stable {
            self.stable_at = Some(load_factor);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_cost_at_most_their_share_and_a_loss_is_told_once() {
        let mut watch = StabilityWatch::default();
        let mut looks = 0;
        for increment in 1..=100_u32 {
            let due = watch.is_due(4, 3.0);
            looks += u32::from(due);
            let found = due.then_some(match increment <= 50 {
                true => Stability::Stable,
                false => Stability::Unstable { modes: 1 },
            });
            let loss = watch.loss(found);
            assert_eq!(loss.is_some(), increment == 60, "{increment}");
            if let Some(loss) = loss {
                assert_eq!(loss.stable_at, Some(45.0));
            }
            watch.take(f64::from(increment), 4, found);
        }
        assert_eq!(looks, 6, "18 of 400 major iterations");
        assert!(
            watch.is_due(60, 3.0),
            "one that is dear itself is always looked at"
        );
    }
}
