//! Table 2, except that a node with friction that touches starts to slide, with friction opposing its motion.
//!
//! In Table 2 it sticks first. If the friction bound is soon exceeded, sticking and sliding may then alternate forever. A node
//! that slides from the start gets the direction of its motion and converges.

use crate::Method;
use crate::contact::table2::Entry;

/// A node with friction starts to slide when it touches.
pub struct Sliding;

impl Method for Sliding {
    fn entry(&self) -> Entry {
        Entry::Sliding
    }
}
