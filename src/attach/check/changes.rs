//! Checks interventions between two iterations: forced modes, holds, parameters.

use super::report::{Outcome, fails, good, not_offered};
use super::trial::{Trial, at, is_last};
use serde_json::Value;
use stickslip_core::plane::max_abs;
use stickslip_core::{Mode, counted};
use stickslip_debugger::Fault;
use stickslip_debugger::explain::names::MODES;
use stickslip_debugger::recorded::orders::{FRICTION, INCREMENT};
use stickslip_exchange::attach::message::{EndedLevel, Id, ParameterKind, ParameterMessage, State};
use stickslip_scene::shown;

/// Maximum number of contacts forced, each in every mode.
const FORCED: usize = 100;
/// Maximum number of contacts held.
const HELD: usize = 4;
/// Iterations per held contact.
const LONG: usize = 10;
/// Iterations in which a parameter should have an effect.
const SHOWS: usize = 4;
/// Load factors with a smaller relative difference are equal.
const SAME: f64 = 1e-9;

fn name(contact: &Id) -> String {
    shown::line(&contact.to_string()).into_owned()
}

/// Forces each contact in each mode, and finally all at once.
pub fn force(mut trial: Trial, _: &[State]) -> Result<Outcome, Fault> {
    const MEND: &str =
        "`mode` of the next state must be the forced mode, whatever the rules choose";
    if !trial.hello.abilities.force {
        return Ok(not_offered(""));
    }
    let contacts = trial.some_contacts(FORCED);
    let (mut obeyed, mut refused, mut tried) = (0, Vec::new(), 0);
    for contact in &contacts {
        if trial.is_late() {
            break;
        }
        tried += 1;
        for mode in MODES {
            if let Err(reason) = trial.force(contact, mode, false)? {
                // A frictionless contact cannot stick, and one past the end of its surface cannot touch.
                refused.push(format!("{} {}: {reason}", name(contact), mode.word()));
                continue;
            }
            let state = trial.step()?;
            let found = state.as_ref().and_then(|state| at(state, contact));
            if let Some(found) = found {
                if found.mode != mode {
                    let (is, wanted) = (found.mode.word(), mode.word());
                    let contact = name(contact);
                    return Ok(fails(
                        format!(
                            "contact {contact} is forced {wanted}, but the next iteration solves it {is}"
                        ),
                        MEND,
                    ));
                }
                obeyed += 1;
            }
            if state.is_none_or(|state| is_last(&state)) {
                trial.again()?;
            }
        }
    }
    if obeyed == 0 {
        let why = refused
            .first()
            .cloned()
            .unwrap_or_else(|| "no forced iteration was solved".into());
        return Ok(fails(
            why,
            "offer force in hello only if contacts can be forced",
        ));
    }
    trial.again()?;
    let mut all = Vec::new();
    for (contact, mode) in contacts.iter().zip(MODES.iter().cycle()) {
        if trial.force(contact, *mode, false)?.is_ok() {
            all.push((contact, *mode));
        }
    }
    if let Some(state) = trial.step()? {
        let other = all
            .iter()
            .find(|(contact, mode)| at(&state, contact).is_some_and(|found| found.mode != *mode));
        if let Some((contact, mode)) = other {
            let found = format!(
                "with all contacts forced at once, {} is not {}",
                name(contact),
                mode.word()
            );
            return Ok(fails(found, MEND));
        }
    }
    let count = trial.scene.contacts.len();
    let mut found = format!(
        "{tried} of {}, one by one and all at once: the next iteration has the forced mode",
        counted(count, "contact")
    );
    if let Some(first) = refused.first() {
        found += &format!(
            "; {} refused, the first: {}",
            refused.len(),
            shown::line(first)
        );
    }
    Ok(good(found))
}

