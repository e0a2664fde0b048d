//! Position of a slave node relative to its surface during a major iteration, and its motion in a solve.
//!
//! If a bond has a compliance ([`Bond::Giving`]), springs c = (c_n, c_t) connect the node S to a point S' that obeys the laws of
//! hard contact and rigid stick instead of S. With the total forces F on the node,
//!
//! ```text
//! x_S' = x_S + c_n F_n n + c_t F_t t,     g' = g + c_n F_n,     v' = v − c ΔF,     slip' = slip − c_t F_t
//! ```
//!
//! for the gap, the relative motion v = Δu_S* − Δu_S and the slip. In the problem of forces and motions at the interface, v = −W
//! F + …, this adds c to the diagonal of W. All mode decisions use S': here `gap` and `motion` are those of S'.

use crate::model::Bond;
use crate::{Equation, RelativeMotion};
use serde::{Deserialize, Serialize};

/// Geometry of a slave node, frozen during a major iteration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NodeKinematics {
    /// Gap g' of the touching point (length); negative is penetration. Equals that of the node if its bond is hard.
    pub gap: f64,
    /// Outward normal n at S* (unit).
    pub normal: [f64; 2],
    /// Position of S*.
    pub foot: [f64; 2],
    /// Distances along −t and +t that S* may move until its side meets the next one at an angle (length). `None` if it does not.
    #[serde(default, skip_serializing_if = "is_endless")]
    pub room: [Option<f64>; 2],
    /// Whether the normal and the tangential motion contain an unknown. If not, the supports carry that force.
    pub moves: [bool; 2],
    /// Contact law.
    #[serde(default, skip_serializing_if = "Bond::is_hard")]
    pub bond: Bond,
}

impl NodeKinematics {
    /// The remaining distance for a motion of S* relative to S along t (length): S* itself moves in the opposite direction along
    /// the surface. `None` if the side does not end at an angle.
    pub fn room_for(&self, motion: f64) -> Option<f64> {
        self.room[usize::from(motion < 0.0)]
    }
}

/// Converts an equation of the touching point S' to one of the node S, for compliances between them (length per force): v' = v −
/// c ΔF.
pub fn through(row: Equation, give: [f64; 2]) -> Equation {
    match row.motion {
        RelativeMotion::None => row,
        RelativeMotion::Normal => Equation {
            d_n: row.d_n - give[0],
            ..row
        },
        RelativeMotion::Tangential => Equation {
            d_t: row.d_t - give[1],
            ..row
        },
    }
}

fn is_endless(room: &[Option<f64>; 2]) -> bool {
    room.iter().all(Option::is_none)
}

/// Result of a solve at a slave node; normal and tangential components.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct NodeIncrement {
    /// Increments ΔF_n, ΔF_t of the force on the slave node.
    pub force: [f64; 2],
    /// Motion of S* relative to S, or to the touching point S' if the bond has a compliance: Δu_nS* − Δu_nS, Δu_tS* − Δu_tS
    /// (length).
    pub motion: [f64; 2],
}
