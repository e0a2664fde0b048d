//! Solvers that others made, stepped by this debugger: child processes that speak the protocol of
//! [`stickslip_exchange::attach`], as solvers of ours ([`Solver`](crate::step::Solver)).
//!
//! - [`fault`]: the named ends of one that does not do what it should; [`log`]: what it says besides.
//! - [`link`]: the child process; [`meeting`]: its start; `told`: its messages as states and events; `orders`: interventions as
//!   requests; `posed`: its frozen interface problem; `judged`: the laws, on the numbers that it tells.
//! - [`attached`]: the solver, with the tree of the states that it has had; [`past`]: one that was kept in a file,
//!   [`story`]: what that tells, as text.
//! - [`calculix`]: finished CalculiX runs; [`recording`]: everything finished, by the name of its file.
//! - [`serve`]: our own solver on the other side; `wire`: its states and events as messages.
//! - [`check`]: whether a solver does what it says it does.

pub mod attached;
pub mod calculix;
pub mod check;
pub mod fault;
mod judged;
pub mod link;
pub mod log;
pub mod meeting;
mod orders;
pub mod past;
mod posed;
pub mod recording;
pub mod serve;
pub mod story;
mod told;
mod wire;

use crate::outside::carried::{Carried, carried};
pub use attached::Attached;
pub use fault::Fault;
pub use link::Start;
pub use log::Log;

/// The Python side of the protocol, as one file.
pub const PYTHON: Carried = carried!("stickslip_attach.py", "src/attach/stickslip_attach.py");
