//! The contents of a deck as plain data; objects refer to each other by index.

use super::source::DeckLocation;
use crate::mesh::CellKind;
use std::collections::BTreeMap;

/// A CalculiX or Abaqus deck.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Deck {
    /// The deck's own name, then those of its include files.
    pub files: Vec<String>,
    /// Text of `*HEADING`, on one line.
    pub heading: String,
    /// Nodes in deck order.
    pub nodes: Vec<Node>,
    /// Elements in deck order.
    pub elements: Vec<Element>,
    /// Sets of nodes.
    pub node_sets: Vec<Set>,
    /// Sets of elements.
    pub element_sets: Vec<Set>,
    /// Surfaces.
    pub surfaces: Vec<Surface>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Sections; a later section overrides an earlier one for the same element.
    pub sections: Vec<Section>,
    /// Amplitudes.
    pub amplitudes: Vec<Amplitude>,
    /// Contact laws.
    pub interactions: Vec<Interaction>,
    /// Contact pairs.
    pub pairs: Vec<Pair>,
    /// Ties between surfaces.
    pub ties: Vec<Tie>,
    /// Supports that are active from the start.
    pub supports: Vec<Value>,
    /// Temperatures before the first step, by node.
    pub temperatures: BTreeMap<usize, f64>,
    /// The steps in order, at least one.
    pub steps: Vec<Step>,
    /// Node sets whose displacements are printed.
    pub printed: Vec<usize>,
    /// Warnings about ignored or reinterpreted input, in deck order, each once.
    pub remarks: Vec<Remark>,
    /// Whether cards that may support, load or couple nodes were skipped; only in outlines.
    pub is_incomplete: bool,
    /// Whether cards were skipped because they have errors; only in outlines.
    pub has_faults: bool,
}

/// A node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Number in the deck.
    pub label: u64,
    /// Position; z is 0 except in outlines.
    pub at: [f64; 3],
    /// Where it is defined.
    pub place: DeckLocation,
}

impl Node {
    /// Position in the plane.
    pub fn plane(&self) -> [f64; 2] {
        let [x, y, _] = self.at;
        [x, y]
    }
}

/// Family of elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Family {
    /// CPE: plane strain.
    PlaneStrain,
    /// CPS: plane stress.
    PlaneStress,
    /// CAX: rings about the axis x = 0.
    Axisymmetric,
    /// B21, B22 and similar: plane beams.
    Beam,
    /// C3D: solids; only in outlines.
    Solid,
}

/// A kind of element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ElementType {
    /// Family.
    pub family: Family,
    /// Shape and node order. The nodes of a 3-node beam are stored as start, middle, end.
    pub cell: CellKind,
    /// Whether an 8-node quadrilateral uses 2 x 2 integration points.
    pub reduced: bool,
}

/// An element.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// Number in the deck.
    pub label: u64,
    /// Kind of element.
    pub kind: ElementType,
    /// Indices into [`Deck::nodes`].
    pub nodes: Vec<usize>,
    /// Where it is defined.
    pub place: DeckLocation,
}

/// A named set of nodes or elements.
#[derive(Debug, Clone, PartialEq)]
pub struct Set {
    /// Name in uppercase.
    pub name: String,
    /// Indices, ascending, each once.
    pub members: Vec<usize>,
}

/// A surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Name in uppercase.
    pub name: String,
    /// Faces or nodes of the surface.
    pub of: Faces,
    /// Where it is defined.
    pub place: DeckLocation,
}

/// Faces or nodes of a surface.
#[derive(Debug, Clone, PartialEq)]
pub enum Faces {
    /// Sides of elements: index of the element, and of its side from 0.
    Elements(Vec<(usize, usize)>),
    /// Nodes.
    Nodes(Vec<usize>),
}

