//! The scene file as its author writes it: one Rust type per RON construct.
//!
//! Nothing here is checked beyond what a type can say; [`stickslip_core::model`] turns a [`Spec`] into a
//! [`Model`](stickslip_core::model::Model), and refuses what makes no sense. Every field is either required or has the
//! default that its comment names.

use super::arc::ArcSpec;
use super::contact_law::{ContactLaw, FrictionSpec};
use super::described::macros::described;
use super::given::{Cells, NodeSet, SideSet};
pub use super::loads::{LoadSpec, Scale};
pub use super::monitor::{MonitorSpec, Quantity};
use serde::{Deserialize, Serialize};
use stickslip_core::model::{
    Component, Control, ElementKind, InitialState, Jumps, Law, Mode, Plane, Settings, Update,
    least, on_leg,
};

/// A point or a vector in the plane, `(x, y)`, in the scene's unit of length.
pub type Point = (f64, f64);

described! {
    /// A whole scene file.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct Spec {
        /// One line that says what the scene is.
        pub title: String,
        /// A few sentences for the reader: source, units, what to look for. Default: empty.
        #[serde(default)]
        pub about: String => skip,
        /// Divides every generated element into this many. Default: 1.
        #[serde(default = "one")]
        pub refine: usize,
        /// Nodes, one by one or generated along curves.
        pub nodes: Vec<Nodes>,
        /// Materials and sections by name.
        pub materials: Vec<Material>,
        /// What deforms.
        pub bodies: Vec<BodySpec>,
        /// Master surfaces. Default: none.
        #[serde(default)]
        pub surfaces: Vec<SurfaceSpec>,
        /// Slave nodes. Default: none.
        #[serde(default)]
        pub slaves: Vec<SlaveSpec>,
        /// Coulomb friction of every slave node that names none of its own. Default: smooth.
        #[serde(default)]
        pub friction: FrictionSpec,
        /// Restrained degrees of freedom. Default: none.
        #[serde(default)]
        pub supports: Vec<SupportSpec>,
        /// Reference loads, multiplied by the load factor. Default: none.
        #[serde(default)]
        pub loads: Vec<LoadSpec>,
        /// The path of the load factor and its increments.
        pub history: History,
        /// Choices of the method and its limits. Default: those of [`Settings`].
        #[serde(default)]
        pub settings: Settings,
        /// What `--csv` and the load-displacement view report. Default: none.
        #[serde(default)]
        pub monitors: Vec<MonitorSpec>,
        /// The scene of an attached solver, as it told it; nothing else of the file counts then, and nothing of ours solves it
        /// (manual page `attaching`). Default: none.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub attached: Option<String> => skip,
    }
}

impl Default for Spec {
    /// A scene without bodies, nodes and all that stands on them.
    fn default() -> Self {
        Spec {
            title: String::new(),
            about: String::new(),
            refine: 1,
            nodes: Vec::new(),
            materials: Vec::new(),
            bodies: Vec::new(),
            surfaces: Vec::new(),
            slaves: Vec::new(),
            friction: FrictionSpec::default(),
            supports: Vec::new(),
            loads: Vec::new(),
            history: History::default(),
            settings: Settings::default(),
            monitors: Vec::new(),
            attached: None,
        }
    }
}

fn one() -> usize {
    1
}

