//! Table 2, but a rough node that touches enters sliding, against its travel.
//!
//! In Table 2 it sticks first. If the friction bound is soon exceeded, sticking and sliding may then alternate for ever. A
//! node that slides from the start takes the direction of its travel, and settles.

use crate::contact::table2::Entry;
use crate::interface::method::Method;

/// A rough node enters sliding.
pub struct Sliding;

impl Method for Sliding {
    fn entry(&self) -> Entry {
        Entry::Sliding
    }
}
