//! Interface problems in space, in the frames (n, t, n × t) of their contacts.

use super::described::{Described, ScalarPlace, Visit};
use serde::{Deserialize, Serialize};
use stickslip_core::model::Friction;

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

impl Described for SpaceSpec {
    /// Its numbers cannot be set from outside.
    fn walk(&mut self, _place: &ScalarPlace<'_>, _visit: &mut Visit<'_>) {}

    fn kind() -> String {
        "an interface problem in space".to_owned()
    }

    fn blank() -> String {
        String::new()
    }

    fn shown(&self) -> String {
        String::new()
    }
}
