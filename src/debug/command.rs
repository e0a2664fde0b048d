//! Every action by name: the one table behind keys, footer, help, completion and the README's list.

use crate::scene::Mode;
use std::path::PathBuf;

/// What the debugger can be told to do to the solver.
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    /// Forward by `count` of `unit`.
    Forward { unit: Unit, count: u32 },
    /// Back by `count` of `unit`; exact.
    Back { unit: Unit, count: u32 },
    /// Force a slave node (by slave number) into a mode: for the next minor iteration, or until released.
    Force {
        slave: usize,
        mode: Mode,
        hold: bool,
    },
    /// Give a slave node back to Table 2.
    Release { slave: usize },
    /// Change the increment size and start the present increment again.
    Increment(f64),
    /// Change a scalar that may change during a run: `friction.angle`, `friction.cohesion`, `settings.*`.
    Set { path: String, value: String },
    /// Write a snapshot of the shown state. `overwrite` only when asked.
    Snapshot {
        file: Option<PathBuf>,
        overwrite: bool,
    },
}

/// How far a motion goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    Minor,
    /// To the end of the present major iteration.
    Major,
    /// To the end of the present increment.
    Increment,
    /// To the end of the history, a failure, or (back) the start.
    Run,
}
