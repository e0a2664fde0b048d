//! How a slave node stands over its surface during a major iteration, and how a solve moves it there.

use serde::{Deserialize, Serialize};

/// A slave node's surroundings, frozen during a major iteration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NodeKinematics {
    /// Gap g (length); negative is penetration.
    pub gap: f64,
    /// Outward normal n at S* (unit).
    pub normal: [f64; 2],
    /// Position of S*.
    pub foot: [f64; 2],
    /// Whether any unknown takes part in the normal and in the tangential motion. If not, the supports carry that force.
    pub moves: [bool; 2],
}

/// What a solve gave at a slave node; normal and tangential components.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeIncrement {
    /// Increments ΔF_n, ΔF_t of the force on the slave node.
    pub force: [f64; 2],
    /// Motion of S* relative to S: Δu_nS* − Δu_nS, Δu_tS* − Δu_tS (length).
    pub motion: [f64; 2],
}