/// An elastic material.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name in uppercase.
    pub name: String,
    /// Young's modulus and Poisson's ratio.
    pub elastic: Option<(f64, f64)>,
    /// Mass per volume.
    pub density: Option<f64>,
    /// Largest yield stress; only in an outline.
    pub yields: Option<f64>,
    /// Coefficient of thermal expansion, if it is a single one.
    pub expansion: Option<f64>,
    /// Where it is defined.
    pub place: DeckLocation,
    /// Location of `*ELASTIC`.
    pub elastic_place: DeckLocation,
}

/// Assigns a material to elements.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// The set of elements.
    pub set: usize,
    /// The material.
    pub material: usize,
    /// Kind of section.
    pub form: Form,
    /// Location.
    pub place: DeckLocation,
}

/// Kind of section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Form {
    /// A continuum with this thickness; 1 by default and for rings.
    Solid {
        /// Across the plane.
        thickness: f64,
    },
    /// A beam with a rectangular section.
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
    /// Name in uppercase.
    pub name: String,
    /// Whether its time counts from the start of the first step instead of the current step.
    pub total: bool,
    /// Time and factor, with ascending times.
    pub points: Vec<(f64, f64)>,
    /// Where it is defined.
    pub place: DeckLocation,
}

/// Interaction of two surfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct Interaction {
    /// Name in uppercase.
    pub name: String,
    /// Law in the normal direction.
    pub normal: Normal,
    /// Coefficient of friction; 0 for none.
    pub friction: f64,
    /// Stick slope: shear stress per elastic slip; `None` for rigid stick.
    pub stick: Option<f64>,
    /// Where it is defined.
    pub place: DeckLocation,
    /// Location of `*SURFACE BEHAVIOR`.
    pub normal_place: DeckLocation,
    /// Location of `*FRICTION`.
    pub friction_place: DeckLocation,
}

/// A contact law in the normal direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Normal {
    /// No penetration.
    Hard,
    /// Pressure proportional to overclosure.
    Linear {
        /// Pressure per length.
        stiffness: f64,
    },
    /// Tied, in tension too.
    Tied {
        /// Stress per length of opening.
        stiffness: f64,
    },
}

/// A contact pair.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// The slave surface.
    pub slave: usize,
    /// The master surface.
    pub master: usize,
    /// The contact law.
    pub interaction: usize,
    /// Whether the deck requests surface-to-surface contact.
    pub faces: bool,
    /// Whether master faces are determined only once, at the start.
    pub small_sliding: bool,
    /// Nodes that are moved onto the master at the start.
    pub adjust: Option<Adjust>,
    /// Location.
    pub place: DeckLocation,
}

/// Nodes that are moved onto their master before the first step, without stress.
#[derive(Debug, Clone, PartialEq)]
pub enum Adjust {
    /// Nodes inside, or at most this far away.
    Within(f64),
    /// The nodes of a set.
    Set(usize),
}

/// A surface tied to another.
#[derive(Debug, Clone, PartialEq)]
pub struct Tie {
    /// The slave surface.
    pub slave: usize,
    /// The master surface.
    pub master: usize,
    /// Maximum distance; `None` if not given.
    pub tolerance: Option<f64>,
    /// Whether tied nodes are moved onto the master without stress.
    pub adjust: bool,
    /// Location.
    pub place: DeckLocation,
}

/// A step.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Step {
    /// Location of its first line.
    pub place: DeckLocation,
    /// Location of `*STATIC`.
    pub static_place: DeckLocation,
    /// Whether strains and rotations are large.
    pub nlgeom: bool,
    /// Whether loads without an amplitude apply at once instead of in proportion to time.
    pub at_once: bool,
    /// Maximum number of increments.
    pub increments: Option<u64>,
    /// Its increments.
    pub time: Time,
    /// Whether prescribed displacements of earlier steps are removed.
    pub new_motions: bool,
    /// Whether point loads of earlier steps are removed.
    pub new_forces: bool,
    /// Whether pressures of earlier steps are removed.
    pub new_pressures: bool,
    /// Whether volume forces of earlier steps are removed.
    pub new_weights: bool,
    /// Whether temperatures of earlier steps are removed.
    pub new_temperatures: bool,
    /// Prescribed degrees of freedom.
    pub motions: Vec<Value>,
    /// Point loads.
    pub forces: Vec<Value>,
    /// Pressure on sides of elements.
    pub pressures: Vec<Pressure>,
    /// Volume forces.
    pub weights: Vec<Weight>,
    /// Rises of the temperature above that before the first step; the direction has no meaning.
    pub temperatures: Vec<Value>,
}

