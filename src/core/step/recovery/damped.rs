//! Damped motion past a limit point (`history.jumps: dynamic`): from the last equilibrium to the next stable one.
//!
//! Where the increment fails that is as small as `settings.limit_load` allows, the loads stay, and what is out of balance moves
//! the nodes against a viscosity c that all displacements have alike (rotations and forces follow without):
//!
//! ```text
//! c u̇ = R(u),      backward Euler:   R(u_k) − (c / Δt) (u_k − u_k−1) = 0
//! ```
//!
//! Each step is an increment of its own, with Table 1 and 2, judge and strategies, with c / Δt, the *drag*, on the diagonal of the
//! tangent; its end is where friction holds on to next. c only sets the unit of time and is one: what is chosen is the drag.
//! It begins at the interface's stiffness, is divided by up to [`FASTER`] after a step that went little, and multiplied
//! by that where a step fails, goes further than [`STRIDE`], or ends where even the drag does not make it stable, since a
//! backward Euler step then goes to another root than the motion does.
//!
//! Where steps have become small though the drag is, the drag is left out. If that ends in a stable equilibrium within a
//! stride, it is accepted, marked as a jump; else the motion goes on. Viscosity only ever takes work, Σ (c / Δt) |Δu|²; it is
//! summed up and told.

use super::motion::Motion;
use super::retry::{Effect, Recovery, Retry};
use super::stalled::Stalled;
use crate::contact::laws::{ContactLaw, Finding, Verdict};
use crate::linear::norms::Norms;
use crate::step::event::{Failure, Moves, Outcome, Slow};
use crate::step::jump::Landing;

use crate::step::pace::Pace;
use crate::step::stepper::Stepper;
use crate::step::sub_increment::SubIncrement;
use crate::step::watch::StabilityWatch;
use std::sync::Arc;

/// Furthest that a step goes, over the scene's length.
const STRIDE: f64 = 0.01;
/// A step that goes less than this part of a stride may be followed by a faster one.
const SHORT: f64 = 0.25;
/// By how much the drag changes.
const FASTER: f64 = 4.0;
/// A motion that is below this part of a stride in a step, while the drag is below this part of the stiffness, may be at rest.
const RESTING: f64 = 0.01;
/// By how much the drag must have fallen before rest is tried for again.
const AGAIN: f64 = 64.0;
/// Largest drag, over the stiffness: a step that fails with it does not fail of going too far.
const STIFFEST: f64 = 1e9;
/// Smallest drag, over the stiffness: nodes that still do not rest without it never will.
const SOFTEST: f64 = 1e-12;
/// A motion shorter than this part of the scene's length is no jump: the increment failed of something else than a limit point.
const JUMP: f64 = 1e-3;
/// Most steps of a motion.
const MOST_STEPS: u32 = 5000;

/// A damped motion from the last equilibrium: the smallest increment has failed.
pub(super) struct Release;

impl Recovery for Release {
    fn name(&self) -> &'static str {
        "release"
    }

    fn propose(&self, why: &Failure, stalled: &Stalled<'_>) -> Option<Retry> {
        let helps = stalled.size_helps(why) || matches!(why, Failure::Singular(_));
        let (why, load) = (why.clone(), stalled.state.start.load_factor);
        (helps && stalled.can_move()).then_some(Retry {
            part: stalled.state.sub_increment,
            effect: Effect::Release,
            outcome: Outcome::Moves(Moves::LetsGo { why, load }),
        })
    }
}

/// A slower step of the damped motion.
pub(super) struct Slower;

impl Recovery for Slower {
    fn name(&self) -> &'static str {
        "slower"
    }

    fn propose(&self, why: &Failure, stalled: &Stalled<'_>) -> Option<Retry> {
        slower(Slow::Failed(why.clone()), stalled)
    }
}

/// The step again with more drag; coming to rest was too early.
fn slower(slow: Slow, stalled: &Stalled<'_>) -> Option<Retry> {
    let mut motion = stalled.state.motion?;
    if motion.coming_to_rest {
        motion.coming_to_rest = false;
    } else if motion.drag < STIFFEST * motion.stiffness {
        motion.drag *= FASTER;
    } else {
        return None;
    }
    Some(Retry {
        part: stalled.state.sub_increment,
        effect: Effect::Motion(motion),
        outcome: Outcome::Moves(Moves::Slower(slow)),
    })
}

