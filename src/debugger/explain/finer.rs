//! A finer mesh, tried: the scene with every generated element divided in two, from its start to the load that failed.

use super::restart::{Restart, changed, restart};
use stickslip_core::step::state::State;
use stickslip_scene::format::spec::Spec;

/// How the trial ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Finer {
    /// The refinement that was tried.
    pub refine: usize,
    /// End of the run.
    pub run: Restart,
}

/// Tries a scene with twice its refinement, with the settings of a failed state. `None` where that was stopped, or where
/// no element of it is generated.
pub fn finer(spec: &Spec, state: &State, stop: &dyn Fn() -> bool) -> Option<Finer> {
    let mut spec = spec.clone();
    spec.refine *= 2;
    let refine = spec.refine;
    let mut stepper = changed(spec, state)?;
    if stepper.model().dofs.len() <= state.u.len() {
        return None;
    }
    let run = restart(&mut stepper, state, stop)?;
    Some(Finer { refine, run })
}
