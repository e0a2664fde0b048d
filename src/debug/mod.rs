//! The debugger as a state machine without a terminal: commands in, frames out.
//!
//! - [`session`]: the history and a cursor in it; [`command`]: what it can be told.
//! - [`snapshot`]: recorded states; [`differences`]: what differs between two; [`files`]: how anything is written.
//! - [`report`]: what happened, in words.

pub mod census;
pub mod command;
pub mod core;
pub mod diagnosis;
pub mod differences;
pub mod files;
pub mod influence;
pub mod report;
pub mod session;
pub mod snapshot;
mod worker;
