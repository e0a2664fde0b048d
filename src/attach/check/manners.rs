//! Checks invalid requests, interrupts, and the end of the solver.

use super::super::link::name;
use super::report::{Outcome, fails, good, not_offered};
use super::trial::{Trial, millis};
use std::time::{Duration, Instant};
use stickslip_core::Mode;
use stickslip_debugger::Fault;
use stickslip_exchange::attach::message::{Id, State};
use stickslip_exchange::attach::{Answer, Request};

/// Time to end; unloading large libraries on a busy machine takes seconds.
const PATIENCE: Duration = Duration::from_secs(10);

/// Checks that an interrupt, before or during a step, has no separate answer.
pub fn interrupt(mut trial: Trial, _: &[State]) -> Result<Outcome, Fault> {
    if !trial.hello.abilities.interrupt {
        return Ok(not_offered(
            "the first Ctrl-C waits for the current iteration; the second sends a signal",
        ));
    }
    trial.link.interrupt();
    trial.step()?;
    trial.interrupted_step()?;
    Ok(match trial.step()? {
        Some(_) => good("before and during a step; both that step and the next are answered"),
        None => fails(
            "the step after an interrupt was refused",
            "an interrupt may only end the current request, if there is one",
        ),
    })
}

/// Checks that requests for unknown things are refused without side effects.
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
            let found = format!("{} was not refused", name(&request));
            return Ok(fails(
                found,
                "refuse requests for what does not exist or is not offered",
            ));
        }
    }
    Ok(match (trial.step()?.as_ref(), states.first()) {
        (Some(now), Some(then)) if now == then => {
            good("invalid requests are refused without side effects")
        }
        _ => fails(
            "refused requests change the first iteration",
            "a refused request must not change anything",
        ),
    })
}

/// Checks that the solver ends on `bye`.
pub fn bye(mut trial: Trial, _: &[State]) -> Result<Outcome, Fault> {
    let began = Instant::now();
    Ok(if trial.link.leave(true, PATIENCE) {
        good(format!("ends within {:.0} ms", millis(began.elapsed())))
    } else {
        fails("does not end", "end on bye")
    })
}

/// Checks that the solver ends when the debugger is gone.
pub fn end_of_input(mut trial: Trial, _: &[State]) -> Result<Outcome, Fault> {
    Ok(if trial.link.leave(false, PATIENCE) {
        good("ends when its standard input is closed")
    } else {
        fails(
            "does not end when its standard input is closed",
            "treat an empty read as the end of the input, and leave the loop",
        )
    })
}
