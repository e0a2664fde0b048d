//! stickslip: a terminal step-through debugger for FEM contact iterations.
//!
//! The program is the command line ([`cli`]) on top of these packages, which are re-exported here. Each package uses
//! only those above it:
//!
//! - `stickslip-linalg`: linear systems. `stickslip-core`: the solver, without files, terminal or threads.
//! - `stickslip-exchange`: file formats of other programs as plain data.
//! - `stickslip-platform`: what differs between operating systems.
//! - [`scene`]: the scene file ([`format`](mod@format)), and the [`model::Model`] that is built from it.
//! - [`study`]: many runs of a scene: sweeps, convergence maps, work-precision charts.
//! - [`manual`]: the pages that `help` shows.
//! - `stickslip-debugger`: the debugger without a terminal ([`session`]), with its history, explanations, actions and lessons.
//! - [`attach`]: solvers in other processes.
//! - [`tui`]: the debugger in the terminal; with the feature `tui`.

#![forbid(unsafe_code)]

pub mod cli;

pub use stickslip_attach as attach;
pub use stickslip_core::{contact, executor, fem, interface, linear, model, step, strategy};
pub use stickslip_debugger::{action, explain, history, record, recorded, session, teach};
pub use stickslip_linalg as linalg;
pub use stickslip_manual as manual;
pub use stickslip_platform as platform;
pub use stickslip_scene as scene;
pub use stickslip_scene::format;
pub use stickslip_study as study;
#[cfg(feature = "tui")]
pub use stickslip_tui as tui;
