//! Result of a minor iteration at one slave node.

use crate::contact::corner::{Side, split};
use crate::{Decision, Friction, Mode, Rule, SurfacePoint, Test, TestedQuantity};
use serde::{Deserialize, Serialize};

/// Result of a minor iteration at one slave node. Forces are total forces on the slave node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactRecord {
    /// The decision of Table 2, with the compared numbers. `decision.before` is the mode of this solve and `decision.next` that
    /// of the next.
    pub decision: Decision,
    /// Whether the user forced the mode of this or the next solve.
    pub forced: Forced,
    /// Gap after this solve, on the frozen geometry; negative is penetration, which includes the deformation of a touching node's
    /// bond.
    pub gap: f64,
    /// Normal force; compression positive.
    pub f_n: f64,
    /// Tangential force along t (n turned 90 degrees anticlockwise).
    pub f_t: f64,
    /// T_max of this solve (eqn 20): the largest tangential force that friction can give, with its sign.
    pub t_max: f64,
    /// T_max used in this solve (lagged); equals `t_max` once it has converged.
    pub t_max_used: f64,
    /// Slip u_tS* − u_tS, accumulated as the settings define.
    pub slip: f64,
    /// Distance along the surface from S* to the stick point, with the sign of slip; 0 while the node is free.
    pub drift: f64,
    /// Position of S*. `None` beyond the ends of all surfaces.
    pub spot: Option<SurfacePoint>,
    /// Outward normal n at S*.
    pub normal: [f64; 2],
    /// Position of S* at the start of this major iteration.
    pub foot: [f64; 2],
    /// In space, the directions of the tangential force and of the slip: their angles (radians) from t towards n × t. `f_t` and
    /// `slip` are then lengths, and not negative. `None` in the plane.
    pub directions: Option<[f64; 2]>,
    /// Half the angle (radians) between the normals of the two sides that hold the node
    /// ([`crate::contact::state::ContactState::corner`]); `None` if a single side does.
    pub corner: Option<f64>,
    /// Whether supports carry a force component (normal, tangential), because its equation contains no unknown.
    pub carried: [bool; 2],
}

/// The turn (radians, -π to π) from one direction to another.
pub fn turn(from: f64, to: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    PI - (PI - (to - from)).rem_euclid(TAU)
}

/// Force from one of two sides, in the frame (n, t) of that side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SideForce {
    /// Normal force; compression positive.
    pub f_n: f64,
    /// Tangential force.
    pub f_t: f64,
    /// Friction bound tan φ F_n + c of this side.
    pub limit: f64,
}

impl ContactRecord {
    /// The angle (radians, 0 to π) between the tangential force and the slip of a sliding node in space; `None` in the plane, or
    /// if either is zero or unknown.
    pub fn deviation(&self) -> Option<f64> {
        let [force, slip] = self.directions?;
        let slides = self.decision.before == Mode::Sliding;
        (slides && self.f_t > 0.0 && self.slip > 0.0).then(|| turn(force, slip).abs())
    }

    /// The components of the tangential force along t and n × t in space; `None` in the plane.
    pub fn shear(&self) -> Option<[f64; 2]> {
        let [force, _] = self.directions?;
        Some([self.f_t * force.cos(), self.f_t * force.sin()])
    }

    /// Whether an attached solver selects another next mode than its declared rules give for the same numbers, without being
    /// forced.
    pub fn differs(&self) -> bool {
        let decision = &self.decision;
        let own = !matches!(decision.rule, Rule::Held | Rule::Waits);
        own && self.forced == Forced::No && decision.wanted != decision.next
    }

    /// Whether a test of this node's decision is a tie. Without friction limit, tests of friction compare 0 with 0 and decide nothing.
    pub fn is_tie(&self, test: &Test) -> bool {
        let of_friction = matches!(
            test.tested,
            TestedQuantity::ShearForce | TestedQuantity::Slip
        );
        test.tie && !(of_friction && self.t_max == 0.0)
    }

    /// The force from each of the two sides that hold the node, in walking order; `friction` is that of one side. With friction
    /// the split is not unique, and the one of least norm is returned ([`split`]). `None` if a single side holds the node, or if
    /// both together cannot give the force.
    pub fn sides(&self, friction: &Friction) -> Option<[SideForce; 2]> {
        let [one, other] = Side::pair(self.normal, self.corner?, friction);
        let [c, s] = self.normal;
        let force = [c * self.f_n - s * self.f_t, s * self.f_n + c * self.f_t];
        let forces = split(force, [&one, &other])?;
        let of = |side: &Side, force: [f64; 2]| {
            let [f_n, f_t] = side.components(force);
            let limit = side.coefficient * f_n + side.cohesion;
            SideForce { f_n, f_t, limit }
        };
        Some([of(&one, forces[0]), of(&other, forces[1])])
    }
}

/// Whether the user forces a node's mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Forced {
    /// Not forced: the strategy chooses the mode.
    #[default]
    No,
    /// Forced for one minor iteration.
    Once(Mode),
    /// Forced until released.
    Held(Mode),
}
