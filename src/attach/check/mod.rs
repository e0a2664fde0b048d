//! Whether a solver does what it says it does: each ability is exercised, and what fails is told with how to mend it.
//!
//! - [`report`]: what was found; `trial`: a solver that is tried.
//! - `steps`: what it tells as it steps, and whether it tells that twice; `back`: how it goes back.
//! - `changes`: forced modes, holds and parameters; `problem`: the frozen interface problem.
//! - `manners`: requests that are wrong, that come in between, and the last.

mod back;
mod changes;
mod manners;
mod problem;
pub mod report;
mod steps;
mod trial;

use super::fault::Fault;
use super::link::Start;
use super::log::Log;
pub use report::{Checked, Report, Verdict};
use stickslip_exchange::attach::message::State;
use trial::{Trial, millis};

/// Tries a solver. The log records all messages, one start after the other.
pub fn check(start: &Start, log: &Log) -> Report {
    let mut report = Report {
        name: start.typed(),
        checks: Vec::new(),
    };
    let first = match Trial::begin(start, log) {
        Ok(trial) => trial,
        Err(fault) => {
            report.ends("start", &fault);
            return report;
        }
    };
    report.name = format!("{} {}", first.hello.name, first.hello.version);
    let count = first.scene.contacts.len();
    let s = if count == 1 { "" } else { "s" };
    let took = millis(first.began);
    report.good("start", format!("{count} contact{s}, {took:.0} ms"));
    let states = steps::stepping(&mut report, first);
    if states.is_empty() {
        return report;
    }
    type Of = fn(&mut Report, Trial, &[State]) -> Result<(), Fault>;
    let checks: [(&'static str, Of); 10] = [
        ("determinism", steps::determinism),
        ("restore", back::restore),
        ("force", changes::force),
        ("hold", changes::hold),
        ("parameters", changes::parameters),
        ("increment", changes::increment),
        ("friction", changes::friction),
        ("problem", problem::problem),
        ("interrupt", manners::interrupt),
        ("wrong requests", manners::wrong_requests),
    ];
    for (what, of) in checks {
        if let Err(fault) =
            Trial::begin(start, log).and_then(|trial| of(&mut report, trial, &states))
        {
            report.ends(what, &fault);
        }
    }
    for (what, of) in [
        ("bye", manners::bye as Of),
        ("end of input", manners::end_of_input),
    ] {
        if let Err(fault) =
            Trial::begin(start, log).and_then(|trial| of(&mut report, trial, &states))
        {
            report.ends(what, &fault);
        }
    }
    report
}
