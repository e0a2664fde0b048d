//! The state of a slave node between minor iterations.

use crate::contact::corner;
use crate::model::{InitialState, SlipCount, Sticking};
use crate::{Forced, Friction, Mode, Settings, SurfacePoint};
use serde::{Deserialize, Serialize};

/// A slave node between two minor iterations.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ContactState {
    /// Mode of the next minor iteration.
    pub mode: Mode,
    /// Mode forced by the user, if any.
    pub forced: Forced,
    /// Total normal force F_n^(k−1) on the slave node at the start of the current major iteration; compression positive.
    pub f_n: f64,
    /// Total tangential force F_t^(k−1) along t, at the same time.
    pub f_t: f64,
    /// T_max for the next minor iteration, signed.
    pub t_max: f64,
    /// Direction of T_max: −1, 0 (unknown) or 1.
    pub sign: f64,
    /// Slip accumulated up to the start of the current major iteration.
    pub slip: f64,
    /// Point of the master where the node stuck, or where it was when an increment was last accepted. `None` after a major
    /// iteration in which the node opened, unless `kept` ([`crate::contact::stick_point`]).
    pub anchor: Option<SurfacePoint>,
    /// Whether the anchor is retained while the node is free, so that its net slip counts.
    #[serde(default)]
    pub kept: bool,
    /// Distance along the surface from S* to the anchor at the start of the current major iteration, positive along t, minus
    /// elastic slip if the bond has a compliance along t. In a corner, and for a tied node: distance of the node from its point,
    /// along t.
    pub drift: f64,
    /// Elastic slip of the node when it was anchored (length).
    #[serde(default, skip_serializing_if = "is_zero")]
    pub stretched: f64,
    /// Ratio ρ of tangential to normal travel if the node touched in the current major iteration; else 0.
    pub ratio: f64,
    /// Ratio of tangential to normal travel in the last minor iteration, used as ρ if the node touches.
    pub travel: f64,
    /// Position of S*. `None` beyond the ends of all surfaces.
    pub spot: Option<SurfacePoint>,
    /// Half the angle (radians) between the normals of the two sides that hold the node where they meet; S* is then that point.
    /// Positive in a concave corner, negative on a convex vertex. `None` if a single side holds it.
    pub corner: Option<f64>,
    /// The point on the second surface, if the corner is between two surfaces ([`crate::contact::crossing`]); S* is the one on
    /// the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub second: Option<SurfacePoint>,
    /// The last master element that the node left in the current increment, if any.
    pub left: Option<usize>,
    /// Outward normal at the start of the current major iteration.
    pub normal: [f64; 2],
}

fn is_zero(length: &f64) -> bool {
    *length == 0.0
}

impl ContactState {
    /// Whether the user forces the mode.
    pub fn is_forced(&self) -> bool {
        self.forced != Forced::No
    }

    /// A node before the first minor iteration: its mode, and its initial state.
    pub fn new(mode: Mode, brought: &InitialState) -> Self {
        ContactState {
            mode,
            f_n: brought.f_n,
            f_t: brought.f_t,
            t_max: brought.t_max,
            sign: if brought.t_max == 0.0 {
                0.0
            } else {
                brought.t_max.signum()
            },
            slip: brought.slip,
            drift: brought.slip,
            ratio: brought.ratio,
            normal: [0.0, 1.0],
            ..Self::default()
        }
    }

    /// Anchors the node at a surface point, where its bond has the compliance `give` along t (length per force).
    pub fn anchor_at(&mut self, spot: Option<SurfacePoint>, give: f64) {
        self.anchor = spot;
        self.stretched = match give {
            0.0 => 0.0,
            give => give * self.f_t,
        };
    }

    /// Slip up to the start of the current major iteration, which sticking undoes (length): accumulated, or measured from the
    /// anchor, depending on the settings.
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

    /// Effective friction of the node: `in_force`, or in a corner that of both sides ([`corner::widened`]).
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

/// Number of these contacts, given by index, in a mode.
pub fn in_mode(contacts: &[ContactState], of: &[usize], mode: Mode) -> f64 {
    of.iter()
        .filter(|contact| contacts[**contact].mode == mode)
        .count() as f64
}

/// The largest drift of these contacts, given by index, with its sign.
pub fn largest_drift(contacts: &[ContactState], of: &[usize]) -> f64 {
    of.iter()
        .map(|&contact| contacts[contact].drift)
        .fold(
            0.0,
            |most: f64, d| if d.abs() > most.abs() { d } else { most },
        )
}
