//! One change at a time: only the first of all nodes that would change does, and the others wait (Bland's least index rule).
//!
//! Nodes that react to each other's changes then no longer cycle together. The cost is one minor iteration per change.

use crate::Method;
use crate::contact::table2::Entry;

/// Table 2, one change at a time.
pub struct Least;

impl Method for Least {
    fn is_single(&self, _stalled: bool) -> bool {
        true
    }
}

/// One change at a time, and a node with friction that touches starts to slide.
pub struct SlidingLeast;

impl Method for SlidingLeast {
    fn entry(&self) -> Entry {
        Entry::Sliding
    }

    fn is_single(&self, _stalled: bool) -> bool {
        true
    }
}
