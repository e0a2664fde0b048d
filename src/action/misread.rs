//! Why a line means no action.

use crate::history::breakpoints::NoPlace;
use crate::interface::census::MOST;
use crate::manual::NoPage;
use crate::study::read::NoVary;

/// Why a line means no action: what is wrong, and what would be right.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Misread {
    #[error("type an action's name; ? lists them all")]
    Nothing,
    #[error("no action's name is so long; ? lists them all")]
    LongName,
    #[error("no action is called '{0}'; ? lists them all")]
    NoAction(String),
    #[error("'{word}' could be {}", names.join(", "))]
    Ambiguous {
        word: String,
        names: Vec<&'static str>,
    },
    #[error("what follows {name} is longer than {most} characters")]
    LongRest { name: &'static str, most: usize },
    /// Words too many or too few; how the action is written.
    #[error("{0}")]
    Usage(String),
    /// A word that is no value of its kind; `instead` says what would be one.
    #[error("'{word}' is no {kind}; {instead}")]
    NoValue {
        word: String,
        kind: &'static str,
        instead: String,
    },
    #[error(transparent)]
    NoPage(#[from] NoPage),
    #[error(transparent)]
    NoPlace(#[from] NoPlace),
    #[error("'{word}' is none of {}", all.join(", "))]
    NoneOf {
        word: String,
        all: [&'static str; 3],
    },
    #[error("'{0}' cannot be watched; {1} can")]
    NotWatched(String, String),
    #[error("'{0}' is nothing to break at; {1} are")]
    NoCondition(String, String),
    #[error("open a scene first")]
    NoScene,
    #[error("this scene has no slave nodes")]
    NoSlaves,
    #[error("{word} is not a slave node; those are {slaves}")]
    NoSlave { word: String, slaves: String },
    #[error("no node is called '{word}'; slave nodes are {slaves}")]
    NoNode { word: String, slaves: String },
    #[error("no slave node's name contains '{word}'; there are {slaves}")]
    NotFound { word: String, slaves: String },
    #[error("a census is held over at most {MOST} nodes, and these are {0}")]
    ManyNodes(usize),
    #[error("this scene has no monitors")]
    NoMonitors,
    #[error("no monitor is called '{name}'; there are {monitors}")]
    NoMonitor { name: String, monitors: String },
    /// Settings of a chart that cannot be read.
    #[error(transparent)]
    NoChart(#[from] NoVary),
}

impl Misread {
    /// A word that is no mode.
    pub(super) fn no_mode(word: &str) -> Misread {
        let instead = "free, sliding or fixed would be".into();
        Misread::no_value(word, "mode", instead)
    }

    /// A word that is no value of a kind.
    pub(super) fn no_value(word: &str, kind: &'static str, instead: String) -> Misread {
        let word = word.into();
        Misread::NoValue {
            word,
            kind,
            instead,
        }
    }
}
