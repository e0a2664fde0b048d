//! Reads scene files (through [`format`](mod@format)), checks them, and compiles them to the model that the solver uses.
//!
//! - [`readers`]: the kinds of files: how each is recognised, and how those with a scene are read.
//! - `compile`, with [`nodes`], `curves`, `blocks`, `geometry` and [`limits`]: converts a [`format::Spec`] to a
//!   [`Model`](stickslip_core::model::Model), or reports errors.
//! - [`cost`]: estimated time and memory of a scene, and unused features; [`memory`]: available memory.
//! - [`base`]: a scene read once for many settings; [`solver`]: creates the solver of a scene, with all threads.
//! - `deck`: CalculiX and Abaqus decks; [`import`]: meshes of other programs.
//! - [`attached`]: scenes sent by attached solvers; [`mesh_file`]: their meshes in files.
//! - `pressed`: detects prescribed displacements that compress a solid beyond the range of its law.
//! - `unmatched`: second-order slave sides over borders of second-order masters.
//! - [`problems`]: interface problems of other programs.
//! - [`builtin`]: the built-in scenes; [`embedded`](mod@embedded): other embedded files.
//! - [`shown`]: makes external text safe for a terminal, table or picture; [`number`]: formats numbers for people.
//! - [`calculix`]: the files of a finished CalculiX run.

#![forbid(unsafe_code)]

pub mod attached;
pub mod base;
pub mod bonds;
pub mod builtin;
pub mod calculix;
pub mod cost;
pub mod embedded;
pub mod format;
pub mod gaps;
pub mod import;
pub mod limits;
pub mod memory;
pub mod mesh_file;
pub mod nodes;
pub mod number;
pub mod overlaps;
pub mod precision;
pub mod problems;
pub mod readers;
pub mod scene;
pub mod shown;
pub mod solver;

mod areas;
mod blocks;
mod compile;
mod corners;
mod curves;
mod deck;
mod geometry;
mod pressed;
mod unmatched;

pub use compile::increments;
pub use embedded::EmbeddedFile;
pub use format::{SceneError, Spec};
pub use number::{shortest, sig2, sig4, sig6};
pub use problems::siconos;
pub use readers::{FileKind, IN_SPACE};
pub use scene::Scene;
pub use shown::{aligned, few, first_of, joined};
