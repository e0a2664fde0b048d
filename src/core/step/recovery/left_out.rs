//! Runs without one recovery or strategy, to find out whether a scene needs it.

use crate::Strategy;

/// The recovery or strategy that a stepper does not use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OmittedStep {
    /// A recovery, by name ([`super::names`]).
    Recovery(&'static str),
    /// A strategy of the ladder after its first.
    Strategy(Strategy),
}