described! {
    /// Nodes, one by one or in chains of m-node elements.
    ///
    /// A chain's nodes are called `ID.1`, `ID.2`, … in order; `ID.start`, `ID.end`, `ID@0.5` (at that fraction of the
    /// chain's parameter) and `ID.all` name them whatever the refinement. So do they for each edge of a block.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub enum Nodes {
        /// One node, called `id`.
        Node {
            /// Name of the node, or of the chain.
            id: String => name,
            /// Where it stands.
            at: Point,
        },
        /// A straight chain.
        Line {
            /// Name of the node, or of the chain.
            id: String => name,
            /// Its first node.
            from: Point,
            /// Its last node.
            to: Point,
            /// Number of elements, before refinement.
            elements: usize,
            /// Nodes per element, 2 to 9.
            per_element: usize,
        },
        /// A circular arc; angles in degrees, anticlockwise from +x, `from` may exceed `to`.
        Arc {
            /// Name of the node, or of the chain.
            id: String => name,
            /// Center of the circle.
            center: Point,
            /// Radius of the circle, a length.
            radius: f64,
            /// Angle of its first node.
            from: f64,
            /// Angle of its last node.
            to: f64,
            /// Number of elements, before refinement.
            elements: usize,
            /// Nodes per element, 2 to 9.
            per_element: usize,
        },
        /// A chain through given points; elements are the Lagrange curves through them.
        Through {
            /// Name of the node, or of the chain.
            id: String => name,
            /// The nodes before refinement, in order; each element shares its last one with the next.
            points: Vec<Point>,
            /// Nodes per element, 2 to 9.
            per_element: usize,
        },
        /// A mesh on a block with four sides: of 8-node quadrilaterals, or of another kind of element.
        ///
        /// Its edges are chains of elements of 2 or 3 nodes, as its elements have along a side, `ID.bottom`, `ID.right`, `ID.top` and `ID.left`, walked anticlockwise
        /// so that the outward side is on the right. They can be used wherever a chain can, and, as lists of nodes, without
        /// `.all`. All nodes are `ID.1`, `ID.2`, … row by row from the bottom, and `ID.all`.
        Block {
            /// Name of the block.
            id: String => name,
            /// Two opposite corners of an upright rectangle, lower left and upper right; or all four of a
            /// quadrilateral, anticlockwise, the bottom edge first.
            corners: Vec<Point>,
            /// Number of elements along the bottom and along the left edge, before refinement.
            elements: (usize, usize),
            /// What it is made of; each quadrilateral is cut into two triangles where these are named. Default: quad8.
            #[serde(default, skip_serializing_if = "ElementKind::is_default")]
            element: ElementKind,
            /// Length of the last element over that of the first along bottom and top (left to right), and along left and
            /// right (upwards); lengths between grow by a constant factor. Refinement divides each element evenly.
            /// Default: (1, 1).
            #[serde(default = "even")]
            grading: (f64, f64),
            /// Sides that are not straight; what lies between is blended from all four. Default: none.
            #[serde(default)]
            sides: Sides,
            /// Turns and shifts the block, curved sides and all, once it is made. Default: as it lies.
            #[serde(default)]
            place: Place,
        },
        /// One mesh of several blocks, joined along sides. Blocks lie apart, however close, where no joint names them.
        Mesh {
            /// Name of the mesh.
            id: String => name,
            /// The blocks. Their edges keep their names; their common nodes have one name for each.
            of: Vec<String>,
            /// Pairs of edges that become one, as `("a.right", "b.left")`: their nodes must coincide one by one.
            joints: Vec<(String, String)>,
            /// How far two nodes that become one may be apart, in lengths of the edge; the first edge's stays.
            /// Default: 1e-6.
            #[serde(default = "joint_tolerance")]
            tolerance: f64,
        },
        /// A chain over nodes that exist already, which it shares: a rigid joint between beams, or a line along several
        /// edges of blocks, around a corner too. Refined as far as its parts are.
        Chain {
            /// Name of the node, or of the chain.
            id: String => name,
            /// Names of single nodes, of whole chains (`ID.all`) and of edges of blocks. A chain or edge goes on from the
            /// node at which the one before it ends.
            of: Vec<String>,
            /// Nodes per element, 2 to 9.
            per_element: usize,
        },
        /// A mesh that is given node by node. `refine` does not divide its elements.
        ///
        /// Its nodes are called `ID.label`, and all of them `ID.all`. A solid on `ID` takes all elements, one on `ID.part`
        /// those of a part; `ID.part` and `ID.set` stand for all nodes of theirs, and `ID.side` is a line of sides, walked
        /// with the body on the left. Sides that do not hang together are several surfaces.
        Given {
            /// Name of the mesh.
            id: String => name,
            /// The nodes as `(label, x, y)`, in any order; no label stands twice.
            nodes: Vec<(usize, f64, f64)> => skip,
            /// The elements, part by part.
            elements: Vec<Cells> => skip,
            /// Nodes by name. Default: none.
            #[serde(default)]
            sets: Vec<NodeSet> => skip,
            /// Sides by name. Default: none.
            #[serde(default)]
            sides: Vec<SideSet> => skip,
        },
        /// A mesh from a file of Gmsh (.msh, version 2.2 or 4.1, text or binary), which becomes a Given one. Snapshots have it
        /// inside.
        ///
        /// Physical groups keep their names: those of surfaces are parts, those of curves are sides, those of points are sets.
        /// One without a name is called `surface2`, `line3` or `point4` by its number.
        Import {
            /// Name of the mesh.
            id: String => name,
            /// The file, beside the scene or in a folder below it.
            file: String,
            /// Whether quadrilaterals of eight nodes are integrated in 2 x 2 points. Default: false.
            #[serde(default, skip_serializing_if = "std::ops::Not::not")]
            reduced: bool,
            /// Factor on all coordinates, from the file's unit of length to the scene's. Default: 1.
            #[serde(default = "unit")]
            scale: f64,
        },
    }
}

