//! `stickslip attach --check`: tests each ability that a solver offers, and reports how to fix what fails.
//!
//! - [`report`]: the results; `trial`: a solver under test.
//! - `steps`: states and determinism; `back`: saved states.
//! - `changes`: forced modes, holds and parameters; `problem`: the frozen interface problem.
//! - `manners`: invalid requests, interrupts, the end.

mod back;
mod changes;
mod manners;
mod problem;
pub mod report;
mod steps;
mod trial;

use super::link::Start;
pub use report::{CheckResult, Outcome, Report, Verdict};
use stickslip_core::counted;
use stickslip_debugger::{Fault, Log};
use stickslip_exchange::attach::message::State;
use trial::{Trial, millis};

/// Checks a solver. The log records the messages of all starts.
pub fn check(start: &Start, log: &Log) -> Report {
    let mut report = Report {
        name: start.typed(),
        checks: Vec::new(),
    };
    let first = match Trial::begin(start, log) {
        Ok(trial) => trial,
        Err(fault) => {
            report.add("start", Err(fault));
            return report;
        }
    };
    report.name = format!("{} {}", first.hello.name, first.hello.version);
    let count = first.scene.contacts.len();
    let took = millis(first.began);
    let found = format!("{}, {took:.0} ms", counted(count, "contact"));
    report.add("start", Ok(report::good(found)));
    let states = steps::stepping(&mut report, first);
    if states.is_empty() {
        return report;
    }
    type Check = fn(Trial, &[State]) -> Result<Outcome, Fault>;
    let checks: [(&'static str, Check); 12] = [
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
        ("bye", manners::bye),
        ("end of input", manners::end_of_input),
    ];
    for (what, check) in checks {
        let trial = Trial::begin(start, log);
        report.add(what, trial.and_then(|trial| check(trial, &states)));
    }
    report
}
