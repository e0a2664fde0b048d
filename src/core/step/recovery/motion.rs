//! What a damped motion from one equilibrium to the next carries from step to step (`step::damped`).

use serde::{Deserialize, Serialize};

/// A damped motion under way.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Load factor of the last equilibrium.
    pub from: f64,
    /// Stiffness of the interface where it began, by which drags are measured (force by length).
    pub stiffness: f64,
    /// Viscosity of a displacement over the time step: c / Δt (force by length).
    pub drag: f64,
    /// Steps that are done.
    pub steps: u32,
    /// Sum of the largest displacements of these steps (length).
    pub travelled: f64,
    /// Work that the viscosity has taken in them (force times length), never negative.
    pub dissipated: f64,
    /// Whether the present attempt is the one without drag that is to end in equilibrium.
    pub coming_to_rest: bool,
    /// Drag at which that was last tried; infinite before.
    pub tried: f64,
}

impl Motion {
    /// A motion that begins.
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
        }
    }

    /// The drag in force; `None` where equilibrium is sought.
    pub fn drag(&self) -> Option<f64> {
        (!self.coming_to_rest).then_some(self.drag)
    }
}
