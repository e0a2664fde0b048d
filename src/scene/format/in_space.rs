//! Interface problems in space, in the frames (n, t, n × t) of their contacts.

use super::described::fixed;
use serde::{Deserialize, Serialize};
use stickslip_core::Friction;

/// An interface problem in space: (gap, u) = W f + free, with three components for each contact in turn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpaceSpec {
    /// The contacts, in the order of the rows of W: name and friction.
    pub contacts: Vec<(String, Friction)>,
    /// Entries of W: row, column (from 0) and value; repeated ones are added.
    pub compliance: Vec<(usize, usize, f64)>,
    /// Gap and motion without contact forces.
    pub free: Vec<f64>,
}

fixed! {
    SpaceSpec, "an interface problem in space", "";
}
