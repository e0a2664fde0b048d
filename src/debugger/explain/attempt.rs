//! Repeats the failed attempt of an increment, to record the result of each major iteration.
//!
//! A state does not contain its history, so that the attempt is repeated from its start.

use std::mem::discriminant;
use std::ops::ControlFlow;
use std::sync::Arc;
use stickslip_core::{Failure, Mode, Norms, Outcome, RunEnd, State, Stepper, SurfacePoint, Until};

/// Result of a major iteration.
#[derive(Debug, Clone)]
pub struct Major {
    /// Norms after it: the distance from equilibrium.
    pub after: Norms,
    /// Values of all degrees of freedom.
    pub u: Arc<Vec<f64>>,
    /// The node with the largest out-of-balance force, and that force; `None` if unknown.
    pub largest: Option<(usize, f64)>,
    /// Mode of each slave node, and its point on the surface.
    pub contacts: Vec<(Mode, Option<SurfacePoint>)>,
}

/// An attempt from its start to its failure.
#[derive(Debug, Clone)]
pub struct Attempt {
    /// The major iterations that ended.
    pub majors: Vec<Major>,
    /// The failure.
    pub failure: Failure,
}

impl Attempt {
    /// Repeats the attempt that failed in a state. `None` if interrupted, or if the attempt ends differently,
    /// as after interventions. The stepper is left at the end of the attempt.
    pub fn again(
        stepper: &mut Stepper,
        state: &State,
        failure: &Failure,
        stop: &dyn Fn() -> bool,
    ) -> Option<Attempt> {
        stepper.restore(&state.attempt_again());
        let mut majors = Vec::new();
        let end = stepper.drive(Until::end().interrupted_by(stop), |stepper| {
            match stepper.event().outcome {
                Outcome::Major { after, .. } | Outcome::Refused { after, .. } => {
                    majors.push(Major::new(stepper, after));
                    ControlFlow::Continue(())
                }
                Outcome::Increment { .. }
                | Outcome::Cut { .. }
                | Outcome::WholeIncrement { .. }
                | Outcome::PathCorner { .. }
                | Outcome::Fallback { .. }
                | Outcome::Motion(_) => ControlFlow::Break(()),
                Outcome::Minor
                | Outcome::Damped { .. }
                | Outcome::StrategyChange { .. }
                | Outcome::HeldBack { .. }
                | Outcome::Failed(_) => ControlFlow::Continue(()),
            }
        });
        match end {
            RunEnd::Failed(again) if discriminant(&again) == discriminant(failure) => {
                Some(Attempt {
                    majors,
                    failure: again,
                })
            }
            _ => None,
        }
    }

    /// The largest relative error (residual or interface) after each major iteration.
    pub fn errors(&self) -> Vec<f64> {
        self.majors
            .iter()
            .map(|major| major.after.relative.max(major.after.interface))
            .collect()
    }
}

impl Major {
    fn new(stepper: &Stepper, after: Norms) -> Major {
        let (state, dofs) = (stepper.state(), &stepper.model().dofs);
        let largest = stepper
            .largest_residual()
            .and_then(|(dof, force)| Some((dofs.node_of(dof)?.0, force)));
        let contacts = state.nodes.iter().map(|node| (node.mode, node.spot));
        Major {
            after,
            largest,
            u: state.u.clone(),
            contacts: contacts.collect(),
        }
    }
}
