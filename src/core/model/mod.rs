//! The model: what the solver works on, the ground on which everything else stands.
//!
//! Indices instead of names, generated nodes laid out, degrees of freedom numbered. Only what the scene names is
//! here: nodes of rigid surfaces have no unknowns, beams with GA no shear unknowns.
//!
//! Degrees of freedom are laid out node by node (x, y and, on beams, the rotation), then the bodies' own, body by body:
//! the shear forces of shear-rigid beams, one per Gauss point, and the forces on bodies that are given by a compliance,
//! whose equations are lengths, all of them. `equation[d]` is the number of the unknown of degree of freedom d, or
//! none where it is restrained or prescribed.

pub mod documented;

mod body;
mod contact;
mod dofs;
mod friction;
mod load;
mod mesh;
mod settings;

pub use body::{Beam, Body, BodyKind, Elastic, Form, Law, Linear, Plane, Solid, Update};
pub use contact::{Contact, Surface};
pub use dofs::{Axis, Component, Dofs};
pub use friction::{Friction, InitialState, Mode};
pub use load::{Factor, Jumps, Load, Prescribed, least};
pub use mesh::ElementKind;
pub use settings::{
    AtCycle, AtLimit, BoundUpdate, Geometry, ResidualMethod, Settings, SlipCount, Solver, Sticking,
    Strategy, Ties, Touch,
};

/// A checked scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    pub title: String,
    pub about: String,
    pub nodes: Vec<Node>,
    pub bodies: Vec<Body>,
    pub surfaces: Vec<Surface>,
    pub contacts: Vec<Contact>,
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
    /// Memory that the solver may take (bytes), unless `settings.memory` says otherwise.
    pub budget: f64,
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
