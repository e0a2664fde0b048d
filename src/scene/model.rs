//! The checked scene: what the solver works on.
//!
//! Indices instead of names, generated nodes laid out, degrees of freedom numbered. Only what the scene names is
//! here: nodes of rigid surfaces have no unknowns, beams with GA no shear unknowns.
//!
//! Degrees of freedom are laid out node by node (x, y and, on beams, the rotation), then the bodies' own, body by body:
//! the shear forces of shear-rigid beams, one per Gauss point, and the forces on bodies that are given by a compliance,
//! whose equations are lengths, all of them. `equation[d]` is the number of the unknown of degree of freedom d, or
//! none where it is restrained or prescribed.

use super::spec::{
    Axis, Component, Friction, InitialState, Jumps, Law, Mode, Plane, Settings, Update,
};

/// A checked scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    pub title: String,
    pub about: String,
    pub nodes: Vec<Node>,
    pub bodies: Vec<Body>,
    pub surfaces: Vec<Surface>,
    pub slaves: Vec<Slave>,
    pub dofs: Dofs,
    pub loads: Vec<Load>,
    /// Prescribed motions other than zero.
    pub prescribed: Vec<Prescribed>,
    /// Corners of the path of the load factor, at least two.
    pub path: Vec<f64>,
    /// Increment of the load factor, positive.
    pub increment: f64,
    /// Size below which an increment that fails is not cut; none stands for a 64th of the increment in force.
    pub least: Option<f64>,
    /// What increments do that jump.
    pub jumps: Jumps,
    pub settings: Settings,
    pub monitors: Vec<Monitor>,
    /// Diagonal of the bounding box of all bodies' nodes: the scene's unit of length for tolerances.
    pub length: f64,
}

/// A node in the reference configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// `ID.k` for the k-th node of a chain or block (from 1), or the id of a single node.
    pub name: String,
    pub at: [f64; 2],
}

/// A deformable body.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    pub name: String,
    /// Distinct nodes of the body, along the chain for a beam.
    pub nodes: Vec<usize>,
    pub kind: BodyKind,
}

/// What a body is made of.
#[derive(Debug, Clone, PartialEq)]
pub enum BodyKind {
    Beam(Beam),
    Solid(Solid),
    Linear(Linear),
}

impl BodyKind {
    /// The lines of a drawing of it: a beam's elements, a solid's outline, bars between two nodes.
    pub fn lines(&self) -> &[Vec<usize>] {
        match self {
            BodyKind::Beam(beam) => &beam.elements,
            BodyKind::Solid(solid) => &solid.edges,
            BodyKind::Linear(linear) => &linear.bars,
        }
    }
}

/// A body that is given by a matrix over the x and y of its nodes, in their order.
#[derive(Debug, Clone, PartialEq)]
pub struct Linear {
    pub form: Form,
    /// Row, column and value of the matrix' entries, row by row; the whole diagonal, and what else is not zero.
    pub entries: Vec<(usize, usize, f64)>,
    /// Pairs of nodes that bars join, for a drawing.
    pub bars: Vec<Vec<usize>>,
}

/// What the matrix of a [`Linear`] body is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// f = K u.
    Stiffness,
    /// u = free λ + W f. The forces f are unknowns of their own, from this degree of freedom on, in the order of the
    /// matrix; their equations are u − W f = free λ. The displacements where no force acts are loads there.
    Compliance { first_force: usize },
}

impl Linear {
    /// Whether the matrix is the same when rows and columns change places, to the last bit.
    pub fn is_symmetric(&self) -> bool {
        let mut turned: Vec<(usize, usize, f64)> =
            self.entries.iter().map(|&(i, j, v)| (j, i, v)).collect();
        turned.sort_unstable_by_key(|&(i, j, _)| (i, j));
        turned == self.entries
    }
}

