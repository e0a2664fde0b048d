//! How a slave node stands over its surface during a major iteration, and how a solve moves it there.
//!
//! Where a bond gives way ([`Bond::Giving`]), springs c = (c_n, c_t) stand between the node S and a point S' that obeys the
//! laws of hard contact and rigid sticking in its place. With total forces F on the node,
//!
//! ```text
//! x_S' = x_S + c_n F_n n + c_t F_t t,     g' = g + c_n F_n,     v' = v − c ΔF,     slip' = slip − c_t F_t
//! ```
//!
//! for the gap, the relative motion v = Δu_S* − Δu_S and the slip. In the problem of forces and motions at the interface, v = −W F + …,
//! that adds c to the diagonal of W. All that decides about modes sees S': here `gap` and `motion` are those of S'.

use crate::contact::table1::{Equation, Motion};
use crate::model::Bond;
use serde::{Deserialize, Serialize};

/// A slave node's surroundings, frozen during a major iteration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NodeKinematics {
    /// Gap g' of the touching point (length); negative is penetration. That of the node itself where its bond is hard.
    pub gap: f64,
    /// Outward normal n at S* (unit).
    pub normal: [f64; 2],
    /// Position of S*.
    pub foot: [f64; 2],
    /// Ways that S* may go along −t and along +t until its side ends at an angle to the next one (length). `None` where it
    /// does not.
    #[serde(default, skip_serializing_if = "is_endless")]
    pub room: [Option<f64>; 2],
    /// Whether any unknown takes part in the normal and in the tangential motion. If not, the supports carry that force.
    pub moves: [bool; 2],
    /// What holds where it touches.
    #[serde(default, skip_serializing_if = "Bond::is_hard")]
    pub bond: Bond,
}

impl NodeKinematics {
    /// The room that is left in the direction of a motion of S* relative to S along t (length): S* goes the other way along
    /// the surface. `None` where the side does not end at an angle.
    pub fn room_for(&self, motion: f64) -> Option<f64> {
        self.room[usize::from(motion < 0.0)]
    }
}

/// An equation of the touching point S' as one of the node S, for compliances between them (length by force): v' = v − c ΔF.
pub fn through(row: Equation, give: [f64; 2]) -> Equation {
    match row.motion {
        Motion::None => row,
        Motion::Normal => Equation {
            d_n: row.d_n - give[0],
            ..row
        },
        Motion::Tangential => Equation {
            d_t: row.d_t - give[1],
            ..row
        },
    }
}

fn is_endless(room: &[Option<f64>; 2]) -> bool {
    room.iter().all(Option::is_none)
}

/// What a solve gave at a slave node; normal and tangential components.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NodeIncrement {
    /// Increments ΔF_n, ΔF_t of the force on the slave node.
    pub force: [f64; 2],
    /// Motion of S* relative to S, or to the touching point S' of a bond that gives way: Δu_nS* − Δu_nS, Δu_tS* − Δu_tS (length).
    pub motion: [f64; 2],
}
