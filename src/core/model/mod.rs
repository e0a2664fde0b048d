//! The model: what the solver works on, the ground on which everything else stands.
//!
//! Everything refers to everything else by index (not by name), generated nodes are laid out, and degrees of freedom are
//! numbered. Nodes of rigid surfaces have no unknowns, and beams with a shear stiffness GA have no shear unknowns.
//!
//! Degrees of freedom are laid out node by node (x, y and, on beams, the rotation), then the bodies' own, body by body:
//! the shear forces of shear-rigid beams, one per Gauss point, and the forces on bodies that are given by a compliance,
//! whose equations are lengths, all of them. `equation[d]` is the number of the unknown of degree of freedom d, and
//! `None` if that is restrained or prescribed.

pub mod documented;

mod body;
mod builder;
mod contact;
mod control;
mod dofs;
mod friction;
mod load;
mod mesh;
mod settings;

use serde::{Deserialize, Serialize};

pub use body::{
    Beam, Body, BodyKind, Elastic, Form, Law, Linear, Plane, Solid, SolidElement, Truss, Update,
};
pub use builder::{ModelBuilder, ModelError};
pub use contact::{Bond, Contact, Facing, Piece, PointGive, STENCIL, Surface};
pub use control::{ArcLength, Bound, Control, Measured};
pub use dofs::{Axis, Component, Dofs};
pub use friction::{Friction, InitialState, Mode};
pub use load::{Factor, Jumps, Load, Prescribed, PressedFace, Pressure, least, on_leg};
pub use mesh::{ElementKind, boundary};
pub use settings::{
    AtCycle, AtLimit, BoundUpdate, Geometry, InitialGaps, PointForce, Refactor, ResidualMethod,
    Search, Settings, SlipCount, Solver, Sticking, Strategy, Ties, Touch,
};

/// A checked scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// Title, one line.
    pub title: String,
    /// What the scene shows, as free text; may be empty.
    pub about: String,
    /// All nodes, in the reference configuration; indices of nodes point here.
    pub nodes: Vec<Node>,
    /// What deforms.
    pub bodies: Vec<Body>,
    /// Master surfaces; indices of surfaces point here.
    pub surfaces: Vec<Surface>,
    /// The slave nodes, one contact each; slave numbers point here.
    pub contacts: Vec<Contact>,
    /// Numbering of the degrees of freedom and of the unknowns.
    pub dofs: Dofs,
    /// Dead loads.
    pub loads: Vec<Load>,
    /// Pressures that follow the faces they act on.
    pub pressures: Vec<Pressure>,
    /// Prescribed motions other than zero.
    pub prescribed: Vec<Prescribed>,
    /// Corners of the path of the load factor, at least two.
    pub path: Vec<f64>,
    /// Increment of the load factor, positive.
    pub increment: f64,
    /// Increments on each leg of the path, positive, one a leg; none where all have `increment`.
    pub increments: Vec<f64>,
    /// Size below which an increment that fails is not cut further. `None` stands for 1/64 of the increment in force.
    pub least: Option<f64>,
    /// What happens to an increment that jumps to another branch of equilibrium.
    pub jumps: Jumps,
    /// What drives the history.
    pub control: Control,
    /// How the path is followed, where that drives it.
    pub arc: ArcLength,
    /// Choices of the method, and its limits.
    pub settings: Settings,
    /// Numbers to report, in the order of the columns of outputs.
    pub monitors: Vec<Monitor>,
    /// Memory that the solver may take (bytes), unless `settings.memory` says otherwise.
    pub budget: f64,
    /// Diagonal of the bounding box of all bodies' nodes: the scene's unit of length for tolerances.
    pub length: f64,
    /// How a finished run of another program counts. `None` for everything that can be stepped.
    pub finished: Option<FinishedRun>,
}

/// A finished run of another program, with one level of iterations, whose files do not distinguish stick from slip: a
/// contact is closed ([`Mode::Fixed`]) or open.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FinishedRun {
    /// Names of the increments, by number from 1.
    pub increments: Vec<String>,
    /// The first turn of each cycle, as iterations of the whole run, from 0.
    pub cycles: Vec<std::ops::Range<usize>>,
    /// Limit of the displacement correction (relative).
    pub correction_limit: f64,
}

/// A node in the reference configuration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Node {
    /// `ID.k` for the k-th node of a chain or block (from 1), or the id of a single node.
    #[serde(default)]
    pub name: String,
    /// Position (length).
    pub at: [f64; 2],
}

/// A number to report.
#[derive(Debug, Clone, PartialEq)]
pub struct Monitor {
    /// Name of the column in outputs.
    pub name: String,
    /// What it reports.
    pub of: Watched,
}

