//! Table 1: the two equations that a slave node adds in each mode, and T_max (eqn 20).
//!
//! The unknowns are the increments ΔF_n, ΔF_t of the interaction force. The paper applies a known ΔF_t as a load on slave and
//! master; here it remains an unknown whose equation gives its value. This is the same system with one more row, and with the
//! same columns in every mode:
//!
//! ```text
//! slave row:    −n ΔF_n − t ΔF_t      (added to K Δu = ΔP)
//! master row i:  N_i (n ΔF_n + t ΔF_t)
//! fixed:    Δu_nS* − Δu_nS = g          Δu_tS* − Δu_tS = g ρ
//! sliding:  Δu_nS* − Δu_nS = g          ΔF_t = T_max − F_t
//! free:     ΔF_n = −F_n                 ΔF_t = −F_t
//! ```
//!
//! A node that slid in an earlier major iteration of the increment and is then found to stick has not slipped at all: sticking
//! undoes that slip, measured from the stick point ([`crate::contact::stick_point`]) or accumulated; in the paper's reading, slip
//! is accumulated over a single major iteration, and there is nothing to undo.

use crate::{Friction, Mode};

/// The component of the motion of S* relative to S in an equation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RelativeMotion {
    /// Nothing.
    None,
    /// The normal component Δu_nS* − Δu_nS, with the factor one.
    Normal,
    /// The tangential component Δu_tS* − Δu_tS, with the factor one.
    Tangential,
}

/// One equation: motion + d_n ΔF_n + d_t ΔF_t = value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Equation {
    /// The component of the relative motion in the equation.
    pub motion: RelativeMotion,
    /// Factor of ΔF_n.
    pub d_n: f64,
    /// Factor of ΔF_t.
    pub d_t: f64,
    /// Right-hand side: a length if the equation contains a motion, else a force.
    pub value: f64,
}

/// Data of a slave node for its equations, from major iteration k−1 and the previous minor iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlipDirection {
    /// Gap g^(k−1), length.
    pub gap: f64,
    /// Ratio ρ of tangential to normal travel, if the node touched in this major iteration; else 0.
    pub ratio: f64,
    /// Previous slip that sticking must undo (length): the drift from the anchor, or the accumulated slip.
    pub slip: f64,
    /// Total normal force F_n^(k−1).
    pub f_n: f64,
    /// Total tangential force F_t^(k−1).
    pub f_t: f64,
    /// The tangential force of sliding.
    pub limit: FrictionBound,
}

/// The tangential force of a sliding node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FrictionBound {
    /// T_max of the previous minor iteration.
    Lagged(f64),
    /// T_max follows F_n within the solve: sign · (coefficient · F_n + cohesion).
    Consistent {
        /// Direction of T_max: ±1, or 0 if unknown.
        sign: f64,
        /// tan φ.
        coefficient: f64,
        /// c (force).
        cohesion: f64,
    },
}

/// Table 1's equations of a node in a mode: normal, then tangential.
pub fn equations(mode: Mode, known: &SlipDirection) -> [Equation; 2] {
    let normal = Equation {
        motion: RelativeMotion::Normal,
        d_n: 0.0,
        d_t: 0.0,
        value: known.gap,
    };
    match mode {
        Mode::Fixed => [
            normal,
            Equation {
                motion: RelativeMotion::Tangential,
                d_n: 0.0,
                d_t: 0.0,
                value: known.gap * known.ratio - known.slip,
            },
        ],
        Mode::Sliding => [normal, sliding(known)],
        Mode::Free => [gone(1.0, 0.0, known.f_n), gone(0.0, 1.0, known.f_t)],
    }
}

/// The equation of a sliding node whose motion in a major iteration is resisted by a stiffness κ (force per length): ΔF_t − κ
/// (Δu_tS* − Δu_tS) = T_max − F_t. When the major iterations have converged, the motion is zero, and this is Table 1's equation.
pub fn braked(sliding: Equation, stiffness: f64) -> Equation {
    Equation {
        motion: RelativeMotion::Tangential,
        d_n: -sliding.d_n / stiffness,
        d_t: -sliding.d_t / stiffness,
        value: -sliding.value / stiffness,
    }
}

