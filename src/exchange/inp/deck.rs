//! What stands in a deck, as plain data: everything refers to everything else by position.

use super::source::Place;
use crate::mesh::CellKind;

/// A deck of CalculiX or Abaqus.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Deck {
    /// The deck's own name, then those of the files that it includes.
    pub files: Vec<String>,
    /// What stands below `*HEADING`, on one line.
    pub heading: String,
    /// The nodes, in the order of the deck.
    pub nodes: Vec<Node>,
    /// The elements, in the order of the deck.
    pub elements: Vec<Element>,
    /// Sets of nodes.
    pub node_sets: Vec<Set>,
    /// Sets of elements.
    pub element_sets: Vec<Set>,
    /// Surfaces.
    pub surfaces: Vec<Surface>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Sections; where two name the same element, the later one holds.
    pub sections: Vec<Section>,
    /// Amplitudes.
    pub amplitudes: Vec<Amplitude>,
    /// Contact laws.
    pub interactions: Vec<Interaction>,
    /// Contact pairs.
    pub pairs: Vec<Pair>,
    /// Surfaces that are tied to others.
    pub ties: Vec<Tie>,
    /// Supports that hold from the beginning.
    pub supports: Vec<Value>,
    /// The steps, one after another; one at least.
    pub steps: Vec<Step>,
    /// Sets of nodes whose displacements are printed.
    pub printed: Vec<usize>,
    /// What is not read, or read as something else, in the order of the deck; each once.
    pub remarks: Vec<Remark>,
}

/// A node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Its number in the deck.
    pub label: u64,
    /// Where it stands.
    pub at: [f64; 2],
    /// Where it is defined.
    pub place: Place,
}

/// What a part of an element list is made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Family {
    /// CPE: no strain across the plane.
    PlaneStrain,
    /// CPS: no stress across the plane.
    PlaneStress,
    /// CAX: rings about the axis x = 0.
    Axisymmetric,
    /// B21, B22 and their like: beams that bend in the plane.
    Beam,
}

/// A kind of element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ElementType {
    /// What it is made for.
    pub family: Family,
    /// Its shape, and the order of its nodes. A beam of three nodes has its middle in the middle here: start, middle, end.
    pub cell: CellKind,
    /// Whether a quadrilateral of eight nodes is integrated in 2 x 2 points.
    pub reduced: bool,
}

/// An element.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// Its number in the deck.
    pub label: u64,
    /// What it is.
    pub kind: ElementType,
    /// Positions in [`Deck::nodes`].
    pub nodes: Vec<usize>,
    /// Where it is defined.
    pub place: Place,
}

/// Nodes or elements by a name.
#[derive(Debug, Clone, PartialEq)]
pub struct Set {
    /// Its name, in capitals.
    pub name: String,
    /// Positions, ascending, each once.
    pub members: Vec<usize>,
}

/// A surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Its name, in capitals.
    pub name: String,
    /// What it is made of.
    pub of: Faces,
    /// Where it is defined.
    pub place: Place,
}

/// What a surface is made of.
#[derive(Debug, Clone, PartialEq)]
pub enum Faces {
    /// Sides of elements: position of the element, and of the side in it from 0.
    Elements(Vec<(usize, usize)>),
    /// Nodes.
    Nodes(Vec<usize>),
}

/// An elastic material.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Its name, in capitals.
    pub name: String,
    /// Young's modulus and Poisson's ratio.
    pub elastic: Option<(f64, f64)>,
    /// Mass by volume.
    pub density: Option<f64>,
    /// Where it is defined.
    pub place: Place,
    /// Where `*ELASTIC` stands.
    pub elastic_place: Place,
}

/// What elements are made of.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// The set of elements.
    pub set: usize,
    /// The material.
    pub material: usize,
    /// Its form.
    pub form: Form,
    /// Where it stands.
    pub place: Place,
}

/// The form of a section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Form {
    /// A continuum of this thickness; 1 where none is given, and for rings.
    Solid {
        /// Across the plane.
        thickness: f64,
    },
    /// A beam of a rectangular section.
    Rectangle {
        /// Across the plane.
        width: f64,
        /// In the plane.
        height: f64,
    },
}

/// A factor as a function of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Amplitude {
    /// Its name, in capitals.
    pub name: String,
    /// Whether its time is that since the first step's beginning, and not the step's own.
    pub total: bool,
    /// Time and factor, times rising.
    pub points: Vec<(f64, f64)>,
    /// Where it is defined.
    pub place: Place,
}

