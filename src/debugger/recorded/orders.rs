//! Converts interventions into requests to a solver, and the requests of an exchange back into interventions.

use stickslip_core::step::intervene;
use stickslip_core::step::solver::Range;
use stickslip_core::{Capabilities, Contact, Friction, Intervention, Mode};
use stickslip_exchange::attach::Request;
use stickslip_exchange::attach::message::Id;

/// Parameters with a fixed meaning. This one is the increment.
pub const INCREMENT: &str = "increment";
/// The coefficient of friction, for all contacts.
pub const FRICTION: &str = "friction";
/// The cohesion, for all contacts.
pub const COHESION: &str = "cohesion";

/// The requests for an intervention.
pub fn requests(
    intervention: &Intervention,
    contacts: &[Contact],
    ids: &[Id],
    offers: &Capabilities,
) -> Vec<Request> {
    let force = |slave: usize, mode: Mode, hold: bool| {
        let contact = ids.get(slave)?.clone();
        Some(Request::Force {
            contact,
            mode,
            hold,
        })
    };
    let set = |name: &str, value: f64| Request::Set {
        name: name.to_owned(),
        value: serde_json::Value::from(value),
    };
    // A request changes all contacts, so it is sent only for a field that all of them share.
    let coulomb = |all: &[Friction]| {
        let untied = all
            .iter()
            .zip(contacts)
            .filter(|(_, of)| !of.bond.is_tied());
        let mut all: Vec<Friction> = untied.map(|(friction, _)| *friction).collect();
        let last = all.pop().unwrap_or_default();
        let mu = (offers.friction && all.iter().all(|f| f.angle == last.angle))
            .then(|| set(FRICTION, last.coefficient()));
        let cohesion = (offers.cohesion && all.iter().all(|f| f.cohesion == last.cohesion))
            .then(|| set(COHESION, last.cohesion));
        mu.into_iter().chain(cohesion).collect()
    };
    match intervention {
        Intervention::Force { slave, mode, hold } => {
            force(*slave, *mode, *hold).into_iter().collect()
        }
        Intervention::Assume(starts) => starts
            .iter()
            .filter_map(|start| force(start.slave, start.mode, false))
            .collect(),
        Intervention::Release { slave } => {
            let contact = ids.get(*slave).cloned();
            contact
                .map(|contact| Request::Release { contact })
                .into_iter()
                .collect()
        }
        Intervention::Increment(size) => vec![set(INCREMENT, *size)],
        Intervention::Friction(friction) => coulomb(&vec![*friction; contacts.len()]),
        Intervention::Frictions(all) => coulomb(all),
        Intervention::Settings(_) => Vec::new(),
        Intervention::Parameter { name, value } => vec![Request::Set {
            name: name.clone(),
            value: match value {
                intervene::Value::Number(number) if is_whole(name, offers) => {
                    serde_json::Value::from(*number as i64)
                }
                intervene::Value::Number(number) => serde_json::Value::from(*number),
                intervene::Value::Flag(flag) => serde_json::Value::from(*flag),
                intervene::Value::Text(text) => serde_json::Value::from(text.as_str()),
            },
        }],
    }
}

/// Whether a parameter is an integer.
fn is_whole(name: &str, offers: &Capabilities) -> bool {
    let known = offers.parameters.iter().find(|known| known.name == name);
    known.is_some_and(|known| matches!(known.range, Range::Numbers { whole: true, .. }))
}

/// Adds a granted request to the changes made at a state; `now` is the friction of its contacts. Combines the two
/// requests of one friction change.
pub fn add(
    changed: &mut Vec<Intervention>,
    request: &Request,
    ids: &[Id],
    now: &[Friction],
    contacts: &[Contact],
) {
    let slave = |id: &Id| ids.iter().position(|known| known == id);
    let force =
        |id: &Id, mode, hold| slave(id).map(|slave| Intervention::Force { slave, mode, hold });
    let now = match changed.last() {
        Some(Intervention::Friction(last)) => &vec![*last; now.len()],
        Some(Intervention::Frictions(last)) => &last.clone(),
        _ => now,
    };
    let intervention = match request {
        Request::Force {
            contact,
            mode,
            hold,
        } => force(contact, *mode, *hold),
        Request::Release { contact } => slave(contact).map(|slave| Intervention::Release { slave }),
        Request::Set { name, value } => {
            let change = set(name, value, now, contacts);
            let is_friction = |one: &Intervention| {
                matches!(one, Intervention::Friction(_) | Intervention::Frictions(_))
            };
            if name == COHESION && is_friction(&change) && changed.last().is_some_and(is_friction) {
                changed.pop();
            }
            Some(change)
        }
        _ => None,
    };
    changed.extend(intervention);
}

/// The intervention that changes the friction of all contacts, except tied ones; `now` is that before.
pub fn changed_friction(
    now: &[Friction],
    contacts: &[Contact],
    change: impl Fn(Friction) -> Friction,
) -> Intervention {
    let change = |(now, of): (&Friction, &Contact)| match of.bond.is_tied() {
        true => *now,
        false => change(*now),
    };
    each_friction(now.iter().zip(contacts).map(change).collect())
}

/// The intervention that gives each contact its friction.
pub fn each_friction(all: Vec<Friction>) -> Intervention {
    let first = all.first().copied().unwrap_or_default();
    if all.iter().all(|friction| *friction == first) {
        Intervention::Friction(first)
    } else {
        Intervention::Frictions(all)
    }
}

/// The intervention that sets a parameter; `now` is the friction of the contacts before.
pub fn set(
    name: &str,
    value: &serde_json::Value,
    now: &[Friction],
    contacts: &[Contact],
) -> Intervention {
    match (name, value.as_f64()) {
        (INCREMENT, Some(size)) => Intervention::Increment(size),
        (FRICTION, Some(mu)) => changed_friction(now, contacts, |f| {
            Friction::from_coefficient(mu, f.cohesion)
        }),
        (COHESION, Some(cohesion)) => {
            changed_friction(now, contacts, |f| Friction { cohesion, ..f })
        }
        (_, number) => Intervention::Parameter {
            name: name.to_owned(),
            value: match (number, value) {
                (Some(number), _) => intervene::Value::Number(number),
                (None, serde_json::Value::Bool(flag)) => intervene::Value::Flag(*flag),
                (None, serde_json::Value::String(text)) => intervene::Value::Text(text.clone()),
                (None, other) => intervene::Value::Text(other.to_string()),
            },
        },
    }
}
