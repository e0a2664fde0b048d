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
//! Where `settings.search` allows it, the search goes on:
//!
//! 6. with parts down to a 4096th of the least increment;
//! 7. with the loads of the last equilibrium, from which the nodes move damped to the next one ([`super::damped`]), which is marked.
//!
//! Before all others, where nothing holds a body at the start of the history, nodes that touch without a gap start fixed.
//!
//! Each is cut into halves as before, and is in force until a part of the increment is accepted. If none helps, the last half is tried
//! once more without a fallback, so that the failed state is the one that the failure describes.

use crate::model::{BoundUpdate, Settings, Strategy, Touch};
use crate::step::sub_increment::SubIncrement;
use crate::strategy;
use serde::{Deserialize, Serialize};

/// How far below the least increment the search cuts.
pub(super) const DEEPER: f64 = 4096.0;

/// A fallback.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fallback {
    /// Nodes that touch at the start of the history, without a gap, start fixed.
    Touching,
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
    /// Parts smaller than the least increment.
    Deeper,
    /// A damped motion from the last equilibrium.
    Release,
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
    Touching "nodes that touch at the start held",
    Section "parts that are no halves",
    Consistent "T_max in the equations",
    Start "touching nodes held where they were",
    Newton "semismooth Newton first",
    Held "sliding held back",
    Deeper "parts below the least increment",
    Release "a damped motion from the last equilibrium",
    Back "the last half as it was, since nothing else helps",
}

impl Fallback {
    /// Whether it is part of the search ([`crate::model::SearchMode`]).
    pub(in crate::step) fn searches(self) -> bool {
        matches!(
            self,
            Fallback::Touching | Fallback::Deeper | Fallback::Release
        )
    }

    /// What it makes of the settings in force on a rung.
    pub(in crate::step) fn in_force(self, mut settings: Settings, rung: usize) -> Settings {
        match self {
            Fallback::Touching
            | Fallback::Section
            | Fallback::Held
            | Fallback::Deeper
            | Fallback::Release
            | Fallback::Back => {}
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
