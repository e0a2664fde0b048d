//! What a strategy decides: how the modes of the next minor iteration are chosen.
//!
//! All of them solve for one assumption of every node's mode, as Table 2 does, and differ in how they go on from there: in
//! the mode with which a node enters contact, in how many nodes may change at once, in the test itself, or in that they
//! look at all nodes together.

use crate::contact::table2::{Decision, Entry, Numbers, Rule, Tested, Ties, decide};
use crate::interface::problem::{Assumed, InterfaceProblem};
use crate::model::{BoundUpdate, Friction, Strategy};
use serde::{Deserialize, Serialize};
use std::any::Any;

/// A strategy. What it does not say is done as Table 2 has it.
pub trait Method: Sync {
    /// How T_max enters the equations; `wanted` is what the settings say.
    fn bound(&self, wanted: BoundUpdate) -> BoundUpdate {
        wanted
    }

    /// How a rough node enters contact.
    fn entry(&self) -> Entry {
        Entry::Fixed
    }

    /// The mode that a node takes next, with the reason.
    fn choose(&self, numbers: &Numbers, known: &Known<'_>) -> Choice {
        Choice {
            decision: decide(numbers, known.ties),
            sign: None,
        }
    }

    /// Whether [`Method::choose`] looks at [`Known::spring`].
    fn compares_by_springs(&self) -> bool {
        false
    }

    /// Whether only one node may change at a time; `stalled` says that the number of changing nodes has not fallen for
    /// a while.
    fn is_single(&self, _stalled: bool) -> bool {
        false
    }

    /// Whether a return to earlier modes is no cycle as long as the number of changing nodes still falls.
    fn counts_changes(&self) -> bool {
        false
    }

    /// What looks at all nodes together, once the modes that a major iteration begins with do not hold.
    fn search(&self) -> Option<&dyn Search> {
        None
    }

    /// The strategies that are tried one after the other in its place, the cheapest first; none where it stands for itself.
    fn rungs(&self) -> &'static [Strategy] {
        &[]
    }
}

/// What a verdict on one node may look at beside the numbers of Table 2.
#[derive(Debug, Clone, Copy)]
pub struct Known<'a> {
    pub friction: &'a Friction,
    pub ties: &'a Ties,
    /// Stiffness of the springs that compare lengths with forces (force by length).
    pub spring: f64,
    /// Direction that T_max had.
    pub sign: f64,
    /// Slip as counted (length), also of a free node.
    pub slip: f64,
}

/// A verdict on one node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    pub decision: Decision,
    /// Direction of T_max, where the strategy knows it.
    pub sign: Option<f64>,
}

/// Looks at all nodes together, one proposal a minor iteration.
pub trait Search {
    /// The next proposal.
    ///
    /// # Errors
    /// Why there is none.
    fn propose(&self, asked: Asked<'_>) -> Result<Proposal, NoProposal>;
}

/// What a search is asked for.
pub struct Asked<'a> {
    /// The start that it has come to, and the step from there.
    pub start: usize,
    pub step: usize,
    /// How many of its states a minor iteration has not confirmed.
    pub unconfirmed: usize,
    /// What every node brought into the major iteration.
    pub brought: &'a [Assumed],
    /// The interface problem; `None` where the bodies cannot be condensed.
    pub problem: &'a mut dyn FnMut() -> Option<InterfaceProblem>,
    /// What the search keeps from one proposal to the next. It may be gone, and is made again then.
    pub kept: &'a mut Option<Box<dyn Any + Send>>,
}

/// What a search has the nodes do.
#[derive(Debug, Clone, PartialEq)]
pub struct Proposal {
    /// For every node what it does, with F_n, F_t, gap and slip.
    pub nodes: Vec<(Assumed, [f64; 4])>,
    pub rule: Rule,
    /// How far the problem is still relaxed (relative).
    pub cover: f64,
    /// What reached its bound, and at which node.
    pub bound: Option<(usize, Tested)>,
    /// Where the search goes on.
    pub next: Searched,
}

/// How far a search over all nodes has come in a major iteration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Searched {
    /// The modes that the iteration began with are tried first.
    #[default]
    Not,
    /// The next minor iteration is this step from this start; of a census, the answer of this number.
    At {
        start: usize,
        #[serde(rename = "pivot")]
        step: usize,
    },
    /// A state was found from this start, and the next minor iteration checks it.
    Found { start: usize },
}

/// Why a search proposes nothing more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoProposal {
    /// No assumption is consistent: so many were tried, all that there are.
    NoAnswer { tried: usize },
    /// None was found, which does not prove that there is none.
    NotFound(NotFound),
}

/// Why a search found no consistent state, which does not prove that there is none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum NotFound {
    /// Pivoting ended on a ray, from every start.
    Ray,
    /// The equations of every start of pivoting are singular.
    NoStart,
    /// So many nodes can touch that their assumptions are too many to try.
    TooMany { nodes: usize },
    /// The equations of the nodes that cannot touch are singular.
    Loose,
    /// The bodies cannot be condensed to the interface.
    NotCondensed,
    /// So many states were found, and the minor iteration that checked each did not confirm it.
    Unconfirmed { states: usize },
}

impl From<NotFound> for NoProposal {
    fn from(why: NotFound) -> Self {
        NoProposal::NotFound(why)
    }
}