/// Checks that held modes persist through equilibrium and into the next increment, until released.
pub fn hold(mut trial: Trial, states: &[State]) -> Result<Outcome, Fault> {
    if !trial.hello.abilities.hold {
        return Ok(not_offered(""));
    }
    let (mut longest, mut held) = (0, 0);
    for contact in trial.some_contacts(HELD) {
        let own = states
            .last()
            .and_then(|state| at(state, &contact))
            .map(|found| found.mode);
        // A mode that the contact would leave.
        let mode = if own == Some(Mode::Free) {
            Mode::Fixed
        } else {
            Mode::Free
        };
        trial.again()?;
        if trial.force(&contact, mode, true)?.is_err() {
            continue;
        }
        held += 1;
        let states = trial.steps(LONG)?;
        longest = longest.max(states.len());
        let left = states
            .iter()
            .zip(1..)
            .find(|(state, _)| at(state, &contact).is_some_and(|found| found.mode != mode));
        if let Some((state, number)) = left {
            let before = usize::checked_sub(number, 2).and_then(|place| states.get(place));
            let then = match before.map(|state| state.ended) {
                Some(EndedLevel::Equilibrium) => ", after equilibrium",
                Some(EndedLevel::Increment) => ", in a new increment",
                Some(EndedLevel::Cut) => ", after the increment was cut",
                _ => "",
            };
            let is = at(state, &contact).map_or("", |found| found.mode.word());
            let found = format!(
                "contact {} is held {}, but solved {is} in iteration {number}{then}",
                name(&contact),
                mode.word()
            );
            return Ok(fails(
                found,
                "use a held mode in every iteration until it is released, even after an equilibrium or an increment",
            ));
        }
        // After the end no release is possible.
        if states.last().is_none_or(is_last) {
            continue;
        }
        let release = stickslip_exchange::attach::Request::Release {
            contact: contact.clone(),
        };
        if let Err(reason) = trial.order(&release)? {
            let found = format!(
                "release of contact {} was refused: {reason}",
                name(&contact)
            );
            return Ok(fails(found, "answer release with ok"));
        }
    }
    Ok(match held {
        0 => fails(
            "no contact can be held",
            "offer hold in hello only if contacts can be held",
        ),
        _ => good(format!(
            "{} held through {} and released",
            counted(held, "contact"),
            counted(longest, "iteration")
        )),
    })
}

/// Checks that each parameter accepts its current value and rejects invalid ones; reports parameters without effect.
pub fn parameters(mut trial: Trial, states: &[State]) -> Result<Outcome, Fault> {
    let all = trial.hello.parameters.clone();
    if all.is_empty() {
        return Ok(not_offered(""));
    }
    for known in &all {
        let name = &known.name;
        if let Err(reason) = trial.set(name, known.value.clone())? {
            let found = format!("{name} refuses its current value: {reason}");
            return Ok(fails(found, "answer set with ok for the value in hello"));
        }
        for wrong in wrong_values(known) {
            if trial.set(name, wrong.clone())?.is_ok() {
                let found = format!("{name} accepts the invalid value {wrong}");
                return Ok(fails(
                    found,
                    "refuse values out of range or of the wrong kind, and change nothing",
                ));
            }
        }
    }
    let mut without = Vec::new();
    for known in &all {
        if trial.is_late() {
            break;
        }
        let Some(other) = another_value(known) else {
            continue;
        };
        trial.again()?;
        if trial.set(&known.name, other)?.is_err() {
            continue;
        }
        let now = trial.steps(SHOWS)?;
        if states.starts_with(&now) {
            without.push(known.name.as_str());
        }
    }
    let mut found = format!(
        "{}: current values are accepted, invalid ones refused",
        counted(all.len(), "parameter")
    );
    if !without.is_empty() {
        found += &format!(
            "; without effect in the first {SHOWS} iterations: {}",
            without.join(", ")
        );
    }
    Ok(good(found))
}

/// Values that a parameter cannot have.
fn wrong_values(known: &ParameterMessage) -> Vec<Value> {
    let mut wrong = Vec::new();
    match known.kind {
        ParameterKind::Number | ParameterKind::Integer => {
            wrong.push(Value::from("not a number"));
            wrong.extend(known.least.map(|least| Value::from(least - 1.0)));
            wrong.extend(known.most.map(|most| Value::from(most + 1.0)));
        }
        ParameterKind::Flag => wrong.push(Value::from("neither")),
        ParameterKind::Choice => wrong.push(Value::from("no such choice")),
        // A text parameter may interpret any value as text.
        ParameterKind::Text => {}
    }
    wrong
}

