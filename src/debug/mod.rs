//! The debugger as a state machine without a terminal: commands in, frames out.

pub mod command;
pub mod report;
pub mod session;
pub mod snapshot;
mod worker;
