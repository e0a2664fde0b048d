//! What one slave node brings from minor iteration to minor iteration.

use crate::contact::corner;
use crate::contact::projection::SurfacePoint;
use crate::contact::record::Forced;
use crate::model::{Friction, InitialState, Mode, Settings, SlipCount, Sticking};
use serde::{Deserialize, Serialize};

/// One slave node between two minor iterations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ContactState {
    /// Mode of the next minor iteration.
    pub mode: Mode,
    /// Mode forced by the user, if any.
    pub forced: Forced,
    /// Total forces F_n^(k−1), F_t^(k−1) at the start of the present major iteration.
    pub f_n: f64,
    pub f_t: f64,
    /// T_max for the next minor iteration, signed.
    pub t_max: f64,
    /// Direction of T_max: −1, 0 (unknown) or 1.
    pub sign: f64,
    /// Slip counted up to the start of the present major iteration.
    pub slip: f64,
    /// Where on the master it stuck, or last was when an increment was accepted; none from a major iteration on in which it
    /// opened, unless it is kept ([`crate::contact::stick_point`]).
    pub anchor: Option<SurfacePoint>,
    /// Whether the anchor is kept while the node is free, so that its net slip counts.
    #[serde(default)]
    pub kept: bool,
    /// Length of the surface from S* to the anchor at the start of the present major iteration, positive along t; in a
    /// corner, how far along t the node still has to go to it.
    pub drift: f64,
    /// Ratio ρ of tangential to normal travel where the node touched in the present major iteration; else 0.
    pub ratio: f64,
    /// Tangential over normal travel in the last minor iteration: the ρ that the node would take, should it touch.
    pub travel: f64,
    /// Where S* lies; none past the ends of all surfaces.
    pub spot: Option<SurfacePoint>,
    /// Half the angle (radians) of the concave corner in which it is held; S* is that corner then.
    #[serde(default)]
    pub corner: Option<f64>,
    /// The master element that it left last in the present increment.
    #[serde(default)]
    pub left: Option<usize>,
    /// Outward normal at the start of the present major iteration.
    pub normal: [f64; 2],
}

impl ContactState {
    pub fn new(mode: Mode, brought: &InitialState) -> Self {
        ContactState {
            mode,
            forced: Forced::No,
            f_n: brought.f_n,
            f_t: brought.f_t,
            t_max: brought.t_max,
            sign: if brought.t_max == 0.0 {
                0.0
            } else {
                brought.t_max.signum()
            },
            slip: brought.slip,
            anchor: None,
            kept: false,
            drift: brought.slip,
            ratio: brought.ratio,
            travel: 0.0,
            spot: None,
            corner: None,
            left: None,
            normal: [0.0, 1.0],
        }
    }

    /// What it has slipped up to the start of the present major iteration, and what sticking takes back: counted, or
    /// measured from its anchor.
    pub fn slipped(&self, settings: &Settings) -> f64 {
        if self.corner.is_some() {
            return self.drift;
        }
        match (settings.sticking, settings.slip) {
            (Sticking::Anchored, _) => self.drift,
            (Sticking::Increments, SlipCount::Increment) => self.slip,
            (Sticking::Increments, SlipCount::Major) => 0.0,
        }
    }

    /// Friction where it stands: that in force, or what the corner makes of it.
    pub fn friction(&self, in_force: &Friction) -> Friction {
        match self.corner {
            Some(half) => corner::widened(in_force, half),
            None => *in_force,
        }
    }

    /// Total force on the slave node in Cartesian components (eqn 2).
    pub fn force(&self) -> [f64; 2] {
        let [c, s] = self.normal;
        [c * self.f_n - s * self.f_t, s * self.f_n + c * self.f_t]
    }
}