/// The equation d_n ΔF_n + d_t ΔF_t = −`force`, which makes a total force component zero.
pub fn gone(d_n: f64, d_t: f64, force: f64) -> Equation {
    Equation {
        motion: RelativeMotion::None,
        d_n,
        d_t,
        value: -force,
    }
}

fn sliding(known: &SlipDirection) -> Equation {
    let (d_n, value) = match known.limit {
        FrictionBound::Lagged(t_max) => (0.0, t_max - known.f_t),
        FrictionBound::Consistent {
            sign,
            coefficient,
            cohesion,
        } => (
            -sign * coefficient,
            sign * (coefficient * known.f_n + cohesion) - known.f_t,
        ),
    };
    Equation {
        motion: RelativeMotion::None,
        d_n,
        d_t: 1.0,
        value,
    }
}

/// T_max = sign (tan φ |F_n| + c), eqn (20); `sign` is the direction of the tangential force (−1, 1, or 0 if unknown).
pub fn t_max(friction: &Friction, f_n: f64, sign: f64) -> f64 {
    friction.limit(f_n.abs()) * sign
}

/// The direction of T_max (−1, 0 or 1): the sign of `f_t` if |F_t| > `tiny_force`; else the sign of `slip` if
/// |slip| > `tiny_slip`; else `had`. The slip counts because a node that starts to slide without a force would otherwise stay
/// without friction forever.
pub fn direction(f_t: f64, tiny_force: f64, slip: f64, tiny_slip: f64, had: f64) -> f64 {
    if f_t.abs() > tiny_force {
        f_t.signum()
    } else if slip.abs() > tiny_slip {
        slip.signum()
    } else {
        had
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KNOWN: SlipDirection = SlipDirection {
        gap: -0.2,
        ratio: 1.5,
        slip: 0.0,
        f_n: 3.0,
        f_t: -1.0,
        limit: FrictionBound::Lagged(-1.7),
    };

    #[test]
    fn the_equations_are_those_of_table_1() {
        let [n, t] = equations(Mode::Fixed, &KNOWN);
        assert_eq!((n.motion, n.value), (RelativeMotion::Normal, -0.2));
        assert_eq!(
            (t.motion, t.value),
            (RelativeMotion::Tangential, -0.2 * 1.5)
        );
        let [n, t] = equations(Mode::Sliding, &KNOWN);
        assert_eq!((n.motion, n.value), (RelativeMotion::Normal, -0.2));
        assert_eq!((t.d_n, t.d_t, t.value), (0.0, 1.0, -1.7 + 1.0));
        let [n, t] = equations(Mode::Free, &KNOWN);
        assert_eq!((n.d_n, n.d_t, n.value), (1.0, 0.0, -3.0));
        assert_eq!((t.d_n, t.d_t, t.value), (0.0, 1.0, 1.0));
    }

    #[test]
    fn a_consistent_limit_makes_the_total_force_obey_coulomb_for_any_increment() {
        let limit = FrictionBound::Consistent {
            sign: -1.0,
            coefficient: 0.5,
            cohesion: 0.1,
        };
        let [_, t] = equations(Mode::Sliding, &SlipDirection { limit, ..KNOWN });
        let d_f_n = 0.7;
        let d_f_t = (t.value - t.d_n * d_f_n) / t.d_t;
        assert!((KNOWN.f_t + d_f_t + (0.5 * (KNOWN.f_n + d_f_n) + 0.1)).abs() < 1e-15);
    }

    #[test]
    fn an_unloaded_sliding_node_takes_the_direction_of_its_slip() {
        assert_eq!(direction(0.0, 1e-12, -3.0, 1e-12, 0.0), -1.0);
        assert_eq!(direction(2.0, 1e-12, -3.0, 1e-12, 0.0), 1.0);
        assert_eq!(direction(0.0, 1e-12, 0.0, 1e-12, 1.0), 1.0);
    }
}
