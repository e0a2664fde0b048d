//! External solvers, stepped by the debugger: child processes that speak the protocol of [`stickslip_exchange::attach`], used
//! through the trait [`Solver`](stickslip_core::step::Solver).
//!
//! - [`channel`]: streams and sockets; [`link`]: the child process; [`started_solver`]: its start.
//! - [`attached`]: the solver, with the tree of its states.
//! - [`serve`]: stickslip's own solver as an attachable program; `wire`: its states and events as messages.
//! - [`check`]: tests what a solver offers.

#![forbid(unsafe_code)]

pub mod attached;
pub mod channel;
pub mod check;
pub mod link;
pub mod serve;
pub mod started_solver;
mod wire;

pub use attached::Attached;
pub use channel::Channel;
pub use link::Start;

/// The Python module of the protocol.
pub const PYTHON: &str = include_str!("clients/stickslip_attach.py");
/// JSON schema of the solver's messages.
pub const SCHEMA: &str = include_str!("clients/messages.schema.json");
/// The C and C++ header for solvers that keep their loops, with its implementation.
pub const C: &str = include_str!("clients/stickslip_attach.h");
/// The Fortran module on top of that header.
pub const FORTRAN: &str = include_str!("clients/stickslip_attach.f90");
