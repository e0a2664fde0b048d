//! What a history is driven by: the load factor itself, or the way along the path of equilibrium (arc length).

use super::documented::documented;
use serde::{Deserialize, Serialize};

documented! {
    /// What drives a history from one increment to the next.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Control {
        /// The load factor, by increments.
        #[default]
        Load,
        /// The way along the path of equilibrium; the load factor is an unknown, and may fall and rise again.
        Arc,
    }
}

impl Control {
    /// Whether it is what a scene that does not name it has.
    pub fn is_default(&self) -> bool {
        *self == Control::default()
    }
}

/// How the path of equilibrium is followed.
#[derive(Debug, Clone, PartialEq)]
pub struct ArcLength {
    /// What is given a size in every increment.
    pub along: Measured,
    /// Size of the first increment, in what is measured. `None`: what the tangent goes while the load factor moves by an
    /// increment.
    pub step: Option<f64>,
    /// Largest size of an increment. `None`: [`ArcLength::MOST`] times the first.
    pub largest: Option<f64>,
    /// Size below which an increment is not cut. `None`: [`ArcLength::LEAST`] times the first.
    pub least: Option<f64>,
    /// Major iterations of an increment that keep its size: with fewer the next is larger, with more it is smaller.
    pub iterations: u32,
    /// Arc after which the history ends (in what is measured). `None`: [`ArcLength::FARTHEST`] times the scene's length.
    pub length: Option<f64>,
    /// Displacements at which the history ends, if it comes there.
    pub bounds: Vec<Bound>,
}

/// What is given a size in every increment of arc length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Measured {
    /// All displacements together, along the tangent at the start of the increment (Riks): of the part that goes along the
    /// tangent, the largest (length).
    #[default]
    Displacements,
    /// The value of one degree of freedom.
    Dof(usize),
    /// The slip of one contact, by its number.
    Slip(usize),
}

/// A displacement at which a history ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// Number of the degree of freedom.
    pub dof: usize,
    /// Its value there.
    pub at: f64,
}

impl ArcLength {
    /// Default of `largest` over the first step.
    pub const MOST: f64 = 10.0;
    /// Default of `least` over the first step.
    pub const LEAST: f64 = 1.0 / 1024.0;
    /// Default of `iterations`.
    pub const ITERATIONS: u32 = 6;
    /// Default of `length` over the scene's length.
    pub const FARTHEST: f64 = 10.0;
}

impl Default for ArcLength {
    fn default() -> Self {
        ArcLength {
            along: Measured::default(),
            step: None,
            largest: None,
            least: None,
            iterations: ArcLength::ITERATIONS,
            length: None,
            bounds: Vec::new(),
        }
    }
}