/// A valid value other than the current one.
fn another_value(known: &ParameterMessage) -> Option<Value> {
    let in_range = |x: &f64| {
        known.least.is_none_or(|least| *x >= least) && known.most.is_none_or(|most| *x <= most)
    };
    match known.kind {
        ParameterKind::Number => {
            let now = known.value.as_f64()?;
            let others = [0.5 * now, 2.0 * now, now + 1.0, now - 1.0];
            others
                .into_iter()
                .find(|x| *x != now && in_range(x))
                .map(Value::from)
        }
        ParameterKind::Integer => {
            let now = known.value.as_i64()?;
            let others = [now + 1, now - 1];
            others
                .into_iter()
                .find(|x| in_range(&(*x as f64)))
                .map(Value::from)
        }
        ParameterKind::Flag => known.value.as_bool().map(|now| Value::from(!now)),
        ParameterKind::Choice => {
            let other = known
                .choices
                .iter()
                .find(|choice| known.value != choice.as_str());
            other.map(|choice| Value::from(choice.as_str()))
        }
        ParameterKind::Text => None,
    }
}

/// The value of the parameter with this name and a predefined meaning, if it is a number.
fn parameter_value(trial: &Trial, name: &str) -> Option<f64> {
    let parameter = trial
        .hello
        .parameters
        .iter()
        .find(|parameter| parameter.name == name);
    parameter?.value.as_f64()
}

/// Checks that a new increment restarts the current one.
pub fn increment(mut trial: Trial, states: &[State]) -> Result<Outcome, Fault> {
    const MEND: &str = "with a new size, restart the current increment from the last accepted state: same increment, next attempt, major 1, minor 1";
    let Some(size) = parameter_value(&trial, INCREMENT) else {
        return Ok(not_offered(""));
    };
    // In the middle of an increment, if possible.
    let done = states
        .iter()
        .position(|state| state.ended == EndedLevel::Iteration)
        .map_or(0, |place| place + 1);
    let before = trial.steps(done)?;
    if let Err(reason) = trial.set(INCREMENT, 0.5 * size)? {
        return Ok(fails(format!("half the size was refused: {reason}"), MEND));
    }
    let Some(now) = trial.step()? else {
        return Ok(fails("the next step was refused", MEND));
    };
    if let Some(last) = before.last() {
        let at = now.at;
        let again = at.increment == last.at.increment
            && at.attempt > last.at.attempt
            && (at.major, at.minor) == (1, 1);
        if !again {
            let found = format!(
                "after {}.{}.{}.{} (increment, attempt, major, minor) the next position is {}.{}.{}.{}",
                last.at.increment,
                last.at.attempt,
                last.at.major,
                last.at.minor,
                at.increment,
                at.attempt,
                at.major,
                at.minor
            );
            return Ok(fails(found, MEND));
        }
    }
    let [from, to] = trial.scene.load.unwrap_or([0.0, 1.0]);
    let wanted = (from < to).then_some(from + 0.5 * size);
    if let (Some(load), Some(wanted), 1) = (now.load, wanted, now.at.increment)
        && (load - wanted).abs() > SAME * wanted.abs().max(size)
    {
        let found = format!("half the size gives the load factor {load:?} instead of {wanted:?}");
        return Ok(fails(
            found,
            "`load` must be the load factor at the end of the current increment",
        ));
    }
    Ok(good("half the size restarts the increment"))
}

/// Checks that without friction the limit is the cohesion.
pub fn friction(mut trial: Trial, states: &[State]) -> Result<Outcome, Fault> {
    if parameter_value(&trial, FRICTION).is_none() {
        return Ok(not_offered(""));
    }
    if let Err(reason) = trial.set(FRICTION, 0.0)? {
        return Ok(fails(
            format!("mu = 0 was refused: {reason}"),
            "friction is the coefficient of all contacts; accept 0 for no friction",
        ));
    }
    let now = trial.steps(states.len())?;
    let size = |of: &[State]| {
        let all = of
            .iter()
            .flat_map(|state| &state.contacts)
            .filter_map(|found| found.limit);
        max_abs(all)
    };
    let cohesion = trial.scene.contacts.iter().fold(0.0, |most: f64, contact| {
        most.max(contact.friction.cohesion)
    });
    // The first iteration may still use the old value.
    let (least, then) = (size(now.get(1..).unwrap_or(&[])), size(states));
    Ok(if then > 0.0 && least > cohesion + 1e-6 * then {
        fails(
            format!("with mu = 0 the largest limit is {least:?}"),
            "compute limit as mu f_n + cohesion with the new mu, from the next iteration on",
        )
    } else {
        good("with mu = 0 every limit is the cohesion")
    })
}
