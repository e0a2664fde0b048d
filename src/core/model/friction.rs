//! Modes of interaction (Table 1) and Coulomb friction (eqn 20).

use crate::documented::documented;
use serde::{Deserialize, Serialize};

documented! {
    /// Mode of interaction of a slave node with its master element (Table 1).
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Mode {
        /// Apart: no interaction force.
        #[default]
        Free,
        /// Touching; the tangential force is T_max.
        Sliding,
        /// Touching and stuck.
        Fixed,
    }
}

crate::words! {
    Mode, ALL, word:
    Free "free",
    Sliding "sliding",
    Fixed "fixed",
}

documented! {
    /// Coulomb friction, eqn (20).
    #[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct Friction {
        /// Friction angle φ in degrees, 0 <= φ < 90. Default: 0.
        #[serde(default)]
        pub angle: f64,
        /// Cohesion, a force per slave node. Default: 0.
        #[serde(default)]
        pub cohesion: f64,
    }
}

/// Number of floating-point neighbours searched on either side of arctan μ. The combined rounding error of arctan, the conversion
/// to degrees and back, and tan is smaller.
const NEAR: u64 = 8;

impl Friction {
    /// Friction with a given coefficient. Of all angles that reproduce the coefficient exactly, the one with the shortest decimal
    /// form.
    pub fn from_coefficient(mu: f64, cohesion: f64) -> Friction {
        let near = mu.atan().to_degrees();
        let of = |angle| Friction { angle, cohesion };
        let exact = (0..=NEAR)
            .flat_map(|k| {
                let bits = near.to_bits();
                [bits.saturating_sub(k), bits.saturating_add(k)].map(f64::from_bits)
            })
            .map(of)
            .filter(|friction| friction.coefficient() == mu);
        exact
            .min_by_key(|friction| friction.angle.to_string().len())
            .unwrap_or(of(near))
    }

    /// Coefficient of friction, tan φ.
    pub fn coefficient(&self) -> f64 {
        self.angle.to_radians().tan()
    }

    /// The largest tangential force under a normal force.
    pub fn limit(&self, f_n: f64) -> f64 {
        self.coefficient() * f_n + self.cohesion
    }

    /// Whether there is neither friction nor cohesion, so that no tangential force can arise.
    pub fn is_smooth(&self) -> bool {
        self.angle == 0.0 && self.cohesion == 0.0
    }
}

documented! {
    /// Values that a slave node carries into the first minor iteration, as for a step taken over from another code. A node that
    /// starts free carries no forces. Forces that are not balanced by the bodies count as out of balance, as after a major
    /// iteration.
    #[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
    #[serde(deny_unknown_fields, default)]
    pub struct InitialState {
        /// Normal force on the slave node along the master's outward normal n; compression is positive.
        pub f_n: f64,
        /// Tangential force along t, which is n turned 90 degrees anticlockwise.
        pub f_t: f64,
        /// Signed T_max of the first minor iteration.
        pub t_max: f64,
        /// Slip u_tS* − u_tS accumulated so far in the increment (length).
        pub slip: f64,
        /// Ratio of tangential to normal travel of a node that has just touched.
        pub ratio: f64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_and_round_angles_are_reproduced_exactly() {
        for tenth in 0..899 {
            let angle = f64::from(tenth) / 10.0;
            let friction = Friction {
                angle,
                cohesion: 2.0,
            };
            let mu = friction.coefficient();
            let back = Friction::from_coefficient(mu, 2.0);
            assert_eq!(back.coefficient().to_bits(), mu.to_bits(), "{angle}");
            assert_eq!(back, friction);
        }
    }
}