impl Nodes {
    /// Its id.
    pub fn id(&self) -> &str {
        match self {
            Nodes::Node { id, .. }
            | Nodes::Line { id, .. }
            | Nodes::Arc { id, .. }
            | Nodes::Through { id, .. }
            | Nodes::Block { id, .. }
            | Nodes::Mesh { id, .. }
            | Nodes::Chain { id, .. }
            | Nodes::Given { id, .. }
            | Nodes::Import { id, .. } => id,
        }
    }
}

fn even() -> (f64, f64) {
    (1.0, 1.0)
}

fn joint_tolerance() -> f64 {
    1e-6
}

described! {
    /// The curved sides of a block. Default of each: straight.
    #[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
    #[serde(deny_unknown_fields, default)]
    pub struct Sides {
        /// The side between two corners; straight where none is given.
        pub bottom: Option<Side>,
        /// The side between two corners; straight where none is given.
        pub right: Option<Side>,
        /// The side between two corners; straight where none is given.
        pub top: Option<Side>,
        /// The side between two corners; straight where none is given.
        pub left: Option<Side>,
    }
}

impl Sides {
    /// In the order of the walk around the block: bottom, right, top, left.
    pub fn around(&self) -> [Option<&Side>; 4] {
        [
            self.bottom.as_ref(),
            self.right.as_ref(),
            self.top.as_ref(),
            self.left.as_ref(),
        ]
    }
}

described! {
    /// A curved side of a block, from corner to corner.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub enum Side {
        /// The circular arc about a center that is equally far from both corners, the shorter way round.
        Arc {
            /// Center of the circle.
            center: Point,
        },
        /// The curve of a chain that stands above the block in the scene, or of an earlier block's edge, walked either
        /// way; its ends are the two corners. Only the curve is taken, with the chain's own spacing (a graded edge is
        /// graded already); no nodes are shared.
        Along {
            /// Id of the chain, or name of the edge.
            chain: String,
        },
    }
}

described! {
    /// Where a block is put: first turned, then shifted.
    #[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
    #[serde(deny_unknown_fields, default)]
    pub struct Place {
        /// Degrees, anticlockwise. Default: 0.
        pub turn: f64,
        /// The point about which it turns. Default: (0, 0).
        pub about: Point,
        /// Default: (0, 0).
        pub shift: Point,
    }
}

described! {
    /// A material or section.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[allow(non_snake_case)]
    pub enum Material {
        /// A beam's section stiffnesses.
        Section {
            /// Name of the material.
            id: String => name,
            /// Axial stiffness, force.
            EA: f64,
            /// Bending stiffness, force times length squared.
            EI: f64,
            /// Shear stiffness, force. Default: none, that is shear-rigid.
            #[serde(default)]
            GA: Option<f64>,
        },
        /// An elastic continuum in the plane.
        Elastic {
            /// Name of the material.
            id: String => name,
            /// Young's modulus, force by area.
            E: f64,
            /// Poisson's ratio, 0 <= nu < 0.5.
            nu: f64,
            /// Default: svk.
            #[serde(default)]
            law: Law,
            /// Default: strain.
            #[serde(default)]
            plane: Plane,
            /// Thickness across the plane, of the undeformed body; none in axisymmetry. Default: 1.
            #[serde(default = "unit")]
            thickness: f64,
            /// Default: total.
            #[serde(default)]
            update: Update,
        },
    }
}

