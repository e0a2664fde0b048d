//! The list Try of the diagnosis page: what can be done, with the outcome of each trial.

use super::remedies::{self, BUDGET, RemedyTrial, TrialEnd, compare};
use super::remedy::{Remedy, RemedyInput};
use stickslip_core::{RunFinding, counted};

/// Outcome of a line of the list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum TryOutcome {
    /// A trial reached the load.
    Works,
    /// Not tried, or not yet.
    Untried,
    /// A trial did not reach the load.
    Fails,
}

/// A line of the list.
#[derive(Debug, Clone, PartialEq)]
pub struct TryLine {
    /// What to do.
    pub label: String,
    /// What to type for it; empty if it has no command.
    pub typed: String,
    /// Its outcome.
    pub outcome: TryOutcome,
    /// The outcome in words.
    pub end: String,
    /// Its trial, which can be repeated in a branch.
    pub trial: Option<RemedyTrial>,
}

impl TryLine {
    /// The line of a tried remedy.
    pub fn tried(trial: &RemedyTrial) -> TryLine {
        let works = helps(trial);
        let minors = counted(trial.minors, "minor");
        let end = match (works, &trial.how) {
            (true, RemedyInput::Restart(_)) => format!("tried from the start: passes, {minors}"),
            (true, _) => format!("tried: converges, {minors}"),
            (false, _) if trial.end == TrialEnd::Converged => {
                "tried: held nodes violate a law".to_owned()
            }
            (false, _) if trial.end == TrialEnd::Budget => {
                format!("tried: no convergence within {BUDGET} minors")
            }
            (false, _) => format!("tried: {}", remedies::end_words(&trial.end)),
        };
        TryLine {
            label: trial.label.clone(),
            typed: typed(&trial.how),
            outcome: if works {
                TryOutcome::Works
            } else {
                TryOutcome::Fails
            },
            end,
            trial: Some(trial.clone()),
        }
    }

    /// The line of a remedy that is still to be tried; `seconds` is the time of an earlier trial.
    pub fn untried(remedy: &Remedy, seconds: Option<f64>) -> TryLine {
        let about = seconds.filter(|seconds| *seconds >= 1.0);
        let about = about
            .map(|seconds| format!(", about {seconds:.0} s"))
            .unwrap_or_default();
        TryLine {
            typed: typed(&remedy.how),
            end: format!("not tried yet{about}"),
            ..TryLine::by_hand(&remedy.label)
        }
    }

    /// Something that only the user can do.
    pub fn by_hand(text: &str) -> TryLine {
        TryLine {
            label: text.to_owned(),
            typed: String::new(),
            outcome: TryOutcome::Untried,
            end: "not tried".to_owned(),
            trial: None,
        }
    }

    /// The cure of a finding, as lines of the input.
    pub fn from_finding(found: &RunFinding) -> TryLine {
        TryLine {
            typed: found.shown_lines(),
            ..TryLine::by_hand(&found.cure)
        }
    }

    /// Mark of the outcome.
    pub fn mark(&self) -> &'static str {
        match self.outcome {
            TryOutcome::Works => "✓",
            TryOutcome::Untried => "?",
            TryOutcome::Fails => "✗",
        }
    }

    /// What to type, or the label of what has no command.
    pub fn command(&self) -> &str {
        match self.typed.as_str() {
            "" => &self.label,
            typed => typed,
        }
    }

    /// The line with options for the command line instead of a command of the debugger.
    pub fn option(&self) -> String {
        match self.trial.as_ref().map(|trial| &trial.how) {
            Some(RemedyInput::Set(path, value)) => format!("--set {path}={value} ({})", self.end),
            _ => format!("{} ({})", self.command(), self.end),
        }
    }

    /// The line, without its mark.
    pub fn words(&self) -> String {
        match self.typed.as_str() {
            "" => format!("{} ({})", self.label, self.end),
            typed => format!("{}: {typed} ({})", self.label, self.end),
        }
    }
}

/// What to type; empty if only Enter on the line does it.
fn typed(how: &RemedyInput) -> String {
    match how {
        RemedyInput::Listed => String::new(),
        _ => how.typed(),
    }
}

/// Whether a trial reached the load without violations.
pub fn helps(trial: &RemedyTrial) -> bool {
    trial.end == TrialEnd::Converged && trial.left.is_none_or(|left| left.held == 0)
}

/// Best first: what works, in the order of the remedies; then what is untried; then what did not help.
pub fn sort(lines: &mut [TryLine]) {
    lines.sort_by(|a, b| {
        let by_trial = match (&a.trial, &b.trial) {
            (Some(a), Some(b)) => compare(a, b),
            _ => std::cmp::Ordering::Equal,
        };
        a.outcome.cmp(&b.outcome).then(by_trial)
    });
}
