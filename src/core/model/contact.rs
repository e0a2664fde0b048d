//! The interface: master surfaces, and the contacts that slave nodes may make with them.

use super::friction::{Friction, InitialState, Mode};

/// A master surface: a chain of m-node interface elements; the outward side is on the right of the walk.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    pub name: String,
    /// Node numbers of each element in walking order; neighbours share their end node.
    pub elements: Vec<Vec<usize>>,
    /// No node of it can move by an unknown.
    pub rigid: bool,
    /// Goes on straight past its ends.
    pub endless: bool,
}

/// A slave node.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    pub node: usize,
    /// Candidate surfaces.
    pub surfaces: Vec<usize>,
    pub friction: Friction,
    pub start: Mode,
    pub state: InitialState,
}
