//! Block pivoting: all changes at once, but one at a time while their number does not fall.
//!
//! As long as the number of changing nodes has reached a new minimum within the last few minor iterations of a major iteration,
//! returning to earlier modes does not count as a cycle.

use crate::Method;
use crate::contact::table2::Entry;

/// Nodes with friction start to slide; all changes at once until the number of changes stalls.
pub struct Block;

impl Method for Block {
    fn entry(&self) -> Entry {
        Entry::Sliding
    }

    fn is_single(&self, stalled: bool) -> bool {
        stalled
    }

    fn counts_changes(&self) -> bool {
        true
    }
}
