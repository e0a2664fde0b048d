//! stickslip: a terminal step-through debugger for FEM contact iterations.
//!
//! The map of the house, from the ground up; an arrow of use only ever points down this list.
//!
//! - [`outside`]: what comes from outside: files that are read, and texts of them that are shown.
//! - [`scene`]: what to solve. A RON file ([`scene::spec`]) becomes a checked [`scene::Model`].
//! - [`manual`]: the pages that `help` shows.
//! - [`linalg`]: the only place that knows faer, a package of its own. Sparsity patterns, factors, checked solves.
//! - [`fem`]: the bodies. Shape functions, beams, quadrilaterals, materials, assembly of internal forces and tangent.
//! - [`contact`]: the interface. Projection, modes, Table 1, T_max, Table 2 with its reasons.
//! - [`solve`]: the stepper: increments, major iterations, minor iterations, one per call.
//! - [`debug`]: the debugger without a terminal: session, commands, snapshots.
//! - [`study`]: many runs of a scene: sweeps, stability maps, work-precision charts.
//! - [`cli`] and [`tui`]: the two front ends.

pub mod cli;
pub mod contact;
pub mod debug;
pub mod fem;
pub mod manual;
pub mod outside;
pub mod scene;
pub mod solve;
pub mod study;
pub mod tui;

pub use stickslip_linalg as linalg;
