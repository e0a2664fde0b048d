//! Decides when a fallback is used, and for which part of the increment.

use super::FALLBACKS;
use super::fallback::{DEEPER, Fallback, FallbackState};
use super::retry::{Effect, Recovery, Retry};
use super::stalled::FailedIncrement;
use crate::model::Jumps;
use crate::strategy;
use crate::{Failure, Outcome, Settings, State, SubIncrement};
use std::cmp::Ordering;

impl Recovery for Fallback {
    fn name(&self) -> &'static str {
        match self {
            Fallback::Touching => "touching",
            Fallback::Section => "section",
            Fallback::Consistent => "consistent",
            Fallback::Start => "start",
            Fallback::Held => "held",
            Fallback::Geometry => "geometry",
            Fallback::Deeper => "deeper",
            Fallback::Release => "motion",
            Fallback::Longer => "longer",
            Fallback::Back => "back",
        }
    }

    fn propose(&self, why: &Failure, stalled: &FailedIncrement<'_>) -> Option<Retry> {
        let state = stalled.state;
        let chosen = &state.controls.settings;
        let tried = state.recovery.fallback.map(|route| route.by);
        let out_of_turn = match (state.record.searched.adopted, tried) {
            // The one that helped last came first; the others follow in their order.
            (Some(adopted), Some(by)) if adopted == by => adopted == *self,
            (_, tried) => tried.is_some_and(|by| by >= *self),
        };
        if out_of_turn
            || strategy::rungs(chosen.strategy).is_empty()
            || matches!(why, Failure::BranchJump { .. }) && state.recovery.fallback.is_none()
            || !(matches!(self, Fallback::Touching | Fallback::Back)
                || stalled.size_helps(why)
                || stalled.drowned(why))
            || state.way.is_some()
            || stalled.model.jumps == Jumps::Dynamic
            || !self.helps(why, stalled)
        {
            return None;
        }
        let (by, from) = (*self, last_half(state));
        let rest = from.rest(state.start.load_factor);
        let part = match by {
            Fallback::Section => rest.section(),
            Fallback::Touching => state.sub_increment,
            Fallback::Deeper => from.halved(),
            Fallback::Release => state.sub_increment,
            Fallback::Held | Fallback::Back => from,
            Fallback::Longer => stalled.longer(from.rest.unwrap_or(from.to))?,
            _ => rest,
        };
        let (why, size) = (why.clone(), part.size());
        Some(Retry {
            part,
            effect: Effect::Fallback(FallbackState { by, from }),
            outcome: Outcome::Fallback { why, by, size },
        })
    }
}

/// The last half of the increment that failed before any fallback.
fn last_half(state: &State) -> SubIncrement {
    state
        .recovery
        .fallback
        .map_or(state.sub_increment, |route| route.from)
}

/// In the order in which they are tried.
impl Ord for Fallback {
    fn cmp(&self, other: &Self) -> Ordering {
        self.turn().cmp(&other.turn())
    }
}

impl PartialOrd for Fallback {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Fallback {
    /// Place in the order in which fallbacks are tried.
    fn turn(self) -> Option<usize> {
        FALLBACKS
            .iter()
            .position(|listed| listed.name() == self.name())
    }

    /// Whether the fallback may help after this failure. If all bodies are given as matrices, the interface problem itself fails,
    /// and the ladder has already tried every strategy; at most, sliding can be held back.
    fn helps(self, why: &Failure, stalled: &FailedIncrement<'_>) -> bool {
        let state = stalled.state;
        if self == Fallback::Back {
            return state.recovery.fallback.is_some();
        }
        if self.searches() && !stalled.searches(self) {
            return false;
        }
        if matches!(why, Failure::Inverted(_)) && !self.searches() {
            return false;
        }
        match self {
            Fallback::Touching => stalled.can_touch(why),
            // The least increment of the scene applies if it is set.
            Fallback::Deeper => {
                stalled.model.least.is_none()
                    && last_half(state).size() > state.controls.least / DEEPER
            }
            Fallback::Release => stalled.can_release(),
            Fallback::Held => stalled.can_hold(why),
            Fallback::Longer => true,
            Fallback::Section => {
                let rest = last_half(state).rest(state.start.load_factor);
                // Without a least increment of the scene, the section may be smaller than 1/64.
                let least = stalled.model.least;
                !stalled.is_given() && least.is_none_or(|least| rest.section().size() >= least)
            }
            Fallback::Geometry if state.record.searched.geometry => false,
            _ => !stalled.is_given() && self.changes(&state.controls.settings),
        }
    }

    /// Whether the fallback changes these settings.
    fn changes(self, chosen: &Settings) -> bool {
        let first = strategy::in_force(chosen, 0, 0);
        self.in_force(first) != first
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{BoundUpdate, Touch};

    #[test]
    fn a_fallback_that_the_settings_have_already_is_left_out() {
        let plain = Settings {
            touch: Touch::Ratio,
            ..Settings::default()
        };
        let own = Settings {
            touch: Touch::Start,
            t_max: BoundUpdate::Consistent,
            ..plain
        };
        for by in [Fallback::Consistent, Fallback::Start] {
            assert!(by.changes(&plain), "{by:?}");
            assert!(!by.changes(&own), "{by:?}");
        }
    }
}
