//! What a user can change in a run, as plain data; applied by [`super::intervene`].

use crate::linear::estimate::TooLarge;
use crate::{Friction, Mode, Settings};
use serde::{Deserialize, Serialize};

/// A change made by the user; recorded in snapshots and replayed from them.
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
    /// Start several slave nodes from a known state, each in a mode, for the next minor iteration.
    Assume(Vec<Start>),
    /// Return a slave node to the control of Table 2.
    Release {
        /// Slave number.
        slave: usize,
    },
    /// Change the increment size and restart the current increment. If the scene lists an increment for each leg of the path, the
    /// next leg begins with its own.
    Increment(f64),
    /// Replace the friction of every slave node.
    Friction(Friction),
    /// Replace the friction of each slave node separately, in the order of the scene.
    Frictions(Vec<Friction>),
    /// Replace the settings.
    Settings(Settings),
    /// Change a parameter of an attached solver.
    Parameter {
        /// Parameter name.
        name: String,
        /// Its value.
        value: Value,
    },
}

/// Value of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Value {
    /// A number, integer or not.
    Number(f64),
    /// True or false.
    Flag(bool),
    /// A string.
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

/// Why an intervention is refused; the state is not changed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// The history is finished.
    #[error("the history is done; step back first")]
    Done,
    /// No contact has this number.
    #[error("slave node {slave} does not exist: the {count} slave nodes are numbered from 0")]
    NoContact {
        /// Requested number.
        slave: usize,
        /// Number of contacts.
        count: usize,
    },
    /// A contact without a surface can only be free.
    #[error("the node is beyond the end of its surface and can only be free")]
    OffSurface,
    /// A tied contact is always fixed.
    #[error("the node is tied to its surface: it is always fixed")]
    Tied,
    /// Friction out of range.
    #[error("friction angle must be at least 0 and less than 90 degrees, cohesion at least 0")]
    Friction,
    /// Settings that apply only when the scene is opened, because they fix the initial gaps and the surfaces.
    #[error(
        "initial_gaps, adjust_gap and point_force apply only when a scene is opened: set them in its file or with --set"
    )]
    StartGaps,
    /// A limit of zero iterations.
    #[error("iteration limits must be at least 1")]
    Limits,
    /// An increment that is not a positive number.
    #[error("increment must be a positive number, not {0}")]
    Increment(f64),
    /// The requested linear solver does not fit into memory.
    #[error(transparent)]
    TooLarge(TooLarge),
    /// Only attached solvers have parameters.
    #[error("no attached solver has a parameter '{0}'")]
    NoParameter(String),
    /// The attached solver does not offer the intervention.
    #[error("{0}")]
    NotOffered(String),
}

/// Known state from which a slave node starts the next minor iteration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Start {
    /// Slave number.
    pub slave: usize,
    /// Mode of the next minor iteration.
    pub mode: Mode,
    /// T_max, signed (force).
    pub t_max: f64,
}
