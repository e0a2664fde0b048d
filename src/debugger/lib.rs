//! The debugger without a terminal: commands in, frames out, and everything that the front ends share.
//!
//! Each takes only from those above it:
//!
//! - [`explain`]: what happened, why, and what could be done about it, in the words that all front ends share.
//! - [`history`]: what was done so far: frames, branches, breakpoints, watches.
//! - [`record`]: what is kept in files: snapshots, journals, problems written as scenes.
//! - [`recorded`]: finished runs of other solvers, and the messages of running ones.
//! - [`session`]: the state machine.
//! - [`action`]: everything that can be done, by name, by key, or by a typed line.
//! - [`teach`]: guided lessons.

#![forbid(unsafe_code)]

pub mod action;
pub mod explain;
pub mod history;
pub mod record;
pub mod recorded;
pub mod session;
pub mod teach;
