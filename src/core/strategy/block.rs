//! Block pivoting: all changes at once, and one at a time while their number does not fall.
//!
//! While the number of changing nodes has reached a new minimum within the last few minor iterations of a major one, the
//! modes may return to earlier ones without that being a cycle.

use crate::contact::table2::Entry;
use crate::interface::method::Method;

/// Rough nodes enter sliding; all changes at once until that stalls.
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
