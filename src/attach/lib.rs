//! Solvers that others made, stepped by this debugger: child processes that speak the protocol of
//! [`stickslip_exchange::attach`], as solvers of ours ([`Solver`](stickslip_core::step::Solver)).
//!
//! - [`link`]: the child process; [`meeting`]: its start.
//! - [`attached`]: the solver, with the tree of the states that it has had.
//! - `wire`: states and events of our solver as messages; [`serve`]: our own solver on the other side.
//! - [`check`]: whether a solver does what it says it does.

#![forbid(unsafe_code)]

pub mod attached;
pub mod check;
pub mod link;
pub mod meeting;
pub mod serve;
mod wire;

pub use attached::Attached;
pub use link::Start;

/// The Python side of the protocol, as one file.
pub const PYTHON: &str = include_str!("stickslip_attach.py");
