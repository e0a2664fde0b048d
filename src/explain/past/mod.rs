//! A CalculiX run that is over: what its files tell of its contact iterations.
//!
//! - [`round`]: cycles of iterations; [`chatter`]: who closes and opens again.
//! - [`run`]: the run with both, and who is in contact where.
//! - [`words`]: sentences about it; [`summary`]: all of it as text.

pub mod chatter;
pub mod round;
pub mod run;
pub mod summary;
pub mod words;
