//! A session of the debugger, without a terminal: commands in, frames out.
//!
//! - [`machine`]: the state machine: its data, and how commands start and end. Their effects are in one module
//!   per subject: `motion` (through the history), `change` (interventions), `lists` (branches, breakpoints,
//!   watches), `writing` (snapshots, journals), `questions` (background analyses).
//! - [`worker`]: the thread that solves; [`background`]: the thread that analyses; [`exports`]: the files it
//!   writes.
//! - `kept`: sessions on recorded runs.
//! - `diary`: the journal being written; [`replay`]: repeating a journal; [`refusal`]: the errors.

pub mod background;
mod change;
mod diary;
pub mod exports;
mod kept;
mod lists;
pub mod machine;
mod motion;
mod questions;
pub mod refusal;
pub mod replay;
pub mod worker;
mod writing;

pub use machine::{Reply, Session};
pub use refusal::Refusal;
