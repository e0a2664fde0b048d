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
    /// The pieces of a smooth curve through all nodes, one for each element, whose nodes are then those that the piece
    /// depends on. Empty where each element is the Lagrange curve through its own nodes.
    pub smooth: Vec<Piece>,
}

/// A piece of a smooth curve, from one node to the next: a cubic whose slope at each end depends on the nodes around
/// ([`crate::contact::smooth`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Place among the element's nodes of the one where the piece begins; it ends at the one behind.
    pub first: usize,
    /// Share of each of the element's nodes in the slope at the beginning and at the end, by the part of the piece that is
    /// walked: dx/dt with t from 0 to 1.
    pub slopes: [[f64; STENCIL]; 2],
}

/// Most nodes that a piece depends on.
pub const STENCIL: usize = 4;

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
