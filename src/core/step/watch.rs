//! Schedules the stability checks of accepted states, and records their results.
//!
//! A check costs about as much as a factorization. It is made
//!
//! - after every increment that may have jumped: if it is suspected ([`crate::step::pace`]), or moves by more than `FAR` times
//!   the scene's length;
//! - otherwise as soon as the major iterations accepted since the last check cost 1 / `SHARE` times as much as a check: after
//!   every increment if a check is less than 5 % of its work, after every n-th increment if increments are cheap. Checks
//!   therefore take at most 5 % of a run.
//!
//! Both costs are estimated from the scene's sizes ([`crate::linear::estimate`]), not measured, so that a run checks the same
//! states on every machine. States on an arc-length path are not checked: such a path passes unstable states on purpose.

use crate::Stability;
use serde::{Deserialize, Serialize};

/// Maximum fraction of the work for scheduled stability checks.
pub const SHARE: f64 = 0.05;
/// An increment that moves by more than this fraction of the scene's length may have passed a limit point.
pub(super) const FAR: f64 = 0.03;

/// Stability of the accepted states that were checked.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct StabilityWatch {
    /// Major iterations of the increments accepted since the last check.
    pub majors: u32,
    /// Load factor of the last state that is known to be stable.
    pub stable_at: Option<f64>,
    /// Whether the last checked state is unstable.
    pub unstable: bool,
}

/// An accepted increment ends in an unstable state, and its start state was not known to be unstable.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StabilityLoss {
    /// Kind of instability of the end state.
    pub stability: Stability,
    /// Load factor of the last state that is known to be stable.
    pub stable_at: Option<f64>,
}

impl StabilityWatch {
    /// Whether no increment was recorded yet.
    pub(super) fn is_new(&self) -> bool {
        *self == StabilityWatch::default()
    }

    /// Whether a check is due after an increment of `majors` major iterations, if a check costs as much as `look` of them.
    pub(super) fn is_due(&self, majors: u32, look: f64) -> bool {
        f64::from(self.majors.saturating_add(majors)) * SHARE >= look
    }

    /// The loss of stability, if this state is unstable and the last checked state was not.
    pub(super) fn loss(&self, stability: Option<Stability>) -> Option<StabilityLoss> {
        let stability = stability.filter(|found| found.is_unstable() && !self.unstable)?;
        Some(StabilityLoss {
            stability,
            stable_at: self.stable_at,
        })
    }

    /// Records an accepted state, and its stability if it was checked.
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
            let found = due.then_some(if increment <= 50 {
                Stability::Stable
            } else {
                Stability::Unstable { modes: 1 }
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
            "an expensive increment is always checked"
        );
    }
}
