//! A stiffness that CalculiX has stored, and what touches, pulls and holds it: a RON file that begins with `Stored(`.
//!
//! ```text
//! *FREQUENCY, SOLVER=MATRIXSTORAGE        in a step of the deck, with a *DENSITY, writes JOB.sti and JOB.dof
//! ```
//!
//! Nodes are called by the numbers that the deck gives them. The stiffness is condensed to the nodes that may touch
//! ([`crate::problems::stored`]); what comes of it is a [`super::condensed::Problem`].

use super::spec::History;
use serde::{Deserialize, Serialize};
use stickslip_core::model::{Friction, Mode, Settings};

/// What such a file begins with.
pub const HEAD: &str = "Stored";

/// Nodes that may touch one rigid straight surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Touching {
    /// Their numbers in the deck.
    pub nodes: Vec<u64>,
    /// The surface's outward normal, which points to the nodes; of any length. Default: upwards, (0, 1).
    #[serde(default = "upwards")]
    pub normal: (f64, f64),
    /// Distance to the surface, undeformed; negative is penetration. Default: 0.
    #[serde(default)]
    pub gap: f64,
    /// Default: smooth.
    #[serde(default)]
    pub friction: Friction,
    /// Default: free.
    #[serde(default)]
    pub start: Mode,
}

/// A load on each of some nodes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pulled {
    /// Their numbers in the deck.
    pub nodes: Vec<u64>,
    /// Force along x at load factor 1. Default: 0.
    #[serde(default)]
    pub x: f64,
    /// Force along y at load factor 1. Default: 0.
    #[serde(default)]
    pub y: f64,
}

/// Nodes that are moved; what the deck restrains has no unknowns, and stays where it is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Moved {
    /// Their numbers in the deck.
    pub nodes: Vec<u64>,
    /// Displacement along x at load factor 1. Default: free.
    #[serde(default)]
    pub x: Option<f64>,
    /// Displacement along y at load factor 1. Default: free.
    #[serde(default)]
    pub y: Option<f64>,
}

/// The file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stored {
    /// What it is, in one line.
    pub title: String,
    /// What there is to say of it. Default: empty.
    #[serde(default)]
    pub about: String,
    /// The stiffness: a file .sti, beside this one or in a folder below.
    pub stiffness: String,
    /// Its unknowns: a file .dof. Default: the name of the stiffness with this ending.
    #[serde(default)]
    pub unknowns: Option<String>,
    /// The nodes that may touch, in the order of the contacts.
    pub contacts: Vec<Touching>,
    /// Default: none.
    #[serde(default)]
    pub loads: Vec<Pulled>,
    /// Nodes that are moved. Default: none.
    #[serde(default)]
    pub moved: Vec<Moved>,
    /// A length that gaps and motions are comparable with: tolerances of lengths are parts of it. Default: the largest gap or
    /// motion.
    #[serde(default)]
    pub spacing: Option<f64>,
    /// Default: one increment from 0 to 1.
    #[serde(default)]
    pub history: History,
    /// How it is solved. Default: as for a scene.
    #[serde(default)]
    pub settings: Settings,
}

fn upwards() -> (f64, f64) {
    (0.0, 1.0)
}
