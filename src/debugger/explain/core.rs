//! The core of a cycle: the smallest set of nodes that still cycles with all other modes frozen.
//!
//! To shrink a frozen interface problem that cycles, every node outside a trial set keeps the equations of its
//! initial mode ([`InterfaceProblem::reduced`]), and Table 2 runs over the remaining nodes.

use stickslip_core::interface::minor_history::MinorHistory;
use stickslip_core::interface::t_max_iteration::{TMaxLimit, spiral};
use stickslip_core::strategy::method;
use stickslip_core::{ContactRecord, ContactState, Cycle, InterfaceProblem, Mode, Trials};

/// Up to this number of members, all subsets are tried, smallest first; beyond it, each member is dropped once,
/// if possible.
const EXHAUSTIVE: usize = 10;
/// Maximum number of members searched; with more, only those whose modes change.
const MOST: usize = 40;
/// Relative difference below which two iterations are equal.
const SAME_ITERATION: f64 = 1e-12;

/// Maximum number of iterations in search of a cycle that T_max spirals into.
const AHEAD: usize = 600;
/// Maximum number of periods until T_max converges.
const ROUNDS: usize = 1000;

/// The smallest set of nodes that still cycles.
#[derive(Debug, Clone, PartialEq)]
pub struct Core {
    /// Indices of its nodes in the whole problem.
    pub places: Vec<usize>,
    /// The problem of these nodes alone; the cycle starts from their states.
    pub problem: InterfaceProblem,
    /// Its cycle; members are indices in `problem`.
    pub cycle: Cycle,
}

impl Core {
    /// Its problem at a point of the cycle after T_max has converged. Of the points of one period, the one with
    /// the smallest initial values.
    pub fn on_cycle(&self) -> InterfaceProblem {
        let mut nodes = self.problem.states();
        let mut around = vec![nodes.clone()];
        if let Some(mut trials) = Trials::new(&self.problem) {
            for _ in 0..ROUNDS {
                for _ in 0..self.cycle.period {
                    if trials
                        .minor(&mut nodes, method(self.problem.settings.strategy))
                        .is_some()
                    {
                        around.push(nodes.clone());
                    }
                }
                let [first, .., last] = around.as_slice() else {
                    break;
                };
                let limits =
                    |nodes: &[ContactState]| nodes.iter().map(|n| n.t_max).collect::<Vec<_>>();
                if limits(first) == limits(last) {
                    break;
                }
                around.drain(..around.len() - 1);
            }
        }
        let mut problem = self.problem.clone();
        let least = around.iter().min_by_key(|nodes| {
            nodes
                .iter()
                .map(|n| match n.mode {
                    Mode::Free => 0,
                    Mode::Fixed => 1 + u32::from(n.ratio != 0.0),
                    Mode::Sliding => 2 + u32::from(n.ratio != 0.0),
                })
                .sum::<u32>()
        });
        if let Some(least) = least {
            for (node, state) in problem.nodes.iter_mut().zip(least) {
                node.state = *state;
            }
        }
        problem
    }
}

/// Shrinks a problem that cycles from its initial modes; `None` if it does not cycle or too many nodes take
/// part.
pub fn core(whole: &InterfaceProblem) -> Option<Core> {
    let start = cycle(whole)?;
    let mut members: Vec<usize> = start.members.iter().map(|(place, _)| *place).collect();
    if members.len() > MOST {
        // When some modes change, the T_max of many other nodes follows; those nodes are frozen.
        let changing = start.members.iter().filter(|member| changes(&member.1));
        members = changing.map(|(place, _)| *place).collect();
    }
    if members.is_empty() || members.len() > MOST {
        return None;
    }
    let problem = whole.reduced(&members)?;
    let of = |chosen: &[usize]| {
        let problem = problem.reduced(chosen)?;
        let cycle = cycle(&problem)?;
        Some(Core {
            places: chosen.iter().map(|&member| members[member]).collect(),
            problem,
            cycle,
        })
    };
    if members.len() <= EXHAUSTIVE {
        let mut sets: Vec<u32> = (1..1_u32 << members.len()).collect();
        sets.sort_by_key(|set| set.count_ones());
        let chosen = |set: u32| -> Vec<usize> {
            (0..members.len())
                .filter(|bit| set >> bit & 1 == 1)
                .collect()
        };
        return sets.into_iter().find_map(|set| of(&chosen(set)));
    }
    let mut chosen: Vec<usize> = (0..members.len()).collect();
    let mut best = of(&chosen)?;
    for member in 0..members.len() {
        let fewer: Vec<usize> = chosen.iter().copied().filter(|&m| m != member).collect();
        if let Some(smaller) = of(&fewer) {
            (best, chosen) = (smaller, fewer);
        }
    }
    Some(best)
}

/// Whether a pattern, as of modes, changes.
pub(super) fn changes<T: PartialEq>(pattern: &[T]) -> bool {
    pattern.windows(2).any(|pair| pair[0] != pair[1])
}

/// The cycle that the minor iterations of a frozen problem run into. `None` if they settle, cannot be solved,
/// or reach the limit of the settings first. Members are indices in the problem.
pub fn cycle(problem: &InterfaceProblem) -> Option<Cycle> {
    end(problem)?.err()
}

/// How the minor iterations of a frozen problem end: they settle, with the records of the last one, or run into a cycle. `None` if
/// they cannot be solved, or reach the limit of the settings first.
pub(super) fn end(problem: &InterfaceProblem) -> Option<Result<Vec<ContactRecord>, Cycle>> {
    let mut nodes = problem.states();
    let mut trials = Trials::new(problem)?;
    let mut trail = MinorHistory::default();
    for minor in 1..=problem.settings.minors {
        trail.push(&nodes);
        let (records, settled) = trials.minor(&mut nodes, method(problem.settings.strategy))?;
        if settled {
            return Some(Ok(records));
        }
        if let Some(cycle) = trail.cycle(
            &nodes,
            minor,
            SAME_ITERATION * problem.force,
            SAME_ITERATION,
        ) {
            return Some(Err(cycle));
        }
    }
    spiralling(problem).map(Err)
}

/// The cycle of modes while T_max still spirals in too slowly to repeat within the limit.
fn spiralling(problem: &InterfaceProblem) -> Option<Cycle> {
    let found = spiral(problem, method(problem.settings.strategy), AHEAD)?;
    let takes_part =
        |(place, modes): &(usize, &Vec<Mode>)| changes(modes) || found.places.contains(place);
    let members = found.modes.iter().enumerate().filter(takes_part);
    (found.fate == TMaxLimit::Cycles).then(|| Cycle {
        start: found.start + 1 - found.period,
        period: found.period,
        members: members
            .map(|(place, modes)| (place, modes.clone()))
            .collect(),
    })
}
