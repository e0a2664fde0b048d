//! The attempt of an increment that failed, seen again: what its major iterations led to, one after the other.
//!
//! A state does not say how it was come to. Its attempt is made again from its start, so that what is told of it was seen.

use std::mem::discriminant;
use std::ops::ControlFlow;
use std::sync::Arc;
use stickslip_core::contact::projection::SurfacePoint;
use stickslip_core::linear::norms::Norms;
use stickslip_core::model::Mode;
use stickslip_core::step::drive::{RunEnd, Until};
use stickslip_core::step::event::{Failure, Outcome};
use stickslip_core::step::state::State;
use stickslip_core::step::stepper::Stepper;

/// What a major iteration led to.
#[derive(Debug, Clone)]
pub struct Major {
    /// How far it is from equilibrium.
    pub after: Norms,
    /// Values of all degrees of freedom.
    pub u: Arc<Vec<f64>>,
    /// Mode of each slave node, and where it stands.
    pub contacts: Vec<(Mode, Option<SurfacePoint>)>,
}

/// An attempt, from its start to its failure.
#[derive(Debug, Clone)]
pub struct Attempt {
    /// Its major iterations that came to an end.
    pub majors: Vec<Major>,
    /// How it failed.
    pub failure: Failure,
}

impl Attempt {
    /// Makes the attempt again that failed in a state. `None` where it was stopped, or ends otherwise than it did, as
    /// after changes by hand. The stepper is left where it ends.
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
                    majors.push(Major::of(stepper.state(), after));
                    ControlFlow::Continue(())
                }
                Outcome::Increment { .. }
                | Outcome::Cut { .. }
                | Outcome::Leaps { .. }
                | Outcome::Turns { .. }
                | Outcome::Fallback { .. }
                | Outcome::Moves(_) => ControlFlow::Break(()),
                Outcome::Minor
                | Outcome::Damped { .. }
                | Outcome::Climbed { .. }
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

    /// The largest of residual and interface error after each of its major iterations, relative.
    pub fn errors(&self) -> Vec<f64> {
        let error = |major: &Major| major.after.relative.max(major.after.interface);
        self.majors.iter().map(error).collect()
    }
}

impl Major {
    fn of(state: &State, after: Norms) -> Major {
        let contacts = state.nodes.iter().map(|node| (node.mode, node.spot));
        Major {
            after,
            u: state.u.clone(),
            contacts: contacts.collect(),
        }
    }
}
