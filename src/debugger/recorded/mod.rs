//! Solvers of others without their processes: the messages of the protocol of [`stickslip_exchange::attach`] as this
//! program's states and events, and finished runs, which are stepped as read-only solvers ([`Solver`](stickslip_core::step::Solver)).
//!
//! - [`fault`]: the errors of a solver that breaks the protocol; [`log`]: its log.
//! - [`told`]: its messages as states and events; [`posed`]: its frozen interface problem; [`judged`]: the contact laws, checked with
//!   its numbers.
//! - [`orders`]: interventions as requests.
//! - [`past`]: a solver whose exchange was kept in a file; [`story`]: such a file as text.
//! - [`calculix`]: finished CalculiX runs; [`recording`]: any finished run, by the name of its file.

pub mod calculix;
pub mod fault;
pub mod judged;
pub mod log;
pub mod orders;
pub mod past;
pub mod posed;
pub mod recording;
pub mod story;
pub mod told;
