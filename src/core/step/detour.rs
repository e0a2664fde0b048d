//! Ways round an increment whose halves have all failed: other sizes, and other readings of the minor iterations.
//!
//! Halves meet the same places again and again: a kink that the whole increment lands on is met by its halves, too. What
//! fails with one reading of T_max, or of where a node touches, need not fail with another; all of them are readings of the same
//! laws, and the judge looks at what they come to. So the increment, from the last accepted state on, is tried
//!
//! 1. in two parts that are no halves: first the smaller part of the golden section, which no sum of halves meets;
//! 2. with T_max in the equations ([`crate::model::BoundUpdate::Consistent`]) from the first rung on;
//! 3. with nodes that touch held at the foot of where they were ([`crate::model::Touch::Start`]);
//! 4. with Newton's method on the first rung;
//! 5. with sliding held back ([`crate::step::brake`]): alone of these it may end on another branch of equilibrium, marked.
//!
//! Each of them is cut into halves as before, and holds until a part of the increment is accepted; then everything is as the
//! settings have it. Where none helps, the last half is tried once more as it was at first, so that the state in which the
//! increment fails is the one that its failure tells of. An increment that can be accepted without comes here never.

use crate::model::{BoundUpdate, Settings, Strategy, Touch};
use crate::step::sub_increment::SubIncrement;
use crate::strategy;
use serde::{Deserialize, Serialize};

/// A way round an increment that fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Detour {
    /// First the smaller part of its golden section.
    Section,
    /// T_max in the equations from the first rung on.
    Consistent,
    /// Nodes that touch are held at the foot of where they were.
    Start,
    /// Newton's method on the first rung.
    Newton,
    /// Sliding is held back ([`crate::step::brake`]).
    Held,
    /// The last half again, as it was: nothing else helped.
    Back,
}

/// The detours that are tried, one after the other.
const DETOURS: [Detour; 6] = [
    Detour::Section,
    Detour::Consistent,
    Detour::Start,
    Detour::Newton,
    Detour::Held,
    Detour::Back,
];

/// The detour that an increment is on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Route {
    /// Which.
    pub by: Detour,
    /// The last half that failed without any.
    pub from: SubIncrement,
}

crate::words! {
    Detour, words:
    Section "parts that are no halves",
    Consistent "T_max in the equations",
    Start "touching nodes held where they were",
    Newton "semismooth Newton first",
    Held "sliding held back",
    Back "the last half as it was, since nothing else helps",
}

impl Detour {
    /// The next one that changes anything of these settings.
    pub(super) fn after(last: Option<Detour>, chosen: &Settings) -> Option<Detour> {
        let next = last.map_or(0, |last| last as usize + 1);
        let changes = |detour: &Detour| match detour {
            Detour::Section | Detour::Held | Detour::Back => true,
            _ => detour.in_force(strategy::in_force(chosen, 0), 0) != strategy::in_force(chosen, 0),
        };
        DETOURS[next.min(DETOURS.len())..]
            .iter()
            .copied()
            .find(changes)
    }

    /// What it makes of the settings in force on a rung.
    pub(super) fn in_force(self, mut settings: Settings, rung: usize) -> Settings {
        match self {
            Detour::Section | Detour::Held | Detour::Back => {}
            Detour::Consistent => settings.t_max = BoundUpdate::Consistent,
            Detour::Start => settings.touch = Touch::Start,
            Detour::Newton if rung == 0 => {
                settings.strategy = Strategy::Newton;
                settings.t_max = strategy::method(Strategy::Newton).bound(settings.t_max);
            }
            Detour::Newton => {}
        }
        settings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_detour_is_taken_once_and_what_the_settings_have_already_is_left_out() {
        let all = |chosen: &Settings| {
            let mut last = None;
            std::iter::from_fn(|| {
                last = Detour::after(last, chosen);
                last
            })
            .take(10)
            .collect::<Vec<_>>()
        };
        let plain = Settings {
            touch: Touch::Ratio,
            ..Settings::default()
        };
        assert_eq!(all(&plain), DETOURS);
        let own = Settings {
            touch: Touch::Start,
            t_max: BoundUpdate::Consistent,
            ..plain
        };
        let left = [Detour::Section, Detour::Newton, Detour::Held, Detour::Back];
        assert_eq!(all(&own), left);
    }
}
