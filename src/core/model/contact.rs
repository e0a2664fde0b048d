//! The interface: master surfaces, and the contacts that slave nodes may make with them.

use super::friction::{Friction, InitialState, Mode};
use serde::{Deserialize, Serialize};

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
    /// Local flexibilities of each element under point forces, in addition to its interpolation. Empty if all are zero.
    pub gives: Vec<PointGive>,
}

impl Surface {
    /// A rigid line through two nodes that goes on past both; its outward side is on the right of the walk.
    pub fn endless(name: &str, nodes: [usize; 2]) -> Self {
        Surface {
            name: name.to_owned(),
            elements: vec![nodes.to_vec()],
            rigid: true,
            endless: true,
            smooth: Vec::new(),
            gives: Vec::new(),
        }
    }
}

/// Flexibilities of a shear-flexible beam element under point forces ([`crate::contact::point_force`]), with L its undeformed
/// length; zeros for any other element.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PointGive {
    /// L / (8 GA), length by force.
    pub shear: f64,
    /// L³ / (32 EI), length by force; 0 omits the bending part.
    pub bending: f64,
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
    /// What holds where it touches.
    pub bond: Bond,
    /// Tributary area of the undeformed slave node, by which forces are pressures; that of a whole turn where its body is
    /// axisymmetric. `None` where nothing tells it.
    pub area: Option<f64>,
    /// Data for selecting the pieces of a cut master that the node may touch. `None` if none of its masters is cut, or if the node
    /// has no outward side.
    pub facing: Option<Facing>,
}

/// Selects the pieces that a slave node may touch, for a master that is cut at its corners ([`crate::contact::facing`]).
#[derive(Debug, Clone, PartialEq)]
pub struct Facing {
    /// Nodes before and after the slave node along the outline of its body; at an end of the outline, the slave node itself. The
    /// outside of the body is to the right of the line from the first node to the second.
    pub outline: [usize; 2],
    /// Numbers of the surfaces that are pieces, ascending. The node may touch its other surfaces regardless of direction.
    pub pieces: Vec<usize>,
}

impl Contact {
    /// A node that starts free, with friction, and may touch these surfaces.
    pub fn new(node: usize, surfaces: Vec<usize>, friction: Friction) -> Self {
        Contact {
            node,
            surfaces,
            friction,
            start: Mode::Free,
            state: InitialState::default(),
            overlap: 0.0,
            bond: Bond::Hard,
            area: None,
            facing: None,
        }
    }

    /// Contact pressure and shear (force by undeformed area) of these forces along n and t. `None` without an area.
    pub fn pressure(&self, f_n: f64, f_t: f64) -> Option<[f64; 2]> {
        let area = self.area.filter(|area| *area > 0.0)?;
        Some([f_n / area, f_t / area])
    }
}

/// What holds between a slave node and its surface where they touch, beside friction. The default is hard contact: g >= 0 and
/// F_n >= 0, one of them zero, and sticking without any motion.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub enum Bond {
    /// Nothing gives way.
    #[default]
    Hard,
    /// Springs in series with these compliances along n and along t (length by force), at least one of them positive. While the
    /// node touches, g + c_n F_n = 0; while it sticks, it has gone c_t F_t along t from its stick point.
    Giving([f64; 2]),
    /// Held at a point of its surface, in tension too.
    Tied {
        /// Whether its normal is the axis nearest to the surface's: where supports leave it and its surface nothing to do along
        /// the other axis, equations along n and t would be the same one twice.
        upright: bool,
    },
}

impl Bond {
    /// The bond with these compliances, along n and along t (length by force).
    pub fn giving(give: [f64; 2]) -> Self {
        if give == [0.0; 2] {
            Bond::Hard
        } else {
            Bond::Giving(give)
        }
    }

    /// Compliances in series along n and along t (length by force).
    pub fn give(&self) -> [f64; 2] {
        match self {
            Bond::Giving(give) => *give,
            Bond::Hard | Bond::Tied { .. } => [0.0; 2],
        }
    }

    /// Whether it is hard contact.
    pub fn is_hard(&self) -> bool {
        *self == Bond::Hard
    }

    /// Whether it holds the node for ever.
    pub fn is_tied(&self) -> bool {
        matches!(self, Bond::Tied { .. })
    }
}
