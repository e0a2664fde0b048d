//! Verdicts on runs: the classes of convergence maps.

use super::reason::Reason;
use serde::{Deserialize, Serialize};
use std::fmt;
use stickslip_core::interface::method::NotFound;
use stickslip_core::step::event::Failure;

/// What a run came to. Its letter comes first wherever it is shown, its colour second.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum RunVerdict {
    /// It went to the end, and its end is right as far as can be told.
    Right,
    /// It went to the end, and to a wrong one: no state that Coulomb's law allows, or another branch than the reference.
    Wrong,
    /// Its iterations go round for ever; minor iterations, or major ones.
    Cycle {
        /// Iterations of one period.
        period: u32,
        /// Whether the major iterations go round, and not the minor ones.
        majors: bool,
    },
    /// It grew out of all bounds.
    Diverged,
    /// It said that there is no answer: all assumptions were tried, or Lemke's pivoting ended on a ray.
    NoAnswer,
    /// It failed in another way.
    Failed(Reason),
}

impl RunVerdict {
    /// What a failure is worth.
    pub fn of(failure: &Failure) -> RunVerdict {
        match failure {
            Failure::Cycle(cycle) => RunVerdict::Cycle {
                period: cycle.period,
                majors: false,
            },
            Failure::MajorCycle(round) => RunVerdict::Cycle {
                period: round.period,
                majors: true,
            },
            Failure::Diverged { .. } => RunVerdict::Diverged,
            // That nothing was found where not all could be tried says nothing about the problem.
            Failure::NoAnswer { .. } | Failure::NotFound(NotFound::Ray) => RunVerdict::NoAnswer,
            other => RunVerdict::Failed(Reason::from(other)),
        }
    }

    /// Letter, glyph and word.
    fn names(self) -> (char, char, &'static str) {
        match self {
            RunVerdict::Right => ('C', '✓', "converged"),
            RunVerdict::Wrong => ('W', '≠', "wrong"),
            RunVerdict::Cycle { .. } => ('O', '↺', "cycle"),
            RunVerdict::Diverged => ('D', '↗', "diverged"),
            RunVerdict::NoAnswer => ('N', '∅', "no-answer"),
            RunVerdict::Failed(_) => ('F', '✗', "failed"),
        }
    }

    /// Its letter.
    pub fn letter(self) -> char {
        self.names().0
    }

    /// Its glyph.
    pub fn glyph(self) -> char {
        self.names().1
    }

    /// What it is called in tables: a word without blanks.
    pub fn word(self) -> &'static str {
        self.names().2
    }

    /// What the word leaves out: a cycle's period, the reason of a failure; else empty.
    pub fn detail(self) -> String {
        match self {
            RunVerdict::Cycle { period, .. } => period.to_string(),
            RunVerdict::Failed(reason) => reason.to_string(),
            _ => String::new(),
        }
    }
}

impl fmt::Display for RunVerdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RunVerdict::Cycle { period, majors } => {
                let of = if *majors { "majors" } else { "minors" };
                write!(f, "{period}-cycle of {of}")
            }
            RunVerdict::Failed(reason) => write!(f, "{reason}"),
            other => f.write_str(other.word()),
        }
    }
}
