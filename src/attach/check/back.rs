//! Whether states that a solver keeps are the same when it comes back to them.

use super::report::{Outcome, fails, good, not_offered};
use super::steps::otherwise;
use super::trial::{Trial, at, is_last};
use serde_json::Value;
use stickslip_core::model::Mode;
use stickslip_debugger::recorded::fault::Fault;
use stickslip_exchange::attach::message::{Ended, Restore, State};

/// Iterations that are looked at after each state.
const AFTER: usize = 2;
const MEND: &str = "a token keeps all that the next iterations depend on: displacements, forces, modes, what is forced and held, parameters, counters, multipliers, anchors";

/// All states are kept as far as that is offered; each is gone back to, the last first, and from the start again.
pub fn restore(mut trial: Trial, states: &[State]) -> Result<Outcome, Fault> {
    let offered = trial.hello.abilities.restore;
    if offered == Restore::None {
        let took = format!(
            "going back starts it anew ({:.0} ms), and does everything again",
            super::millis(trial.began)
        );
        return Ok(not_offered(took));
    }
    let mut kept: Vec<(usize, Value)> = Vec::new();
    for place in 0..states.len() {
        let begins = place == 0 || matches!(states[place - 1].ended, Ended::Increment);
        if offered == Restore::Any || begins {
            match trial.save()? {
                Ok(token) => kept.push((place, token)),
                Err(reason) => {
                    let found = format!("save after iteration {place} is refused: {reason}");
                    return Ok(fails(
                        found,
                        "what hello offers is kept: \"any\" state, or the start and every one after which an \"increment\" has ended",
                    ));
                }
            }
        }
        if trial.is_late() || trial.step()?.is_none() {
            break;
        }
    }
    let ways = kept.iter().rev().chain(kept.first());
    for (place, token) in ways.clone() {
        if let Some((found, mend)) = comes_back(&mut trial, *place, token, states)? {
            return Ok(fails(found, mend));
        }
        if trial.is_late() {
            break;
        }
    }
    if let Some((place, token)) = kept.first()
        && trial.hello.abilities.force
        && let Some(found) = forgets(&mut trial, *place, token, states)?
    {
        return Ok(fails(found, MEND));
    }
    let (count, s) = (kept.len(), if kept.len() == 1 { "" } else { "s" });
    Ok(good(format!(
        "{count} state{s} gone back to, and what follows is the same to the last bit"
    )))
}

/// What is not the same after a state was gone back to, and how to mend it.
fn comes_back(
    trial: &mut Trial,
    place: usize,
    token: &Value,
    states: &[State],
) -> Result<Option<(String, &'static str)>, Fault> {
    if let Err(reason) = trial.restore(token)? {
        let found = format!("the token given after iteration {place} is refused: {reason}");
        return Ok(Some((
            found,
            "a token that was given is good until the solver ends",
        )));
    }
    for (then, number) in states.iter().zip(1..).skip(place).take(AFTER) {
        let now = trial.step()?;
        if now.as_ref() == Some(then) {
            continue;
        }
        let how = match now {
            None => "it is refused".to_owned(),
            Some(now) => {
                otherwise(then, &now).unwrap_or_else(|| "the numbers have other bits".into())
            }
        };
        let found = format!(
            "gone back to the state after iteration {place}, iteration {number} is another: {how}"
        );
        return Ok(Some((found, MEND)));
    }
    Ok(None)
}

/// Whether what was forced after a state was kept is still forced when it is gone back to.
fn forgets(
    trial: &mut Trial,
    place: usize,
    token: &Value,
    states: &[State],
) -> Result<Option<String>, Fault> {
    let Some(then) = states.get(place) else {
        return Ok(None);
    };
    for contact in trial.some_contacts(3) {
        let Some(own) = at(then, &contact).map(|found| found.mode) else {
            continue;
        };
        let other = if own == Mode::Free {
            Mode::Fixed
        } else {
            Mode::Free
        };
        if trial.restore(token)?.is_err() || trial.force(&contact, other, true)?.is_err() {
            continue;
        }
        let failed = trial.step()?.is_none_or(|state| is_last(&state));
        if trial.restore(token)?.is_err() {
            return Ok(Some(
                "after a forced iteration its tokens are refused".into(),
            ));
        }
        if trial.step()?.as_ref() != Some(then) {
            let failed = if failed { ", which failed" } else { "" };
            return Ok(Some(format!(
                "after an iteration that was forced{failed}, it does not come back to what it was before"
            )));
        }
    }
    Ok(None)
}
