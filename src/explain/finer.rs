//! A finer mesh, tried: the scene with every generated element divided in two, from its start to the load that failed.
//!
//! Unlike all other remedies this one cannot set out from the failed state, whose nodes are others.

use crate::format::spec::Spec;
use crate::scene::Scene;
use crate::step::drive::{RunEnd, Until};
use crate::step::event::{Failure, Outcome};
use crate::step::intervene::Intervention;
use crate::step::state::{State, Status};
use crate::step::stepper::Stepper;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Most minor iterations of the trial.
const BUDGET: u64 = 4000;

/// How the trial ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Finer {
    /// The refinement that was tried.
    pub refine: usize,
    /// Minor iterations from the start.
    pub minors: u64,
    /// What it failed of; `None` inside where its budget was used up, and outside where it came to the load.
    pub failure: Option<Option<Failure>>,
}

/// Tries a scene with twice its refinement, with the settings of a failed state. `None` where that was stopped, or where
/// no element of it is generated.
pub fn finer(spec: &Spec, state: &State, stop: &dyn Fn() -> bool) -> Option<Finer> {
    let mut spec = spec.clone();
    spec.refine *= 2;
    let refine = spec.refine;
    let own = spec.slaves.iter().filter_map(|group| group.friction);
    let by_area = own
        .chain([spec.friction])
        .any(|friction| friction.adhesion != 0.0);
    let model = Scene::from_spec("finer", spec).ok()?.model;
    if model.dofs.len() <= state.u.len() {
        return None;
    }
    let mut stepper = Stepper::new(Arc::new(model));
    let settings = Intervention::Settings(state.controls.settings);
    stepper.intervene(&settings).ok()?;
    // Friction that was changed for all nodes is that of the finer ones; groups of nodes, and cohesion by area, have what the
    // scene says.
    if !by_area
        && let [first, rest @ ..] = state.controls.friction.as_slice()
        && rest.iter().all(|friction| friction == first)
        && stepper
            .model()
            .contacts
            .iter()
            .any(|contact| contact.friction != *first)
    {
        stepper.intervene(&Intervention::Friction(*first)).ok()?;
    }
    let target = (state.start.leg, state.load_factor);
    let mut minors = 0;
    let until = Until::end().minors(BUDGET).interrupted_by(stop);
    let end = stepper.drive(until, |stepper| {
        minors += 1;
        let accepted = matches!(stepper.event().outcome, Outcome::Increment { .. });
        match accepted && is_past(stepper, target) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    });
    let failure = match end {
        RunEnd::Stopped(()) | RunEnd::Finished => None,
        RunEnd::Failed(failure) => Some(Some(failure)),
        RunEnd::Spent => Some(None),
        RunEnd::Interrupted => return None,
    };
    Some(Finer {
        refine,
        minors,
        failure,
    })
}

/// Whether the last accepted state has come to a load on a leg of the path.
fn is_past(stepper: &Stepper, (leg, load): (usize, f64)) -> bool {
    let (state, path) = (stepper.state(), &stepper.model().path);
    let start = &state.start;
    let way = match path.get(leg..leg + 2) {
        Some([from, to]) => (to - from).signum(),
        _ => 1.0,
    };
    let slack = 1e-9 * state.controls.increment;
    let on_leg = start.leg == leg && (start.load_factor - load) * way >= -slack;
    state.status == Status::Finished || start.leg > leg || on_leg
}
