//! The interface between a slave node and its master surface.

pub mod decision;
