//! Fallbacks: other ways to solve an increment if all its halves have failed.
//!
//! Halving meets the same points again: a kink at the end of the whole increment is also the end of one of its halves. An
//! increment that fails with one interpretation of T_max, or of the point of contact, may succeed with another; all are
//! interpretations of the same laws, and the judge checks the result. So the increment is tried from the last accepted state
//!
//! 1. in two unequal parts: first the smaller part of the golden section, which no sum of halves equals;
//! 2. with T_max in the equations ([`crate::model::BoundUpdate::Consistent`]) from the first rung on;
//! 3. with touching nodes held at the projections of their start positions ([`crate::model::Touch::Start`]);
//! 4. with sliding held back ([`super::proximal`]): this one may end on another branch of equilibrium, marked.
//!
//! If `settings.search` allows it, the search continues:
//!
//! 5. with the change of the contact geometry in the tangent ([`Geometry::Consistent`]), if the scene freezes it: without it, the
//!    major iterations may diverge or cycle however small the increment. It stays in force in the following increments;
//! 6. with parts down to 1/4096 of the least increment;
//! 7. with the loads of the last equilibrium, from which a damped motion leads to the next one (`damped`), which is
//!    marked;
//! 8. in parts of twice the increment: past the end of this one there may be an equilibrium again. The part is marked as a jump.
//!
//! Before all others, if a body is unsupported at the start of the history, near contacts start closed.
//!
//! Each fallback is cut into halves as before and stays in force until a part of the increment is accepted. If none helps, the
//! last half is repeated without a fallback, so that the failed state matches the reported failure.

use crate::model::{Geometry, Touch};
use crate::{BoundUpdate, Settings, SubIncrement};
use serde::{Deserialize, Serialize};

/// Factor by which the search cuts below the least increment.
pub(super) const DEEPER: f64 = 4096.0;

crate::words! {
    /// A fallback. They are tried in the order of the list in [`super`]; digests of states contain their places here, so a new one
    /// comes last.
    #[derive(Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Fallback, words {
        /// Contacts with a small gap at the start of the history are closed.
        Touching "near contacts closed at the start",
        /// The smaller part of the golden section first.
        Section "unequal parts",
        /// T_max in the equations from the first strategy on.
        Consistent "t_max: consistent",
        /// Touching nodes are held at the projections of their start positions.
        Start "touch: start",
        /// Sliding is held back ([`super::proximal`]).
        Held "held-back sliding",
        /// Parts smaller than the least increment.
        Deeper "parts below the least increment",
        /// A damped motion from the last equilibrium.
        Release "a damped motion from the last equilibrium",
        /// The last half without a fallback: nothing else helped.
        Back "the last part without a fallback, since none has helped",
        /// The change of the contact geometry in the tangent, in this increment and all that follow.
        Geometry "geometry: consistent",
        /// Twice the increment from the last equilibrium, past the end of this one, and its halves.
        Longer "parts of twice the increment",
    }
}

/// The fallback that is in force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FallbackState {
    /// Kind of fallback.
    pub by: Fallback,
    /// The last half that failed without a fallback.
    pub from: SubIncrement,
}

impl Fallback {
    /// Whether it belongs to the search ([`crate::model::SearchBudget`]).
    pub(in crate::step) fn searches(self) -> bool {
        matches!(
            self,
            Fallback::Touching
                | Fallback::Geometry
                | Fallback::Deeper
                | Fallback::Release
                | Fallback::Longer
        )
    }

    /// The settings in force with this fallback.
    pub fn in_force(self, mut settings: Settings) -> Settings {
        match self {
            Fallback::Touching
            | Fallback::Section
            | Fallback::Held
            | Fallback::Deeper
            | Fallback::Release
            | Fallback::Longer
            | Fallback::Back => {}
            Fallback::Consistent => settings.t_max = BoundUpdate::Consistent,
            Fallback::Start => settings.touch = Touch::Start,
            Fallback::Geometry => settings.geometry = Geometry::Consistent,
        }
        settings
    }
}
