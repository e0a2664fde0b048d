//! Fallbacks: other ways to take an increment whose halves have all failed.
//!
//! Halves meet the same places again: a kink that the whole increment lands on is met by its halves, too. What fails with one
//! interpretation of T_max, or of where a node touches, need not fail with another; all are interpretations of the same laws, and the
//! judge checks the result. So the increment, from the last accepted state on, is tried
//!
//! 1. in two parts that are no halves: first the smaller part of the golden section, which no sum of halves meets;
//! 2. with T_max in the equations ([`crate::model::BoundUpdate::Consistent`]) from the first rung on;
//! 3. with nodes that touch held at the foot of where they were ([`crate::model::Touch::Start`]);
//! 4. with Newton's method on the first rung;
//! 5. with sliding held back ([`super::proximal`]): this one may end on another branch of equilibrium, marked.
//!
//! Each is cut into halves as before, and is in force until a part of the increment is accepted. If none helps, the last half is tried
//! once more without a fallback, so that the failed state is the one that the failure describes.

use super::{Effect, Recovery, Retry, Stalled};
use crate::model::{BoundUpdate, Jumps, Settings, Strategy, Touch};
use crate::step::event::{Failure, Outcome};
use crate::step::state::State;
use crate::step::sub_increment::SubIncrement;
use crate::strategy;
use serde::{Deserialize, Serialize};

/// A fallback.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fallback {
    /// First the smaller part of its golden section.
    Section,
    /// T_max in the equations from the first rung on.
    Consistent,
    /// Nodes that touch are held at the foot of where they were.
    Start,
    /// Newton's method on the first rung.
    Newton,
    /// Sliding is held back ([`super::proximal`]).
    Held,
    /// The last half again, as it was: nothing else helped.
    Back,
}

/// The fallback that is in force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FallbackState {
    /// Which.
    pub by: Fallback,
    /// The last half that failed without any.
    pub from: SubIncrement,
}

crate::words! {
    Fallback, words:
    Section "parts that are no halves",
    Consistent "T_max in the equations",
    Start "touching nodes held where they were",
    Newton "semismooth Newton first",
    Held "sliding held back",
    Back "the last half as it was, since nothing else helps",
}

impl Recovery for Fallback {
    fn propose(&self, why: &Failure, stalled: &Stalled<'_>) -> Option<Retry> {
        let state = stalled.state;
        let chosen = &state.controls.settings;
        if state.fallback.is_some_and(|route| route.by >= *self)
            || strategy::rungs(chosen.strategy).is_empty()
            || matches!(why, Failure::Leapt { .. }) && state.fallback.is_none()
            || !(stalled.size_helps(why) || stalled.drowned(why))
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
            Fallback::Held | Fallback::Back => from,
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
        .fallback
        .map_or(state.sub_increment, |route| route.from)
}

impl Fallback {
    /// Whether it may help after this failure. Where all bodies are given by numbers it is the interface problem itself that fails, of
    /// which the ladder has tried all that it knows; there sliding can be held back at most.
    fn helps(self, why: &Failure, stalled: &Stalled<'_>) -> bool {
        let state = stalled.state;
        if self == Fallback::Back {
            return state.fallback.is_some();
        }
        if matches!(why, Failure::Inverted(_)) {
            return false;
        }
        match self {
            Fallback::Held => stalled.can_hold(why),
            Fallback::Section => {
                let rest = last_half(state).rest(state.start.load_factor);
                // What the scene names as the least is one; else the section may be finer than a 64th.
                let least = stalled.model.least;
                !stalled.is_given() && least.is_none_or(|least| rest.section().size() >= least)
            }
            _ => !stalled.is_given() && self.changes(&state.controls.settings),
        }
    }

    /// Whether it changes these settings.
    fn changes(self, chosen: &Settings) -> bool {
        let first = strategy::in_force(chosen, 0);
        self.in_force(first, 0) != first
    }

    /// What it makes of the settings in force on a rung.
    pub(in crate::step) fn in_force(self, mut settings: Settings, rung: usize) -> Settings {
        match self {
            Fallback::Section | Fallback::Held | Fallback::Back => {}
            Fallback::Consistent => settings.t_max = BoundUpdate::Consistent,
            Fallback::Start => settings.touch = Touch::Start,
            Fallback::Newton if rung == 0 => {
                settings.strategy = Strategy::Newton;
                settings.t_max = strategy::method(Strategy::Newton).bound(settings.t_max);
            }
            Fallback::Newton => {}
        }
        settings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        for by in [Fallback::Consistent, Fallback::Start, Fallback::Newton] {
            assert!(by.changes(&plain), "{by:?}");
            assert_eq!(by.changes(&own), by == Fallback::Newton, "{by:?}");
        }
    }
}
