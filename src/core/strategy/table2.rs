//! Table 2 as printed: every node's next mode follows from its own numbers, and all nodes change at the same time.

use crate::Method;

/// Table 2, and nothing else.
pub struct Table2;

impl Method for Table2 {}
