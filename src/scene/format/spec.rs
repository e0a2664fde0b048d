//! The scene file as its author writes it: one Rust type per RON construct.
//!
//! Only types are checked here; [`stickslip_core::model`] turns a [`Spec`] into a [`Model`](stickslip_core::model::Model) and
//! rejects invalid values. Every field is either required or has the default named in its comment.

use super::arc::ArcSpec;
use super::contact_law::{ContactLaw, FrictionSpec};
use super::described::Described;
use super::described::macros::described;
use super::given::{Cells, NodeSet, SideSet};
use super::in_space::SpaceSpec;
pub use super::loads::{LoadSpec, Scale};
pub use super::monitor::{MonitorSpec, Quantity};
use stickslip_core::model::{SlavePoints, least, on_leg};
use stickslip_core::words::is_default;
use stickslip_core::{
    Component, Control, ElementKind, InitialState, Jumps, Law, Mode, Plane, Settings, Update,
};

/// A point or a vector in the plane, `(x, y)`, in the scene's unit of length.
pub type Point = (f64, f64);

described! {
    /// A whole scene file.
    pub struct Spec {
        /// One-line title of the scene.
        pub title: String,
        /// A short description for the reader: source, units, what to look for. Default: empty.
        #[serde(default)]
        pub about: String => skip,
        /// Number of parts into which every generated element is divided (per direction). Default: 1.
        #[serde(default = "one")]
        pub refine: usize,
        /// Nodes, given one by one or generated along curves.
        pub nodes: Vec<Nodes>,
        /// Materials and sections by name.
        pub materials: Vec<Material>,
        /// Deformable bodies.
        pub bodies: Vec<BodySpec>,
        /// Master surfaces. Default: none.
        #[serde(default)]
        pub surfaces: Vec<SurfaceSpec>,
        /// Slave nodes. Default: none.
        #[serde(default)]
        pub slaves: Vec<SlaveSpec>,
        /// Coulomb friction of all slave nodes without a `friction` value. Default: smooth.
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
        /// Options and limits of the method. Default: those of [`Settings`].
        #[serde(default)]
        pub settings: Settings,
        /// Quantities that `--csv` and the load-displacement view report. Default: none.
        #[serde(default)]
        pub monitors: Vec<MonitorSpec>,
        /// Scene of an attached solver, as sent by that solver. The rest of the file is then ignored, and only the attached
        /// solver can solve the scene (manual page `attaching`). Default: none.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub attached: Option<String> => skip,
        /// An interface problem in space. Of the rest of the file only title, text and settings are used. Default: none.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub in_space: Option<SpaceSpec> => skip,
    }
}

impl Default for Spec {
    /// A scene without nodes and bodies.
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
            in_space: None,
        }
    }
}

fn one() -> usize {
    1
}

