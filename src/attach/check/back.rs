//! Checks that saved states are restored exactly.

use super::report::{Outcome, fails, good, not_offered};
use super::steps::difference;
use super::trial::{Trial, at, is_last};
use serde_json::Value;
use stickslip_core::{Mode, counted};
use stickslip_debugger::Fault;
use stickslip_exchange::attach::message::{EndedLevel, Restore, State};

/// Iterations compared after each restored state.
const AFTER: usize = 2;
const MEND: &str = "save everything that the next iterations depend on: displacements, forces, modes, what is forced and held, parameters, counters, multipliers, anchors";

/// Saves all states that the solver offers to save, then restores each one, from the last to the first, and the first one again.
pub fn restore(mut trial: Trial, states: &[State]) -> Result<Outcome, Fault> {
    let offered = trial.hello.abilities.restore;
    if offered == Restore::None {
        let took = format!(
            "going back restarts the solver ({:.0} ms) and repeats all iterations",
            super::millis(trial.began)
        );
        return Ok(not_offered(took));
    }
    let mut kept: Vec<(usize, Value)> = Vec::new();
    for place in 0..states.len() {
        let begins = place == 0 || matches!(states[place - 1].ended, EndedLevel::Increment);
        if offered == Restore::Any || begins {
            match trial.save()? {
                Ok(token) => kept.push((place, token)),
                Err(reason) => {
                    let found = format!("save after iteration {place} was refused: {reason}");
                    return Ok(fails(
                        found,
                        "save the states that hello offers: \"any\" state, or the start and every state after the end of an \"increment\"",
                    ));
                }
            }
        }
        if trial.is_late() || trial.step()?.is_none() {
            break;
        }
    }
    for (place, token) in kept.iter().rev().chain(kept.first()) {
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
    Ok(good(format!(
        "{} restored; the following iterations are bit-identical",
        counted(kept.len(), "state")
    )))
}

/// The difference after restoring a state, and how to fix it.
fn comes_back(
    trial: &mut Trial,
    place: usize,
    token: &Value,
    states: &[State],
) -> Result<Option<(String, &'static str)>, Fault> {
    if let Err(reason) = trial.restore(token)? {
        let found = format!("the token from iteration {place} was refused: {reason}");
        return Ok(Some((found, "keep tokens valid until the solver ends")));
    }
    for (then, number) in states.iter().zip(1..).skip(place).take(AFTER) {
        let now = trial.step()?;
        if now.as_ref() == Some(then) {
            continue;
        }
        let how = match now {
            None => "the step was refused".to_owned(),
            Some(now) => difference(then, &now),
        };
        let found = format!("after restoring iteration {place}, iteration {number} differs: {how}");
        return Ok(Some((found, MEND)));
    }
    Ok(None)
}

/// Checks that restoring a state also removes modes forced after it was saved.
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
                "after a forced iteration the tokens are refused".into(),
            ));
        }
        if trial.step()?.as_ref() != Some(then) {
            let failed = if failed { " that failed" } else { "" };
            return Ok(Some(format!(
                "after a forced iteration{failed}, restore does not give the earlier state"
            )));
        }
    }
    Ok(None)
}
