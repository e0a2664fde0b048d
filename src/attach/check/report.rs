//! The results of a check.

use std::fmt::Write;
use stickslip_debugger::Fault;

/// The verdict of a check.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Verdict {
    /// Passed.
    Good,
    /// Failed, with how to fix it.
    Fails(String),
    /// The solver does not offer it.
    NotOffered,
    /// Could not be tested, with the reason.
    NotTried(String),
}

/// A check.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CheckResult {
    /// The ability that was tested.
    pub what: &'static str,
    /// The finding.
    pub found: String,
    /// The verdict.
    pub verdict: Verdict,
}

/// The results for one solver.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// Name and version of the solver.
    pub name: String,
    /// The checks, in order.
    pub checks: Vec<CheckResult>,
}

impl Report {
    /// Number of failed checks.
    pub fn failed(&self) -> usize {
        self.checks
            .iter()
            .filter(|check| matches!(check.verdict, Verdict::Fails(_)))
            .count()
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

    /// Adds a check, or the fault that ended it.
    pub fn add(&mut self, what: &'static str, outcome: Result<Outcome, Fault>) {
        let (found, verdict) =
            outcome.unwrap_or_else(|fault| fails(fault.to_string(), mend(&fault)));
        self.checks.push(CheckResult {
            what,
            found,
            verdict,
        });
    }
}

/// Finding and verdict of a check.
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

/// How to fix a fault.
pub(super) fn mend(fault: &Fault) -> &'static str {
    match fault {
        Fault::NotStarted { .. } => {
            "give a program that can be started, with its arguments, after --"
        }
        Fault::Silent { .. } => {
            "answer every request with one line, and flush it at once (in Python: print(line, flush=True))"
        }
        Fault::Junk { .. } => {
            "reserve standard output for the protocol: at the start, before any library prints, duplicate it and redirect it to standard error (in Python: os.dup2(2, 1))"
        }
        Fault::Misformed { .. } => {
            "`stickslip help protocol` describes every message; missing and infinite numbers are null"
        }
        Fault::Torn(_) => "end every message with a line feed, and flush before exiting",
        Fault::TooLong { .. } => {
            "send sparse matrices as triplets, and leave displacements out of the states"
        }
        Fault::OtherAnswer { .. } | Fault::Unasked { .. } => {
            "give each request exactly one answer, of the type that `stickslip help protocol` names; send everything else as a message"
        }
        Fault::Version(_) => "set protocol 1 in hello",
        Fault::Refused { .. } => {
            "do what hello offers, or refuse it for a reason specific to the request"
        }
        Fault::Unfit { .. } => "make all later messages consistent with the scene",
        Fault::OtherScene { .. } | Fault::Changed { .. } => {
            "with the same arguments, solve the same problem at every start"
        }
        Fault::Died { .. } | Fault::Bye { .. } => {
            "end the solver only on bye: refuse what cannot be done, and report what cannot be solved as a state that ended with failure"
        }
        Fault::Stopped { .. } | Fault::Unknown | Fault::NoScene | Fault::Past => "",
    }
}
