//! One change at a time: of all nodes that would change, only the first does, and the others wait (Bland's least index).
//!
//! Nodes that react to each other's changes then no longer cycle together. The price is one minor iteration for each change.

use crate::contact::table2::Entry;
use crate::interface::method::Method;

/// Table 2, one change at a time.
pub struct Least;

impl Method for Least {
    fn is_single(&self, _stalled: bool) -> bool {
        true
    }
}

/// One change at a time, and a rough node enters sliding.
pub struct SlidingLeast;

impl Method for SlidingLeast {
    fn entry(&self) -> Entry {
        Entry::Sliding
    }

    fn is_single(&self, _stalled: bool) -> bool {
        true
    }
}
