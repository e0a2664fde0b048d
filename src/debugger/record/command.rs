//! The commands that a session executes and journals record.

use crate::history::breakpoints::Condition;
use crate::{PointKind, Watch};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use stickslip_core::step::intervene::Start;
use stickslip_core::{Intervention, Mode};

/// A command of a session.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Command {
    /// Go forward by `count` of `unit`.
    Forward {
        /// Unit counted.
        unit: Unit,
        /// Number of units.
        count: u32,
    },
    /// Go back by `count` of `unit`; restores the exact states.
    Back {
        /// Unit counted.
        unit: Unit,
        /// Number of units.
        count: u32,
    },
    /// Force a slave node into a mode, for the next minor iteration or until released.
    Force {
        /// Slave number, from 0.
        slave: usize,
        /// New mode.
        mode: Mode,
        /// Whether it is held until released.
        hold: bool,
    },
    /// Release a slave node, so that Table 2 decides again.
    Release {
        /// Slave number, from 0.
        slave: usize,
    },
    /// Change the increment size and restart the current increment.
    Increment(f64),
    /// Change a scalar that can change during a run: `friction.angle`, `friction.cohesion`, `settings.*`.
    Set {
        /// Path in the scene, as typed.
        path: String,
        /// Value, as typed.
        value: String,
    },
    /// Start several slave nodes from a known state.
    Assume(Vec<Start>),
    /// Take these steps in a new branch: minor iterations (`None`) and interventions.
    Follow {
        /// Label of the branch.
        label: String,
        /// Steps in order; `None` is a minor iteration.
        steps: Vec<Option<Intervention>>,
    },
    /// Find the cause of the cycle that starts at the shown state, or the consistent states. With slave
    /// numbers: for these nodes only, all others frozen.
    Census(Vec<usize>),
    /// Try all remedies from the shown state.
    Remedies,
    /// Go to a point of the current line; the start is 0.
    Goto {
        /// Index on the line, from 0.
        step: usize,
    },
    /// Go to the tip of another branch.
    Branch(BranchTarget),
    /// Rename the current branch.
    Rename(String),
    /// List the branches.
    Branches,
    /// Compare the current branch with the named one, by default with its parent.
    Compare(Option<String>),
    /// Set a breakpoint.
    Break(Condition),
    /// List the breakpoints.
    Breakpoints,
    /// Delete the breakpoint with this number, or all.
    Delete(Option<u32>),
    /// Enable or disable a breakpoint, or all.
    Enable {
        /// Number of the breakpoint; `None` for all.
        id: Option<u32>,
        /// Enable; otherwise disable.
        on: bool,
    },
    /// Watch a quantity.
    Watch(Watch),
    /// Remove a watch, by name.
    Unwatch(String),
    /// Write a file made from the shown state: a kind chosen by the extension, the core of its cycle, or its
    /// whole frozen problem.
    Export {
        /// What to write.
        what: ExportScope,
        /// Destination.
        file: PathBuf,
        /// Whether an existing file may be overwritten.
        overwrite: bool,
    },
    /// Write a snapshot of the shown state.
    Snapshot {
        /// Destination; `None` for a name derived from the scene's.
        file: Option<PathBuf>,
        /// Whether an existing file may be overwritten.
        overwrite: bool,
    },
    /// Start a journal in a new file, with all entries so far; without a file, report the path of the current
    /// one.
    Journal(Option<PathBuf>),
}

/// What can be exported from a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum ExportScope {
    /// The core: the smallest set of nodes that still cycles.
    Core,
    /// The whole frozen interface problem.
    Whole,
    /// Chosen by the file's extension: a picture, the scene, or a problem for another program.
    Shown,
}

/// Which branch to go to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum BranchTarget {
    /// The next one in the list.
    Next,
    /// The one before in the list.
    Previous,
    /// The branch with this name.
    Named(String),
}

/// Unit of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Unit {
    /// One minor iteration.
    Minor,
    /// To the end of the current major iteration.
    Major,
    /// To the end of the current increment.
    Increment,
    /// To the end of the history, a failure, or (backward) the start.
    Run,
}

impl Command {
    /// Whether the command changes nothing and is not recorded in journals.
    pub fn is_look(&self) -> bool {
        matches!(
            self,
            Command::Branches
                | Command::Census(_)
                | Command::Remedies
                | Command::Export { .. }
                | Command::Compare(_)
                | Command::Breakpoints
                | Command::Snapshot { .. }
                | Command::Journal(_)
        )
    }

    /// Whether the command only moves along a branch.
    pub fn is_motion(&self) -> bool {
        matches!(
            self,
            Command::Forward { .. } | Command::Back { .. } | Command::Goto { .. }
        )
    }
}

impl Unit {
    /// Whether a motion by this unit ends at a point of this kind.
    pub fn ends(self, kind: PointKind) -> bool {
        match self {
            Unit::Minor => kind.is_solved(),
            Unit::Major => kind.ends_major(),
            Unit::Increment => kind.is_accepted() || kind.is_failure(),
            Unit::Run => kind.is_last() || kind.is_failure(),
        }
    }
}
