//! What a minor iteration found at one slave node.

use crate::contact::corner::{Side, split};
use crate::contact::projection::SurfacePoint;
use crate::contact::table2::{Decision, Rule};
use crate::model::{Friction, Mode};
use serde::{Deserialize, Serialize};

/// What a minor iteration found at one slave node. Forces are totals, on the slave node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactRecord {
    /// Table 2's verdict, with the numbers that it compared. `decision.before` is the mode of this solve and
    /// `decision.next` the mode that the next one takes.
    pub decision: Decision,
    /// Whether the mode of this solve, or the next, was forced by the user.
    pub forced: Forced,
    /// Gap after this solve, on the frozen geometry; negative is penetration, by which a touching node's bond gives way.
    pub gap: f64,
    /// Normal force; compression positive.
    pub f_n: f64,
    /// Tangential force along t (n turned 90 degrees anticlockwise).
    pub f_t: f64,
    /// T_max of this solve (eqn 20): the largest tangential force that friction can give, with its sign.
    pub t_max: f64,
    /// T_max that this solve was made with (the lagged one); equal to `t_max` where it has settled.
    pub t_max_used: f64,
    /// Slip u_tS* − u_tS, as the settings count it.
    pub slip: f64,
    /// Length of the surface from S* to where the node stuck, with the sign of slip; 0 while it is free.
    pub drift: f64,
    /// Where S* lies. `None` past the ends of all surfaces.
    pub spot: Option<SurfacePoint>,
    /// Outward normal n at S*.
    pub normal: [f64; 2],
    /// Position of S* at the start of this major iteration.
    pub foot: [f64; 2],
    /// Half the angle between the normals of the two sides that hold it ([`crate::contact::state::ContactState::corner`]), in radians; `None` where
    /// one side alone does.
    pub corner: Option<f64>,
    /// Whether a force component (normal, tangential) is left to the supports, since no unknown takes part in its equation.
    pub carried: [bool; 2],
}

/// What one of two sides gives, in its own frame (n, t).
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
    /// Whether an attached solver takes another mode next than the rules by which it says that it decides want on the same numbers,
    /// and nobody forces it.
    pub fn differs(&self) -> bool {
        let decision = &self.decision;
        let own = !matches!(decision.rule, Rule::Held | Rule::Waits);
        own && self.forced == Forced::No && decision.wanted != decision.next
    }

    /// What each of the two sides that hold the node gives, in the order of the walk; `friction` is that of one side. With
    /// friction the split is not unique: it is the one of least norm ([`split`]). `None` where one side alone holds the node, and
    /// where both together cannot give the force.
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
