//! Smaller increments: half the load, or a shorter arc.

use super::path_corner::smaller_arc;
use super::retry::{Effect, Recovery, Retry};
use super::stalled::FailedIncrement;
use crate::model::ArcLength;
use crate::step::arc_state::ROUNDING;
use crate::strategy;
use crate::{Failure, Outcome};

/// Half the increment, unless it is the smallest or the strategy does not cut.
pub(super) struct IncrementCut;

impl Recovery for IncrementCut {
    fn name(&self) -> &'static str {
        "halve"
    }

    fn propose(&self, why: &Failure, stalled: &FailedIncrement<'_>) -> Option<Retry> {
        if !stalled.size_helps(why) || stalled.is_exhausted() {
            return None;
        }
        let part = stalled.state.sub_increment.halved();
        let least = stalled.least() * (1.0 - ROUNDING);
        let rungs = strategy::rungs(stalled.state.controls.settings.strategy);
        let cuts = !rungs.is_empty() || stalled.can_move();
        if !cuts || part.size() < least || part.size() == 0.0 {
            return None;
        }
        let (why, size, slave) = (why.clone(), part.size(), why.culprit());
        Some(Retry {
            part,
            effect: Effect::Cut(slave),
            outcome: Outcome::Cut { why, size },
        })
    }
}

/// Along the path: half the arc, or the arc to the next corner, for every strategy. The arc control sets the size.
pub(super) struct ShorterArc;

impl Recovery for ShorterArc {
    fn name(&self) -> &'static str {
        "shorter-arc"
    }

    fn propose(&self, why: &Failure, stalled: &FailedIncrement<'_>) -> Option<Retry> {
        if !stalled.size_helps(why) {
            return None;
        }
        let way = stalled.state.way.as_ref();
        let mut way = way.filter(|way| way.known || way.turned)?.clone();
        let least = stalled.model.arc.least;
        let least = least.unwrap_or(ArcLength::LEAST * way.first);
        let size = smaller_arc(&way);
        if size < least * (1.0 - ROUNDING) {
            return None;
        }
        way.step = size;
        if way.turned {
            (way.turned, way.known) = (false, false);
        }
        let why = why.clone();
        Some(Retry {
            part: stalled.state.sub_increment,
            effect: Effect::Path(way),
            outcome: Outcome::Cut { why, size },
        })
    }
}
