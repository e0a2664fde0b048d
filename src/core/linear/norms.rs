//! How far a state is from equilibrium, in forces and relative to the scene's own scales.

use serde::{Deserialize, Serialize};

/// Sizes of what is not yet in balance; relative ones against the scene's own scales.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Norms {
    /// Largest out-of-balance force (a moment over the scene's length counts as a force), in force.
    pub force: f64,
    /// The same over the force scale.
    pub relative: f64,
    /// Largest violation of the interface conditions, relative: gaps of touching nodes and penetration of free
    /// ones, and drift of fixed ones where they are anchored, over the length scale; force on free nodes and |F_t − T_max| of sliding ones over the force scale.
    pub interface: f64,
    /// Largest displacement change in the last major iteration over the length scale; 0 before the first.
    pub correction: f64,
    /// The force scale.
    pub scale: f64,
    /// What `relative` must not exceed to be in balance: the tolerance, or the round-off of the stiffest forces
    /// where that is larger.
    pub limit: f64,
    /// Round-off of the stiffest forces over the loads and contact forces: what part of these is not known. Also of
    /// lengths that are to vanish, over the length scale.
    #[serde(default)]
    pub noise: f64,
}

impl Norms {
    /// Noise above which no answer is accepted.
    pub const LOUDEST: f64 = 1e-2;
    /// Noise from which on a run says what accuracy is left.
    pub const AUDIBLE: f64 = 1e-6;
}
