//! Verdicts on runs: the classes of convergence maps.

use super::reason::Reason;
use serde::{Deserialize, Serialize};
use std::fmt;
use stickslip_core::{Failure, NotFound};

/// Verdict on a run. Displays show its letter first and its colour second.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum RunVerdict {
    /// The run finished, and no check found its end wrong.
    Right,
    /// The run finished in a wrong state: it violates Coulomb's law, or is on another branch than the
    /// reference.
    Wrong,
    /// The iterations cycle.
    Cycle {
        /// Period of the cycle.
        period: u32,
        /// Whether the major iterations cycle, not the minor ones.
        majors: bool,
    },
    /// The run diverged.
    Diverged,
    /// Reported unsolvable: all assignments were tried, or Lemke's pivoting ended on a ray.
    NoAnswer,
    /// The run failed in another way.
    Failed(Reason),
}

use RunVerdict::*;

impl RunVerdict {
    /// The verdict on a failure.
    pub fn from_failure(failure: &Failure) -> RunVerdict {
        match failure {
            Failure::Cycle(cycle) => Cycle {
                period: cycle.period,
                majors: false,
            },
            Failure::MajorCycle(round) => Cycle {
                period: round.period,
                majors: true,
            },
            Failure::Diverged { .. } => Diverged,
            // An incomplete search without a result proves nothing about the problem.
            Failure::NoAnswer { .. } | Failure::NotFound(NotFound::Ray) => NoAnswer,
            other => Failed(Reason::from(other)),
        }
    }

    /// Letter, glyph and word.
    fn names(self) -> (char, char, &'static str) {
        match self {
            Right => ('C', '✓', "converged"),
            Wrong => ('W', '≠', "wrong"),
            Cycle { .. } => ('O', '↺', "cycle"),
            Diverged => ('D', '↗', "diverged"),
            NoAnswer => ('N', '∅', "no-answer"),
            Failed(_) => ('F', '✗', "failed"),
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

    /// The word in tables, without spaces.
    pub fn word(self) -> &'static str {
        self.names().2
    }

    /// What the word leaves out: the period of a cycle, the reason of a failure; otherwise empty.
    pub fn detail(self) -> String {
        match self {
            Cycle { period, .. } => period.to_string(),
            Failed(reason) => reason.to_string(),
            _ => String::new(),
        }
    }
}

impl fmt::Display for RunVerdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Cycle { period, majors } => {
                let of = if *majors { "majors" } else { "minors" };
                write!(f, "{period}-cycle of {of}")
            }
            Failed(reason) => write!(f, "{reason}"),
            other => f.write_str(other.word()),
        }
    }
}
