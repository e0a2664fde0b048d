//! stickslip: a terminal step-through debugger for FEM contact iterations.
//!
//! The map of the house, from the ground up: each line uses those above it and none below.
//!
//! The solver is a package of its own, [`stickslip_core`], with [`linalg`] under it; its modules are handed on here. Another
//! is [`stickslip_exchange`]: files of other programs as plain data. The program stands on them:
//!
//! - [`outside`]: what comes from outside and goes there: files that are read and written, texts of others that are shown.
//! - [`format`](mod@format): the scene file as its author writes it: read, located, described, and set by paths.
//! - [`scene`]: what to solve: a [`format::Spec`] becomes a checked [`model::Model`].
//! - [`explain`]: what happened, why, and what could be done about it, in the words that all front ends share.
//! - [`study`]: studies with many runs of a scene: sweeps, convergence maps, work-precision charts.
//! - [`history`]: what was done so far: frames, branches, breakpoints, watches.
//! - [`record`]: what is kept in files: snapshots, journals, problems written as scenes.
//! - [`attach`]: solvers that others made, stepped as ours.
//! - [`session`]: the debugger without a terminal: commands in, frames out.
//! - [`manual`]: the pages that `help` shows.
//! - [`action`]: everything that can be done, by name, by key, or by a typed line.
//! - [`teach`]: guided lessons.
//! - [`tui`]: the debugger in the terminal; with the feature `tui`.
//! - [`cli`]: the command line.

#![forbid(unsafe_code)]

pub mod action;
pub mod attach;
pub mod cli;
pub mod explain;
pub mod format;
pub mod history;
pub mod manual;
pub mod outside;
pub mod record;
pub mod scene;
pub mod session;
pub mod study;
pub mod teach;
#[cfg(feature = "tui")]
pub mod tui;

#[cfg(mutants)]
pub use stickslip_core::mutants;
pub use stickslip_core::{
    contact, executor, fem, interface, linalg, linear, model, step, strategy,
};