impl Stepper {
    /// Prepares a damped motion from the last equilibrium, the loads as they are. `None` where nothing can be linearised there.
    pub(super) fn release(&mut self, part: SubIncrement) -> Option<()> {
        self.restart(part);
        if !self.linearise() {
            return None;
        }
        let (from, stiffness) = (self.state.start.load_factor, self.source.spring());
        self.state.motion = Some(Motion::new(from, stiffness));
        Arc::make_mut(&mut self.state.start).load_factor = self.state.load_factor;
        Some(())
    }

    /// Takes a step again, slower. `None` where it is as slow as can be.
    fn slow_down(&mut self, slow: Slow) -> Option<Outcome> {
        let retry = slower(slow, &self.stalled())?;
        self.try_again(retry)
    }

    /// A step has converged, and the judge has nothing against it that could be repaired.
    pub(in crate::step) fn end_step(
        &mut self,
        after: Norms,
        verdict: Verdict,
        worst: Option<Finding>,
    ) -> Outcome {
        let Some(motion) = self.state.motion else {
            return self.accept(after, verdict, Landing::marked(worst));
        };
        let moved = self.source.moved(&self.state.u, &self.state.start.u);
        let stride = STRIDE * self.model.length;
        let slow = match worst.filter(|found| found.law != ContactLaw::Touch) {
            Some(found) => Some(Slow::Failed(Failure::Refused(found))),
            None if moved > stride => Some(Slow::Far { motion: moved }),
            None if self.source.stability(&self.state.at()).is_unstable() => Some(Slow::Unstable),
            None => None,
        };
        if let Some(slow) = slow {
            let why = match &slow {
                Slow::Failed(why) => why.clone(),
                _ => Failure::Restless {
                    steps: motion.steps,
                },
            };
            let slower = self.slow_down(slow);
            return slower.unwrap_or_else(|| self.end_motion(why));
        }
        if motion.coming_to_rest {
            // The other branch has a pace of its own.
            self.state.pace = Pace::default();
            let jumped = motion.travelled + moved > JUMP * self.model.length;
            self.state.watch = StabilityWatch::default();
            let landing = Landing {
                jumped,
                ..Landing::marked(worst)
            };
            return self.accept(after, verdict, landing);
        }
        let limit = self.state.controls.settings.search_limit;
        let spent = self.state.fallback.is_some() && self.state.searched.spent >= limit;
        if spent || motion.steps + 1 >= MOST_STEPS || motion.drag < SOFTEST * motion.stiffness {
            self.next_major();
            return self.end_motion(Failure::Restless {
                steps: motion.steps,
            });
        }
        self.step_on(motion, moved, stride, verdict)
    }

    /// The motion has failed: a search goes back to where it began.
    fn end_motion(&mut self, why: Failure) -> Outcome {
        let back = self.fall_back(&why);
        back.unwrap_or(Outcome::Failed(why))
    }

    /// Makes the end of a step the start of the next one.
    fn step_on(
        &mut self,
        mut motion: Motion,
        moved: f64,
        stride: f64,
        verdict: Verdict,
    ) -> Outcome {
        motion.steps += 1;
        motion.travelled += moved;
        motion.dissipated += motion.drag * self.square_of_motion();
        if moved < SHORT * stride {
            let room = SHORT * stride / moved.max(f64::MIN_POSITIVE);
            motion.drag /= room.clamp(1.0, FASTER);
        }
        let slow = moved < RESTING * stride && motion.drag < RESTING * motion.stiffness;
        if slow && motion.drag * AGAIN <= motion.tried {
            (motion.coming_to_rest, motion.tried) = (true, motion.drag);
        }
        self.state.motion = Some(motion);
        self.settle_contacts();
        self.renew_start(verdict);
        self.state.next.attempt += 1;
        self.state.begin();
        self.forget_workspace();
        Outcome::Moves(Moves::Step {
            motion: moved,
            number: motion.steps,
        })
    }

    /// Sum of the squares of all displacements since the start of the step.
    fn square_of_motion(&self) -> f64 {
        let (now, before) = (&self.state.u, &self.state.start.u);
        let of = |first: &usize| -> f64 {
            let square = |d: usize| (now[d] - before[d]).powi(2);
            square(*first) + square(first + 1)
        };
        self.model.dofs.first.iter().map(of).sum()
    }
}
