//! Why a lesson does not let something be done, and what it cannot tell.

use crate::action::Misread;
use crate::format::error::did_you_mean;
use crate::session::Refusal;

/// Why something is not done now: what the lesson, or free mode, waits for.
#[derive(Debug, thiserror::Error)]
pub enum NotNow {
    /// What is to be done next.
    #[error("the lesson waits: {0}")]
    Waits(String),
    #[error("the lesson is over; q leaves, :lesson begins another")]
    Over,
    #[error("predict first: a, then f free, s sliding, x fixed (p ends predicting)")]
    PredictFirst,
    #[error("nothing is hidden here; step on and predict what comes")]
    NothingHidden,
    #[error("{0} is predicted already")]
    Predicted(String),
    #[error("that is answered; Space goes on")]
    Answered,
    #[error("nothing is asked now")]
    NothingAsked,
    #[error("'{0}' is no mode; free, sliding or fixed would be")]
    NoMode(String),
    #[error("'{0}' is none of 1 to {1}")]
    NoOption(String, usize),
    #[error("'{0}' is no number; -0.05 or 2e-3 would be")]
    NoNumber(String),
}

/// What the solver cannot tell, or what an author asks for that there is not.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Unknown {
    #[error("nothing is solved yet")]
    Unsolved,
    #[error("the solve failed before it found this")]
    Failed,
    #[error("the history is done")]
    Done,
    #[error("the increment has no end within {0} minor iterations")]
    Endless(u32),
    #[error("the bodies of this state cannot be condensed")]
    NotCondensed,
    /// Why there is no census.
    #[error("{0}")]
    NoCensus(crate::interface::census::TooMany),
    #[error("the increment does not end in a cycle")]
    NoCycle,
    #[error("this scene has no slave nodes")]
    NoSlaves,
    #[error("this is no number")]
    NoNumber,
    #[error("what is asked for is not a finite number")]
    NotFinite,
    #[error("no cell of Table 2 decided here")]
    NoCell,
    #[error("none of the choices is true")]
    NoneTrue,
    #[error("more than one of the choices is true")]
    SeveralTrue,
    #[error("a brace {{ is not closed by }}")]
    Brace,
    #[error("{0} of which node? {{{0} NODE}} would be right")]
    WhichNode(String),
    #[error("{0:?} is no action that has a key")]
    NoKey(String),
    #[error("{0} is not of a node; {0} alone would be right")]
    NotNodal(String),
    #[error("the solver knows no {word:?}{} (it knows {})", did_you_mean(word, known.iter().copied()), known.join(", "))]
    NoQuantity {
        word: String,
        known: Vec<&'static str>,
    },
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
