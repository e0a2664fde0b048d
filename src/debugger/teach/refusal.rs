//! Errors of lessons: actions that are not allowed now, and unavailable quantities.

use crate::action::ParseError;
use crate::session::Refusal;
use stickslip_core::counted;
use stickslip_scene::format::error::did_you_mean;

/// Why an action is not allowed now.
#[derive(Debug, thiserror::Error)]
pub enum LessonRefusal {
    /// No lesson is open.
    #[error("no lesson is open; press L to start one")]
    NoLesson,
    /// The lesson waits for another action.
    #[error("the lesson waits: {0}")]
    Waits(String),
    /// The text has more pages.
    #[error("the lesson text continues; press Space for the next page")]
    Unread,
    /// The lesson has ended.
    #[error("the lesson has ended; q quits, :lesson starts another")]
    Over,
    /// Decisions are hidden until predicted.
    #[error("predict first: a, then f free, s sliding, x fixed (p ends predicting)")]
    PredictFirst,
    /// No decision is hidden.
    #[error("no decision is hidden here; step forward and predict the next one")]
    NothingHidden,
    /// The decision at this node has been predicted.
    #[error("{0} has been predicted already")]
    Predicted(String),
    /// The question has been answered.
    #[error("the question has been answered; press Space to continue")]
    Answered,
    /// There is no open question.
    #[error("there is no open question")]
    NothingAsked,
    /// Not a mode.
    #[error("invalid mode '{0}'; expected free, sliding or fixed")]
    NoMode(String),
    /// Not a choice; and the number of choices.
    #[error("invalid choice '{0}'; expected 1 to {1}")]
    NoOption(String, usize),
    /// Not a number.
    #[error("invalid number '{0}'; expected a number such as -0.05 or 2e-3")]
    NoNumber(String),
}

/// Why a quantity is unavailable or a lesson is invalid.
#[derive(Debug, thiserror::Error)]
pub enum LessonError {
    /// No iteration has been solved.
    #[error("no iteration has been solved yet")]
    Unsolved,
    /// The solve failed earlier.
    #[error("the solve failed before this was known")]
    Failed,
    /// There is no later iteration.
    #[error("the history is complete")]
    Done,
    /// The number of minor iterations tried.
    #[error("the increment does not end within {}", counted(*.0, "minor iteration"))]
    Endless(u32),
    /// The bodies cannot be condensed.
    #[error("the bodies of this state cannot be condensed")]
    NotCondensed,
    /// There is no census.
    #[error("{0}")]
    NoCensus(stickslip_core::interface::census::TooMany),
    /// No cycle ends the increment.
    #[error("the increment does not end in a cycle")]
    NoCycle,
    /// The lesson has no chart.
    #[error("this lesson has no chart: [\"PATH=A,B\"]")]
    NoRuns,
    /// The chart cannot be measured.
    #[error("the lesson's chart cannot be measured: {0}")]
    NoChart(String),
    /// The settings do not select exactly one run.
    #[error("{0} does not select exactly one run of the lesson's chart")]
    NoRun(String),
    /// The run has no error: it failed, or it is the reference.
    #[error("this run has no error")]
    NoError,
    /// No increment has been accepted.
    #[error("no increment has been accepted yet")]
    NotJudged,
    /// The node does not slide, or T_max does not lag.
    #[error("no T_max lags here")]
    NoLag,
    /// Neither stability nor instability is proven.
    #[error("the stability of this state is not known")]
    NoStability,
    /// There are too few major iterations near the solution.
    #[error("the residuals of the increment do not show a rate of convergence")]
    NoRate,
    /// There is no slave node to ask about.
    #[error("this scene has no slave nodes")]
    NoSlaves,
    /// Not a number.
    #[error("this is not a number")]
    NoNumber,
    /// The number is not finite.
    #[error("the quantity is not a finite number")]
    NotFinite,
    /// The decision does not follow Table 2.
    #[error("no cell of Table 2 applies here")]
    NoCell,
    /// No choice is right.
    #[error("none of the choices is right")]
    NoneTrue,
    /// Several choices are right.
    #[error("more than one choice is right")]
    SeveralTrue,
    /// A hint that contains the answer, or a number from a later iteration.
    #[error("the hint contains the answer or looks ahead; use numbers of the shown iteration only")]
    TellsAnswer,
    /// A brace is not closed.
    #[error("a brace {{ is not closed by }}")]
    Brace,
    /// A node is missing.
    #[error("{0} needs a node: {{{0} NODE}}")]
    WhichNode(String),
    /// The action has no key.
    #[error("{0:?} is not an action with a key")]
    NoKey(String),
    /// The quantity does not belong to a node.
    #[error("{0} does not take a node; write {0} alone")]
    NotNodal(String),
    /// Unknown quantity.
    #[error("unknown quantity {word:?}{} (known: {})", did_you_mean(word, known.iter().copied()), known.join(", "))]
    NoQuantity {
        /// The word in the file.
        word: String,
        /// Known quantities.
        known: Vec<&'static str>,
    },
    /// Unknown action.
    #[error(transparent)]
    Misread(#[from] ParseError),
}

/// Why the action of a step is neither a key nor a typed line.
#[derive(Debug, thiserror::Error)]
pub(super) enum PressError {
    #[error("{0} takes no count")]
    NoCount(String),
    #[error("not a key, and {0}{1}")]
    NoAction(ParseError, String),
    #[error(transparent)]
    Misread(#[from] ParseError),
}

/// Why a lesson cannot be played to its end.
#[derive(Debug, thiserror::Error)]
pub(super) enum PlaybackError {
    #[error(transparent)]
    NotNow(#[from] LessonRefusal),
    #[error(transparent)]
    Refused(#[from] Refusal),
    #[error("the solution does not reach the goal: {0}")]
    NotReached(String),
    #[error("the history has fewer than {} to predict", counted(*.0, "iteration"))]
    FewIterations(u32),
}
