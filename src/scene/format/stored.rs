//! A stiffness matrix stored by CalculiX, with its contacts, loads and supports: a RON file that begins with `Stored(`.
//!
//! ```text
//! *FREQUENCY, SOLVER=MATRIXSTORAGE        in a step of the deck, with a *DENSITY, writes JOB.sti and JOB.dof
//! ```
//!
//! Nodes are identified by their numbers in the deck. The stiffness is condensed to the nodes that may touch
//! ([`crate::problems::stored`]); the result is a [`super::condensed::Problem`].

use super::spec::History;
use serde::{Deserialize, Serialize};
use stickslip_core::{Friction, Mode, Settings};

/// First word of such a file.
pub const HEAD: &str = "Stored";

/// Nodes that may touch one rigid straight surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RigidContact {
    /// Node numbers in the deck.
    pub nodes: Vec<u64>,
    /// Outward normal of the surface, which points to the nodes; any length. Default: upwards, (0, 1).
    #[serde(default = "upwards")]
    pub normal: (f64, f64),
    /// Undeformed distance to the surface; negative is penetration. Default: 0.
    #[serde(default)]
    pub gap: f64,
    /// Friction of the nodes. Default: smooth.
    #[serde(default)]
    pub friction: Friction,
    /// Mode of the first minor iteration. Default: free.
    #[serde(default)]
    pub start: Mode,
}

/// A load on each of several nodes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NodalLoad {
    /// Node numbers in the deck.
    pub nodes: Vec<u64>,
    /// Force along x at load factor 1. Default: 0.
    #[serde(default)]
    pub x: f64,
    /// Force along y at load factor 1. Default: 0.
    #[serde(default)]
    pub y: f64,
}

/// Nodes with prescribed displacements. Degrees of freedom restrained in the deck have no unknowns and stay fixed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MovedNodes {
    /// Node numbers in the deck.
    pub nodes: Vec<u64>,
    /// Displacement along x at load factor 1. Default: free.
    pub x: Option<f64>,
    /// Displacement along y at load factor 1. Default: free.
    pub y: Option<f64>,
}

/// The file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stored {
    /// One-line title.
    pub title: String,
    /// Description. Default: empty.
    #[serde(default)]
    pub about: String,
    /// The stiffness file (.sti), in the folder of this file or below.
    pub stiffness: String,
    /// The file of its unknowns (.dof). Default: the name of the stiffness file with this extension.
    pub unknowns: Option<String>,
    /// The nodes that may touch, in the order of the contacts.
    pub contacts: Vec<RigidContact>,
    /// Dead loads on nodes. Default: none.
    #[serde(default)]
    pub loads: Vec<NodalLoad>,
    /// Nodes with prescribed displacements. Default: none.
    #[serde(default)]
    pub moved: Vec<MovedNodes>,
    /// A typical length of gaps and motions, to which length tolerances are relative. Default: the largest gap or motion.
    pub spacing: Option<f64>,
    /// Path of the load factor. Default: one increment from 0 to 1.
    #[serde(default)]
    pub history: History,
    /// Options of the method. Default: as for a scene.
    #[serde(default)]
    pub settings: Settings,
}

fn upwards() -> (f64, f64) {
    (0.0, 1.0)
}
