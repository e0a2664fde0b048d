//! Converts interventions into requests to a solver, and the requests of an exchange back into interventions.

use stickslip_core::step::intervene;
use stickslip_core::step::solver::Range;
use stickslip_core::{Capabilities, Friction, Intervention, Mode};
use stickslip_exchange::attach::Request;
use stickslip_exchange::attach::message::Id;

/// Parameters with a fixed meaning. This one is the increment.
pub const INCREMENT: &str = "increment";
/// The coefficient of friction, for all contacts.
pub const FRICTION: &str = "friction";
/// The cohesion, for all contacts.
pub const COHESION: &str = "cohesion";

/// The requests for an intervention.
pub fn requests(intervention: &Intervention, ids: &[Id], offers: &Capabilities) -> Vec<Request> {
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
    let coulomb = |friction: &Friction| {
        let mu = offers
            .friction
            .then(|| set(FRICTION, friction.coefficient()));
        let cohesion = offers.cohesion.then(|| set(COHESION, friction.cohesion));
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
        Intervention::Friction(friction) => coulomb(friction),
        Intervention::Frictions(all) => all.first().map(coulomb).unwrap_or_default(),
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

/// Adds a granted request to the changes made at a state; `now` is the friction there. Combines the two
/// requests of one friction change.
pub fn add(changed: &mut Vec<Intervention>, request: &Request, ids: &[Id], now: Friction) {
    let slave = |id: &Id| ids.iter().position(|known| known == id);
    let force =
        |id: &Id, mode, hold| slave(id).map(|slave| Intervention::Force { slave, mode, hold });
    let now = match changed.last() {
        Some(Intervention::Friction(last)) => *last,
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
            let change = set(name, value, now);
            let is_friction = |one: &Intervention| matches!(one, Intervention::Friction(_));
            if name == COHESION && is_friction(&change) && changed.last().is_some_and(is_friction) {
                changed.pop();
            }
            Some(change)
        }
        _ => None,
    };
    changed.extend(intervention);
}

/// The intervention that sets a parameter; `now` is the friction before.
pub fn set(name: &str, value: &serde_json::Value, now: Friction) -> Intervention {
    match (name, value.as_f64()) {
        (INCREMENT, Some(size)) => Intervention::Increment(size),
        (FRICTION, Some(mu)) => {
            Intervention::Friction(Friction::from_coefficient(mu, now.cohesion))
        }
        (COHESION, Some(cohesion)) => Intervention::Friction(Friction { cohesion, ..now }),
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
