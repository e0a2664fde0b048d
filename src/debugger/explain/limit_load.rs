//! The load at which a body becomes loose, and why: friction is used up, or no contact presses against the
//! motion any more.
//!
//! Repeats the failed increment in smaller steps ([`super::load_limit_probe`]). In the last equilibrium, computes the remaining
//! resistance of each contact of the body against the free motion. With v the relative velocity, friction resists with at
//! most tan φ F_n + c per |v_t|, of which |F_t| is used; an opening contact yields F_n per v_n until its force is zero.
//!
//! A deformable surface can hold a body for a while after all of its contacts slide. Accepted increments are therefore also
//! checked directly ([`body_without_friction`]).

use super::load_limit_probe::{LoadLimitProbe, reach};
use super::rigid_motion::BodyMotion;
use std::collections::HashSet;
use stickslip_core::contact::record::ContactRecord;
use stickslip_core::linear::singular::{RigidMotion, Singular};
use stickslip_core::model::{Body, Mode, Model};
use stickslip_core::step::event::Failure;
use stickslip_core::step::state::State;
use stickslip_core::step::stepper::Stepper;
use stickslip_scene::number::sig4;

/// Fraction of the friction or of the contact forces below which nothing is left.
const LEFT: f64 = 1e-2;

/// Resistance of the remaining contacts against a motion.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Resistance {
    /// Available and used friction (power).
    friction: [f64; 2],
    /// Contact forces that the motion removes (power), and their magnitude over the same velocities.
    opening: [f64; 2],
}

/// Describes the limit load where the increment failed because nothing holds a body. `None` for other failures, for bodies
/// that were loose from the start, and if interrupted. The stepper's final state is unspecified.
pub fn limit_load(
    stepper: &mut Stepper,
    state: &State,
    failure: &Failure,
    stop: &dyn Fn() -> bool,
) -> Option<String> {
    let motion = rigid(failure)?.first()?;
    if state.way.is_some() || state.recovery.motion.is_some() {
        return None;
    }
    let found = reach(stepper, state, stop)?;
    let LoadLimitProbe { load, from, .. } = found;
    found.ends.as_ref()?;
    if load == from && from == stepper.model().path[0] {
        return None;
    }
    let model = stepper.model().clone();
    let places = model.places(&found.at.start.u);
    let mut held = (*found.at).clone();
    held.nodes.clone_from(&found.at.start.nodes);
    let moving = BodyMotion::new(&model, &places, &held, motion)?;
    let resistance = resistance(&moving, &held);
    let why = match resistance {
        Resistance {
            friction: [most, used],
            opening: [left, _],
        } if most > 0.0 && most - used + left <= LEFT * most => "friction is used up",
        Resistance {
            friction: [0.0, _],
            opening: [left, all],
        } if left <= LEFT * all => "no contact presses against the motion any more",
        _ => "equilibrium ends",
    };
    let name = moving.name();
    Some(format!(
        "limit load: {why} at load {}: body {name} is held up to this load",
        sig4(load)
    ))
}

/// The body that has no friction left in an accepted increment: it is held by its slave nodes only, and all of them that touch
/// slide.
pub fn body_without_friction<'a>(model: &'a Model, contacts: &[ContactRecord]) -> Option<&'a str> {
    let touching = model.contacts.iter().zip(contacts);
    let touching: Vec<(usize, bool)> = touching
        .filter(|(_, found)| found.decision.before != Mode::Free)
        .map(|(contact, found)| {
            let slides = found.decision.before == Mode::Sliding && found.t_max != 0.0;
            (contact.node, slides)
        })
        .collect();
    if !touching.iter().any(|(_, slides)| *slides) {
        return None;
    }
    let is_free = |node: usize| {
        let first = model.dofs.first[node];
        let own = first..first + usize::from(model.dofs.count[node]);
        model.dofs.equation[own].iter().all(Option::is_some)
    };
    let slides = |body: &&Body| {
        let nodes: HashSet<usize> = body.nodes.iter().copied().collect();
        let mut own = touching
            .iter()
            .filter(|(node, _)| nodes.contains(node))
            .peekable();
        let others = model.bodies.iter().filter(|other| other.name != body.name);
        own.peek().is_some()
            && own.all(|(_, slides)| *slides)
            && nodes.iter().all(|&node| is_free(node))
            && !others
                .flat_map(|other| &other.nodes)
                .any(|node| nodes.contains(node))
    };
    model.bodies.iter().find(slides).map(|body| &*body.name)
}

/// The rigid motions that a failure reports.
fn rigid(failure: &Failure) -> Option<&[RigidMotion]> {
    match failure {
        Failure::Singular(Singular::Rigid { motions }) => Some(motions),
        Failure::LadderEnded { first, last, .. } => rigid(first).or_else(|| rigid(last)),
        Failure::NoAnswer { first, .. } => first.as_deref().and_then(rigid),
        _ => None,
    }
}

fn resistance(moving: &BodyMotion<'_>, state: &State) -> Resistance {
    let mut all = Resistance::default();
    for (contact, [v_n, v_t]) in moving.rates(state) {
        let node = &state.nodes[contact];
        if node.mode == Mode::Free {
            continue;
        }
        let friction = node.friction(&state.controls.friction[contact]);
        let most = friction.coefficient() * node.f_n.max(0.0) + friction.cohesion;
        let size = v_n.hypot(v_t);
        if v_t.abs() > LEFT * size {
            all.friction[0] += most * v_t.abs();
            all.friction[1] += node.f_t.abs().min(most) * v_t.abs();
        }
        if v_n.abs() > LEFT * size {
            all.opening[0] += node.f_n.abs() * v_n.abs();
        }
        all.opening[1] += node.f_n.abs() * size;
    }
    all
}
