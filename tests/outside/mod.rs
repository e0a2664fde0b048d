//! Random mesh scenes, and a judge from outside of what the solver accepts in them.
//!
//! - [`chain`]: curves of master surfaces by brute force, with shape functions and closest points of their own;
//! - [`give`]: what beam elements leave out under point forces, from the beam's own equations;
//! - [`judge`]: Coulomb's law between two accepted states, from positions and forces alone;
//! - [`draw`] and [`families`]: scenes by seed and number, as texts of scene files;
//! - [`trial`]: a scene's run with every accepted increment judged;
//! - [`needs`]: the recoveries and strategies without which a scene fails;
//! - [`page`]: the diagnosis page of a failed scene, checked for contradictions;
//! - [`tally`]: what came out of many, as a table.
//!
//! Nothing here may use the solver's contact code (`stickslip::contact`), nor what the iteration keeps in its books: modes,
//! anchors, slips, where it believes a node to stand. Of a state only displacements and the forces on slave nodes are read.

#![allow(dead_code)]

pub mod chain;
pub mod draw;
pub mod families;
pub mod give;
pub mod judge;
pub mod needs;
pub mod page;
pub mod tally;
pub mod trial;
