//! The ladder: Table 2 first; if it cycles or cannot go on, the next rung, from the cheapest to the most expensive.
//!
//! From the second rung on, T_max follows F_n within the solve. If no rung finds a consistent state, the increment is cut.

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
    Strategy::Copositive,
    Strategy::GaussSeidel,
];

impl Method for Ladder {
    fn rungs(&self) -> &'static [Strategy] {
        &RUNGS
    }
}