described! {
    /// Nodes, given one by one or in chains of m-node elements.
    ///
    /// The nodes of a chain are `ID.1`, `ID.2`, … in order. `ID.start`, `ID.end`, `ID@0.5` (at that fraction of the chain's
    /// parameter) and `ID.all` are independent of the refinement. The same names exist for each edge of a block.
    pub enum Nodes {
        /// A single node named `id`.
        Node {
            /// Name of the node.
            id: String => name,
            /// Position.
            at: Point,
        },
        /// A straight chain.
        Line {
            /// Name of the chain.
            id: String => name,
            /// First node.
            from: Point,
            /// Last node.
            to: Point,
            /// Number of elements, before refinement.
            elements: usize,
            /// Nodes per element, 2 to 9.
            per_element: usize,
        },
        /// A circular arc. Angles are in degrees, anticlockwise from +x; `from` may exceed `to`.
        Arc {
            /// Name of the chain.
            id: String => name,
            /// Center of the circle.
            center: Point,
            /// Radius of the circle, a length.
            radius: f64,
            /// Angle of the first node.
            from: f64,
            /// Angle of the last node.
            to: f64,
            /// Number of elements, before refinement.
            elements: usize,
            /// Nodes per element, 2 to 9.
            per_element: usize,
        },
        /// A chain through given points; each element is the Lagrange curve through its points.
        Through {
            /// Name of the chain.
            id: String => name,
            /// The nodes before refinement, in order; neighbouring elements share a node.
            points: Vec<Point>,
            /// Nodes per element, 2 to 9.
            per_element: usize,
        },
        /// A mesh on a block with four sides, made of 8-node quadrilaterals or another kind of element.
        ///
        /// Its edges are chains `ID.bottom`, `ID.right`, `ID.top` and `ID.left`, walked anticlockwise, so that the outward side
        /// is on the right. Their elements have 2 or 3 nodes, like the sides of the block's elements. Edges can be used wherever
        /// a chain can, and without `.all` in lists of nodes. All nodes are `ID.1`, `ID.2`, … row by row from the bottom, and
        /// `ID.all`.
        Block {
            /// Name of the block.
            id: String => name,
            /// Two opposite corners of an axis-parallel rectangle, lower left and upper right; or all four corners of a
            /// quadrilateral, anticlockwise, starting with the bottom edge.
            corners: Vec<Point>,
            /// Number of elements along the bottom and along the left edge, before refinement.
            elements: (usize, usize),
            /// Kind of element; for a triangle, each cell is cut into two. Default: quad8.
            #[serde(default, skip_serializing_if = "is_default")]
            element: ElementKind,
            /// Ratio of the last to the first element length, along bottom and top (left to right) and along left and right
            /// (upwards); lengths grow by a constant factor. Refinement divides each element evenly. Default: (1, 1).
            #[serde(default = "even")]
            grading: (f64, f64),
            /// Curved sides; the interior is blended from all four sides. Default: none.
            #[serde(default)]
            sides: Sides,
            /// Rotation and translation applied to the finished block, including its curved sides. Default: no change.
            #[serde(default)]
            place: BlockPosition,
        },
        /// Several blocks joined along edges into one mesh. Blocks without a joint stay separate, however close they are.
        Mesh {
            /// Name of the mesh.
            id: String => name,
            /// Ids of the blocks. Their edges keep their names; a common node keeps its name from each block.
            of: Vec<String>,
            /// Pairs of edges to merge, for example `("a.right", "b.left")`; their nodes must coincide one by one.
            joints: Vec<(String, String)>,
            /// Maximum distance of two merged nodes, relative to the length of the edge; the node of the first edge stays.
            /// Default: 1e-6.
            #[serde(default = "joint_tolerance")]
            tolerance: f64,
        },
        /// A chain over existing nodes, which it shares: a rigid joint between beams, or a line along several edges of blocks,
        /// including around corners. It is refined with its parts.
        Chain {
            /// Name of the chain.
            id: String => name,
            /// Names of single nodes, of whole chains (`ID.all`) and of block edges. Each chain or edge must start at the last
            /// node of the previous one.
            of: Vec<String>,
            /// Nodes per element, 2 to 9.
            per_element: usize,
        },
        /// A mesh given node by node. `refine` does not divide its elements.
        ///
        /// Its nodes are `ID.label`, together `ID.all`. A solid on `ID` contains all elements, a solid on `ID.part` those of a
        /// part. `ID.part` and `ID.set` refer to all nodes of a part or set, and `ID.side` to a line of sides, walked with the
        /// body on the left. Unconnected sides become several surfaces.
        Given {
            /// Name of the mesh.
            id: String => name,
            /// The nodes as `(label, x, y)`, in any order; labels are unique.
            nodes: Vec<(usize, f64, f64)> => skip,
            /// The elements, part by part.
            elements: Vec<Cells> => skip,
            /// Named sets of nodes. Default: none.
            #[serde(default)]
            sets: Vec<NodeSet> => skip,
            /// Named sets of sides. Default: none.
            #[serde(default)]
            sides: Vec<SideSet> => skip,
        },
        /// A mesh from a Gmsh file (.msh, version 2.2 or 4.1, text or binary), converted to a Given mesh. Snapshots contain the
        /// mesh.
        ///
        /// Physical groups keep their names: surfaces become parts, curves become sides, points become sets. A group without a
        /// name is called `surface2`, `line3` or `point4`, by its number.
        Import {
            /// Name of the mesh.
            id: String => name,
            /// The file, in the folder of the scene or below.
            file: String,
            /// Whether 8-node quadrilaterals use reduced integration (2 x 2 points). Default: false.
            #[serde(default, skip_serializing_if = "std::ops::Not::not")]
            reduced: bool,
            /// Factor applied to all coordinates, from the file's unit of length to the scene's. Default: 1.
            #[serde(default = "unit")]
            scale: f64,
        },
    }
}

