//! Data of a damped motion from one equilibrium to the next, kept from step to step (`step::damped`).

use serde::{Deserialize, Serialize};

/// A damped motion in progress.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Load factor of the last equilibrium.
    pub from: f64,
    /// Stiffness of the interface at its start, the reference for drags (force per length).
    pub stiffness: f64,
    /// Viscosity of a displacement divided by the time step: c / Δt (force per length).
    pub drag: f64,
    /// Number of completed steps.
    pub steps: u32,
    /// Sum of the largest displacements of these steps (length).
    pub travelled: f64,
    /// Work dissipated by viscosity in these steps (force times length), never negative.
    pub dissipated: f64,
    /// Whether the current attempt is the one without drag that should end in equilibrium.
    pub coming_to_rest: bool,
    /// Drag at the last such attempt; infinite before the first.
    pub tried: f64,
    /// Whether the current step of a search's motion was tried with less drag before.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub slowed: bool,
}

impl Motion {
    /// A motion at its start.
    pub fn new(from: f64, stiffness: f64) -> Self {
        Motion {
            from,
            stiffness,
            drag: stiffness,
            steps: 0,
            travelled: 0.0,
            dissipated: 0.0,
            coming_to_rest: false,
            tried: f64::MAX,
            slowed: false,
        }
    }

    /// Current drag; `None` during an attempt to reach equilibrium.
    pub fn drag(&self) -> Option<f64> {
        (!self.coming_to_rest).then_some(self.drag)
    }
}
