//! Damped motion past a limit point (`history.jumps: dynamic`): from the last equilibrium to the next stable one.
//!
//! If an increment fails that is as small as `settings.limit_load` allows, the loads are kept constant, and the out-of-balance
//! force moves the nodes against a viscosity c, equal for all displacements (rotations and unknown forces follow without
//! viscosity):
//!
//! ```text
//! c u̇ = R(u),      backward Euler:   R(u_k) − (c / Δt) (u_k − u_k−1) = 0
//! ```
//!
//! Each step is an increment with Tables 1 and 2, judge and strategies, and with c / Δt, the *drag*, on the diagonal of the
//! tangent; friction continues from the end of each step. c only sets the unit of time and is 1; the drag is what is chosen. It
//! starts at the interface's stiffness and is divided by up to [`FASTER`] after a short step. It is multiplied by [`FASTER`] if a
//! step fails, moves further than [`STRIDE`], or ends in a state that is unstable even with the drag, since a backward Euler step
//! then reaches another root than the motion does.
//!
//! If steps are small although the drag is small, the drag is removed. If the result is a stable equilibrium within a stride, it
//! is accepted and marked as a jump; otherwise the motion continues. Viscosity only dissipates work, Σ (c / Δt) |Δu|²; the sum is
//! reported.

use super::fallback::Fallback;
use super::motion::Motion;
use super::retry::{Effect, Recovery, Retry};
use super::stalled::FailedIncrement;
use crate::linear::source::AcceptedState;
use crate::step::event::SmallerStepReason;
use crate::step::jump::AcceptanceNotes;
use crate::{
    Failure, Finding, JudgedLaw, LinearisationPoint, MotionEvent, Norms, Outcome, Pace, Stepper,
    SubIncrement, Verdict,
};

use crate::step::iterate::Iterate;
use crate::step::verdict::worst_of;
use crate::step::watch::StabilityWatch;
use std::sync::Arc;

/// Maximum displacement of a step, relative to the scene's length.
const STRIDE: f64 = 0.01;
/// A step shorter than this fraction of a stride may be followed by a faster one.
const SHORT: f64 = 0.25;
/// Factor by which the drag changes.
const FASTER: f64 = 4.0;
/// The motion may be at rest if a step is below this fraction of a stride and the drag is below this fraction of the stiffness.
const RESTING: f64 = 0.01;
/// Factor by which the drag must have fallen before rest is tried again.
const AGAIN: f64 = 64.0;
/// Maximum drag over stiffness: a step that fails with it does not fail because it moves too far.
const STIFFEST: f64 = 1e9;
/// Minimum drag over stiffness: nodes that still move at this drag will never rest.
const SOFTEST: f64 = 1e-12;
/// A motion below this fraction of the scene's length is not a jump: the increment failed for a reason other than a limit point.
const JUMP: f64 = 1e-3;
/// Maximum number of steps of a motion.
const MOST_STEPS: u32 = 5000;

/// Starts a damped motion from the last equilibrium after the smallest increment has failed.
pub(super) struct Release;

impl Recovery for Release {
    fn name(&self) -> &'static str {
        "release"
    }

    fn propose(&self, why: &Failure, stalled: &FailedIncrement<'_>) -> Option<Retry> {
        let helps = stalled.size_helps(why) || matches!(why, Failure::Singular(_));
        let (why, load) = (why.clone(), stalled.state.start.load_factor);
        (helps && stalled.can_move()).then_some(Retry {
            part: stalled.state.sub_increment,
            effect: Effect::Release,
            outcome: Outcome::Motion(MotionEvent::DynamicStart { why, load }),
        })
    }
}

/// Repeats a step of the damped motion more slowly.
pub(super) struct SlowerMotion;

impl Recovery for SlowerMotion {
    fn name(&self) -> &'static str {
        "slower"
    }

    fn propose(&self, why: &Failure, stalled: &FailedIncrement<'_>) -> Option<Retry> {
        slower(SmallerStepReason::Failed(why.clone()), stalled)
    }
}

/// Repeats the step with more drag, or continues the motion after a premature attempt at rest.
fn slower(slow: SmallerStepReason, stalled: &FailedIncrement<'_>) -> Option<Retry> {
    if stalled.state.recovery.fallback.is_some() && !stalled.searches(Fallback::Release) {
        return None;
    }
    let mut motion = stalled.state.recovery.motion?;
    if motion.coming_to_rest {
        motion.coming_to_rest = false;
    } else if motion.drag < STIFFEST * motion.stiffness {
        motion.drag *= FASTER;
        motion.slowed = stalled.state.recovery.fallback.is_some();
    } else {
        return None;
    }
    Some(Retry {
        part: stalled.state.sub_increment,
        effect: Effect::Motion(motion),
        outcome: Outcome::Motion(MotionEvent::Slower(slow)),
    })
}

impl Stepper {
    /// Repeats a step more slowly. `None` if the maximum drag is reached.
    fn slow_down(&mut self, slow: SmallerStepReason) -> Option<Outcome> {
        let retry = slower(slow, &self.now.stalled())?;
        self.now.try_again(retry)
    }

