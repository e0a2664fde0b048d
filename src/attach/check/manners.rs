//! Requests that are wrong, that come in between, and the last one.

use super::super::fault::Fault;
use super::super::link::name;
use super::report::{Report, Verdict};
use super::trial::{Trial, millis};
use std::time::Instant;
use stickslip_exchange::attach::message::{Id, Mode, State};
use stickslip_exchange::attach::{Answer, Request};

/// An interrupt is no request: it has no answer of its own, before a step and during one.
pub fn interrupt(report: &mut Report, mut trial: Trial, _: &[State]) -> Result<(), Fault> {
    const WHAT: &str = "interrupt";
    if !trial.hello.abilities.interrupt {
        let found = "Ctrl-C waits for the iteration at hand; the second one is a signal";
        report.add(WHAT, found, Verdict::NotOffered);
        return Ok(());
    }
    trial.link.interrupt();
    trial.step()?;
    trial.interrupted_step()?;
    match trial.step()? {
        Some(_) => report.good(
            WHAT,
            "before a step and during one; the step is answered, and the next too",
        ),
        None => report.fails(
            WHAT,
            "after an interrupt the next step is refused",
            "an interrupt ends the request at hand soon, if there is one, and nothing else",
        ),
    }
    Ok(())
}

/// What does not exist is refused, and ends nothing.
pub fn wrong_requests(
    report: &mut Report,
    mut trial: Trial,
    states: &[State],
) -> Result<(), Fault> {
    const WHAT: &str = "wrong requests";
    let nobody = || Id::Text("no such contact".into());
    let wrong = [
        Request::Set {
            name: "no such parameter".into(),
            value: serde_json::Value::from(1),
        },
        Request::Force {
            contact: nobody(),
            mode: Mode::Free,
            hold: false,
        },
        Request::Release { contact: nobody() },
        Request::Restore {
            token: serde_json::Value::from("no such token"),
        },
    ];
    for request in wrong {
        if !matches!(trial.ask(&request)?, Answer::Refused { .. }) {
            let found = format!("{} is not refused", name(&request));
            report.fails(
                WHAT,
                found,
                "what does not exist, or is not offered, is answered by refused",
            );
            return Ok(());
        }
    }
    match (trial.step()?.as_ref(), states.first()) {
        (Some(now), Some(then)) if now == then => {
            report.good(WHAT, "they are refused, and change nothing")
        }
        _ => report.fails(
            WHAT,
            "after requests that were refused the first iteration is another",
            "what is refused changes nothing",
        ),
    }
    Ok(())
}

/// It ends when it is told to.
pub fn bye(report: &mut Report, mut trial: Trial, _: &[State]) -> Result<(), Fault> {
    let began = Instant::now();
    match trial.link.leave(true) {
        true => report.good(
            "bye",
            format!("it ends within {:.0} ms", millis(began.elapsed())),
        ),
        false => report.fails("bye", "it does not end", "end on bye"),
    }
    Ok(())
}

/// It ends when the debugger is gone.
pub fn end_of_input(report: &mut Report, mut trial: Trial, _: &[State]) -> Result<(), Fault> {
    match trial.link.leave(false) {
        true => report.good(
            "end of input",
            "it ends, so that none is left when a debugger dies",
        ),
        false => report.fails(
            "end of input",
            "it does not end when its standard input is closed",
            "a read that gives nothing is the end: leave the loop",
        ),
    }
    Ok(())
}
