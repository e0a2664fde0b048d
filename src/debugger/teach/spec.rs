//! A lesson as its author writes it.
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
//!     ],
//! )
//! ```
//!
//! Right answers do not stand here: they are what the solver then does. So are numbers in texts, see
//! [`super::quantity`].

use serde::Deserialize;
use stickslip_core::model::Mode;
use stickslip_scene::format::spec::Spec;

/// A lesson file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LessonSpec {
    /// One line that says what the lesson is about.
    pub title: String,
    /// What it teaches, in a line.
    #[serde(default)]
    pub about: String,
    /// The scene that it is played on.
    pub scene: SceneSpec,
    /// What is changed in the scene: path and value.
    #[serde(default)]
    pub set: Vec<(String, String)>,
    /// Settings whose product is a work-precision chart, as `:chart` takes them; for questions about `error RUN` and the like.
    #[serde(default)]
    pub chart: Vec<String>,
    /// What is told, asked and done, one after the other.
    pub steps: Vec<StepSpec>,
}

/// Where a lesson's scene comes from.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub enum SceneSpec {
    /// A built-in scene, or a file (as seen from the lesson's).
    Name(String),
    /// A scene of the lesson's own.
    Scene(Box<Spec>),
}

/// A step of a lesson.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum StepSpec {
    /// Something to read.
    Text(String),
    /// Something to do.
    Press {
        /// What is told before.
        text: String,
        /// A key, with a count before it or not (`s`, `3s`), or a typed line (`force beam.end sliding`).
        press: String,
    },
    /// A question.
    Ask {
        /// The question.
        text: String,
        /// What is right.
        answer: AnswerSpec,
        /// Minor iterations that the question looks ahead: 0 asks about the one that is shown.
        #[serde(default)]
        ahead: u32,
        /// Help after a wrong answer, in addition to the decision's numbers. Its numbers are those of the shown iteration.
        #[serde(default)]
        hint: String,
        /// What is said once the answer is known. Its numbers are those of the iteration asked about.
        #[serde(default)]
        then: String,
    },
    /// Free mode, until so many predictions were right.
    Predict {
        /// What is told before.
        text: String,
        /// How many must be right, one after the other.
        right: u32,
    },
}

/// What is asked for; the right answer is what the solver finds.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum AnswerSpec {
    /// The mode that a slave node takes next.
    Mode {
        /// Name of the slave node.
        node: String,
    },
    /// The cell of Table 2, in the row of the node's mode, that fires.
    Rule {
        /// Name of the slave node.
        node: String,
    },
    /// A number: one of [`super::quantity`]. The tolerance is relative; 0 wants it exact.
    Number {
        /// The quantity, as in braces.
        of: String,
        /// How far off an answer may be, relatively.
        tolerance: f64,
    },
    /// One of several sentences, each with what makes it true; one of them must be.
    Choice(Vec<(String, When)>),
}

/// What makes a choice right.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum When {
    /// The increment, run on from here, ends in a cycle.
    Cycles,
    /// The increment, run on from here, is accepted.
    Accepted,
    /// The census finds so many consistent states.
    Answers(usize),
    /// The node takes this mode next.
    Becomes {
        /// Name of the slave node.
        node: String,
        /// The mode that it takes.
        mode: Mode,
    },
    /// The residuals of the increment, run on from here, end with a factor that stays.
    Linear,
    /// They end with ever smaller factors, the digits doubling.
    Quadratic,
    /// The judge found every law obeyed in the increment that was accepted last.
    Obeys,
    /// The judge found this law broken there: penetration, gap, tension, cone, slip, touch, balance or moments.
    Breaks(String),
    /// The first number (a quantity, or written out) is less than the second by a twentieth at least.
    Less(String, String),
    /// The numbers differ by a twentieth at most.
    Close(String, String),
    /// Of the chart's runs whose error is at most this, that with these settings has the fewest factorizations.
    Cheapest {
        /// Settings, as `PATH=A PATH=B`.
        run: String,
        /// The error that is wanted, relative.
        error: f64,
    },
    /// What no solver can tell.
    Right,
    /// Never.
    Wrong,
}
