//! Why an increment failed, in a word.

use serde::{Deserialize, Serialize};
use std::fmt;
use stickslip_core::Failure;

stickslip_core::words! {
    /// Why an increment failed, in a word.
    #[derive(Hash, Serialize, Deserialize)]
    pub enum Reason, word {
        /// The minor iterations cycle.
        MinorCycle "minor-cycle",
        /// The minor iterations reached their limit.
        MinorLimit "minor-limit",
        /// The major iterations reached their limit.
        MajorLimit "major-limit",
        /// The major iterations cycle.
        MajorCycle "major-cycle",
        /// The system of equations is singular.
        Singular "singular",
        /// The residual or the displacements diverged.
        Diverged "diverged",
        /// A slave node is held where it penetrates.
        OverConstrained "jammed",
        /// The judge refused the state.
        Refused "refused",
        /// All assignments were tried; none is consistent.
        NoAnswer "no-answer",
        /// The search found no consistent state, but could not try all assignments.
        NotFound "not-found",
        /// Round-off leaves no accuracy.
        RoundOff "round-off",
        /// A damped motion did not settle.
        #[serde(rename = "Restless")]
        NoRest "restless",
        /// The increment jumped to a state far from the predicted one.
        Jump "jump",
        /// The path control turned back, or its measure did not change.
        OffPath "off-path",
        /// An element of a solid is inverted.
        Inverted "inverted",
    }
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
            Reason::RoundOff => 'a',
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