impl Nodes {
    /// The id.
    pub fn id(&self) -> &str {
        self.called().unwrap_or_default()
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
    #[derive(Default)]
    #[serde(default)]
    pub struct Sides {
        /// Shape of the bottom side; straight if omitted.
        pub bottom: Option<Side>,
        /// Shape of the right side; straight if omitted.
        pub right: Option<Side>,
        /// Shape of the top side; straight if omitted.
        pub top: Option<Side>,
        /// Shape of the left side; straight if omitted.
        pub left: Option<Side>,
    }
}

impl Sides {
    /// In walking order around the block: bottom, right, top, left.
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
    pub enum Side {
        /// The shorter circular arc between both corners, about a center at equal distance from them.
        Arc {
            /// Center of the circle.
            center: Point,
        },
        /// The curve of a chain, or of a block's edge, defined earlier in the scene, in either direction; its ends are the two
        /// corners. Only the curve and its spacing are copied (so a graded edge is graded already); no nodes are shared.
        Along {
            /// Id of the chain, or name of the edge.
            chain: String,
        },
    }
}

described! {
    /// Position of a block: rotation, then translation.
    #[derive(Copy, Default)]
    #[serde(default)]
    pub struct BlockPosition {
        /// Rotation in degrees, anticlockwise. Default: 0.
        pub turn: f64,
        /// Center of the rotation. Default: (0, 0).
        pub about: Point,
        /// Translation. Default: (0, 0).
        pub shift: Point,
    }
}

described! {
    /// A material or section.
    #[allow(non_snake_case)]
    pub enum Material {
        /// Section stiffnesses of a beam.
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
        /// A plane elastic continuum.
        Elastic {
            /// Name of the material.
            id: String => name,
            /// Young's modulus, force per area.
            E: f64,
            /// Poisson's ratio, 0 <= nu < 0.5.
            nu: f64,
            /// Stress-strain law. Default: svk.
            #[serde(default)]
            law: Law,
            /// Assumption about the out-of-plane direction. Default: strain.
            #[serde(default)]
            plane: Plane,
            /// Undeformed thickness across the plane; not used in axisymmetry. Default: 1.
            #[serde(default = "unit")]
            thickness: f64,
            /// Reference configuration of strains and stresses. Default: total.
            #[serde(default)]
            update: Update,
        },
    }
}

fn unit() -> f64 {
    1.0
}

impl Material {
    /// The id.
    pub fn id(&self) -> &str {
        self.called().unwrap_or_default()
    }
}

described! {
    /// A deformable body.
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
        /// A continuum on a block or on a mesh.
        Solid {
            /// Name of the body.
            id: String => name,
            /// Id of the block or mesh, or `ID.part` of a given mesh.
            mesh: String,
            /// Id of the material.
            material: String,
            /// Regions with another material; where they overlap, the last one wins. Default: none.
            #[serde(default)]
            regions: Vec<Region>,
        },
        /// A linear body given by its matrix about the undeformed state: two degrees of freedom per node, x and y, in the order
        /// of `nodes`. Give either `stiffness` (f = K u) or `compliance` (u = W f, W may be singular), row by row. The matrix
        /// need not be symmetric.
        Matrix {
            /// Name of the body.
            id: String => name,
            /// Names of the nodes, each once.
            nodes: Vec<String>,
            /// K, force per length. Default: none.
            #[serde(default)]
            stiffness: Vec<Vec<f64>>,
            /// W, length per force. Default: none.
            #[serde(default)]
            compliance: Vec<Vec<f64>>,
            /// W by its nonzero entries `(row, column, value)`, from 0, instead of all rows; repeated ones are added. Default:
            /// none.
            #[serde(default, skip_serializing_if = "Vec::is_empty")]
            entries: Vec<(usize, usize, f64)> => skip,
            /// Displacement of the body without forces at load factor 1; it is multiplied by the load factor: u = free λ + W f.
            /// Default: zero.
            #[serde(default)]
            free: Vec<f64>,
        },
        /// Elastic bars, hinged at both ends, with arbitrarily large rotations: N = EA (l - L) / L.
        Truss {
            /// Name of the body.
            id: String => name,
            /// Pairs of nodes; each pair is a bar.
            bars: Vec<(String, String)>,
            /// Axial stiffness of every bar, force; in axisymmetry for the whole circumference.
            EA: f64,
            /// Small displacements: each bar keeps its direction. Default: false.
            #[serde(default, skip_serializing_if = "std::ops::Not::not")]
            small: bool,
        },
        /// Linear bars with fixed directions (small displacements). In axisymmetry, stiffnesses refer to the whole circumference.
        Springs {
            /// Name of the body.
            id: String => name,
            /// The bars.
            bars: Vec<Bar>,
        },
    }
}

