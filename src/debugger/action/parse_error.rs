//! Errors of typed lines.

use crate::history::breakpoints::NoPlace;
use stickslip_core::interface::census::MOST;
use stickslip_manual::NoPage;
use stickslip_study::read::NoVary;

/// Why a typed line is not an action, with a hint at what would be valid.
#[derive(Debug, thiserror::Error)]
pub enum ParseError {
    /// The line is empty.
    #[error("type the name of an action; ? lists all actions")]
    Nothing,
    /// The name is longer than any action's.
    #[error("unknown action (name too long); ? lists all actions")]
    LongName,
    /// Unknown name.
    #[error("unknown action '{0}'; ? lists all actions")]
    NoAction(String),
    /// Several names begin with this word.
    #[error("'{word}' is ambiguous: {}", names.join(", "))]
    Ambiguous {
        /// The word typed.
        word: String,
        /// The matching names.
        names: Vec<&'static str>,
    },
    /// The arguments are too long.
    #[error("the arguments of {name} are longer than {most} characters")]
    LongRest {
        /// The action.
        name: &'static str,
        /// Maximum number of characters.
        most: usize,
    },
    /// Too few or too many words; shows the usage.
    #[error("{0}")]
    Usage(String),
    /// A word that is not valid for its kind; `instead` says what is expected.
    #[error("invalid {kind} '{word}'; {instead}")]
    NoValue {
        /// The word typed.
        word: String,
        /// The kind: "mode", "number".
        kind: &'static str,
        /// What is expected.
        instead: String,
    },
    /// The manual has no such page.
    #[error(transparent)]
    NoPage(#[from] NoPage),
    /// Not a position in a run.
    #[error(transparent)]
    NoPlace(#[from] NoPlace),
    /// Not one of a few words.
    #[error("unknown word '{word}'; expected one of: {}", all.join(", "))]
    NoneOf {
        /// The word typed.
        word: String,
        /// The valid words.
        all: Vec<&'static str>,
    },
    /// Not a quantity to watch; a list of the quantities.
    #[error("cannot watch '{0}'; quantities: {1}")]
    NotWatched(String, String),
    /// Not a condition to break at; a list of the conditions.
    #[error("unknown condition '{0}'; conditions: {1}")]
    NoCondition(String, String),
    /// No scene is open.
    #[error("open a scene first")]
    NoScene,
    /// The scene has no slave nodes.
    #[error("this scene has no slave nodes")]
    NoSlaves,
    /// The node exists but is not a slave node.
    #[error("{word} is not a slave node; slave nodes: {slaves}")]
    NoSlave {
        /// The word typed.
        word: String,
        /// The names of the slave nodes.
        slaves: String,
    },
    /// Unknown node.
    #[error("unknown node '{word}'; slave nodes: {slaves}")]
    NoNode {
        /// The word typed.
        word: String,
        /// The names of the slave nodes.
        slaves: String,
    },
    /// The word does not occur in any slave node's name.
    #[error("no slave node name contains '{word}'; slave nodes: {slaves}")]
    NotFound {
        /// The word typed.
        word: String,
        /// The names of the slave nodes.
        slaves: String,
    },
    /// Too many nodes for a census.
    #[error("too many nodes for a census: {0}; the limit is {MOST}")]
    ManyNodes(usize),
    /// The scene has no monitors.
    #[error("this scene has no monitors")]
    NoMonitors,
    /// Unknown monitor.
    #[error("unknown monitor '{name}'; monitors: {monitors}")]
    NoMonitor {
        /// The word typed.
        name: String,
        /// The names of the monitors.
        monitors: String,
    },
    /// Invalid settings of a chart.
    #[error(transparent)]
    NoChart(#[from] NoVary),
}

impl ParseError {
    /// An invalid mode.
    pub(super) fn no_mode(word: &str) -> ParseError {
        let instead = "expected free, sliding or fixed".into();
        ParseError::no_value(word, "mode", instead)
    }

    /// A word that is not valid for its kind.
    pub(super) fn no_value(word: &str, kind: &'static str, instead: String) -> ParseError {
        let word = word.into();
        ParseError::NoValue {
            word,
            kind,
            instead,
        }
    }
}
