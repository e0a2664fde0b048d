//! Why a lesson does not let something be done, and what it cannot tell.

use crate::action::Misread;
use crate::session::Refusal;
use stickslip_scene::format::error::did_you_mean;

/// Why something is not done now: what the lesson, or free mode, waits for.
#[derive(Debug, thiserror::Error)]
pub enum NotNow {
    /// What is to be done next.
    #[error("the lesson waits: {0}")]
    Waits(String),
    /// It says more than the screen has shown.
    #[error("the lesson says more than was shown; Space turns its page")]
    Unread,
    /// There is nothing more to do.
    #[error("the lesson is over; q leaves, :lesson begins another")]
    Over,
    /// Decisions are hidden until they are predicted.
    #[error("predict first: a, then f free, s sliding, x fixed (p ends predicting)")]
    PredictFirst,
    /// No decision is hidden.
    #[error("nothing is hidden here; step on and predict what comes")]
    NothingHidden,
    /// The node whose decision is predicted already.
    #[error("{0} is predicted already")]
    Predicted(String),
    /// The question has its answer.
    #[error("that is answered; Space goes on")]
    Answered,
    /// There is no question.
    #[error("nothing is asked now")]
    NothingAsked,
    /// What was typed for a mode.
    #[error("'{0}' is no mode; free, sliding or fixed would be")]
    NoMode(String),
    /// What was typed for a choice, and how many there are.
    #[error("'{0}' is none of 1 to {1}")]
    NoOption(String, usize),
    /// What was typed for a number.
    #[error("'{0}' is no number; -0.05 or 2e-3 would be")]
    NoNumber(String),
}

/// What the solver cannot tell, or what an author asks for that there is not.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Unknown {
    /// No iteration is solved yet.
    #[error("nothing is solved yet")]
    Unsolved,
    /// The solve failed before.
    #[error("the solve failed before it found this")]
    Failed,
    /// There is no iteration after this one.
    #[error("the history is done")]
    Done,
    /// Minor iterations that were tried.
    #[error("the increment has no end within {0} minor iterations")]
    Endless(u32),
    /// The bodies cannot be condensed to the interface.
    #[error("the bodies of this state cannot be condensed")]
    NotCondensed,
    /// Why there is no census.
    #[error("{0}")]
    NoCensus(stickslip_core::interface::census::TooMany),
    /// No cycle ends the increment.
    #[error("the increment does not end in a cycle")]
    NoCycle,
    /// The lesson has no chart to ask about.
    #[error("this lesson has no chart: [\"PATH=A,B\"]")]
    NoRuns,
    /// Why its chart cannot be measured.
    #[error("the lesson's chart cannot be measured: {0}")]
    NoChart(String),
    /// Settings that are not those of one run.
    #[error("no run of the lesson's chart, or more than one, is {0}")]
    NoRun(String),
    /// The run has no error: it failed, or it is the reference.
    #[error("this run has no error")]
    NoError,
    /// No increment was accepted yet.
    #[error("nothing is accepted yet that could be judged")]
    NotJudged,
    /// The node does not slide, or T_max does not lag.
    #[error("no T_max lags here")]
    NoLag,
    /// Too few major iterations, or none that is near the solution.
    #[error("the increment's residuals show no rate of convergence")]
    NoRate,
    /// There is no slave node to ask about.
    #[error("this scene has no slave nodes")]
    NoSlaves,
    /// Words where a number belongs.
    #[error("this is no number")]
    NoNumber,
    /// The number is infinite, or none.
    #[error("what is asked for is not a finite number")]
    NotFinite,
    /// Another rule than one of Table 2 decided.
    #[error("no cell of Table 2 decided here")]
    NoCell,
    /// A question without a right choice.
    #[error("none of the choices is true")]
    NoneTrue,
    /// A question with more than one right choice.
    #[error("more than one of the choices is true")]
    SeveralTrue,
    /// A hint that contains the answer, or a number from a later iteration.
    #[error("the hint contains the answer or looks ahead; use numbers of the shown iteration only")]
    TellsAnswer,
    /// A brace without its end.
    #[error("a brace {{ is not closed by }}")]
    Brace,
    /// A quantity of a node, without the node.
    #[error("{0} of which node? {{{0} NODE}} would be right")]
    WhichNode(String),
    /// An action that no key has.
    #[error("{0:?} is no action that has a key")]
    NoKey(String),
    /// A quantity of the whole, with a node.
    #[error("{0} is not of a node; {0} alone would be right")]
    NotNodal(String),
    /// A quantity that there is not.
    #[error("the solver knows no {word:?}{} (it knows {})", did_you_mean(word, known.iter().copied()), known.join(", "))]
    NoQuantity {
        /// What was written.
        word: String,
        /// What there is.
        known: Vec<&'static str>,
    },
    /// An action that there is not.
    #[error(transparent)]
    Misread(#[from] Misread),
}

/// Why what a lesson wants pressed can be neither a key nor a typed line.
#[derive(Debug, thiserror::Error)]
pub(super) enum NoPress {
    #[error("{0} takes no count")]
    NoCount(String),
    #[error("no key, and {0}{1}")]
    NoAction(Misread, String),
    #[error(transparent)]
    Misread(#[from] Misread),
}

/// Why a lesson cannot be played through.
#[derive(Debug, thiserror::Error)]
pub(super) enum Unplayable {
    #[error(transparent)]
    NotNow(#[from] NotNow),
    #[error(transparent)]
    Refused(#[from] Refusal),
    #[error("the history has fewer than {0} iterations to predict")]
    FewIterations(u32),
}
