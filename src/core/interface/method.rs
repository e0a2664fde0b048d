//! The decisions of a strategy: how it selects the modes of the next minor iteration.
//!
//! Every strategy solves for one combination of modes at a time, as Table 2 does. They differ in what follows: the mode in which
//! a node enters contact, the number of nodes that may change at once, the test itself, or a search over all nodes together
//! ([`Search`]).

use crate::contact::table2::{Entry, decide};
use crate::{
    AssumedMode, BoundUpdate, Decision, Friction, InterfaceProblem, Numbers, Rule, Strategy, Sweep,
    TestedQuantity, Ties,
};
use serde::{Deserialize, Serialize};
use std::any::Any;

/// A strategy. The default implementation of each method is that of Table 2.
pub trait Method: Send + Sync {
    /// How T_max enters the equations; `wanted` is the setting.
    fn bound(&self, wanted: BoundUpdate) -> BoundUpdate {
        wanted
    }

    /// How a node with friction enters contact.
    fn entry(&self) -> Entry {
        Entry::Fixed
    }

    /// The next mode of a node, with the reason.
    fn choose(&self, numbers: &Numbers, known: &NodeContext<'_>) -> Choice {
        Choice {
            decision: decide(numbers, known.ties),
            sign: None,
        }
    }

    /// Whether [`Method::choose`] uses [`NodeContext::spring`].
    fn compares_by_springs(&self) -> bool {
        false
    }

    /// Whether a line search follows if the minor iterations cycle ([`crate::interface::line_search`]).
    fn searches_line(&self) -> bool {
        false
    }

    /// Whether only one node may change at a time; `stalled` means that the number of changing nodes has not fallen recently.
    fn is_single(&self, _stalled: bool) -> bool {
        false
    }

    /// Whether repeated modes are not a cycle as long as the number of changing nodes still falls.
    fn counts_changes(&self) -> bool {
        false
    }

    /// A search over all nodes together, used if the modes at the start of a major iteration are inconsistent. `None` if the
    /// strategy decides node by node.
    fn search(&self) -> Option<&dyn Search> {
        None
    }

    /// The strategies that are tried in order instead of this one, cheapest first; empty for a single strategy.
    fn rungs(&self) -> &'static [Strategy] {
        &[]
    }

    /// Index in [`Method::rungs`] of the rung after this one, for a number of contacts. `None` after the last.
    fn after(&self, rung: usize, _contacts: usize) -> Option<usize> {
        Some(rung + 1).filter(|&next| next < self.rungs().len())
    }
}

/// Data for a node's decision in addition to the numbers of Table 2.
#[derive(Debug, Clone, Copy)]
pub struct NodeContext<'a> {
    /// Current friction of the node.
    pub friction: &'a Friction,
    /// Tie tolerances.
    pub ties: &'a Ties,
    /// Stiffness of the springs that relate lengths to forces (force per length).
    pub spring: f64,
    /// Direction of T_max in the last minor iteration: −1, 0 (unknown) or 1.
    pub sign: f64,
    /// Accumulated slip (length), also for a free node.
    pub slip: f64,
}

/// Decision for one node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    /// The next mode, with the reason.
    pub decision: Decision,
    /// Direction of T_max (−1, 0 or 1). With `None`, [`crate::contact::table1::direction`] determines it.
    pub sign: Option<f64>,
}

/// Searches over all nodes together, one proposal per minor iteration.
pub trait Search {
    /// The next proposal.
    ///
    /// # Errors
    /// [`NoProposal`] if there is none.
    fn propose(&self, asked: SearchInput<'_>) -> Result<Proposal, NoProposal>;
}

/// A search updates T_max consistently with F_n; Table 2 decides when it has ended.
impl<S: Search + Send + Sync> Method for S {
    fn bound(&self, _wanted: BoundUpdate) -> BoundUpdate {
        BoundUpdate::Consistent
    }

    fn search(&self) -> Option<&dyn Search> {
        Some(self)
    }
}

/// Input of a search.
pub struct SearchInput<'a> {
    /// Current start of the search, from 0.
    pub start: usize,
    /// Step from that start, from 0.
    pub step: usize,
    /// Number of its states that a minor iteration did not confirm.
    pub unconfirmed: usize,
    /// Mode of every node at the start of the major iteration.
    pub brought: &'a [AssumedMode],
    /// The interface problem; `None` if the bodies cannot be condensed.
    pub problem: &'a mut dyn FnMut() -> Option<InterfaceProblem>,
    /// Starts sweeps over the interface problem.
    pub sweep: &'a mut dyn FnMut() -> Result<Sweep, NotFound>,
    /// Data cached between proposals. They may be lost and must then be rebuilt.
    pub kept: &'a mut Option<Box<dyn Any + Send>>,
}

impl SearchInput<'_> {
    /// Takes the cached data, if they have this type and are at this start and step.
    pub fn take_kept<T: 'static>(&mut self, at: impl Fn(&T) -> (usize, usize)) -> Option<Box<T>> {
        let kept: Box<T> = self.kept.take()?.downcast().ok()?;
        (at(&kept) == (self.start, self.step)).then_some(kept)
    }
}

/// Modes proposed by a search.
#[derive(Debug, Clone, PartialEq)]
pub struct Proposal {
    /// Mode of every node, with F_n, F_t (forces), gap and slip (lengths).
    pub nodes: Vec<(AssumedMode, [f64; 4])>,
    /// The rule for the records.
    pub rule: Rule,
    /// Remaining relaxation of the problem, or remaining change or error of the forces (relative).
    pub cover: f64,
    /// Which of these it is.
    pub covers: TestedQuantity,
    /// The quantity that reached its bound, and the node.
    pub bound: Option<(usize, TestedQuantity)>,
    /// Where the search continues.
    pub next: SearchProgress,
}

/// Progress of a search over all nodes in a major iteration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum SearchProgress {
    /// Not started: the initial modes are tried first.
    #[default]
    Not,
    /// The search continues in the next minor iteration.
    At {
        /// Number of the start; for a census, of the solution.
        start: usize,
        /// Steps done from that start.
        #[serde(rename = "pivot")]
        step: usize,
    },
    /// A state was found from this start; the next minor iteration checks it.
    Found {
        /// Number of the start.
        start: usize,
    },
}

/// Why a search has no further proposal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NoProposal {
    /// No combination is consistent; all were tried.
    NoAnswer {
        /// Number of combinations.
        tried: usize,
    },
    /// No consistent state was found, which does not prove that there is none.
    NotFound(NotFound),
}

/// Why a search found no consistent state, which does not prove that there is none.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum NotFound {
    /// Pivoting ended on a ray from every start.
    Ray,
    /// Pivoting reached its limit: its path might still end at a solution.
    Astray {
        /// Pivots done.
        pivots: usize,
    },
    /// The equations of every start of pivoting are singular.
    NoStart,
    /// Gauss-Seidel did not converge.
    Unsettled {
        /// Sweeps done.
        sweeps: usize,
        /// The natural map that is left, relative to the forces, if the compliance was given.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        error: Option<f64>,
    },
    /// More nodes can touch than the census allows ([`crate::interface::census::MOST`]).
    TooMany {
        /// Number of nodes that can touch.
        nodes: usize,
    },
    /// The equations of the nodes that cannot touch are singular.
    Loose,
    /// The bodies cannot be condensed to the interface.
    NotCondensed,
    /// States were found, but the minor iterations that checked them did not confirm any.
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
