//! A changed scene, tried from its start to the load at which a state failed: for changes that no intervention can make in a
//! run, such as another mesh or another material law.

use crate::format::spec::Spec;
use crate::model::Settings;
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
pub struct Restart {
    /// Minor iterations from the start.
    pub minors: u64,
    /// Major iterations from the start.
    pub majors: u64,
    /// Factorizations from the start.
    pub factorizations: u64,
    /// What it failed of; `None` inside where its budget was used up, and outside where it came to the load.
    pub failure: Option<Option<Failure>>,
}

/// The solver of a changed scene at its start, with the settings and friction of a failed state. `None` where there is no such
/// scene.
pub fn changed(spec: Spec, state: &State) -> Option<Stepper> {
    let own = spec.slaves.iter().filter_map(|group| group.friction);
    let by_area = own
        .chain([spec.friction])
        .any(|friction| friction.adhesion != 0.0);
    let model = Scene::from_spec("changed", spec).ok()?.model;
    let mut stepper = Stepper::new(Arc::new(model));
    let own = stepper.model().settings;
    let settings = Settings {
        initial_gaps: own.initial_gaps,
        adjust_gap: own.adjust_gap,
        ..state.controls.settings
    };
    stepper.intervene(&Intervention::Settings(settings)).ok()?;
    // Friction that was changed for all nodes is that of the new ones; groups of nodes, and cohesion by area, have what the
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
    Some(stepper)
}

/// Runs a changed scene to the load that failed in a state. `None` where that was stopped.
pub fn restart(stepper: &mut Stepper, state: &State, stop: &dyn Fn() -> bool) -> Option<Restart> {
    let target = (state.start.leg, state.load_factor);
    let (mut minors, mut majors) = (0, 0);
    let until = Until::end().minors(BUDGET).interrupted_by(stop);
    let end = stepper.drive(until, |stepper| {
        minors += 1;
        let outcome = &stepper.event().outcome;
        majors += u64::from(outcome.ends_major());
        let accepted = matches!(outcome, Outcome::Increment { .. });
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
    Some(Restart {
        minors,
        majors,
        factorizations: stepper.work().factorizations,
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
