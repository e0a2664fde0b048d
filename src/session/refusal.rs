//! Why a session does not do what it is told, or not again what it did.

use super::background::NotWritten;
use crate::format::error::NotSet;
use crate::history::branches::NoBranch;
use crate::outside::files::FileError;
use crate::record::journal::JournalError;
use crate::record::snapshot::SnapshotError;

/// Why a session does not carry out a command: what is wrong, and what would be right.
#[derive(Debug, thiserror::Error)]
pub enum Refusal {
    #[error("the solver is running; interrupt it first (Ctrl-C)")]
    Running,
    #[error("this is the start")]
    Start,
    #[error("there is no step {step} yet; the last one is {last}")]
    NoStep { step: usize, last: usize },
    /// The solver does not take an intervention.
    #[error("{0}")]
    Intervention(crate::step::intervene::Refusal),
    /// A setting that there is not, or a value that is not of its kind.
    #[error(transparent)]
    NotSet(#[from] NotSet),
    /// A value of its kind that the scene cannot have.
    #[error("{0}")]
    Unsound(String),
    #[error(
        "{path} cannot change during a run; friction.*, settings.* and history.increment can (or start again with --set {path}={value})"
    )]
    Unchangeable { path: String, value: String },
    #[error(transparent)]
    NoBranch(#[from] NoBranch),
    #[error("there is no other branch; an intervention before the tip starts one")]
    OneBranch,
    #[error("a branch's name is one line of text")]
    NoName,
    #[error("another branch is called '{0}'")]
    TakenName(String),
    #[error("'{0}' looks like a branch's number; any other name would do")]
    NumberName(String),
    #[error("which branch? :compare BRANCH")]
    WhichBranch,
    #[error("that is this branch; another one would be compared with it")]
    SameBranch,
    #[error("there is nothing to compare")]
    NothingToCompare,
    #[error("there is no breakpoint {id}; {listed}")]
    NoBreakpoint { id: u32, listed: String },
    #[error("there is a watch '{0}' already; unwatch ends it")]
    Watched(String),
    #[error("there are no watches; :watch adds one")]
    NoWatches,
    #[error("no watch is called '{name}'; there are {all}")]
    NoWatch { name: String, all: String },
    #[error("this session keeps no journal, and what it did is not known any more")]
    Forgotten,
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Snapshot(#[from] SnapshotError),
    #[error(transparent)]
    Journal(#[from] JournalError),
    #[error(transparent)]
    NotWritten(#[from] NotWritten),
}

/// How an entry of a journal, done again, leads elsewhere than it did.
#[derive(Debug, thiserror::Error)]
pub(super) enum Departure {
    #[error("no journal has such a command")]
    NoMotion,
    #[error(transparent)]
    Refused(#[from] Refusal),
    #[error("it solves too much for one motion")]
    TooMuch,
    #[error("it solves {now} minor iterations, and solved {then}")]
    Solves { now: u64, then: u64 },
    #[error("it leads to step {} of branch b{}, and led to step {} of b{}", now.1, now.0, then.1, then.0)]
    Leads {
        /// Number of the branch, from 1, and step on its line.
        now: (usize, usize),
        then: (usize, usize),
    },
    #[error("the state is {now}, and was {then}")]
    State { now: String, then: String },
}
