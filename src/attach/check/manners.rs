//! Requests that are wrong, that come in between, and the last one.

use super::super::link::name;
use super::report::{Outcome, fails, good, not_offered};
use super::trial::{Trial, millis};
use std::time::Instant;
use stickslip_core::model::Mode;
use stickslip_debugger::recorded::fault::Fault;
use stickslip_exchange::attach::message::{Id, State};
use stickslip_exchange::attach::{Answer, Request};

/// An interrupt is no request: it has no answer of its own, before a step and during one.
pub fn interrupt(mut trial: Trial, _: &[State]) -> Result<Outcome, Fault> {
    if !trial.hello.abilities.interrupt {
        return Ok(not_offered(
            "the first Ctrl-C waits for the current iteration; the second is a signal",
        ));
    }
    trial.link.interrupt();
    trial.step()?;
    trial.interrupted_step()?;
    Ok(match trial.step()? {
        Some(_) => good("before a step and during one; the step is answered, and the next too"),
        None => fails(
            "after an interrupt the next step is refused",
            "an interrupt ends the request at hand soon, if there is one, and nothing else",
        ),
    })
}

/// What does not exist is refused, and ends nothing.
pub fn wrong_requests(mut trial: Trial, states: &[State]) -> Result<Outcome, Fault> {
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
            return Ok(fails(
                found,
                "what does not exist, or is not offered, is answered by refused",
            ));
        }
    }
    Ok(match (trial.step()?.as_ref(), states.first()) {
        (Some(now), Some(then)) if now == then => good("they are refused, and change nothing"),
        _ => fails(
            "after requests that were refused the first iteration is another",
            "what is refused changes nothing",
        ),
    })
}

/// It ends when it is told to.
pub fn bye(mut trial: Trial, _: &[State]) -> Result<Outcome, Fault> {
    let began = Instant::now();
    Ok(match trial.link.leave(true) {
        true => good(format!("it ends within {:.0} ms", millis(began.elapsed()))),
        false => fails("it does not end", "end on bye"),
    })
}

/// It ends when the debugger is gone.
pub fn end_of_input(mut trial: Trial, _: &[State]) -> Result<Outcome, Fault> {
    Ok(match trial.link.leave(false) {
        true => good("it ends, so that none is left when a debugger dies"),
        false => fails(
            "it does not end when its standard input is closed",
            "a read that gives nothing is the end: leave the loop",
        ),
    })
}
