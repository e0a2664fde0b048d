//! What a run is worth: the words that stability maps sort runs by.

use super::reason::Reason;
use crate::interface::method::NotFound;
use crate::step::event::Failure;
use serde::{Deserialize, Serialize};
use std::fmt;

/// What a run came to. Its letter comes first wherever it is shown, its colour second.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Verdict {
    /// It went to the end, and its end is right as far as can be told.
    Right,
    /// It went to the end, and to a wrong one: no state that Coulomb's law allows, or another branch than the reference.
    Wrong,
    /// Its iterations go round for ever; minor iterations, or major ones.
    Cycle { period: u32, majors: bool },
    /// It grew out of all bounds.
    Diverged,
    /// It said that there is no answer: all assumptions were tried, or Lemke's pivoting ended on a ray.
    NoAnswer,
    /// It failed in another way.
    Failed(Reason),
}

impl Verdict {
    /// What a failure is worth.
    pub fn of(failure: &Failure) -> Verdict {
        match failure {
            Failure::Cycle(cycle) => Verdict::Cycle {
                period: cycle.period,
                majors: false,
            },
            Failure::MajorCycle(round) => Verdict::Cycle {
                period: round.period,
                majors: true,
            },
            Failure::Diverged { .. } => Verdict::Diverged,
            // That nothing was found where not all could be tried says nothing about the problem.
            Failure::NoAnswer { .. } | Failure::NotFound(NotFound::Ray) => Verdict::NoAnswer,
            other => Verdict::Failed(Reason::from(other)),
        }
    }

    /// Its letter.
    pub fn letter(self) -> char {
        match self {
            Verdict::Right => 'C',
            Verdict::Wrong => 'W',
            Verdict::Cycle { .. } => 'O',
            Verdict::Diverged => 'D',
            Verdict::NoAnswer => 'N',
            Verdict::Failed(_) => 'F',
        }
    }

    /// Its glyph.
    pub fn glyph(self) -> char {
        match self {
            Verdict::Right => '✓',
            Verdict::Wrong => '≠',
            Verdict::Cycle { .. } => '↺',
            Verdict::Diverged => '↗',
            Verdict::NoAnswer => '∅',
            Verdict::Failed(_) => '✗',
        }
    }

    /// What it is called in tables: a word without blanks.
    pub fn word(self) -> &'static str {
        match self {
            Verdict::Right => "converged",
            Verdict::Wrong => "wrong",
            Verdict::Cycle { .. } => "cycle",
            Verdict::Diverged => "diverged",
            Verdict::NoAnswer => "no-answer",
            Verdict::Failed(_) => "failed",
        }
    }

    /// What the word leaves out: a cycle's period, the reason of a failure; else empty.
    pub fn detail(self) -> String {
        match self {
            Verdict::Cycle { period, .. } => period.to_string(),
            Verdict::Failed(reason) => reason.to_string(),
            _ => String::new(),
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Verdict::Cycle { period, majors } => {
                let of = if *majors { "majors" } else { "minors" };
                write!(f, "{period}-cycle of {of}")
            }
            Verdict::Failed(reason) => write!(f, "{reason}"),
            other => f.write_str(other.word()),
        }
    }
}
