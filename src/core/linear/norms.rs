//! Residual norms: distance of a state from equilibrium, in forces and relative to the scene's scales.

use serde::{Deserialize, Serialize};

/// Residual norms; relative ones use the scene's scales.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Norms {
    /// Largest out-of-balance force; moments are divided by the scene's length (force).
    pub force: f64,
    /// The same divided by the force scale.
    pub relative: f64,
    /// Largest relative violation of the interface conditions: gaps of touching nodes, penetration of free ones and drift of
    /// anchored fixed ones, divided by the length scale; forces on free nodes and |F_t − T_max| of sliding ones, divided by the
    /// force scale.
    pub interface: f64,
    /// Largest displacement correction in the last major iteration divided by the length scale; 0 before the first.
    pub correction: f64,
    /// The force scale.
    pub scale: f64,
    /// Tolerance for `relative`: the setting, or the round-off of the stiffest forces if that is larger.
    pub limit: f64,
    /// Round-off of the stiffest forces relative to the loads and contact forces, that is, their relative uncertainty; also the
    /// round-off of lengths that should vanish, relative to the length scale.
    #[serde(default)]
    pub noise: f64,
}

impl Norms {
    /// Noise above which no result is accepted.
    pub const LOUDEST: f64 = 1e-2;
    /// Noise above which a run reports the remaining accuracy.
    pub const AUDIBLE: f64 = 1e-6;
}