/// A continuum of 8-node quadrilaterals.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    /// Nodes of each element: the corners anticlockwise, then the middles of the sides that start at them.
    pub elements: Vec<[usize; 8]>,
    /// What it is made of.
    pub materials: Vec<Elastic>,
    /// Index into `materials` of each element.
    pub material_of: Vec<usize>,
    /// Elements of 3 nodes around it, anticlockwise from the lower left corner.
    pub edges: Vec<Vec<usize>>,
}

/// An elastic continuum's numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastic {
    /// Young's modulus (force by area).
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    pub law: Law,
    pub plane: Plane,
    /// Thickness across the plane, undeformed (length).
    pub thickness: f64,
    pub update: Update,
}

/// A chain of m-node beam elements with one section.
#[derive(Debug, Clone, PartialEq)]
pub struct Beam {
    /// Node numbers of each element, all of the same count (2 to 9).
    pub elements: Vec<Vec<usize>>,
    /// Axial stiffness (force).
    pub ea: f64,
    /// Bending stiffness (force · length²).
    pub ei: f64,
    /// Shear stiffness (force); none is shear-rigid.
    pub ga: Option<f64>,
    /// First shear degree of freedom of the body, where shear-rigid: element e, Gauss point p has
    /// `first_shear + e * (m - 1) + p`.
    pub first_shear: Option<usize>,
}

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
pub struct Slave {
    pub node: usize,
    /// Candidate surfaces.
    pub surfaces: Vec<usize>,
    pub friction: Friction,
    pub start: Mode,
    pub state: InitialState,
}

/// Numbering of the degrees of freedom and of the unknowns among them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Dofs {
    /// First degree of freedom of each node.
    pub first: Vec<usize>,
    /// 2 or 3 per node.
    pub count: Vec<u8>,
    /// Number of the equation of each degree of freedom; none where restrained or prescribed.
    pub equation: Vec<Option<usize>>,
    /// Number of equations.
    pub equations: usize,
    /// Number of the bodies' own unknowns among them, which belong to no node and come last.
    pub inner: usize,
}

impl Dofs {
    /// Number of degrees of freedom, restrained ones included.
    pub fn len(&self) -> usize {
        self.equation.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.equation.is_empty()
    }

    /// The degree of freedom of a node's component, if the node has it.
    pub fn dof(&self, node: usize, component: Component) -> Option<usize> {
        let k = component as usize;
        (k < self.count[node] as usize).then(|| self.first[node] + k)
    }
}

/// A dead load on one degree of freedom (a force, or a moment).
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    pub dof: usize,
    pub value: f64,
    pub scale: Factor,
}

/// A prescribed value of one degree of freedom.
#[derive(Debug, Clone, PartialEq)]
pub struct Prescribed {
    pub dof: usize,
    pub value: f64,
    pub scale: Factor,
}

/// A load's own factor as a function of the scene's load factor.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Factor(pub Vec<(f64, f64)>);

impl Factor {
    /// The factor at a load factor: piecewise linear, constant beyond the ends; without points the load factor
    /// itself.
    pub fn at(&self, load_factor: f64) -> f64 {
        let points = &self.0;
        let (Some(first), Some(last)) = (points.first(), points.last()) else {
            return load_factor;
        };
        if load_factor <= first.0 {
            return first.1;
        }
        for pair in points.windows(2) {
            let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
            if load_factor <= x1 {
                return y0 + (y1 - y0) * (load_factor - x0) / (x1 - x0);
            }
        }
        last.1
    }
}

/// A number to report.
#[derive(Debug, Clone, PartialEq)]
pub struct Monitor {
    pub name: String,
    pub of: Watched,
}

/// What a monitor reports.
#[derive(Debug, Clone, PartialEq)]
pub enum Watched {
    /// Value of a degree of freedom.
    Displacement { dof: usize },
    /// Component of the interaction force on slaves (by slave number).
    Contact { slaves: Vec<usize>, axis: Axis },
    /// Support force at a restrained degree of freedom.
    Reaction { dof: usize },
    /// Largest drift of slaves (by slave number).
    Drift { slaves: Vec<usize> },
}
