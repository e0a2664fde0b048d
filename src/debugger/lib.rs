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
mod memo;
pub mod record;
pub mod recorded;
pub mod refusal;
pub mod session;
pub mod teach;

pub use action::Colours;
pub use explain::examination::Examination;
pub use explain::influence::NodePush;
pub use explain::page::DiagnosisPage;
pub use explain::remedies::RemedyTrial;
pub use explain::round_off::RoundOff;
pub use explain::walk::ReportedIterations;
pub use history::breakpoints::Breakpoints;
pub use history::frame::Frame;
pub use history::strip::{PointKind, Strip};
pub use history::tree::Tree;
pub use history::watches::{Watch, WatchQuantity};
pub use record::command::{BranchTarget, Command, ExportScope, Unit};
pub use record::journal::JournalTarget;
pub use record::snapshot::{Snapshot, SnapshotError};
pub use recorded::fault::Fault;
pub use recorded::log::Log;
pub use recorded::recording::Recording;
pub use refusal::Refusal;
pub use session::Session;
pub use teach::{Lesson, Tutor};
