//! Control of the history: by the load factor or by arc length along the equilibrium path.

use crate::documented::documented;
use serde::{Deserialize, Serialize};

documented! {
    /// What controls the history from one increment to the next.
    pub choice Control {
        /// The load factor, in increments.
        #[default]
        Load,
        /// The arc length along the equilibrium path; the load factor is an unknown and may fall and rise again.
        Arc,
    }
}

/// Parameters of arc-length control.
#[derive(Debug, Clone, PartialEq)]
pub struct ArcLength {
    /// The quantity whose change defines the size of an increment.
    pub along: ArcMeasure,
    /// Size of the first increment, in the measured quantity. `None`: the change along the tangent for one increment of the load
    /// factor.
    pub step: Option<f64>,
    /// Maximum size of an increment. `None`: [`ArcLength::MOST`] times the first.
    pub largest: Option<f64>,
    /// Size below which an increment is no longer cut. `None`: [`ArcLength::LEAST`] times the first.
    pub least: Option<f64>,
    /// Target number of major iterations per increment: with fewer, the next increment is larger; with more, smaller.
    pub iterations: u32,
    /// Total arc at which the history ends, in the measured quantity. `None`: [`ArcLength::FARTHEST`] times the scene's length.
    pub length: Option<f64>,
    /// Displacements at which the history ends.
    pub bounds: Vec<Bound>,
}

/// The quantity whose change defines the size of an increment with arc-length control.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum ArcMeasure {
    /// All displacements together, along the tangent at the start of the increment (Riks): the largest component of the
    /// projection on the tangent (length).
    #[default]
    Displacements,
    /// The value of one degree of freedom.
    Dof(usize),
    /// The slip of one contact, by its number.
    Slip(usize),
}

/// A displacement that ends the history.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// Number of the degree of freedom.
    pub dof: usize,
    /// Value at which the history ends.
    pub at: f64,
}

impl ArcLength {
    /// Default of `largest`, relative to the first step.
    pub const MOST: f64 = 10.0;
    /// Default of `least`, relative to the first step.
    pub const LEAST: f64 = 1.0 / 1024.0;
    /// Default of `iterations`.
    pub const ITERATIONS: u32 = 6;
    /// Default of `length`, relative to the scene's length.
    pub const FARTHEST: f64 = 10.0;
}

impl Default for ArcLength {
    fn default() -> Self {
        ArcLength {
            along: ArcMeasure::default(),
            step: None,
            largest: None,
            least: None,
            iterations: ArcLength::ITERATIONS,
            length: None,
            bounds: Vec::new(),
        }
    }
}