described! {
    /// A linear bar between two nodes, or from one node to the ground. It resists relative motion along its angle only, in
    /// tension and compression, without a dead band.
    pub struct Bar {
        /// One or two nodes.
        pub nodes: Vec<String>,
        /// Angle in degrees from +x, anticlockwise. Default: along the line between the two undeformed nodes.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub angle: Option<f64> => given,
        /// Stiffness, force per length.
        pub stiffness: f64,
    }
}

described! {
    /// A part of a solid with a different material: the elements whose midpoint lies in an axis-parallel rectangle.
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
    /// The id.
    pub fn id(&self) -> &str {
        self.called().unwrap_or_default()
    }
}

described! {
    /// A master surface: the interface elements along a chain of nodes.
    ///
    /// The outward side is on the right when walking along the chain (the body is on the left, as on the boundary of a body
    /// walked anticlockwise). Nodes that belong to no body are fixed: the surface is rigid and adds no unknowns.
    #[derive(Default)]
    pub struct SurfaceSpec {
        /// Name of the surface.
        pub id: String => name,
        /// Id of the chain, or name of the edge.
        pub along: String,
        /// Walk the chain in the opposite direction, which swaps the outward side. Default: false.
        #[serde(default)]
        pub reverse: bool,
        /// Extend the surface straight beyond both ends; requires a straight, rigid surface. Default: false.
        #[serde(default)]
        pub endless: bool,
        /// Extend the surface past each of its ends by this part of its first or last element, on the same curve. A slave node in
        /// contact stays in contact up to there; a free node can come into contact up to half of that. Without an extension, a node
        /// at an end of the surface leaves it with the smallest motion outward. Default: 0.1 at an end with which a slave
        /// surface ends too, 0.25 at an end on a line of symmetry that a slave node follows, and 0 at others.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub past_ends: Option<f64>,
        /// Use one smooth curve through all nodes of the chain, so that the normal does not jump between elements: a cubic from
        /// node to node, whose slope at a node is that of the parabola through the node and its two neighbours. Sharp corners are
        /// rounded too; where a corner is real, define two surfaces. Default: false, each element is a separate curve.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        pub smooth: bool,
        /// Cut the surface at convex corners of more than 30 degrees into surfaces `ID.1`, `ID.2`, ...; a slave node of a solid
        /// then touches only those that its own side faces. Without cuts, a node that passes a corner with a small penetration is
        /// briefly closer to the other side and would be pushed out there. Default: false.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        pub cut: bool,
    }
}

