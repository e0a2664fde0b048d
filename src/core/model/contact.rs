//! The interface: master surfaces, and the contacts that slave nodes may make with them.

use super::friction::{Friction, InitialState, Mode};

/// A master surface: a chain of m-node interface elements; the outward side is on the right of the walk.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Name in the scene.
    pub name: String,
    /// Node numbers of each element in walking order; neighbours share their end node.
    pub elements: Vec<Vec<usize>>,
    /// Whether no node of it can move by an unknown.
    pub rigid: bool,
    /// Whether it goes on straight past its ends; such a surface is one element of 2 nodes.
    pub endless: bool,
}

/// A slave node with the surfaces that it may touch.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// Number of the slave node.
    pub node: usize,
    /// Numbers of the surfaces that it may touch.
    pub surfaces: Vec<usize>,
    /// Friction at the start; a user may change it during a run.
    pub friction: Friction,
    /// Mode of the first minor iteration.
    pub start: Mode,
    /// What the node brings into the first minor iteration.
    pub state: InitialState,
    /// How deep the node starts inside its surface, where that is closed over the first leg of the path only
    /// ([`crate::model::InitialGaps::Ramp`]); 0 for all others (length).
    pub overlap: f64,
}
