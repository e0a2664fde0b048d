//! How a slave node stands over its surface during a major iteration, and how a solve moves it there.

use serde::{Deserialize, Serialize};

/// A slave node's surroundings, frozen during a major iteration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NodeKinematics {
    /// Gap g (length); negative is penetration.
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
}

impl NodeKinematics {
    /// The room that is left in the direction of a motion of S* relative to S along t (length): S* goes the other way along
    /// the surface. `None` where the side does not end at an angle.
    pub fn room_for(&self, motion: f64) -> Option<f64> {
        self.room[usize::from(motion < 0.0)]
    }
}

fn is_endless(room: &[Option<f64>; 2]) -> bool {
    room.iter().all(Option::is_none)
}

/// What a solve gave at a slave node; normal and tangential components.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeIncrement {
    /// Increments ΔF_n, ΔF_t of the force on the slave node.
    pub force: [f64; 2],
    /// Motion of S* relative to S: Δu_nS* − Δu_nS, Δu_tS* − Δu_tS (length).
    pub motion: [f64; 2],
}
