//! A recovery or a strategy that a stepper does without, to find out whether a scene needs it.

use crate::model::Strategy;

/// What a stepper must do without.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LeftOut {
    /// A recovery, by name ([`super::names`]).
    Recovery(&'static str),
    /// A strategy of the ladder after its first.
    Strategy(Strategy),
}
