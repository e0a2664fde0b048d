//! What the debugger can be told: the commands that a session carries out, and that journals hold.

use crate::history::breakpoints::Condition;
use crate::history::strip::PointKind;
use crate::history::watches::Watch;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use stickslip_core::model::Mode;
use stickslip_core::step::intervene::{Intervention, Start};

/// What the debugger can be told to do to the solver.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Command {
    /// Forward by `count` of `unit`.
    Forward {
        /// What is counted.
        unit: Unit,
        /// How many of it.
        count: u32,
    },
    /// Back by `count` of `unit`; exact.
    Back {
        /// What is counted.
        unit: Unit,
        /// How many of it.
        count: u32,
    },
    /// Force a slave node (by slave number) into a mode: for the next minor iteration, or until released.
    Force {
        /// Slave number, from 0.
        slave: usize,
        /// The mode that it is to have.
        mode: Mode,
        /// Until it is released, and not only for the next minor iteration.
        hold: bool,
    },
    /// Give a slave node back to Table 2.
    Release {
        /// Slave number, from 0.
        slave: usize,
    },
    /// Change the increment size and start the present increment again.
    Increment(f64),
    /// Change a scalar that may change during a run: `friction.angle`, `friction.cohesion`, `settings.*`.
    Set {
        /// Its path, as a person types it.
        path: String,
        /// Its value, as a person types it.
        value: String,
    },
    /// Start several slave nodes at once from a state that is known.
    Assume(Vec<Start>),
    /// Take these steps in a new branch of this name: minor iterations (none) and interventions.
    Follow {
        /// What the branch is called.
        label: String,
        /// The steps, in order; `None` is a minor iteration.
        steps: Vec<Option<Intervention>>,
    },
    /// Find out why the minor iterations cycle from the shown state, or which states are consistent; of these slave
    /// nodes (by slave number), where there are any, all others going on with what they do.
    Census(Vec<usize>),
    /// Try every remedy from the shown state.
    Remedies,
    /// Go to a point of the current branch's line, by its place; the start is 0.
    Goto {
        /// Place on the branch's line, from 0.
        step: usize,
    },
    /// Go to the tip of another branch.
    Branch(To),
    /// Call the current branch so.
    Rename(String),
    /// List the branches.
    Branches,
    /// Compare the current branch with another: this one, or the one that it left.
    Compare(Option<String>),
    /// Set a breakpoint.
    Break(Condition),
    /// List the breakpoints.
    Breakpoints,
    /// Delete a breakpoint by its number, or all.
    Delete(Option<u32>),
    /// Switch a breakpoint by its number, or all, on or off.
    Enable {
        /// Number of the breakpoint; `None` for all.
        id: Option<u32>,
        /// On, or else off.
        on: bool,
    },
    /// Watch a number.
    Watch(Watch),
    /// End a watch, by its name.
    Unwatch(String),
    /// Write a file of the shown state, the kind by the file's extension; the core of the cycle that it runs into; or its
    /// whole frozen interface problem. `overwrite` only when asked.
    Export {
        /// What is written.
        what: Exported,
        /// Where to.
        file: PathBuf,
        /// Whether a file of that name may be overwritten.
        overwrite: bool,
    },
    /// Write a snapshot of the shown state. `overwrite` only when asked.
    Snapshot {
        /// Where to; `None` for a name made of the scene's.
        file: Option<PathBuf>,
        /// Whether a file of that name may be overwritten.
        overwrite: bool,
    },
    /// Begin a journal in a new file, with all that was done; none tells where it is.
    Journal(Option<PathBuf>),
}

/// What can be written of a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Exported {
    /// The fewest nodes that still cycle.
    Core,
    /// The whole interface problem.
    Whole,
    /// What the file's extension says: a picture, the scene, a problem for another program.
    Shown,
}

/// Which branch.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum To {
    /// The next one in the list.
    Next,
    /// The one before in the list.
    Previous,
    /// The one of that name.
    Named(String),
}

/// How far a motion goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Unit {
    /// One minor iteration.
    Minor,
    /// To the end of the present major iteration.
    Major,
    /// To the end of the present increment.
    Increment,
    /// To the end of the history, a failure, or (back) the start.
    Run,
}

impl Command {
    /// Whether it changes nothing, and is in no journal.
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

    /// Whether it only goes along a branch.
    pub fn is_motion(&self) -> bool {
        matches!(
            self,
            Command::Forward { .. } | Command::Back { .. } | Command::Goto { .. }
        )
    }
}

impl Unit {
    /// Whether a point of this kind ends a motion by this unit.
    pub fn ends(self, kind: PointKind) -> bool {
        match self {
            Unit::Minor => kind.is_solved(),
            Unit::Major => kind.ends_major(),
            Unit::Increment => kind.is_accepted() || kind.is_failure(),
            Unit::Run => kind.is_last() || kind.is_failure(),
        }
    }
}
