//! Sliding that is held back: how an increment ends whose nodes cannot come to rest near where they were.
//!
//! Where a surface bends under a node, or is made of elements that meet at an angle, the force that drives a sliding node
//! along it may fall and rise again over a short way. The branch of equilibrium that the loads follow then ends, the next
//! one begins further on, and Newton's method hops to and fro between tangents that point away from each other. Where
//! nothing else has helped, the smallest increment is tried once more with
//!
//! ```text
//! ΔF_t − κ (Δu_tS* − Δu_tS) = T_max − F_t
//! ```
//!
//! at every sliding node in place of Table 1's ΔF_t = T_max − F_t: the tangential force is taken off a step at a time,
//! and the node goes where that force drives it. Once major iterations come to rest the motion is zero, and the
//! equation is Table 1's; what is accepted does not hang on κ. This is a proximal (Levenberg-Marquardt) step, or one of
//! pseudo-transient continuation with a viscosity on the slip (Kelley & Keyes, SIAM J. Numer. Anal. 35, 1998).
//!
//! The work of those forces on the slip decides about κ. With the slips δ of a major iteration, and the driving forces d =
//! F_t − T_max before and after it, the step is good if Σ δ d was positive, and has not turned below minus half of that: what
//! the nodes lose in energy then goes down from one major iteration to the next, so that none comes back to where it was. κ
//! starts at the interface's own stiffness, and falls after a good step. A step that is not good, or goes far, is taken
//! back, and tried with a greater κ, as is one whose minor iterations find no consistent modes. Friction opposes the slip of
//! the present major iteration, as it would in time; the judge looks at the net slip in the end.

use serde::{Deserialize, Serialize};

/// Factors by which κ grows and falls.
const GROWS: f64 = 8.0;
const FALLS: f64 = 0.25;
/// κ over the interface's stiffness below which it holds nothing back, and above which it does not help.
const LEAST: f64 = 1e-7;
const MOST: f64 = 1e6;

/// How sliding is held back.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Brake {
    /// The interface's own stiffness as the attempt began (force by length).
    pub spring: f64,
    /// κ of the present major iteration (force by length).
    pub stiffness: f64,
}

impl Brake {
    /// As an attempt begins, with the interface's own stiffness (force by length).
    pub(in crate::step) fn new(spring: f64) -> Self {
        Brake {
            spring,
            stiffness: spring,
        }
    }

    /// Holds back more; false where that does not help any more.
    pub(super) fn tighten(&mut self) -> bool {
        self.stiffness = GROWS * self.stiffness.max(LEAST * self.spring);
        self.stiffness <= MOST * self.spring
    }

    /// Holds back less.
    pub(super) fn loosen(&mut self) {
        let less = FALLS * self.stiffness;
        let holds = less > LEAST * self.spring;
        self.stiffness = if holds { less } else { 0.0 };
    }
}
