//! The debugger without a terminal: commands in, frames out. Contains everything that the front ends share.
//!
//! Each module depends only on those listed above it:
//!
//! - [`explain`]: what happened, why, and what to do about it, in the wording that all front ends share.
//! - [`history`]: frames, branches, breakpoints and watches.
//! - [`record`]: files: snapshots, journals, and problems exported as scenes.
//! - [`recorded`]: finished runs of other solvers, and the messages of running ones.
//! - [`session`]: the state machine.
//! - [`action`]: all actions, by name, by key binding or typed on the command line.
//! - [`teach`]: guided lessons.

#![forbid(unsafe_code)]

pub mod action;
pub mod explain;
pub mod history;
pub mod record;
pub mod recorded;
pub mod session;
pub mod teach;
