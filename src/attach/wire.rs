//! Converts models, states and events of the core to messages of the protocol.
//!
//! Nothing is rounded, so that a trace made from the messages has the same bits.

use stickslip_core::contact::record::{self};
use stickslip_core::model::Axis;
use stickslip_core::{
    Bond, ContactRecord, Control, Event, Failure, Jumps, Model, MonitorQuantity, Norms, Outcome,
    State,
};
use stickslip_debugger::explain::failures;
use stickslip_debugger::explain::names;
use stickslip_exchange::attach::message::{
    self, Components, Contact, ContactResult, EndedLevel, Forced, Friction, Id, Monitor,
    ReportedKind, Scene, SurfaceMessage, number,
};

/// The number of a contact in messages, from 1.
pub fn id(contact: usize) -> Id {
    Id::Number(i64::try_from(contact + 1).unwrap_or(i64::MAX))
}

/// The contact with a number.
pub fn contact(id: &Id, model: &Model) -> Option<usize> {
    let Id::Number(number) = id else {
        return None;
    };
    let contact = usize::try_from(*number).ok()?.checked_sub(1)?;
    (contact < model.contacts.len()).then_some(contact)
}

/// The scene message. Surfaces with elements of more than two nodes are sent as the chain of all their nodes; of a surface in
/// several pieces only the first is sent.
pub fn scene(model: &Model) -> Scene {
    let lines = model.bodies.iter().flat_map(|body| body.kind.lines());
    Scene {
        title: model.title.clone(),
        about: model.about.clone(),
        dimension: 2,
        mesh: None,
        nodes: model.nodes.iter().map(node).collect(),
        lines: lines.cloned().collect(),
        faces: Vec::new(),
        surfaces: model.surfaces.iter().map(surface).collect(),
        contacts: (0..model.contacts.len())
            .map(|k| of_contact(model, k))
            .collect(),
        load: match model.path.as_slice() {
            [from, .., to] if from != to => Some([*from, *to]),
            _ => None,
        },
        monitors: model.monitors.iter().map(monitor).collect(),
        arc: model.control == Control::Arc,
        drag: model.jumps == Jumps::Dynamic,
    }
}

fn node(node: &stickslip_core::Node) -> message::NodeMessage {
    message::NodeMessage {
        name: node.name.clone(),
        at: Some(Components::Two(node.at)),
    }
}

fn surface(surface: &stickslip_core::Surface) -> SurfaceMessage {
    let mut nodes: Vec<usize> = Vec::new();
    for element in &surface.elements {
        match nodes.last() {
            Some(last) if Some(last) == element.first() => nodes.extend(&element[1..]),
            Some(_) => break,
            None => nodes.extend(element),
        }
    }
    SurfaceMessage {
        name: surface.name.clone(),
        nodes,
        faces: Vec::new(),
        rigid: surface.rigid,
    }
}

fn of_contact(model: &Model, k: usize) -> Contact {
    let contact = &model.contacts[k];
    let friction = contact.friction;
    Contact {
        id: id(k),
        name: names::slave(model, k).to_owned(),
        node: contact.node,
        surface: contact
            .surfaces
            .first()
            .map(|&surface| model.surfaces[surface].name.clone()),
        friction: Friction {
            mu: None,
            angle: Some(friction.angle),
            cohesion: friction.cohesion,
        },
        mode: contact.start,
        area: contact.area,
        gives: match contact.bond {
            Bond::Giving(give) => Some(give),
            Bond::Hard | Bond::Tied { .. } => None,
        },
        tied: contact.bond.is_tied(),
    }
}

fn monitor(monitor: &stickslip_core::Monitor) -> Monitor {
    let kind = match &monitor.of {
        MonitorQuantity::Contact {
            axis: Axis::X | Axis::Y,
            ..
        }
        | MonitorQuantity::Reaction { .. } => ReportedKind::Force,
        MonitorQuantity::Pressure { .. } => ReportedKind::Pressure,
        MonitorQuantity::Modes { .. } => ReportedKind::Count,
        MonitorQuantity::Displacement { .. } | MonitorQuantity::Drift { .. } => {
            ReportedKind::Length
        }
        MonitorQuantity::Arc | MonitorQuantity::Reported { .. } => ReportedKind::Other,
    };
    Monitor::Kind {
        name: monitor.name.clone(),
        kind,
    }
}