/// The increments of a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Time {
    /// First increment.
    pub initial: f64,
    /// Duration of the step.
    pub period: f64,
    /// Minimum increment.
    pub least: Option<f64>,
    /// Maximum increment.
    pub most: Option<f64>,
    /// Whether all increments have the size of the first.
    pub direct: bool,
}

/// A component of a nodal displacement or load.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Direction {
    /// 1.
    X,
    /// 2.
    Y,
    /// 3; only in outlines.
    Z,
    /// 6, about the out-of-plane axis.
    Rotation,
}

impl Direction {
    /// The direction with a number in a deck, if it is one of these.
    pub fn from_number(number: u64) -> Option<Direction> {
        Some(match number {
            1 => Direction::X,
            2 => Direction::Y,
            3 => Direction::Z,
            6 => Direction::Rotation,
            _ => return None,
        })
    }

    /// Its number in a deck.
    pub fn number(self) -> u64 {
        match self {
            Direction::X => 1,
            Direction::Y => 2,
            Direction::Z => 3,
            Direction::Rotation => 6,
        }
    }

    /// The axis of a translation, from 0.
    pub fn axis(self) -> Option<usize> {
        (self != Direction::Rotation).then_some(self as usize)
    }
}

/// A value for one component of one node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Value {
    /// The node.
    pub node: usize,
    /// The component.
    pub direction: Direction,
    /// Displacement, angle, force or moment.
    pub value: f64,
    /// Its amplitude.
    pub amplitude: Option<usize>,
    /// Location.
    pub place: DeckLocation,
}

/// Pressure on a side of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pressure {
    /// The element.
    pub element: usize,
    /// Index of the side.
    pub side: usize,
    /// Force per area, towards the element.
    pub value: f64,
    /// Its amplitude.
    pub amplitude: Option<usize>,
    /// Location.
    pub place: DeckLocation,
}

/// A volume force on an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weight {
    /// The element.
    pub element: usize,
    /// Kind and value.
    pub load: Volume,
    /// Its amplitude.
    pub amplitude: Option<usize>,
    /// Location.
    pub place: DeckLocation,
}

/// Kind of a volume force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Volume {
    /// Acceleration, multiplied by the density.
    Gravity {
        /// Its components.
        acceleration: [f64; 3],
        /// The unit vector of the deck's direction, also of an acceleration of zero.
        direction: [f64; 3],
    },
    /// Force per volume along an axis.
    Force {
        /// The axis, 0 to 2.
        axis: usize,
        /// Its size.
        value: f64,
    },
}

/// The volume forces of an element that replace each other from step to step; forces of different kinds are added.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum VolumeKind {
    /// Forces along an axis.
    Force(usize),
    /// Accelerations in a direction: its components in units of 1e-9, rounded so that equal directions compare equal.
    Gravity([i64; 3]),
}

impl Volume {
    /// Its kind.
    pub fn kind(&self) -> VolumeKind {
        match self {
            Volume::Force { axis, .. } => VolumeKind::Force(*axis),
            Volume::Gravity { direction, .. } => {
                VolumeKind::Gravity(direction.map(|part| (part * 1e9).round() as i64))
            }
        }
    }
}

/// A warning for the user.
#[derive(Debug, Clone, PartialEq)]
pub struct Remark {
    /// First location.
    pub place: DeckLocation,
    /// How the input was interpreted.
    pub text: String,
    /// Number of occurrences.
    pub times: usize,
}
