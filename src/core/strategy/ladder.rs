//! The ladder: Table 2 first; if it cycles or fails, the next rung, from the cheapest to the most expensive.
//!
//! From the second rung on, T_max follows F_n within the solve. If no rung finds a consistent state, the increment is cut.
//!
//! With more than [`MANY`] contacts, sweeps and then pivoting precede the strategies that change one node at a time or try all
//! starts: a step of those costs a solve, and they need at least as many steps as there are nodes. Sweeps alone solve 248 of the
//! 276 problems of `cargo bench --bench hyperstatic`, and pivoting solves the rest.

use crate::interface::census;
use crate::{Method, Strategy};

/// Tries the rungs in order.
pub struct Ladder;

/// The rungs of the ladder for few contacts, cheapest first.
const RUNGS: [Strategy; 7] = [
    Strategy::Table2,
    Strategy::Sliding,
    Strategy::SlidingLeast,
    Strategy::Lemke,
    Strategy::Census,
    Strategy::GaussSeidel,
    Strategy::Copositive,
];

/// The rungs for many contacts, cheapest first.
const RUNGS_OF_MANY: [Strategy; 7] = [
    Strategy::Table2,
    Strategy::Sliding,
    Strategy::GaussSeidel,
    Strategy::Copositive,
    Strategy::SlidingLeast,
    Strategy::Lemke,
    Strategy::Census,
];

/// Maximum number of contacts that counts as few.
const MANY: usize = 20;
/// Maximum number of contacts for `lemke`.
const MOST_PIVOTED: usize = 64;
/// Maximum number of contacts for `copositive`, which needs 300 bytes per pair of contacts.
const MOST_COPOSITIVE: usize = 1000;

/// Whether only supported modes at the start of the history help, if a body is unsupported in them; `near` of the contacts are over
/// a surface. The strategies for this many contacts start from these modes or with all contacts open, and the equations of both are
/// singular. Only `lemke` has other starts, and the census tries other modes.
pub fn needs_support(contacts: usize, near: usize) -> bool {
    contacts > MOST_PIVOTED.max(MANY) && near > census::MOST
}

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
