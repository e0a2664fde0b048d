//! What was tried of a solver, and what was found.

use std::fmt::Write;
use stickslip_debugger::recorded::fault::Fault;

/// How a check ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Verdict {
    /// It does.
    Good,
    /// It does not; how to mend it.
    Fails(String),
    /// The solver does not offer it.
    NotOffered,
    /// It could not be tried; why.
    NotTried(String),
}

/// A check.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Checked {
    /// What was tried.
    pub what: &'static str,
    /// What was found.
    pub found: String,
    /// How it ended.
    pub verdict: Verdict,
}

/// All checks of a solver.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// Who it is.
    pub name: String,
    /// In the order in which they were made.
    pub checks: Vec<Checked>,
}

impl Report {
    /// How many failed.
    pub fn failed(&self) -> usize {
        let fails = |check: &&Checked| matches!(check.verdict, Verdict::Fails(_));
        self.checks.iter().filter(fails).count()
    }

    /// The report as text.
    pub fn text(&self) -> String {
        let mut text = format!("{}\n", self.name);
        for check in &self.checks {
            let (word, mend) = match &check.verdict {
                Verdict::Good => ("ok", ""),
                Verdict::Fails(mend) => ("FAILS", mend.as_str()),
                Verdict::NotOffered => ("not offered", ""),
                Verdict::NotTried(why) => ("not tried", why.as_str()),
            };
            let line = format!("  {word:<12} {:<14} {}", check.what, check.found);
            // Writing to a string does not fail.
            let _ = writeln!(text, "{}", line.trim_end());
            if !mend.is_empty() {
                let _ = writeln!(text, "{:30}{mend}", "");
            }
        }
        text
    }

    /// Adds a check, or the fault of the solver that ended it.
    pub fn add(&mut self, what: &'static str, outcome: Result<Outcome, Fault>) {
        let (found, verdict) =
            outcome.unwrap_or_else(|fault| fails(fault.to_string(), mend(&fault)));
        self.checks.push(Checked {
            what,
            found,
            verdict,
        });
    }
}

/// What a check found, and how it ended.
pub type Outcome = (String, Verdict);

pub(super) fn good(found: impl Into<String>) -> Outcome {
    (found.into(), Verdict::Good)
}

pub(super) fn fails(found: impl Into<String>, mend: &str) -> Outcome {
    (found.into(), Verdict::Fails(mend.into()))
}

pub(super) fn not_offered(found: impl Into<String>) -> Outcome {
    (found.into(), Verdict::NotOffered)
}

pub(super) fn not_tried(found: impl Into<String>, why: String) -> Outcome {
    (found.into(), Verdict::NotTried(why))
}

/// How a fault is mended.
fn mend(fault: &Fault) -> &'static str {
    match fault {
        Fault::NotStarted { .. } => {
            "what stands after -- is a program that can be started, and its arguments"
        }
        Fault::Silent { .. } => {
            "every request is answered by one line, which is flushed at once (in Python: print(line, flush=True))"
        }
        Fault::Junk { .. } => {
            "give standard output to the protocol alone: at the start, before any library prints, keep a copy of it, and put standard error in its place (in Python: os.dup2(2, 1))"
        }
        Fault::Misformed { .. } => {
            "the page `stickslip help attach` has every message; missing and infinite numbers are null"
        }
        Fault::Torn(_) => "end every message with a line feed, and flush before the end",
        Fault::TooLong { .. } => {
            "give a sparse matrix as triplets, and leave displacements out of the states"
        }
        Fault::OtherAnswer { .. } | Fault::Unasked { .. } => {
            "each request gets exactly one answer, of the type that the page `stickslip help attach` names; all else is a message"
        }
        Fault::Version(_) => "hello says protocol 1",
        Fault::Refused { .. } => {
            "what is offered in hello is done, or refused for a reason that holds there only"
        }
        Fault::Unfit { .. } => "what is told later fits the scene that was told first",
        Fault::OtherScene { .. } | Fault::Changed { .. } => {
            "with the same arguments it solves the same, every time that it is started"
        }
        Fault::Died { .. } | Fault::Bye { .. } => {
            "no request ends the solver but bye: what cannot be done is refused, what cannot be solved is a state that ended with failure"
        }
        Fault::Stopped { .. } | Fault::Unknown | Fault::NoScene | Fault::Past => "",
    }
}
