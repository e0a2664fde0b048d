//! Whether the last equilibrium is lost: with the loads of the smallest increment that fails held, a damped motion
//! ([`stickslip_core::Motion`]) leaves it. Near an equilibrium the motion would stop. This is evidence for one branch: another
//! equilibrium may exist further away.

use std::ops::ControlFlow;
use std::sync::Arc;
use stickslip_core::plane::distance;
use stickslip_core::{Jumps, Model, MotionEvent, Outcome, RunEnd, State, Stepper, Until};
use stickslip_scene::{sig2, sig4, sig6};

/// Displacement from which the motion has left the equilibrium, relative to the scene's length.
const FAR: f64 = 0.01;
/// Maximum number of minor iterations.
const MOST_MINORS: u64 = 8000;

/// Describes the damped motion that leaves the last equilibrium. `None` if there is none, or if interrupted.
pub fn moves_away(model: &Model, state: &State, stop: &dyn Fn() -> bool) -> Option<String> {
    let moving = Model {
        jumps: Jumps::Dynamic,
        ..model.clone()
    };
    let mut stepper = Stepper::new(Arc::new(moving));
    let mut again = state.attempt_again();
    again.recovery.fallback = None;
    stepper.restore(&again);
    let mut from = state.start.clone();
    let until = Until::end().minors(MOST_MINORS).interrupted_by(stop);
    let end = stepper.drive(until, |stepper| {
        let now = stepper.state();
        match &stepper.event().outcome {
            Outcome::Increment { jumped, .. } => {
                from = now.start.clone();
                let reached = *jumped || from.load_factor == state.load_factor;
                if reached {
                    return ControlFlow::Break(None);
                }
            }
            Outcome::Motion(MotionEvent::Step { .. }) => {
                let furthest = furthest(model, &from.u, &now.u);
                if furthest.is_some_and(|(_, way)| way > FAR * model.length) {
                    return ControlFlow::Break(furthest);
                }
            }
            _ => {}
        }
        ControlFlow::Continue(())
    });
    let RunEnd::Stopped(Some((node, way))) = end else {
        return None;
    };
    Some(format!(
        "limit load: equilibrium is lost at load {}: with the loads just beyond held, a damped motion leaves it; node {} has moved by {} ({} % of the scene's length) and is not at rest",
        sig6(from.load_factor),
        model.nodes[node].name,
        sig4(way),
        sig2(100.0 * way / model.length)
    ))
}

/// The node of a body that has moved furthest between these displacements, and how far.
pub(super) fn furthest(model: &Model, from: &[f64], now: &[f64]) -> Option<(usize, f64)> {
    let way = |node: usize| {
        let [from, to] = [from, now].map(|u| model.place(u, node));
        (node, distance(from, to))
    };
    let nodes = model.bodies.iter().flat_map(|body| &body.nodes).copied();
    nodes.map(way).max_by(|a, b| a.1.total_cmp(&b.1))
}
