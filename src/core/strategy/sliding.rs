//! Table 2, but a rough node that touches enters sliding, against its travel.
//!
//! Table 2 lets it stick first. Where the friction bound is soon exceeded, sticking and sliding then take turns; a node
//! that slides from the start has the direction of its travel and settles.

use crate::contact::table2::Entry;
use crate::interface::method::Method;

/// A rough node enters sliding.
pub struct Sliding;

impl Method for Sliding {
    fn entry(&self) -> Entry {
        Entry::Sliding
    }
}
