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

use Reason::*;

impl Reason {
    /// One letter for the reason, for small spaces.
    pub fn letter(self) -> char {
        match self {
            MinorCycle | MajorCycle => 'o',
            MinorLimit => 'm',
            MajorLimit => 'M',
            Singular => 's',
            Diverged => 'd',
            OverConstrained => 'j',
            Refused => 'r',
            NoAnswer | NotFound => 'n',
            RoundOff => 'a',
            NoRest => 'w',
            Jump => 'b',
            OffPath => 'p',
            Inverted => 'i',
        }
    }
}

impl From<&Failure> for Reason {
    fn from(failure: &Failure) -> Reason {
        match failure {
            Failure::Cycle(_) => MinorCycle,
            Failure::MinorLimit { .. } => MinorLimit,
            Failure::MajorLimit { .. } => MajorLimit,
            Failure::MajorCycle(_) => MajorCycle,
            Failure::Singular(_) => Singular,
            Failure::Diverged { .. } => Diverged,
            Failure::OverConstrained { .. } => OverConstrained,
            Failure::Refused(_) => Refused,
            Failure::CutTooOften { last, .. } => Reason::from(last.as_ref()),
            Failure::NoAnswer { .. } => NoAnswer,
            Failure::NoRest { .. } => NoRest,
            Failure::BranchJump { .. } => Jump,
            Failure::PathReversal | Failure::ZeroMeasure => OffPath,
            Failure::RoundOff { .. } => RoundOff,
            Failure::Inverted(_) => Inverted,
            Failure::LadderEnded { .. } | Failure::NotFound(_) | Failure::Reported { .. } => {
                NotFound
            }
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}
