//! How a slave node stands over its surface during a major iteration, and how a solve moves it there.

use serde::{Deserialize, Serialize};

/// A slave node's surroundings, frozen during a major iteration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NodeKinematics {
    /// Gap (length); negative: penetration.
    pub gap: f64,
    /// Outward normal at S*.
    pub normal: [f64; 2],
    /// Position of S*.
    pub foot: [f64; 2],
    /// Whether any unknown takes part in the normal and in the tangential motion; where not, the support carries the
    /// force.
    pub moves: [bool; 2],
}

/// What a solve gave at a slave node: increments of force, and motion of S* relative to S, normal and tangential.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeIncrement {
    pub force: [f64; 2],
    pub motion: [f64; 2],
}
