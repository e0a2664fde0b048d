//! Recognises scenes that consist only of contacts on a level floor and one compliance: interface problems of other programs.

use crate::Model;
use crate::model::{
    Body, BodyKind, Bond, Contact, Control, Form, Linear, LinearSolver, Monitor, MonitorQuantity,
    Surface,
};

/// Maximum number of contacts for which the equations of a compliance are solved together with those of the contacts.
pub const FEW: usize = 100;

/// The parts of a scene that consists only of contacts and a compliance.
#[derive(Debug, Clone, Copy)]
pub struct SparseContacts<'a> {
    /// The compliance, over the nodes of the contacts in their order.
    pub linear: &'a Linear,
    /// Degree of freedom of the first force on the body.
    pub first_force: usize,
    /// Height y of the floor.
    pub floor: f64,
}

/// The contacts and the compliance, if the scene has more than [`FEW`] contacts and nothing else that deforms, moves or is
/// supported. Such a scene is solved on the entries of the compliance.
pub fn sparse_contacts(model: &Model) -> Option<SparseContacts<'_>> {
    let [body] = model.bodies.as_slice() else {
        return None;
    };
    let BodyKind::Linear(linear) = &body.kind else {
        return None;
    };
    let Form::Compliance { first_force } = linear.form else {
        return None;
    };
    let bare = model.has_dead_loads()
        && model.prescribed.is_empty()
        && model.finished.is_none()
        && model.control == Control::Load
        && model.settings.solver != LinearSolver::Condensed;
    let many = model.contacts.len() > FEW && model.contacts.len() == body.nodes.len();
    let watched = |monitor: &Monitor| {
        !matches!(
            monitor.of,
            MonitorQuantity::Reported { .. } | MonitorQuantity::Reaction { .. }
        )
    };
    if !bare || !many || !model.monitors.iter().all(watched) || !is_unsupported(model, body) {
        return None;
    }
    let floor = floor_under(model, model.contacts.first()?.surfaces.first().copied()?)?;
    let over = |contact: &Contact| {
        let [surface] = contact.surfaces.as_slice() else {
            return None;
        };
        let plain = contact.bond == Bond::Hard && contact.overlap == 0.0;
        let alone = plain && contact.facing.is_none();
        floor_under(model, *surface).filter(|_| alone)
    };
    let mut contacts = model.contacts.iter().zip(&body.nodes);
    let alike =
        |(contact, node): (&Contact, &usize)| contact.node == *node && over(contact) == Some(floor);
    contacts.all(alike).then_some(SparseContacts {
        linear,
        first_force,
        floor,
    })
}

/// Whether every degree of freedom of a body is free, and only those.
fn is_unsupported(model: &Model, body: &Body) -> bool {
    let free = |node: &usize| {
        let first = model.dofs.first[*node];
        (first..first + 2).all(|dof| model.dofs.equation[dof].is_some())
    };
    body.nodes.iter().all(free) && model.dofs.equations == 4 * body.nodes.len()
}

/// Height of a surface that is an endless level floor with its outward side up.
fn floor_under(model: &Model, surface: usize) -> Option<f64> {
    let surface: &Surface = model.surfaces.get(surface)?;
    let [element] = surface.elements.as_slice() else {
        return None;
    };
    let &[from, to] = element.as_slice() else {
        return None;
    };
    let [from, to] = [from, to].map(|node| model.nodes[node].at);
    let level = from[1] == to[1] && from[0] > to[0];
    (surface.rigid && surface.endless && level).then_some(from[1])
}
