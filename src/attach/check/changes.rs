//! Whether a solver does what it is told between two iterations: forced modes, holds, parameters.

use super::report::{Outcome, fails, good, not_offered};
use super::trial::{Trial, at, is_last};
use serde_json::Value;
use stickslip_core::model::Mode;
use stickslip_debugger::explain::names::{self, MODES};
use stickslip_debugger::recorded::fault::Fault;
use stickslip_debugger::recorded::orders::{FRICTION, INCREMENT};
use stickslip_exchange::attach::message::{Ended, Id, Parameter, ParameterKind, State};
use stickslip_scene::shown;

/// Contacts that are forced, each in every mode.
const FORCED: usize = 100;
/// Contacts that are held.
const HELD: usize = 4;
/// Iterations for which they are held.
const LONG: usize = 10;
/// Iterations in which a parameter should show.
const SHOWS: usize = 4;
/// Load factors that differ by less than this part are the same.
const SAME: f64 = 1e-9;

fn name(contact: &Id) -> String {
    shown::line(&contact.to_string()).into_owned()
}

/// Forces each contact in each mode; all at once at last.
pub fn force(mut trial: Trial, _: &[State]) -> Result<Outcome, Fault> {
    const MEND: &str = "`mode` of the next state is that of the solve, which is the forced one, whatever the rules would choose";
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
                // A contact without friction cannot stick, one past its surface cannot touch.
                refused.push(format!("{} {}: {reason}", name(contact), names::mode(mode)));
                continue;
            }
            let state = trial.step()?;
            let found = state.as_ref().and_then(|state| at(state, contact));
            if let Some(found) = found {
                if found.mode != mode {
                    let (is, wanted) = (names::mode(found.mode), names::mode(mode));
                    let contact = name(contact);
                    return Ok(fails(
                        format!(
                            "contact {contact} is forced {wanted}, and the next solve has it {is}"
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
            .unwrap_or_else(|| "no forced iteration could be solved".into());
        return Ok(fails(
            why,
            "hello offers force only where contacts can be forced",
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
                "all contacts are forced at once, and {} is not {}",
                name(contact),
                names::mode(*mode)
            );
            return Ok(fails(found, MEND));
        }
    }
    let count = trial.scene.contacts.len();
    let mut found = format!(
        "{tried} of {count} contacts, one by one and all at once: the mode is that of the next solve"
    );
    if let Some(first) = refused.first() {
        found += &format!(
            "; {} refused, the first {}",
            refused.len(),
            shown::line(first)
        );
    }
    Ok(good(found))
}

/// Held modes stay, through equilibrium and to the next increment, until they are released.
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
        // One that it would leave.
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
                Some(Ended::Equilibrium) => ", after equilibrium",
                Some(Ended::Increment) => ", in a new increment",
                Some(Ended::Cut) => ", after the increment was cut",
                _ => "",
            };
            let is = at(state, &contact).map_or("", |found| names::mode(found.mode));
            let found = format!(
                "contact {} is held {}, and solved {is} in iteration {number}{then}",
                name(&contact),
                names::mode(mode)
            );
            return Ok(fails(
                found,
                "a held mode is that of every solve until release, whatever ends in between",
            ));
        }
        // After the end there is nothing to be released for.
        if states.last().is_none_or(is_last) {
            continue;
        }
        let release = stickslip_exchange::attach::Request::Release {
            contact: contact.clone(),
        };
        if let Err(reason) = trial.order(&release)? {
            let found = format!("release of contact {} is refused: {reason}", name(&contact));
            return Ok(fails(found, "release is answered by ok"));
        }
    }
    Ok(match held {
        0 => fails(
            "no contact can be held",
            "hello offers hold only where contacts can be held",
        ),
        _ => good(format!(
            "{held} contacts, through {longest} iterations, and released"
        )),
    })
}

