//! The ladder: Table 2 first; if it cycles or cannot go on, the next rung, from the cheapest to the most expensive.
//!
//! From the second rung on, T_max follows F_n within the solve. If no rung finds a consistent state, the increment is cut.
//!
//! With more contacts than [`MANY`], sweeps and the pivoting that they leave some problems to come before what changes one node
//! at a time or walks all starts: a step of these costs a solve, and there are as many steps as nodes, or more. Sweeps alone
//! solve 248 of the 276 problems of `cargo bench --bench hyperstatic`, and pivoting the rest.

use crate::interface::method::Method;
use crate::model::Strategy;

/// The rungs, one after the other.
pub struct Ladder;

/// The rungs of the ladder, the cheapest first where contacts are few.
const RUNGS: [Strategy; 7] = [
    Strategy::Table2,
    Strategy::Sliding,
    Strategy::SlidingLeast,
    Strategy::Lemke,
    Strategy::Census,
    Strategy::GaussSeidel,
    Strategy::Copositive,
];

/// The same, the cheapest first where contacts are many.
const RUNGS_OF_MANY: [Strategy; 7] = [
    Strategy::Table2,
    Strategy::Sliding,
    Strategy::GaussSeidel,
    Strategy::Copositive,
    Strategy::SlidingLeast,
    Strategy::Lemke,
    Strategy::Census,
];

/// Most contacts that are few.
const MANY: usize = 20;
/// Most contacts with which `lemke` is tried.
const MOST_PIVOTED: usize = 64;
/// Most contacts with which `copositive` is tried: its numbers take 300 bytes for every pair of contacts.
const MOST_COPOSITIVE: usize = 1000;

impl Method for Ladder {
    fn rungs(&self) -> &'static [Strategy] {
        &RUNGS
    }

    fn after(&self, rung: usize, contacts: usize) -> Option<usize> {
        let order = if contacts > MANY {
            RUNGS_OF_MANY
        } else {
            RUNGS
        };
        let here = RUNGS.get(rung)?;
        let next = order
            .into_iter()
            .skip_while(|strategy| strategy != here)
            .skip(1)
            .find(|strategy| match strategy {
                Strategy::Lemke => contacts <= MOST_PIVOTED,
                Strategy::Copositive => contacts <= MOST_COPOSITIVE,
                _ => true,
            })?;
        RUNGS.iter().position(|strategy| *strategy == next)
    }
}
