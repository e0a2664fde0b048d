//! One change at a time: of all nodes that would change, only the first does, and the others wait (Bland's least index).
//!
//! Nodes that answer to each other's changes cannot push each other to and fro any more. It costs as many minor
//! iterations as there are changes.

use crate::contact::table2::Entry;
use crate::interface::method::Method;

/// Table 2, one change at a time.
pub struct Least;

impl Method for Least {
    fn is_single(&self, _stalled: bool) -> bool {
        true
    }
}

/// The same, and a rough node enters sliding.
pub struct SlidingLeast;

impl Method for SlidingLeast {
    fn entry(&self) -> Entry {
        Entry::Sliding
    }

    fn is_single(&self, _stalled: bool) -> bool {
        true
    }
}
