//! The ladder: Table 2 first; if it cycles or cannot go on, the next rung, from the cheapest to the most expensive.
//!
//! From the second rung on, T_max follows F_n within the solve. If no rung finds a consistent state, the increment is cut.
//!
//! Of the last two, sweeps are cheaper: they solved 57 of the first 60 problems of `cargo bench --bench hyperstatic`. Pivoting
//! solves some that sweeps do not, such as number 13, but not all: its path may be longer than it may go, as at number 27.

use crate::interface::method::Method;
use crate::model::Strategy;

/// The rungs, one after the other.
pub struct Ladder;

/// The rungs of the ladder, the cheapest first.
const RUNGS: [Strategy; 7] = [
    Strategy::Table2,
    Strategy::Sliding,
    Strategy::SlidingLeast,
    Strategy::Lemke,
    Strategy::Census,
    Strategy::GaussSeidel,
    Strategy::Copositive,
];

/// Most contacts with which `lemke` is tried.
const MOST_PIVOTED: usize = 64;

impl Method for Ladder {
    fn rungs(&self) -> &'static [Strategy] {
        &RUNGS
    }

    fn leaves_out(&self, rung: Strategy, contacts: usize) -> bool {
        rung == Strategy::Lemke && contacts > MOST_PIVOTED
    }
}
