//! The trait of recoveries, and their proposals.

use super::fallback::FallbackState;
use super::motion::Motion;
use super::stalled::FailedIncrement;
use crate::step::arc_state::ArcState;
use crate::{Failure, Outcome, SubIncrement};

/// One way to restart an increment.
pub(super) trait Recovery: Sync {
    /// Its name, for [`crate::step::stepper::Stepper::leave_out`].
    fn name(&self) -> &'static str;

    /// What to try after the failure `why`. `None` if this recovery does not apply or has been tried.
    fn propose(&self, why: &Failure, stalled: &FailedIncrement<'_>) -> Option<Retry>;
}

/// How to restart an increment.
pub(in crate::step) struct Retry {
    /// The part of the increment that is tried.
    pub(super) part: SubIncrement,
    /// The change of the state.
    pub(super) effect: Effect,
    /// The reported outcome.
    pub(super) outcome: Outcome,
}

/// Change of the state by a recovery.
pub(super) enum Effect {
    /// One more cut, attributed to this slave node, if any.
    Cut(Option<usize>),
    /// The arc and the corner of the path.
    Path(Box<ArcState>),
    /// The increment is accepted although it jumps.
    Whole,
    /// The loads are kept constant, and a damped motion begins.
    Release,
    /// Another drag of the damped motion.
    Motion(Motion),
    /// The fallback.
    Fallback(FallbackState),
}