    /// Ends a converged step without violations that could be repaired.
    pub(in crate::step) fn end_step(
        &mut self,
        after: Norms,
        verdict: Verdict,
        worst: Option<Finding>,
    ) -> Outcome {
        let Some(motion) = self.now.state.recovery.motion else {
            return self
                .now
                .accept(after, verdict, AcceptanceNotes::marked(worst));
        };
        let moved = self
            .now
            .source
            .moved(&self.now.state.u, &self.now.state.start.u);
        let stride = STRIDE * self.now.model.length;
        let slow = match worst.filter(|found| found.law != JudgedLaw::Touch) {
            Some(found) => Some(SmallerStepReason::Failed(Failure::Refused(found))),
            None if moved > stride => Some(SmallerStepReason::Far { motion: moved }),
            None if self
                .now
                .source
                .stability(&self.now.state.at())
                .is_unstable() =>
            {
                Some(SmallerStepReason::Unstable)
            }
            None => None,
        };
        if let Some(slow) = slow {
            let why = match &slow {
                SmallerStepReason::Failed(why) => why.clone(),
                _ => Failure::NoRest {
                    steps: motion.steps,
                },
            };
            let slower = self.slow_down(slow);
            return slower.unwrap_or_else(|| self.end_motion(why));
        }
        if motion.coming_to_rest {
            let far = motion.travelled + moved > JUMP * self.now.model.length;
            let jumped = far || self.now.violates_since_origin(&after);
            // The other branch has a different pace.
            self.now.state.record.pace = Pace::default();
            self.now.state.record.watch = StabilityWatch::default();
            let landing = AcceptanceNotes {
                jumped,
                ..AcceptanceNotes::marked(worst)
            };
            return self.now.accept(after, verdict, landing);
        }
        let spent = self.now.state.recovery.fallback.is_some()
            && !self.now.stalled().searches(Fallback::Release);
        if spent || motion.steps + 1 >= MOST_STEPS || motion.drag < SOFTEST * motion.stiffness {
            self.now.state.next_major();
            return self.end_motion(Failure::NoRest {
                steps: motion.steps,
            });
        }
        self.now.step_on(motion, moved, stride, verdict)
    }

    /// Ends a failed motion: a search returns to its start.
    fn end_motion(&mut self, why: Failure) -> Outcome {
        let back = self.fall_back(&why);
        back.unwrap_or(Outcome::Failed(why))
    }
}

impl Iterate {
    /// Whether the state violates a law over the whole damped motion of a search, as it does if a node slides and sticks again on
    /// the way. It then depends on the motion, however small that is.
    fn violates_since_origin(&mut self, after: &Norms) -> bool {
        let Some(origin) = self.state.record.searched.origin.clone() else {
            return false;
        };
        let at = LinearisationPoint {
            accepted: AcceptedState {
                u: &origin.u,
                history: &origin.history,
                contacts: &origin.nodes,
            },
            ..self.state.at()
        };
        let worst = worst_of(&self.source.judge(&at, after));
        worst.is_some_and(|found| found.law != JudgedLaw::Touch)
    }

    /// Prepares a damped motion from the last equilibrium, with constant loads. `None` if the state there cannot be linearised.
    pub(super) fn release(&mut self, part: SubIncrement) -> Option<()> {
        self.restart(part);
        if !self.linearise() {
            return None;
        }
        let (from, stiffness) = (self.state.start.load_factor, self.source.spring());
        self.state.recovery.motion = Some(Motion::new(from, stiffness));
        Arc::make_mut(&mut self.state.start).load_factor = self.state.load_factor;
        Some(())
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
        motion.dissipated += motion.drag * square_of_motion(self);
        // With less drag the next step would probably fail like this one, which costs a search the whole ladder.
        let keeps = std::mem::take(&mut motion.slowed);
        if moved < SHORT * stride && !keeps {
            let room = SHORT * stride / moved.max(f64::MIN_POSITIVE);
            motion.drag /= room.clamp(1.0, FASTER);
        }
        let slow = moved < RESTING * stride && motion.drag < RESTING * motion.stiffness;
        if slow && motion.drag * AGAIN <= motion.tried {
            (motion.coming_to_rest, motion.tried) = (true, motion.drag);
        }
        self.state.recovery.motion = Some(motion);
        self.settle_contacts();
        self.renew_start(verdict);
        self.state.next.attempt += 1;
        self.state.begin();
        self.forget_workspace();
        Outcome::Motion(MotionEvent::Step {
            motion: moved,
            number: motion.steps,
        })
    }
}

/// Sum of the squares of all displacements since the start of the step.
fn square_of_motion(iterate: &Iterate) -> f64 {
    let (now, before) = (&iterate.state.u, &iterate.state.start.u);
    iterate
        .model
        .dofs
        .first
        .iter()
        .map(|first| -> f64 {
            let square = |d: usize| (now[d] - before[d]).powi(2);
            square(*first) + square(first + 1)
        })
        .sum()
}
