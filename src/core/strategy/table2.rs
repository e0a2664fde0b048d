//! Table 2 as printed: every node's mode from its own numbers, all at once.

use crate::interface::method::Method;

/// Table 2, and nothing else.
pub struct Table2;

impl Method for Table2 {}
