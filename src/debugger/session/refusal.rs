//! Why a session does not do what it is told, or not again what it did.

use crate::history::branches::NoBranch;
use crate::record::export::shown::ExportError;
use crate::record::journal::JournalError;
use crate::record::snapshot::SnapshotError;
use stickslip_platform::files::FileError;
use stickslip_scene::format::error::NotSet;

/// Why a session does not carry out a command: what is wrong, and what would be right.
#[derive(Debug, thiserror::Error)]
pub enum Refusal {
    /// A run is on.
    #[error("the solver is running; interrupt it first (Ctrl-C)")]
    Running,
    /// There is nothing before this step.
    #[error("this is the start")]
    Start,
    /// A step that there is not yet.
    #[error("there is no step {step} yet; the last one is {last}")]
    NoStep {
        /// What was asked for.
        step: usize,
        /// The last one.
        last: usize,
    },
    /// The solver does not take an intervention.
    #[error("{0}")]
    Intervention(stickslip_core::step::intervene::Refusal),
    /// A setting that there is not, or a value that is not of its kind.
    #[error(transparent)]
    NotSet(#[from] NotSet),
    /// A value of its kind that the scene cannot have.
    #[error("{0}")]
    Unsound(String),
    /// A value that is fixed once a run has begun.
    #[error(
        "{path} cannot change during a run; friction.*, settings.* and history.increment can (or start again with --set {path}={value})"
    )]
    Unchangeable {
        /// Its path in the scene.
        path: String,
        /// What it was to be.
        value: String,
    },
    /// An attached solver has no such parameter.
    #[error("the solver has no parameter '{name}'; {known}")]
    NoParameter {
        /// What was asked for.
        name: String,
        /// Those that there are, in words.
        known: String,
    },
    /// No branch is called so.
    #[error(transparent)]
    NoBranch(#[from] NoBranch),
    /// There is one branch only.
    #[error("there is no other branch; an intervention before the tip starts one")]
    OneBranch,
    /// The existing branches use the whole memory budget.
    #[error(
        "no new branch: those that there are take {} of at most {} MB; steps from the tip of a branch start none",
        taken >> 20, most >> 20
    )]
    NoRoom {
        /// Size of the branches in bytes.
        taken: usize,
        /// Maximum size in bytes at which a branch can begin.
        most: usize,
    },
    /// A name that is empty, or not one line.
    #[error("a branch's name is one line of text")]
    NoName,
    /// The name of another branch.
    #[error("another branch is called '{0}'")]
    TakenName(String),
    /// A name that could be a number.
    #[error("'{0}' looks like a branch's number; any other name would do")]
    NumberName(String),
    /// Several branches could be meant.
    #[error("which branch? :compare BRANCH")]
    WhichBranch,
    /// A branch compared with itself.
    #[error("that is this branch; another one would be compared with it")]
    SameBranch,
    /// Neither branch has solved anything.
    #[error("there is nothing to compare")]
    NothingToCompare,
    /// A breakpoint that there is not.
    #[error("there is no breakpoint {id}; {listed}")]
    NoBreakpoint {
        /// Its number.
        id: u32,
        /// Those that there are, in words.
        listed: String,
    },
    /// The name of a watch that there is.
    #[error("there is a watch '{0}' already; unwatch ends it")]
    Watched(String),
    /// There is no watch.
    #[error("there are no watches; :watch adds one")]
    NoWatches,
    /// A watch that there is not.
    #[error("no watch is called '{name}'; there are {all}")]
    NoWatch {
        /// Its name.
        name: String,
        /// Those that there are, in words.
        all: String,
    },
    /// What the session did was not kept.
    #[error("this session keeps no journal, and what it did is not known any more")]
    Forgotten,
    /// A file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A snapshot could not be made.
    #[error(transparent)]
    Snapshot(#[from] SnapshotError),
    /// A journal could not be written or read.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// A problem could not be written out.
    #[error(transparent)]
    Export(#[from] ExportError),
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
