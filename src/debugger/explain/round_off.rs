//! Decides whether a number is more than the round-off of the sum that it results from. This is the only place with such a rule.
//!
//! Forces, gaps, slips and drifts are sums of terms as large as the acting forces or the coordinates of the
//! scene. In double precision such a sum has an error of a few ε = 2^-52 times its largest term. Below
//! [`TIMES`] such errors, and below the noise of the stiffest forces ([`Norms::noise`]), a number is shown as
//! 0, no arrow is drawn for it, and no lesson asks about it. A number that decided a mode is always shown, with
//! [`NOTE`].

use stickslip_core::{Model, Norms};
use stickslip_scene::number;

/// Round-off in units of the machine precision times the largest term of a sum.
pub const TIMES: f64 = 64.0;
/// Forces below this fraction of the force scale are not drawn: next to them, the accuracy to which a solve iterates would be drawn
/// as large as a force.
const DRAWN: f64 = 1e-9;
/// Note for a number that decided something although it is round-off.
pub const NOTE: &str = "(round-off)";

/// Sizes below which forces and lengths are round-off.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RoundOff {
    /// Force.
    pub force: f64,
    /// Length.
    pub length: f64,
    /// Force below which no arrow is drawn.
    pub drawn: f64,
}

/// The largest length of a scene: its size or its largest coordinate.
pub fn reach(model: &Model) -> f64 {
    model
        .nodes
        .iter()
        .flat_map(|node| node.at)
        .fold(model.length, |m, x| m.max(x.abs()))
}

impl RoundOff {
    /// The limits for a scene with these norms.
    pub fn new(model: &Model, norms: &Norms) -> RoundOff {
        RoundOff::with_reach(reach(model), norms)
    }

    /// The limits for a scene with this [`reach`] and these norms.
    pub fn with_reach(reach: f64, norms: &Norms) -> RoundOff {
        let ulps = TIMES * f64::EPSILON;
        RoundOff {
            force: norms.scale * norms.noise.max(ulps),
            length: ulps * reach,
            drawn: norms.scale * norms.noise.max(DRAWN),
        }
    }

    /// A force, or 0 if it is round-off.
    pub fn force(&self, value: f64) -> f64 {
        clean(value, self.force)
    }

    /// A force as an arrow, or 0 if it is too small to be drawn.
    pub fn arrow(&self, size: f64) -> f64 {
        clean(size, self.drawn)
    }

    /// A length, or 0 if it is round-off.
    pub fn length(&self, value: f64) -> f64 {
        clean(value, self.length)
    }

    /// A component of a unit vector, or 0 if it is round-off.
    pub fn component(&self, value: f64) -> f64 {
        clean(value, TIMES * f64::EPSILON)
    }

    /// |F_t| over |T_max| as a table cell; a dash if both are round-off.
    pub fn ratio(&self, f_t: f64, t_max: f64) -> String {
        number::ratio(self.force(f_t), self.force(t_max))
    }
}

/// A value, or 0 if it is round-off; NaN stays NaN.
fn clean(value: f64, round_off: f64) -> f64 {
    if value.abs() <= round_off { 0.0 } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_off_becomes_zero_and_other_values_are_unchanged() {
        let round_off = RoundOff {
            force: 1e-12,
            length: 1e-15,
            drawn: 1e-9,
        };
        assert_eq!(round_off.force(1e-12), 0.0);
        assert_eq!(round_off.force(-1.1e-12), -1.1e-12);
        assert_eq!(round_off.arrow(1e-10), 0.0);
        assert_eq!(round_off.arrow(2e-9), 2e-9);
        assert_eq!(round_off.length(f64::INFINITY), f64::INFINITY);
        assert!(round_off.length(f64::NAN).is_nan());
        assert_eq!(round_off.ratio(1e-13, 1e-14), "–");
        assert_eq!(round_off.ratio(0.5, 1.0), "0.5");
    }
}
