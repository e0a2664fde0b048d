//! Tries a finer mesh: the scene with every generated element divided in two, from its start to the load of the
//! failure.

use super::restart::{BUDGET, Restart, changed, restart};
use stickslip_core::State;
use stickslip_scene::Spec;

/// Result of the trial.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshProbe {
    /// The refinement tried.
    pub refine: usize,
    /// End of the run.
    pub run: Restart,
}

/// Tries a scene with twice its refinement and the settings of a failed state. `None` if interrupted, or if
/// none of its meshes is generated.
pub fn finer(spec: &Spec, state: &State, stop: &dyn Fn() -> bool) -> Option<MeshProbe> {
    let mut spec = spec.clone();
    spec.refine *= 2;
    let refine = spec.refine;
    let mut stepper = changed(spec, state)?;
    if stepper.model().dofs.len() <= state.u.len() {
        return None;
    }
    let run = restart(&mut stepper, state, BUDGET, stop)?;
    Some(MeshProbe { refine, run })
}
