//! Other programs' solvers without their processes: converts messages of the attach protocol
//! ([`stickslip_exchange::attach`]) into states and events, and opens finished runs as read-only solvers
//! ([`Solver`](stickslip_core::step::Solver)).
//!
//! - [`fault`]: errors of a solver that violates the protocol; [`log`]: its log.
//! - [`decode`]: its messages as states and events; [`interface_problem`]: its frozen interface problem.
//! - [`orders`]: interventions as requests.
//! - [`exchange`]: a solver replayed from its stored exchange; [`story`]: such a file as text.
//! - [`calculix`]: finished CalculiX runs; [`recording`]: opens a finished run by file name.

pub mod calculix;
pub mod decode;
pub mod exchange;
pub mod fault;
pub mod log;
pub mod orders;

pub mod interface_problem;
pub mod recording;
pub mod story;