/// Each parameter takes its own value, refuses what it cannot take, and what another value does is looked at.
pub fn parameters(mut trial: Trial, states: &[State]) -> Result<Outcome, Fault> {
    let all = trial.hello.parameters.clone();
    if all.is_empty() {
        return Ok(not_offered(""));
    }
    for known in &all {
        let name = &known.name;
        if let Err(reason) = trial.set(name, known.value.clone())? {
            let found = format!("{name} refuses the value that it has: {reason}");
            return Ok(fails(
                found,
                "set with the value of hello is answered by ok",
            ));
        }
        for wrong in wrong_values(known) {
            if trial.set(name, wrong.clone())?.is_ok() {
                let found = format!("{name} takes {wrong}, which is none of its values");
                return Ok(fails(
                    found,
                    "what is out of range, or of another kind, is answered by refused, and changes nothing",
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
        "{} of them take their own values, and refuse others",
        all.len()
    );
    if !without.is_empty() {
        found += &format!(
            "; without effect in the first {SHOWS} iterations: {}",
            without.join(", ")
        );
    }
    Ok(good(found))
}

/// Values that a parameter cannot take.
fn wrong_values(known: &Parameter) -> Vec<Value> {
    let mut wrong = Vec::new();
    match known.kind {
        ParameterKind::Number | ParameterKind::Integer => {
            wrong.push(Value::from("no number"));
            wrong.extend(known.least.map(|least| Value::from(least - 1.0)));
            wrong.extend(known.most.map(|most| Value::from(most + 1.0)));
        }
        ParameterKind::Flag => wrong.push(Value::from("neither")),
        ParameterKind::Choice => wrong.push(Value::from("no such choice")),
        // A solver may read anything from a text.
        ParameterKind::Text => {}
    }
    wrong
}

/// A value that a parameter can take and does not have.
fn another_value(known: &Parameter) -> Option<Value> {
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

/// The parameter of a meaning, with its number.
fn meant(trial: &Trial, name: &str) -> Option<f64> {
    let known = trial
        .hello
        .parameters
        .iter()
        .find(|known| known.name == name);
    known?.value.as_f64()
}

/// Another increment starts the present one again.
pub fn increment(mut trial: Trial, states: &[State]) -> Result<Outcome, Fault> {
    const MEND: &str = "with a new size the present increment starts again: the same increment, a further attempt, major 1, minor 1, from the last accepted state";
    let Some(size) = meant(&trial, INCREMENT) else {
        return Ok(not_offered(""));
    };
    // In the middle of an increment, if there is a middle.
    let done = states
        .iter()
        .position(|state| state.ended == Ended::Iteration)
        .map_or(0, |place| place + 1);
    let before = trial.steps(done)?;
    if let Err(reason) = trial.set(INCREMENT, 0.5 * size)? {
        return Ok(fails(
            format!("half of its size is refused: {reason}"),
            MEND,
        ));
    }
    let Some(now) = trial.step()? else {
        return Ok(fails("the step after it is refused", MEND));
    };
    if let Some(last) = before.last() {
        let at = now.at;
        let again = at.increment == last.at.increment
            && at.attempt > last.at.attempt
            && (at.major, at.minor) == (1, 1);
        if !again {
            let found = format!(
                "after {}.{}.{}.{} (increment, attempt, major, minor) it goes on with {}.{}.{}.{}",
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
        let found = format!(
            "half of its size leads to the load factor {load:?}, and {wanted:?} would be right"
        );
        return Ok(fails(
            found,
            "`load` is the factor at the end of the present increment",
        ));
    }
    Ok(good("half of its size starts the increment again"))
}

/// Without friction there is no limit but the cohesion.
pub fn friction(mut trial: Trial, states: &[State]) -> Result<Outcome, Fault> {
    if meant(&trial, FRICTION).is_none() {
        return Ok(not_offered(""));
    }
    if let Err(reason) = trial.set(FRICTION, 0.0)? {
        return Ok(fails(
            format!("mu = 0 is refused: {reason}"),
            "friction is the coefficient of all contacts, and 0 is none",
        ));
    }
    let now = trial.steps(states.len())?;
    let size = |of: &[State]| {
        let all = of
            .iter()
            .flat_map(|state| &state.contacts)
            .filter_map(|found| found.limit);
        all.fold(0.0, |most: f64, limit| most.max(limit.abs()))
    };
    let cohesion = trial.scene.contacts.iter().fold(0.0, |most: f64, contact| {
        most.max(contact.friction.cohesion)
    });
    // The first solve may still have the old one.
    let (least, then) = (size(now.get(1..).unwrap_or(&[])), size(states));
    Ok(match then > 0.0 && least > cohesion.max(1e-6 * then) {
        true => fails(
            format!("with mu = 0 the limit of a contact is {least:?}"),
            "limit is mu f_n + cohesion with the mu that was set, from the next iteration on",
        ),
        false => good("with mu = 0 no contact has a limit but its cohesion"),
    })
}