fn unit() -> f64 {
    1.0
}

impl Material {
    /// Its id.
    pub fn id(&self) -> &str {
        match self {
            Material::Section { id, .. } | Material::Elastic { id, .. } => id,
        }
    }
}

described! {
    /// A deformable body.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[allow(non_snake_case)]
    pub enum BodySpec {
        /// A geometrically exact planar beam along a chain of nodes.
        Beam {
            /// Name of the body.
            id: String => name,
            /// Id of the chain.
            along: String,
            /// Id of the material.
            material: String,
        },
        /// A continuum on a block, or on a mesh of several.
        Solid {
            /// Name of the body.
            id: String => name,
            /// Id of the block or mesh, or `ID.part` of a given one.
            mesh: String,
            /// Id of the material.
            material: String,
            /// Parts of another material; where they overlap, the last one holds. Default: none.
            #[serde(default)]
            regions: Vec<Region>,
        },
        /// A linear body, given by its matrix about the undeformed state: two degrees of freedom a node, x and y, in the order
        /// of `nodes`. Either `stiffness` (f = K u) or `compliance` (u = W f, W may be singular) is named, row by row;
        /// neither need be symmetric.
        Matrix {
            /// Name of the body.
            id: String => name,
            /// Names of nodes, each once.
            nodes: Vec<String>,
            /// K, force by length. Default: none.
            #[serde(default)]
            stiffness: Vec<Vec<f64>>,
            /// W, length by force. Default: none.
            #[serde(default)]
            compliance: Vec<Vec<f64>>,
            /// Displacement of the body under no force at load factor 1, times the load factor: u = free λ + W f. Default: zero.
            #[serde(default)]
            free: Vec<f64>,
        },
        /// Elastic bars, hinged at both ends, that turn as far as they like: N = EA (l - L) / L.
        Truss {
            /// Name of the body.
            id: String => name,
            /// Pairs of nodes, a bar between each.
            bars: Vec<(String, String)>,
            /// Axial stiffness of every bar, a force; in axisymmetry of all bars around together.
            EA: f64,
            /// Displacements are small: each bar keeps its direction. Default: false.
            #[serde(default, skip_serializing_if = "std::ops::Not::not")]
            small: bool,
        },
        /// Linear bars, their directions fixed: small displacements. In axisymmetry stiffnesses are of the whole circumference.
        Springs {
            /// Name of the body.
            id: String => name,
            /// The bars.
            bars: Vec<Bar>,
        },
    }
}

described! {
    /// A linear bar between two nodes, or from one node to the ground. It resists motion (of one node against the other)
    /// along its angle alone, both ways and from the start: there is no dead band.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct Bar {
        /// One node or two.
        pub nodes: Vec<String>,
        /// Degrees from +x, anticlockwise. Default: along the line between the two undeformed nodes.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub angle: Option<f64> => given,
        /// Force by length.
        pub stiffness: f64,
    }
}

described! {
    /// A part of a solid with a material of its own: the elements whose middle lies in an upright rectangle.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct Region {
        /// Lower left corner.
        pub from: Point,
        /// Upper right corner.
        pub to: Point,
        /// Id of the material.
        pub material: String,
    }
}

impl BodySpec {
    /// Its id.
    pub fn id(&self) -> &str {
        match self {
            BodySpec::Beam { id, .. }
            | BodySpec::Solid { id, .. }
            | BodySpec::Truss { id, .. }
            | BodySpec::Matrix { id, .. }
            | BodySpec::Springs { id, .. } => id,
        }
    }
}

