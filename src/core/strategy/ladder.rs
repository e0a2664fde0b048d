//! The ladder: Table 2 first; where it cycles or cannot go on, what gets out at the least cost.
//!
//! From its second rung on T_max stands in the matrix. Where no rung finds a consistent state the increment is cut.

use crate::interface::method::Method;
use crate::model::Strategy;

/// The rungs, one after the other.
pub struct Ladder;

/// The rungs of the ladder, the cheapest first.
const RUNGS: [Strategy; 5] = [
    Strategy::Table2,
    Strategy::Sliding,
    Strategy::SlidingLeast,
    Strategy::Lemke,
    Strategy::Census,
];

impl Method for Ladder {
    fn rungs(&self) -> &'static [Strategy] {
        &RUNGS
    }
}
