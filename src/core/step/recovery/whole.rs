//! Takes the whole increment if the halves that check it for a jump to another branch ([`crate::step::jump`]) have failed. Near a
//! limit point the halves may have no equilibrium although the whole increment has one beyond it.

use super::retry::{Effect, Recovery, Retry};
use super::stalled::FailedIncrement;
use crate::model::Jumps;
use crate::strategy;
use crate::{Failure, Outcome};

pub(super) struct WholeIncrement;

impl Recovery for WholeIncrement {
    fn name(&self) -> &'static str {
        "whole"
    }

    fn propose(&self, why: &Failure, stalled: &FailedIncrement<'_>) -> Option<Retry> {
        let state = stalled.state;
        let rungs = strategy::rungs(state.controls.settings.strategy);
        let cuts = !rungs.is_empty() && stalled.model.jumps == Jumps::Cut;
        if !cuts
            || matches!(why, Failure::BranchJump { .. })
            || !stalled.size_helps(why)
            || stalled.is_exhausted()
        {
            return None;
        }
        let from = state.start.load_factor;
        let part = state.record.pace.suspect?.sub_increment.remaining(from);
        let (why, size) = (why.clone(), (part.target() - from).abs());
        Some(Retry {
            part,
            effect: Effect::Whole,
            outcome: Outcome::WholeIncrement { why, size },
        })
    }
}
