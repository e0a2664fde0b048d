//! Errors of a session: why it rejects a command, and how a replay departs from its journal.

use crate::history::branches::NoBranch;
use crate::history::breakpoints::NoBreakpoint;
use crate::history::watches::WatchError;
use crate::record::journal::JournalError;
use crate::{ExportError, SnapshotError};
use stickslip_core::counted;
use stickslip_platform::files::FileError;
use stickslip_scene::format::error::SetError;

/// Why a session rejects a command, with a hint at what would work.
#[derive(Debug, thiserror::Error)]
pub enum Refusal {
    /// The solver is running.
    #[error("the solver is running; interrupt it first (Ctrl-C)")]
    Running,
    /// The cursor is at the start.
    #[error("already at the start")]
    Start,
    /// The step does not exist.
    #[error("step {step} does not exist yet; the last one is {last}")]
    NoStep {
        /// Requested step.
        step: usize,
        /// Last step.
        last: usize,
    },
    /// The solver rejects the intervention.
    #[error("{0}")]
    Intervention(stickslip_core::step::intervene::Refusal),
    /// Unknown setting, or a value of the wrong type.
    #[error(transparent)]
    NotSet(#[from] SetError),
    /// A value of the right type that the scene cannot have.
    #[error("{0}")]
    Unsound(String),
    /// A value that is fixed once a run has started.
    #[error(
        "{path} cannot change during a run; only friction.*, settings.* and history.increment can. Restart with --set {path}={value}"
    )]
    Unchangeable {
        /// Path in the scene.
        path: String,
        /// Requested value.
        value: String,
    },
    /// Unknown parameter of an attached solver.
    #[error("the solver has no parameter '{name}'; {known}")]
    NoParameter {
        /// Requested name.
        name: String,
        /// Known parameters, in words.
        known: String,
    },
    /// No branch with this name.
    #[error(transparent)]
    NoBranch(#[from] NoBranch),
    /// There is only one branch.
    #[error("there is only one branch; an intervention before the tip starts another")]
    OneBranch,
    /// The branches have used up their memory budget.
    #[error(
        "no new branch: the existing ones take {} MB (limit {} MB); continue from the tip of a \
         branch instead",
        taken >> 20, most >> 20
    )]
    NoRoom {
        /// Size of the branches in bytes.
        taken: usize,
        /// Maximum size in bytes at which a branch can still start.
        most: usize,
    },
    /// An empty name, or one of several lines.
    #[error("a branch name must be one line of text")]
    NoName,
    /// The name is taken.
    #[error("branch name '{0}' is already in use")]
    TakenName(String),
    /// The name could be a number.
    #[error("branch name '{0}' looks like a branch number; choose another")]
    NumberName(String),
    /// The branch is ambiguous.
    #[error("which branch? :compare BRANCH")]
    WhichBranch,
    /// A branch compared with itself.
    #[error("this is the current branch; name another one to compare it with")]
    SameBranch,
    /// Neither branch has solved anything.
    #[error("there is nothing to compare")]
    NothingToCompare,
    /// No breakpoint with this number.
    #[error(transparent)]
    NoBreakpoint(#[from] NoBreakpoint),
    /// A watch cannot be added or removed.
    #[error(transparent)]
    Watch(#[from] WatchError),
    /// The session has kept no entries.
    #[error("this session has kept no record of its commands, so no journal can be written")]
    Forgotten,
    /// A file cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A snapshot cannot be made.
    #[error(transparent)]
    Snapshot(#[from] SnapshotError),
    /// A journal cannot be written or read.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// A problem cannot be exported.
    #[error(transparent)]
    Export(#[from] ExportError),
}

/// How the replay of a journal entry differs from the original.
#[derive(Debug, thiserror::Error)]
pub(super) enum Departure {
    #[error("a journal cannot contain this command")]
    NoMotion,
    #[error(transparent)]
    Refused(#[from] Refusal),
    #[error("it solves too many iterations for one motion")]
    TooMuch,
    #[error("it now solves {} instead of {then}", counted(*now, "minor iteration"))]
    Solves { now: u64, then: u64 },
    #[error("it now ends at step {} of branch b{} instead of step {} of b{}", now.1, now.0, then.1, then.0)]
    Leads {
        /// Number of the branch, from 1, and step on its line.
        now: (usize, usize),
        then: (usize, usize),
    },
    #[error("the state is now {now} instead of {then}")]
    State { now: String, then: String },
}