/// The state message for a minor iteration, with `monitors` if it ended an increment.
pub fn state(model: &Model, state: &State, event: &Event, monitors: &[f64]) -> message::State {
    let (ended, after, size) = ended(event);
    let found = event.nodes.iter().enumerate();
    message::State {
        at: event.position,
        load: Some(event.load_factor),
        ended,
        reason: reason(model, event),
        size,
        contacts: found.map(|(k, record)| of_record(k, record)).collect(),
        residual: norms(&event.before),
        after,
        displacements: Some(displacements(model, state)),
        spring: None,
        monitors: monitors.iter().copied().map(number).collect(),
        arc: event.arc.and_then(number),
        drag: (event.drag != 0.0).then_some(event.drag),
    }
}

/// Displacements of all nodes.
fn displacements(model: &Model, state: &State) -> Vec<Components> {
    (0..model.nodes.len())
        .map(|node| {
            let dof = |axis: usize| match model.dofs.count.get(node) {
                Some(2..) => state.u.get(model.dofs.first[node] + axis).copied(),
                _ => None,
            };
            Components::Two([dof(0).unwrap_or(0.0), dof(1).unwrap_or(0.0)])
        })
        .collect()
}

fn ended(event: &Event) -> (EndedLevel, Option<message::NormsMessage>, Option<f64>) {
    match &event.outcome {
        Outcome::Minor
        | Outcome::Damped { .. }
        | Outcome::StrategyChange { .. }
        | Outcome::HeldBack { .. } => (EndedLevel::Iteration, None, None),
        Outcome::Cut { size, .. }
        | Outcome::WholeIncrement { size, .. }
        | Outcome::Fallback { size, .. } => (EndedLevel::Cut, None, number(*size)),
        Outcome::PathCorner { .. } | Outcome::Motion(_) => (EndedLevel::Cut, None, None),
        Outcome::Major { after, .. } | Outcome::Refused { after, .. } => {
            (EndedLevel::Equilibrium, Some(norms(after)), None)
        }
        Outcome::Increment { after, last, .. } => {
            let ended = if *last {
                EndedLevel::Done
            } else {
                EndedLevel::Increment
            };
            (ended, Some(norms(after)), None)
        }
        Outcome::Failed(failure) => {
            let relative = match failure {
                Failure::MajorLimit { relative, .. } | Failure::Diverged { relative } => {
                    Some(*relative)
                }
                _ => None,
            };
            let after = relative.map(|relative| message::NormsMessage {
                relative: number(relative),
                ..message::NormsMessage::default()
            });
            (EndedLevel::Failure, after, None)
        }
    }
}

fn reason(model: &Model, event: &Event) -> String {
    match &event.outcome {
        Outcome::Failed(why)
        | Outcome::Cut { why, .. }
        | Outcome::WholeIncrement { why, .. }
        | Outcome::Fallback { why, .. }
        | Outcome::PathCorner { why, .. } => failures::describe(model, why),
        _ => String::new(),
    }
}

fn of_record(k: usize, record: &ContactRecord) -> ContactResult {
    let decision = &record.decision;
    ContactResult {
        id: Some(id(k)),
        mode: decision.before,
        next: decision.next,
        gap: number(record.gap),
        f_n: number(record.f_n),
        f_t: number(record.f_t).map(Components::One),
        limit: number(record.t_max),
        slip: number(record.slip).map(Components::One),
        rule: decision.rule.name().to_owned(),
        margin: None,
        tests: decision.tests.into_iter().flatten().collect(),
        wanted: (decision.wanted != decision.next).then_some(decision.wanted),
        limit_used: number(record.t_max_used),
        drift: number(record.drift),
        normal: place(record.normal),
        tangent: None,
        foot: place(record.foot),
        corner: record.corner,
        carried: record.carried,
        forced: match record.forced {
            record::Forced::No => None,
            record::Forced::Once(_) => Some(Forced::Once),
            record::Forced::Held(_) => Some(Forced::Held),
        },
        over: record.spot.is_some(),
    }
}

/// Finite coordinates; a contact without a surface has none.
fn place(at: [f64; 2]) -> Option<Components> {
    at.iter()
        .all(|x| x.is_finite())
        .then_some(Components::Two(at))
}

fn norms(norms: &Norms) -> message::NormsMessage {
    message::NormsMessage {
        relative: number(norms.relative),
        force: number(norms.force),
        interface: number(norms.interface),
        correction: number(norms.correction),
        scale: number(norms.scale),
        limit: number(norms.limit),
        noise: number(norms.noise),
    }
}
