//! What is kept in files: recorded states, journals of sessions, and problems written as scenes of their own.
//!
//! - [`snapshot`]: a recorded state; [`differences`]: what differs between two.
//! - [`command`]: what a session can be told, as journals have it; [`journal`]: the record of a session; [`story`]: it as
//!   text to read.
//! - [`export`]: files made of a state, the kind by the extension: pictures, scenes, problems for other programs.

pub mod command;
pub mod differences;
pub mod export;
pub mod journal;
pub mod snapshot;
pub mod story;
