//! What a user may change in a run, as plain data; [`super::intervene`] does it.

use crate::linear::estimate::TooLarge;
use crate::model::{Friction, Mode, Settings};
use serde::{Deserialize, Serialize};

/// A change from outside; recorded in snapshots and replayed from them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Intervention {
    /// Force a slave node (by slave number) into a mode: for the next minor iteration, or until released.
    Force {
        /// Slave number.
        slave: usize,
        /// The mode.
        mode: Mode,
        /// Whether it is held until released.
        hold: bool,
    },
    /// Start several slave nodes at once from a state that is known: each in a mode, for the next minor iteration.
    Assume(Vec<Start>),
    /// Give a slave node back to Table 2.
    Release {
        /// Slave number.
        slave: usize,
    },
    /// Change the increment size and start the present increment again. Where the scene lists increments of each leg of the
    /// path, the next leg begins with its own.
    Increment(f64),
    /// Replace the friction of every slave node.
    Friction(Friction),
    /// Replace the friction of each slave node by its own, in the order of the scene.
    Frictions(Vec<Friction>),
    /// Replace the settings.
    Settings(Settings),
    /// Change a parameter of an attached solver.
    Parameter {
        /// Its name.
        name: String,
        /// Its value.
        value: Value,
    },
}

/// Value of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Value {
    /// A number, whole or not.
    Number(f64),
    /// True or false.
    Flag(bool),
    /// A text.
    Text(String),
}

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Value::Number(number) => number.fmt(f),
            Value::Flag(flag) => flag.fmt(f),
            Value::Text(text) => text.fmt(f),
        }
    }
}

/// Why an intervention is refused; the state stays as it was.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// There is nothing left to change.
    #[error("the history is done; step back first")]
    Done,
    /// No contact has this number.
    #[error("there are {count} slave nodes, numbered from 0; {slave} is none")]
    NoContact {
        /// The number that was asked for.
        slave: usize,
        /// How many there are.
        count: usize,
    },
    /// A contact without a surface can only be free.
    #[error("the node is past the end of its surface: it has nothing to touch")]
    OffSurface,
    /// A tied contact is fixed for ever.
    #[error("the node is tied to its surface: it is always fixed")]
    Tied,
    /// A friction out of bounds.
    #[error("a friction angle is at least 0 and less than 90 degrees, a cohesion not negative")]
    Friction,
    /// Settings that apply only when the scene is opened, because they fix the initial gaps and the surfaces.
    #[error(
        "initial_gaps, adjust_gap and point_force are settled when a scene is opened: set them in its file, or with --set"
    )]
    StartGaps,
    /// A limit of no iterations.
    #[error("limits of iterations are at least 1")]
    Limits,
    /// An increment that is no positive number.
    #[error("an increment is a positive number, not {0}")]
    Increment(f64),
    /// The solver that was asked for does not fit the memory.
    #[error(transparent)]
    TooLarge(TooLarge),
    /// Only attached solvers have parameters.
    #[error("no solver is attached that has a parameter '{0}'")]
    NoParameter(String),
    /// An attached solver does not offer it.
    #[error("{0}")]
    NotOffered(String),
}

/// Where a slave node is to start from in the next minor iteration, known from elsewhere.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Start {
    /// Slave number.
    pub slave: usize,
    /// Mode of the next minor iteration.
    pub mode: Mode,
    /// T_max, signed (force).
    pub t_max: f64,
}
