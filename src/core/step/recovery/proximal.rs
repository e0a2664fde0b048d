//! Holds sliding back, to complete increments whose nodes find no equilibrium near their start.
//!
//! If a surface bends under a node, or consists of elements that meet at an angle, the force that drives a sliding node along it
//! may fall and rise again over a short distance. The branch of equilibrium under the loads then ends, the next one begins
//! further on, and Newton's method jumps back and forth between tangents that point away from each other. If nothing else has
//! helped, the smallest increment is tried again with
//!
//! ```text
//! ΔF_t − κ (Δu_tS* − Δu_tS) = T_max − F_t
//! ```
//!
//! at every sliding node instead of ΔF_t = T_max − F_t of Table 1: the excess tangential force is removed step by step, and the
//! node moves where that force drives it. Once the major iterations converge the motion is zero, and the equation is that of
//! Table 1; the accepted state is independent of κ. This is a proximal (Levenberg-Marquardt) step, or a step of pseudo-transient
//! continuation with a viscosity on the slip (Kelley & Keyes, SIAM J. Numer. Anal. 35, 1998).
//!
//! The work of these forces on the slip controls κ. With the slips δ of a major iteration, and the driving forces d = F_t − T_max
//! before and after it, the step is good if Σ δ d was positive and has not fallen below minus half of that: the energy of the
//! nodes then decreases from one major iteration to the next, so none returns to an earlier state. κ starts at the interface's
//! stiffness and decreases after a good step. A step that is not good, or moves too far, is undone and repeated with a larger κ,
//! as is one whose minor iterations find no consistent modes. Friction opposes the slip of the current major iteration, as it
//! would in time; the judge checks the net slip at the end.

use serde::{Deserialize, Serialize};

/// Factors by which κ grows and falls.
const GROWS: f64 = 8.0;
const FALLS: f64 = 0.25;
/// Bounds of κ over the interface's stiffness: below the first it has no effect, above the second it does not help.
const LEAST: f64 = 1e-7;
const MOST: f64 = 1e6;

/// State of the held-back sliding.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SlipStiffness {
    /// Stiffness of the interface at the start of the attempt (force per length).
    pub spring: f64,
    /// κ of the current major iteration (force per length).
    pub stiffness: f64,
}

impl SlipStiffness {
    /// At the start of an attempt, with the interface's stiffness (force per length).
    pub(in crate::step) fn new(spring: f64) -> Self {
        SlipStiffness {
            spring,
            stiffness: spring,
        }
    }

    /// Increases κ; false if a larger κ no longer helps.
    pub(super) fn tighten(&mut self) -> bool {
        self.stiffness = GROWS * self.stiffness.max(LEAST * self.spring);
        // Without any stiffness, where it underflows, no κ holds anything back.
        self.stiffness < MOST * self.spring
    }

    /// Decreases κ.
    pub(super) fn loosen(&mut self) {
        let less = FALLS * self.stiffness;
        let holds = less > LEAST * self.spring;
        self.stiffness = if holds { less } else { 0.0 };
    }
}
