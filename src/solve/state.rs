//! Everything that the next minor iteration depends on, as plain data.

use crate::solve::event::Position;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The solver's state between two minor iterations. Cheap to clone: what changes seldom is shared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// The minor iteration that comes next.
    pub next: Position,
    /// Values of all degrees of freedom ([`crate::scene::model::Dofs`]) at the start of the present major iteration.
    pub u: Arc<Vec<f64>>,
}
