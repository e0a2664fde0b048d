//! A recovery, and what it proposes.

use super::fallback::FallbackState;
use super::motion::Motion;
use super::stalled::Stalled;
use crate::step::event::{Failure, Outcome};
use crate::step::sub_increment::SubIncrement;
use crate::step::way::Way;

/// One way to start an increment again.
pub(super) trait Recovery: Sync {
    /// Its name, for [`crate::step::stepper::Stepper::leave_out`].
    fn name(&self) -> &'static str;

    /// What to try after the failure `why`. `None` if this recovery does not apply, or has been tried.
    fn propose(&self, why: &Failure, stalled: &Stalled<'_>) -> Option<Retry>;
}

/// How to start an increment again.
pub(in crate::step) struct Retry {
    /// The part of it that is tried.
    pub(super) part: SubIncrement,
    /// What it changes in the state.
    pub(super) effect: Effect,
    /// What is reported.
    pub(super) outcome: Outcome,
}

/// What a recovery changes in the state.
pub(super) enum Effect {
    /// One more cut, because of this slave node if any.
    Cut(Option<usize>),
    /// The arc and the corner of the path.
    Path(Box<Way>),
    /// The increment is accepted although it jumps.
    Whole,
    /// The loads stay, and a damped motion begins.
    Release,
    /// Another drag of the damped motion.
    Motion(Motion),
    /// The fallback.
    Fallback(FallbackState),
}
