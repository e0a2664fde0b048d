//! Why an increment failed, in a word.

use serde::{Deserialize, Serialize};
use std::fmt;
use stickslip_core::step::event::Failure;

/// Why an increment failed, in a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Reason {
    /// The minor iterations cycle.
    MinorCycle,
    /// The minor iterations reached their limit.
    MinorLimit,
    /// The major iterations reached their limit.
    MajorLimit,
    /// The major iterations cycle.
    MajorCycle,
    /// The system of equations is singular.
    Singular,
    /// The residual or the displacements diverged.
    Diverged,
    /// A slave node is held where it penetrates.
    OverConstrained,
    /// The judge refused the state.
    Refused,
    /// All assignments were tried; none is consistent.
    NoAnswer,
    /// The search found no consistent state, but could not try all assignments.
    NotFound,
    /// Round-off leaves no accuracy.
    RoundOff,
    /// A damped motion did not settle.
    #[serde(rename = "Restless")]
    NoRest,
    /// The increment jumped to a state far from the predicted one.
    Jump,
    /// The path control turned back, or its measure did not change.
    OffPath,
    /// An element of a solid is inverted.
    Inverted,
}

stickslip_core::words! {
    Reason, word:
    MinorCycle "minor-cycle",
    MinorLimit "minor-limit",
    MajorLimit "major-limit",
    MajorCycle "major-cycle",
    Singular "singular",
    Diverged "diverged",
    OverConstrained "jammed",
    Refused "refused",
    NoAnswer "no-answer",
    NotFound "not-found",
    RoundOff "round-off",
    NoRest "restless",
    Jump "jump",
    OffPath "off-path",
    Inverted "inverted",
}

impl Reason {
    /// One letter for the reason, for small spaces.
    pub fn letter(self) -> char {
        match self {
            Reason::MinorCycle | Reason::MajorCycle => 'o',
            Reason::MinorLimit => 'm',
            Reason::MajorLimit => 'M',
            Reason::Singular => 's',
            Reason::Diverged => 'd',
            Reason::OverConstrained => 'j',
            Reason::Refused => 'r',
            Reason::NoAnswer | Reason::NotFound => 'n',
            Reason::RoundOff => 'r',
            Reason::NoRest => 'w',
            Reason::Jump => 'b',
            Reason::OffPath => 'p',
            Reason::Inverted => 'i',
        }
    }
}

impl From<&Failure> for Reason {
    fn from(failure: &Failure) -> Reason {
        match failure {
            Failure::Cycle(_) => Reason::MinorCycle,
            Failure::MinorLimit { .. } => Reason::MinorLimit,
            Failure::MajorLimit { .. } => Reason::MajorLimit,
            Failure::MajorCycle(_) => Reason::MajorCycle,
            Failure::Singular(_) => Reason::Singular,
            Failure::Diverged { .. } => Reason::Diverged,
            Failure::OverConstrained { .. } => Reason::OverConstrained,
            Failure::Refused(_) => Reason::Refused,
            Failure::CutTooOften { last, .. } => Reason::from(last.as_ref()),
            Failure::NoAnswer { .. } => Reason::NoAnswer,
            Failure::NoRest { .. } => Reason::NoRest,
            Failure::BranchJump { .. } => Reason::Jump,
            Failure::PathReversal | Failure::ZeroMeasure => Reason::OffPath,
            Failure::RoundOff { .. } => Reason::RoundOff,
            Failure::Inverted(_) => Reason::Inverted,
            Failure::LadderEnded { .. } | Failure::NotFound(_) | Failure::Reported { .. } => {
                Reason::NotFound
            }
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}