/// How surfaces act on each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Interaction {
    /// Its name, in capitals.
    pub name: String,
    /// Across the surface.
    pub normal: Normal,
    /// Coefficient of friction, 0 where there is none.
    pub friction: f64,
    /// Stick slope: shear stress by elastic slip; none where sticking is rigid.
    pub stick: Option<f64>,
    /// Where it is defined.
    pub place: Place,
    /// Where `*SURFACE BEHAVIOR` stands.
    pub normal_place: Place,
    /// Where `*FRICTION` stands.
    pub friction_place: Place,
}

/// A contact law across the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Normal {
    /// Nothing goes through.
    Hard,
    /// Pressure by overclosure.
    Linear {
        /// Pressure by length.
        stiffness: f64,
    },
    /// Held together, in tension too.
    Tied {
        /// Stress by length of opening.
        stiffness: f64,
    },
}

/// A contact pair.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// The surface whose nodes are slaves.
    pub slave: usize,
    /// The surface of the masters.
    pub master: usize,
    /// The contact law.
    pub interaction: usize,
    /// Whether the deck asks for the integrated contact of faces.
    pub faces: bool,
    /// Whether masters are found once, at the beginning.
    pub small_sliding: bool,
    /// Which nodes are moved onto the master at the beginning.
    pub adjust: Option<Adjust>,
    /// Where it stands.
    pub place: Place,
}

/// Which nodes are moved onto their master before the first step, without stress.
#[derive(Debug, Clone, PartialEq)]
pub enum Adjust {
    /// Those inside, or at most so far away.
    Within(f64),
    /// Those of a set.
    Set(usize),
}

/// A surface tied to another.
#[derive(Debug, Clone, PartialEq)]
pub struct Tie {
    /// The surface whose nodes are tied.
    pub slave: usize,
    /// The surface to which they are.
    pub master: usize,
    /// How far apart they may be; none where the deck does not say.
    pub tolerance: Option<f64>,
    /// Whether tied nodes are moved onto the master without stress.
    pub adjust: bool,
    /// Where it stands.
    pub place: Place,
}

/// A step.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Step {
    /// Where it begins.
    pub place: Place,
    /// Where `*STATIC` stands.
    pub static_place: Place,
    /// Whether strains and rotations are large in it.
    pub nlgeom: bool,
    /// Whether loads without an amplitude are there at once, and not in proportion to time.
    pub at_once: bool,
    /// Its increments.
    pub time: Time,
    /// Whether supports and prescribed motions of the steps before are given up.
    pub new_motions: bool,
    /// Whether point loads of the steps before are given up.
    pub new_forces: bool,
    /// Whether loads on elements of the steps before are given up.
    pub new_pressures: bool,
    /// Prescribed degrees of freedom.
    pub motions: Vec<Value>,
    /// Point loads.
    pub forces: Vec<Value>,
    /// Pressure on sides of elements.
    pub pressures: Vec<Pressure>,
    /// Weight.
    pub weights: Vec<Weight>,
}

/// The increments of a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Time {
    /// The first increment.
    pub initial: f64,
    /// All of the step.
    pub period: f64,
    /// Least increment.
    pub least: Option<f64>,
    /// Largest increment.
    pub most: Option<f64>,
    /// Whether all increments are as the first.
    pub direct: bool,
}

/// A component of a node's motion or load.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Direction {
    /// 1.
    X,
    /// 2.
    Y,
    /// 6, about the normal of the plane.
    Rotation,
}

/// A value for one component of one node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Value {
    /// The node.
    pub node: usize,
    /// The component.
    pub direction: Direction,
    /// Length, angle, force or moment.
    pub value: f64,
    /// Its amplitude.
    pub amplitude: Option<usize>,
    /// Where it stands.
    pub place: Place,
}

/// Pressure on a side of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pressure {
    /// The element.
    pub element: usize,
    /// The side, from 0.
    pub side: usize,
    /// Force by area, towards the element.
    pub value: f64,
    /// Its amplitude.
    pub amplitude: Option<usize>,
    /// Where it stands.
    pub place: Place,
}

/// Force by volume on an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weight {
    /// The element.
    pub element: usize,
    /// What acts.
    pub load: Volume,
    /// Its amplitude.
    pub amplitude: Option<usize>,
    /// Where it stands.
    pub place: Place,
}

/// A force on all of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Volume {
    /// Acceleration, which acts on the density.
    Gravity([f64; 2]),
    /// Force by volume.
    Force([f64; 2]),
}

/// Something that a reader of results should know.
#[derive(Debug, Clone, PartialEq)]
pub struct Remark {
    /// Where it stands first.
    pub place: Place,
    /// What is done with it.
    pub text: String,
    /// How often it stands there.
    pub times: usize,
}
