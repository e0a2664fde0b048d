//! The interface: master surfaces and the contacts of slave nodes with them.

use super::documented::documented;
use super::friction::{Friction, InitialState, Mode};
use serde::{Deserialize, Serialize};

/// A master surface: a chain of m-node interface elements. The outward side is on the right when walking along the chain.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Name in the scene.
    pub name: String,
    /// Node numbers of each element in walking order; neighbouring elements share an end node.
    pub elements: Vec<Vec<usize>>,
    /// Whether no node of the surface has an unknown.
    pub rigid: bool,
    /// Whether the surface extends straight beyond its ends. Such a surface is a single element of 2 nodes.
    pub endless: bool,
    /// How far the first element extends past its start and the last one past its end, in units of their ξ. Only nodes that already
    /// touch are held in the outer half. Zeros on a closed chain.
    pub past_ends: [f64; 2],
    /// Pieces of a smooth curve through all nodes, one per element. The nodes of an element are then those that its piece depends
    /// on. Empty if each element is the Lagrange curve through its own nodes.
    pub smooth: Vec<Piece>,
    /// Local flexibilities of each element under point forces, in addition to its interpolation. Empty if all are zero.
    pub gives: Vec<PointGive>,
}

impl Surface {
    /// A surface of Lagrange elements without local flexibilities.
    pub fn new(name: &str, elements: Vec<Vec<usize>>, rigid: bool) -> Self {
        Surface {
            name: name.to_owned(),
            elements,
            rigid,
            endless: false,
            past_ends: [0.0; 2],
            smooth: Vec::new(),
            gives: Vec::new(),
        }
    }

    /// An endless rigid line through two nodes; its outward side is on the right of the walk.
    pub fn endless(name: &str, nodes: [usize; 2]) -> Self {
        Surface {
            endless: true,
            ..Surface::new(name, vec![nodes.to_vec()], true)
        }
    }

    /// The nodes of its elements, in the order of the walk; a node between two elements is repeated.
    pub fn nodes(&self) -> impl DoubleEndedIterator<Item = &usize> {
        self.elements.iter().flatten()
    }
}

/// Flexibilities of a shear-flexible beam element under point forces ([`crate::contact::point_force`]), with L its undeformed
/// length; zeros for any other element.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PointGive {
    /// L / (8 GA), length per force.
    pub shear: f64,
    /// L³ / (32 EI), length per force; 0 omits the bending part.
    pub bending: f64,
}

/// A piece of a smooth curve between two neighbouring nodes: a cubic whose end slopes depend on nearby nodes
/// ([`crate::contact::smooth`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Index, among the element's nodes, of the start node of the piece; the next node is its end.
    pub first: usize,
    /// Weights of the element's nodes in the slope dx/dt at the start and at the end of the piece, with t from 0 to 1.
    pub slopes: [[f64; STENCIL]; 2],
}

/// Maximum number of nodes that a piece depends on.
pub const STENCIL: usize = 4;

/// A slave node, or a point of a slave face, with the surfaces that it may touch.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// Number of the slave node.
    pub node: usize,
    /// Nodes that carry the slave node, with weights, if it is a point of a face: it has no unknowns, and its displacement is their
    /// weighted sum. Empty if it is a node of a body.
    pub weights: Vec<(usize, f64)>,
    /// Numbers of the surfaces that it may touch.
    pub surfaces: Vec<usize>,
    /// Initial friction; the user may change it during a run.
    pub friction: Friction,
    /// Mode of the first minor iteration.
    pub start: Mode,
    /// Values carried into the first minor iteration.
    pub state: InitialState,
    /// Initial penetration to be closed over the first leg of the path ([`crate::model::InitialGaps::Ramp`]); 0 for all other
    /// contacts (length).
    pub overlap: f64,
    /// Contact law.
    pub bond: Bond,
    /// Undeformed tributary area of the slave node, which converts forces to pressures; in axisymmetry that of the whole
    /// circumference. `None` if it is unknown.
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
    /// A contact that starts free, with this friction and these candidate surfaces.
    pub fn new(node: usize, surfaces: Vec<usize>, friction: Friction) -> Self {
        Contact {
            node,
            weights: Vec::new(),
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

    /// Whether it transmits forces across a distance: with a compliance, or an initial overlap of which the fraction `unclosed` is
    /// still open.
    pub fn is_apart(&self, unclosed: f64) -> bool {
        !self.bond.is_hard() || self.overlap * unclosed > 0.0
    }

    /// The nodes on which its force acts, with their weights.
    pub fn carriers(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let own = self.weights.is_empty().then_some((self.node, 1.0));
        own.into_iter().chain(self.weights.iter().copied())
    }

    /// Contact pressure and shear traction (force per undeformed area) of these forces along n and t. `None` without an area.
    pub fn pressure(&self, f_n: f64, f_t: f64) -> Option<[f64; 2]> {
        let area = self.area.filter(|area| *area > 0.0)?;
        Some([f_n / area, f_t / area])
    }
}

documented! {
    /// The points of a slave surface at which its law holds.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum SlavePoints {
        /// Its nodes, with their tributary areas (node to surface).
        #[default]
        Node,
        /// Gauss points of its sides (surface to surface), at least 10 per side, on each part of a side that lies over one side of
        /// the undeformed masters. A point is a weighted sum of the nodes of its side. A side belongs to the slave
        /// surface if all its nodes do, or if `sides` names it. Only for solids, and not for hard contact or rigid ties, which
        /// would be more equations than a side has unknowns.
        Surface,
    }
}

impl SlavePoints {
    /// Whether this is the default, which scenes may omit.
    pub fn is_node(&self) -> bool {
        *self == SlavePoints::Node
    }
}

/// The contact law of a slave node and its surface, apart from friction. The default is hard contact: g >= 0, F_n >= 0, one of
/// them zero, and rigid stick.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub enum Bond {
    /// Rigid.
    #[default]
    Hard,
    /// Springs in series with these compliances along n and t (length per force), at least one of them positive. While the node
    /// touches, g + c_n F_n = 0; while it sticks, it is displaced by c_t F_t along t from its stick point.
    Giving([f64; 2]),
    /// Tied to a point of its surface; transmits tension too.
    Tied {
        /// Compliances along n and t (length per force); zeros if it is rigid.
        #[serde(default, skip_serializing_if = "is_rigid")]
        give: [f64; 2],
        /// Whether the normal is replaced by the nearest coordinate axis. Needed if supports restrain the node and its surface
        /// along the other axis, because the equations along n and t would then be linearly dependent.
        upright: bool,
    },
}

impl Bond {
    /// The law with these compliances along n and t (length per force).
    pub fn giving(give: [f64; 2]) -> Self {
        if give == [0.0; 2] {
            Bond::Hard
        } else {
            Bond::Giving(give)
        }
    }

    /// Compliances in series along n and t (length per force).
    pub fn give(&self) -> [f64; 2] {
        match self {
            Bond::Giving(give) | Bond::Tied { give, .. } => *give,
            Bond::Hard => [0.0; 2],
        }
    }

    /// The rigid tie.
    pub fn tied() -> Self {
        Bond::Tied {
            give: [0.0; 2],
            upright: false,
        }
    }

    /// Whether it is hard contact.
    pub fn is_hard(&self) -> bool {
        *self == Bond::Hard
    }

    /// Whether the node is tied.
    pub fn is_tied(&self) -> bool {
        matches!(self, Bond::Tied { .. })
    }
}

fn is_rigid(give: &[f64; 2]) -> bool {
    *give == [0.0; 2]
}
