//! A session of the debugger, without a terminal: commands in, frames out.
//!
//! - [`machine`]: the state machine: its data, and how commands start and end. Their effects are in one module
//!   per subject: `motion` (through the history), `change` (interventions), `questions` (background analyses).
//! - [`timeline`]: the shown line of the history and the cursor; [`connection`]: the solver as the session sees it.
//! - [`worker`]: the thread that solves; [`background`]: the thread that analyses; [`exports`]: the files it
//!   writes; `trials`: one of the analyses.
//! - `recorded_run`: sessions on recorded runs.
//! - [`journal_writer`]: the journal being written; [`replay`]: repeating a journal.

pub mod background;
pub mod background_messages;
mod change;
pub mod connection;
pub mod exports;
pub mod journal_writer;
pub mod machine;
mod motion;
mod questions;
mod recorded_run;
pub mod replay;
pub mod timeline;
mod trials;
pub mod worker;

pub use machine::{Reply, Session};
