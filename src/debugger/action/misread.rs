//! Why a line means no action.

use crate::history::breakpoints::NoPlace;
use stickslip_core::interface::census::MOST;
use stickslip_manual::NoPage;
use stickslip_study::read::NoVary;

/// Why a line means no action: what is wrong, and what would be right.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Misread {
    /// The line is empty.
    #[error("type an action's name; ? lists them all")]
    Nothing,
    /// The name is longer than any.
    #[error("no action's name is so long; ? lists them all")]
    LongName,
    /// No action has this name.
    #[error("no action is called '{0}'; ? lists them all")]
    NoAction(String),
    /// Several names begin with this word.
    #[error("'{word}' could be {}", names.join(", "))]
    Ambiguous {
        /// What was typed.
        word: String,
        /// The names that begin with it.
        names: Vec<&'static str>,
    },
    /// The arguments are too long to be meant.
    #[error("what follows {name} is longer than {most} characters")]
    LongRest {
        /// The action.
        name: &'static str,
        /// Most characters that it takes.
        most: usize,
    },
    /// Words too many or too few; how the action is written.
    #[error("{0}")]
    Usage(String),
    /// A word that is no value of its kind; `instead` says what would be one.
    #[error("'{word}' is no {kind}; {instead}")]
    NoValue {
        /// What was typed.
        word: String,
        /// What it should be: "mode", "number".
        kind: &'static str,
        /// What would be one.
        instead: String,
    },
    /// There is no such page of the manual.
    #[error(transparent)]
    NoPage(#[from] NoPage),
    /// A word that is no place in a run.
    #[error(transparent)]
    NoPlace(#[from] NoPlace),
    /// A word that is none of a few.
    #[error("'{word}' is none of {}", all.join(", "))]
    NoneOf {
        /// What was typed.
        word: String,
        /// The words that would do.
        all: Vec<&'static str>,
    },
    /// A word that is no quantity to watch, and the quantities.
    #[error("'{0}' cannot be watched; {1} can")]
    NotWatched(String, String),
    /// A word that is no condition to break at, and the conditions.
    #[error("'{0}' is nothing to break at; {1} are")]
    NoCondition(String, String),
    /// No scene is open.
    #[error("open a scene first")]
    NoScene,
    /// The scene has no slave nodes.
    #[error("this scene has no slave nodes")]
    NoSlaves,
    /// The node exists and is not a slave node.
    #[error("{word} is not a slave node; those are {slaves}")]
    NoSlave {
        /// What was typed.
        word: String,
        /// The names of the slave nodes.
        slaves: String,
    },
    /// No node has this name.
    #[error("no node is called '{word}'; slave nodes are {slaves}")]
    NoNode {
        /// What was typed.
        word: String,
        /// The names of the slave nodes.
        slaves: String,
    },
    /// No name of a slave node contains this word.
    #[error("no slave node's name contains '{word}'; there are {slaves}")]
    NotFound {
        /// What was typed.
        word: String,
        /// The names of the slave nodes.
        slaves: String,
    },
    /// More nodes than a census is held over.
    #[error("a census is held over at most {MOST} nodes, and these are {0}")]
    ManyNodes(usize),
    /// The scene has no monitors.
    #[error("this scene has no monitors")]
    NoMonitors,
    /// No monitor has this name.
    #[error("no monitor is called '{name}'; there are {monitors}")]
    NoMonitor {
        /// What was typed.
        name: String,
        /// The names of the monitors.
        monitors: String,
    },
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