described! {
    /// A master surface: the interface elements along a chain of nodes.
    ///
    /// Whoever walks along the chain has the outward side on the right (the body on the left, as along the boundary of
    /// a body whose nodes run anticlockwise). Nodes that belong to no body are restrained: the surface is rigid and
    /// adds no unknowns.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct SurfaceSpec {
        /// Name of the surface.
        pub id: String => name,
        /// Id of the chain, or name of the edge.
        pub along: String,
        /// Walk the chain the other way, so that the outward side changes. Default: false.
        #[serde(default)]
        pub reverse: bool,
        /// Goes on straight past both ends, for ever. For a straight, rigid surface. Default: false.
        #[serde(default)]
        pub endless: bool,
        /// One smooth curve through all nodes of the chain, so that the normal does not jump between its elements: from node
        /// to node a cubic, whose slope at a node is that of the parabola through it and its two neighbours. A sharp corner is
        /// rounded, too: where there is a real one, make two surfaces. Default: false, where each element is a curve of its
        /// own.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        pub smooth: bool,
        /// Cut at convex corners of more than 30 degrees into surfaces `ID.1`, `ID.2`, ..., of which a slave node of a solid touches
        /// only those that its own side faces. A node that goes past a corner at a small depth is nearer to the other side for a
        /// moment, and would be pressed out there. Default: false.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        pub cut: bool,
    }
}

described! {
    /// Slave nodes and the surfaces that they may touch.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct SlaveSpec {
        /// Names of nodes; `ID.all` stands for every node of a chain, and a block's `ID.left` for those of its edge, less
        /// those that cannot move over surfaces that cannot move either. The corner of two edges counts once.
        pub nodes: Vec<String>,
        /// Surfaces among which each node finds its own element.
        pub on: Vec<String>,
        /// The mode of the first minor iteration. Default: free.
        #[serde(default)]
        pub start: Mode,
        /// Friction of these nodes. Default: the scene's.
        #[serde(default)]
        pub friction: Option<FrictionSpec>,
        /// What holds where these nodes touch. Default: Hard.
        #[serde(default, skip_serializing_if = "ContactLaw::is_hard")]
        pub law: ContactLaw,
        /// Stick stiffness K_t, a shear stress by length: a node that sticks gives way along the surface by F_t / (K_t A), with its
        /// tributary area A (elastic slip). Default: none, it sticks rigidly.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub stick: Option<f64>,
        /// Tributary area of each of these nodes, undeformed. Default: none, it is that of the sides of its body.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub area: Option<f64>,
        /// What these nodes bring from iterations before the scene's first. Default: nothing.
        #[serde(default)]
        pub state: InitialState,
    }
}

described! {
    /// Restrained degrees of freedom of nodes.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct SupportSpec {
        /// Name of a node; `ID.all` for a whole chain.
        pub node: String,
        /// What is restrained.
        pub fix: Vec<Component>,
    }
}

described! {
    /// The path of the load factor.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct History {
        /// Corners of the path, the first of which is where the scene starts unloaded, usually 0.
        pub path: Vec<f64>,
        /// Size of an increment of the load factor; the last one of each leg is shorter where it must be.
        pub increment: f64,
        /// Sizes of the increments on each leg of the path, one a leg. Setting `increment` changes them in proportion. Default:
        /// `increment` on all.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        pub increments: Vec<f64>,
        /// Size below which an increment that fails is not cut any more (`strategy: ladder` halves it). Default: a 64th of
        /// the leg's increment.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub least: Option<f64> => given,
        /// What an increment does that jumps to another branch of equilibrium (`strategy: ladder`). Default: cut.
        #[serde(default, skip_serializing_if = "Jumps::is_default")]
        pub jumps: Jumps,
        /// What drives the history from one increment to the next. Default: load.
        #[serde(default, skip_serializing_if = "Control::is_default")]
        pub control: Control,
        /// How the path of equilibrium is followed, with `control: arc`. Default: along all displacements.
        #[serde(default, skip_serializing_if = "ArcSpec::is_default")]
        pub arc: ArcSpec,
    }
}

impl Default for History {
    /// One increment from 0 to 1.
    fn default() -> Self {
        History {
            path: vec![0.0, 1.0],
            increment: 1.0,
            increments: Vec::new(),
            least: None,
            jumps: Jumps::default(),
            control: Control::default(),
            arc: ArcSpec::default(),
        }
    }
}

impl History {
    /// Size of the increments on a leg of the path.
    pub fn on_leg(&self, leg: usize) -> f64 {
        on_leg(&self.increments, self.increment, leg)
    }

    /// Size below which no increment is cut.
    pub fn least(&self) -> f64 {
        let smallest = self.increments.iter().copied().reduce(f64::min);
        least(self.least, smallest.unwrap_or(self.increment))
    }
}