/// What a monitor reports.
#[derive(Debug, Clone, PartialEq)]
pub enum Watched {
    /// Value of a degree of freedom.
    Displacement {
        /// Number of the degree of freedom.
        dof: usize,
    },
    /// Component of the interaction force on slaves (by slave number).
    Contact {
        /// Slave numbers; their forces are added up.
        slaves: Vec<usize>,
        /// The component.
        axis: Axis,
    },
    /// Support force at a restrained degree of freedom.
    Reaction {
        /// Number of the degree of freedom.
        dof: usize,
    },
    /// How many slaves have a mode.
    Modes {
        /// Slave numbers.
        slaves: Vec<usize>,
        /// The mode.
        mode: Mode,
    },
    /// Largest drift of slaves (by slave number).
    Drift {
        /// Slave numbers.
        slaves: Vec<usize>,
    },
    /// Contact pressure F_n / A, or shear F_t / A, of one of some slaves: the one where it is largest in size (force by
    /// undeformed area).
    Pressure {
        /// Slave numbers, each of a contact with an area.
        slaves: Vec<usize>,
        /// Whether it is the shear.
        shear: bool,
    },
    /// A number that an attached solver tells.
    Told {
        /// Its place among those that it tells.
        number: usize,
        /// What kind of number it is.
        kind: ToldKind,
    },
    /// Arc along the path of equilibrium from the start of the history, in what [`ArcLength::along`] measures.
    Arc,
}

/// What kind of number an attached solver tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ToldKind {
    /// A length.
    Length,
    /// A force.
    Force,
    /// A force by area.
    Pressure,
    /// A count.
    Count,
    /// It does not say.
    #[default]
    Other,
}

/// Diagonal of the bounding box of nodes; 0 for none.
pub fn diagonal<'a>(nodes: impl Iterator<Item = &'a Node>) -> f64 {
    let none = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    let [low, high] = nodes.fold(none, |[low, high], node| {
        let [x, y] = node.at;
        [
            [low[0].min(x), low[1].min(y)],
            [high[0].max(x), high[1].max(y)],
        ]
    });
    let size = [high[0] - low[0], high[1] - low[1]];
    match size[0] >= 0.0 {
        true => size[0].hypot(size[1]),
        false => 0.0,
    }
}

impl Model {
    /// A scene of which another solver knows what deforms: nodes, masters and contacts, load factors from 0 to 1 in one
    /// increment, and no unknowns. What else is known is changed in it.
    pub fn of_contacts(
        title: &str,
        nodes: Vec<Node>,
        surfaces: Vec<Surface>,
        contacts: Vec<Contact>,
    ) -> Model {
        let count = nodes.len();
        let length = match diagonal(nodes.iter()) {
            length if length > 0.0 => length,
            // One node has no size, and its motions are compared with something all the same.
            _ => 1.0,
        };
        Model {
            title: title.to_owned(),
            about: String::new(),
            nodes,
            bodies: Vec::new(),
            surfaces,
            contacts,
            dofs: Dofs {
                first: (0..count).map(|node| 2 * node).collect(),
                count: vec![2; count],
                equation: vec![None; 2 * count],
                equations: 0,
                inner: 0,
            },
            loads: Vec::new(),
            pressures: Vec::new(),
            prescribed: Vec::new(),
            path: vec![0.0, 1.0],
            increment: 1.0,
            increments: Vec::new(),
            least: None,
            jumps: Jumps::default(),
            control: Control::default(),
            arc: ArcLength::default(),
            settings: Settings::default(),
            monitors: Vec::new(),
            budget: f64::INFINITY,
            length,
            finished: None,
        }
    }

    /// Name of an increment: its number, or what a finished run calls it.
    pub fn increment_name(&self, number: u32) -> String {
        let names = self
            .finished
            .as_ref()
            .map_or(&[][..], |run| &run.increments);
        let named = names.get((number as usize).wrapping_sub(1));
        named.map_or_else(|| number.to_string(), String::clone)
    }

    /// Size of the increments on a leg of the path, as the scene has them.
    pub fn on_leg(&self, leg: usize) -> f64 {
        on_leg(&self.increments, self.increment, leg)
    }

    /// Whether any body is a solid.
    pub fn has_solids(&self) -> bool {
        let mut bodies = self.bodies.iter();
        bodies.any(|body| matches!(body.kind, BodyKind::Solid(_)))
    }

    /// Whether x is a radius and y the axis: forces are then those of the whole circumference.
    pub fn is_axisymmetric(&self) -> bool {
        self.bodies.iter().any(Body::is_axisymmetric)
    }

    /// Where a node is when all degrees of freedom have these values: its place in the reference shape, displaced.
    pub fn place(&self, u: &[f64], node: usize) -> [f64; 2] {
        let at = self.nodes[node].at;
        let Some(&first) = self.dofs.first.get(node) else {
            return at;
        };
        let moved = |axis: usize| u.get(first + axis).copied().unwrap_or(0.0);
        match self.dofs.count.get(node) {
            Some(2..) => [at[0] + moved(0), at[1] + moved(1)],
            _ => at,
        }
    }

    /// What part of the overlaps that are closed over the first leg of the path ([`Contact::overlap`]) is left at a load
    /// factor on a leg.
    pub fn unclosed(&self, leg: usize, load_factor: f64) -> f64 {
        match self.path.as_slice() {
            [from, to, ..] if leg == 0 => ((to - load_factor) / (to - from)).clamp(0.0, 1.0),
            _ => 0.0,
        }
    }

    /// The places of all nodes ([`Model::place`]).
    pub fn places(&self, u: &[f64]) -> Vec<[f64; 2]> {
        (0..self.nodes.len())
            .map(|node| self.place(u, node))
            .collect()
    }
}