described! {
    /// Slave nodes and the surfaces that they may touch.
    #[derive(Default)]
    pub struct SlaveSpec {
        /// Names of nodes. `ID.all` means every node of a chain, and an edge such as `ID.left` of a block all its nodes, except
        /// nodes that cannot move if the surface cannot move either. A corner of two edges counts once.
        pub nodes: Vec<String>,
        /// Surfaces that each node may touch.
        pub on: Vec<String>,
        /// The mode of the first minor iteration. Default: free.
        #[serde(default)]
        pub start: Mode,
        /// Friction of these nodes. Default: the scene's.
        #[serde(default)]
        pub friction: Option<FrictionSpec>,
        /// Contact law of these nodes. Default: Hard.
        #[serde(default, skip_serializing_if = "ContactLaw::is_hard")]
        pub law: ContactLaw,
        /// Stick stiffness K_t, shear stress per length: a stuck node yields along the surface by F_t / (K_t A) with its
        /// tributary area A (elastic slip). Default: none, sticking is rigid; for points of faces (`by: surface`), whose rigid
        /// sticking would be more equations than a face has unknowns, the stiffness of the law.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub stick: Option<f64>,
        /// The points of the slave surface at which the law holds. Default: node.
        #[serde(default, skip_serializing_if = "SlavePoints::is_node")]
        pub by: SlavePoints,
        /// Names of the sides that make up the slave surface: chains, or sides of a given mesh. The areas of the nodes and the
        /// points of faces are those of these sides. Default: none, the sides of bodies that have all their nodes in this list.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        pub sides: Vec<String>,
        /// Undeformed tributary area of each of these nodes. Default: none, it is computed from the sides of the body.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub area: Option<f64>,
        /// Values from iterations before the scene's first one. Default: nothing.
        #[serde(default)]
        pub state: InitialState,
    }
}

described! {
    /// Restrained degrees of freedom of a node.
    pub struct SupportSpec {
        /// Name of a node; `ID.all` for a whole chain.
        pub node: String,
        /// The restrained degrees of freedom.
        pub fix: Vec<Component>,
    }
}

described! {
    /// The path of the load factor.
    pub struct History {
        /// Corners of the path. The first one, usually 0, is the unloaded state.
        pub path: Vec<f64>,
        /// Increment of the load factor; the last increment of a leg may be shorter.
        pub increment: f64,
        /// Increment on each leg of the path, one value per leg. Setting `increment` scales all of them. Default: `increment` on
        /// all.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        pub increments: Vec<f64>,
        /// Size below which a failing increment is no longer cut (`strategy: ladder` halves it). Default: 1/64 of the leg's
        /// increment.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub least: Option<f64> => given,
        /// What to do with an increment that jumps to another equilibrium branch (`strategy: ladder`). Default: cut.
        #[serde(default, skip_serializing_if = "is_default")]
        pub jumps: Jumps,
        /// What controls the history from one increment to the next. Default: load.
        #[serde(default, skip_serializing_if = "is_default")]
        pub control: Control,
        /// Parameters of arc-length control, with `control: arc`. Default: along all displacements.
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

impl Spec {
    /// Notes about values without effect.
    pub fn notes(&self) -> Vec<String> {
        let is_nothing =
            |scale: &Scale| !scale.is_empty() && scale.iter().all(|(_, by)| *by == 0.0);
        let loads = self.loads.iter().enumerate();
        let loads = loads.filter(|(_, load)| is_nothing(load.scale()));
        let loads = loads.map(|(k, _)| format!("loads[{k}] is 0 at every load factor (scale)"));
        let is_ignored = |slave: &SlaveSpec| {
            slave.start == Mode::Free && (slave.state.f_n, slave.state.f_t) != (0.0, 0.0)
        };
        let slaves = self.slaves.iter().enumerate();
        let slaves = slaves.filter(|(_, slave)| is_ignored(slave));
        let slaves = slaves.map(|(k, _)| {
            format!("slaves[{k}].state: f_n and f_t have no effect on nodes that start free")
        });
        loads.chain(slaves).collect()
    }
}

impl History {
    /// Increment size on a leg of the path.
    pub fn on_leg(&self, leg: usize) -> f64 {
        on_leg(&self.increments, self.increment, leg)
    }

    /// Size below which an increment is no longer cut.
    pub fn least(&self) -> f64 {
        let smallest = self.increments.iter().copied().reduce(f64::min);
        least(self.least, smallest.unwrap_or(self.increment))
    }
}
