//! What a strategy decides: how the modes of the next minor iteration are chosen.
//!
//! Every strategy solves for one assumption of every node's mode, as Table 2 does. They differ in what follows: in the mode
//! with which a node enters contact, in how many nodes may change at once, in the test itself, or in looking at all nodes
//! together ([`Search`]).

use crate::contact::table2::{Decision, Entry, Numbers, Rule, Tested, Ties, decide};
use crate::interface::problem::{Assumed, InterfaceProblem};
use crate::model::{BoundUpdate, Friction, Strategy};
use serde::{Deserialize, Serialize};
use std::any::Any;

/// A strategy. Each method that it does not implement does what Table 2 does.
pub trait Method: Send + Sync {
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

    /// Whether modes may repeat while the number of changing nodes still falls, without this being a cycle.
    fn counts_changes(&self) -> bool {
        false
    }

    /// A search over all nodes together, used when the modes at the start of a major iteration do not hold. `None` if the
    /// strategy decides node by node.
    fn search(&self) -> Option<&dyn Search> {
        None
    }

    /// The strategies that are tried one after the other in its place, the cheapest first; empty if it stands for itself.
    fn rungs(&self) -> &'static [Strategy] {
        &[]
    }

    /// Which of [`Method::rungs`] follows one of them (by number) with so many contacts. `None` after the last.
    fn after(&self, rung: usize, _contacts: usize) -> Option<usize> {
        Some(rung + 1).filter(|&next| next < self.rungs().len())
    }
}

/// What a verdict on one node may look at beside the numbers of Table 2.
#[derive(Debug, Clone, Copy)]
pub struct Known<'a> {
    /// Friction in force at the node.
    pub friction: &'a Friction,
    /// What counts as a tie.
    pub ties: &'a Ties,
    /// Stiffness of the springs that compare lengths with forces (force by length).
    pub spring: f64,
    /// Direction of T_max in the last minor iteration: −1, 0 (unknown) or 1.
    pub sign: f64,
    /// Slip as counted (length), also of a free node.
    pub slip: f64,
}

/// A verdict on one node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    /// The mode that the node takes next, with the reason.
    pub decision: Decision,
    /// Direction of T_max (−1, 0 or 1). `None` leaves it to [`crate::contact::table1::direction`].
    pub sign: Option<f64>,
}

/// Looks at all nodes together, one proposal a minor iteration.
pub trait Search {
    /// The next proposal.
    ///
    /// # Errors
    /// [`NoProposal`] if there is none.
    fn propose(&self, asked: Asked<'_>) -> Result<Proposal, NoProposal>;
}

/// What a search is asked for.
pub struct Asked<'a> {
    /// The start that the search has come to, from 0.
    pub start: usize,
    /// The step from there, from 0.
    pub step: usize,
    /// How many of its states a minor iteration has not confirmed.
    pub unconfirmed: usize,
    /// What every node brought into the major iteration, one entry a node.
    pub brought: &'a [Assumed],
    /// The interface problem; `None` where the bodies cannot be condensed.
    pub problem: &'a mut dyn FnMut() -> Option<InterfaceProblem>,
    /// What the search keeps from one proposal to the next. It may be gone, and is made again then.
    pub kept: &'a mut Option<Box<dyn Any + Send>>,
}

/// What a search has the nodes do.
#[derive(Debug, Clone, PartialEq)]
pub struct Proposal {
    /// For every node what it does, with F_n, F_t (forces), gap and slip (lengths).
    pub nodes: Vec<(Assumed, [f64; 4])>,
    /// The rule that records name as the reason.
    pub rule: Rule,
    /// How far the problem is still relaxed, or how much its forces still change (relative).
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
    /// The search goes on in the next minor iteration.
    At {
        /// Number of the start; of a census, of the answer.
        start: usize,
        /// Steps done from that start.
        #[serde(rename = "pivot")]
        step: usize,
    },
    /// A state was found from this start, and the next minor iteration checks it.
    Found {
        /// Number of the start.
        start: usize,
    },
}

/// Why a search proposes nothing more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoProposal {
    /// No assumption is consistent; all of them were tried.
    NoAnswer {
        /// Number of assumptions.
        tried: usize,
    },
    /// No consistent state was found, which does not prove that there is none.
    NotFound(NotFound),
}

/// Why a search found no consistent state, which does not prove that there is none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum NotFound {
    /// Pivoting ended on a ray, from every start.
    Ray,
    /// Pivoting was given up: its path may still end in an answer.
    Astray {
        /// Pivots done.
        pivots: usize,
    },
    /// The equations of every start of pivoting are singular.
    NoStart,
    /// Gauss-Seidel came to no modes that last.
    Unsettled {
        /// Sweeps done.
        sweeps: usize,
    },
    /// More nodes can touch than a census can try all assumptions of ([`crate::interface::census::MOST`]).
    TooMany {
        /// Number of nodes that can touch.
        nodes: usize,
    },
    /// The equations of the nodes that cannot touch are singular.
    Loose,
    /// The bodies cannot be condensed to the interface.
    NotCondensed,
    /// States were found, but the minor iteration that checked each of them did not confirm it.
    Unconfirmed {
        /// Number of states found.
        states: usize,
    },
}

impl From<NotFound> for NoProposal {
    fn from(why: NotFound) -> Self {
        NoProposal::NotFound(why)
    }
}
