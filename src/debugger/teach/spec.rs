//! The file format of a lesson.
//!
//! ```ron
//! (
//!     title: "Why free and fixed take turns",
//!     about: "One line for the list.",
//!     scene: Name("osc-inclined-cantilever"),          // or scene: Scene(( … a whole scene … ))
//!     set: [("friction.angle", "20")],                 // as --set does; may be left out
//!     steps: [
//!         Text("Words. {F_n beam.end} is replaced by the number that the solver found."),
//!         Press(text: "Solve once.", press: "s"),
//!         Ask(text: "Which mode comes next?", answer: Mode(node: "beam.end"), hint: "…", then: "…"),
//!         Predict(text: "Now you alone.", right: 3),
//!         Reach(text: "Reach the end.", without: [ladder], solution: ["set settings.t_max consistent", "c"]),
//!     ],
//! )
//! ```
//!
//! Right answers are not in the file: they are the results of the solver. So are the numbers in texts, see
//! [`super::quantity`].

use serde::Deserialize;
use stickslip_core::Mode;
use stickslip_scene::Spec;

/// A lesson file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LessonSpec {
    /// Title, one line.
    pub title: String,
    /// Subject, one line.
    #[serde(default)]
    pub about: String,
    /// The scene.
    pub scene: SceneSpec,
    /// Changes to the scene: path and value.
    #[serde(default)]
    pub set: Vec<(String, String)>,
    /// Settings of a work-precision chart, as for `:chart`, for questions about `error RUN` and `factorizations
    /// RUN`.
    #[serde(default)]
    pub chart: Vec<String>,
    /// The steps in order.
    pub steps: Vec<StepSpec>,
}

/// The scene of a lesson.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub enum SceneSpec {
    /// A built-in scene, or a file (relative to the lesson's folder).
    Name(String),
    /// A scene in the lesson's file.
    Scene(Box<Spec>),
    /// The recorded exchange with an attached solver: a built-in one, or a file (relative to the lesson's folder).
    Recorded(String),
}

/// A step of a lesson.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum StepSpec {
    /// Something to read.
    Text(String),
    /// An action to perform.
    Press {
        /// Text before the action.
        text: String,
        /// A key, optionally with a count (`s`, `3s`), or a typed line (`force beam.end sliding`).
        press: String,
    },
    /// A question.
    Ask {
        /// The question.
        text: String,
        /// The right answer.
        answer: AnswerSpec,
        /// Number of minor iterations that the question looks ahead: 0 asks about the shown one.
        #[serde(default)]
        ahead: u32,
        /// Reply to a wrong answer, in addition to the decision's numbers. Its numbers are those of the shown
        /// iteration.
        #[serde(default)]
        hint: String,
        /// Reply to the right answer. Its numbers are those of the iteration asked about.
        #[serde(default)]
        then: String,
    },
    /// A state to reach with any keys. After a task only texts and tasks may follow.
    Reach {
        /// The task.
        text: String,
        /// The load factor of an accepted increment; without it, the end of the history.
        #[serde(default)]
        load: Option<f64>,
        /// Reach a failed increment instead.
        #[serde(default)]
        failure: bool,
        /// What must not be used on the way.
        #[serde(default)]
        without: Vec<Aid>,
        /// Shown on request; its numbers are those of the start of the task.
        hint: String,
        /// Reply, with the numbers of the reached state.
        #[serde(default)]
        then: String,
        /// Keys and typed lines that reach the state from the start of the task.
        solution: Vec<String>,
    },
    /// A number to find with any keys: a quantity of the state at the start of the task.
    Find {
        /// The task.
        text: String,
        /// The quantity, as in braces.
        of: String,
        /// Relative tolerance.
        tolerance: f64,
        /// Shown on request and after a wrong answer.
        #[serde(default)]
        hint: String,
        /// Reply to the right answer.
        #[serde(default)]
        then: String,
    },
    /// Free mode, until enough predictions were right.
    Predict {
        /// Text before the predictions.
        text: String,
        /// Number of consecutive right predictions required.
        right: u32,
    },
}

stickslip_core::words! {
    /// What a task can exclude.
    #[derive(Deserialize)]
    #[serde(rename_all = "snake_case")]
    pub enum Aid, words {
        /// The strategy `ladder`.
        Ladder "the strategy ladder",
        /// Forced modes, and starts from a consistent state.
        Force "forced modes",
        /// Another friction or cohesion.
        Friction "another friction",
        /// Another size of the increment.
        Increment "another increment size",
        /// Any other change of the settings.
        Settings "other settings",
    }
}

/// What is asked; the solver provides the right answer.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum AnswerSpec {
    /// The next mode of a slave node.
    Mode {
        /// Name of the slave node.
        node: String,
    },
    /// The cell of Table 2 that applies, in the row of the node's mode.
    Rule {
        /// Name of the slave node.
        node: String,
    },
    /// A number: one of [`super::quantity`]. The tolerance is relative; 0 requires the exact number.
    Number {
        /// The quantity, as in braces.
        of: String,
        /// Relative tolerance.
        tolerance: f64,
    },
    /// One of several sentences, each with its condition; exactly one must be right.
    Choice(Vec<(String, When)>),
}

/// The condition that makes a choice right.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum When {
    /// The increment, continued from here, ends in a cycle.
    Cycles,
    /// The increment, continued from here, is accepted.
    Accepted,
    /// Number of consistent states in the census.
    Answers(usize),
    /// The next mode of a node.
    Becomes {
        /// Name of the slave node.
        node: String,
        /// The next mode.
        mode: Mode,
    },
    /// Linear convergence: the residuals of the increment, continued from here, fall by a constant factor at
    /// the end.
    Linear,
    /// Quadratic convergence: the number of correct digits doubles at the end.
    Quadratic,
    /// The shown equilibrium is stable under a constant load.
    Stable,
    /// It is unstable.
    Unstable,
    /// The judge found no violation in the last accepted increment.
    Obeys,
    /// The judge found a violation of this law there: penetration, gap, tension, cone, slip, touch, balance or
    /// moments.
    Breaks(String),
    /// The first number (a quantity or a literal) is less than the second by at least a twentieth.
    Less(String, String),
    /// The numbers differ by at most a twentieth.
    Close(String, String),
    /// The run with the fewest factorizations of those with at most this error.
    Cheapest {
        /// Settings, as `PATH=A PATH=B`.
        run: String,
        /// Largest relative error.
        error: f64,
    },
    /// Always right.
    Right,
    /// Never right.
    Wrong,
}
