//! The laws of a pair of slave nodes and surfaces: what holds where they touch, and what friction does there.

use super::described::macros::described;
use serde::{Deserialize, Serialize};
use stickslip_core::model::Friction;

described! {
    /// What holds between a slave node and its surface where they touch. Coulomb friction goes with the first two.
    #[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub enum ContactLaw {
        /// g >= 0 and F_n >= 0, one of them zero.
        #[default]
        Hard,
        /// The surface gives way in proportion to the pressure: g + F_n / (K A) = 0 while the node touches, with the total F_n and
        /// the node's tributary area A. To the interface it is a compliance 1 / (K A) in series. A node on the axis of an
        /// axisymmetric body bears no force; what it has of the area goes to its neighbour.
        Penalty {
            /// K, a pressure by length of penetration.
            stiffness: f64,
        },
        /// Held at its point of the surface for ever, in tension too, without friction. The node is put onto the surface
        /// before anything deforms, without stress.
        Tied,
    }
}

impl ContactLaw {
    /// Whether it is the one that pairs have who name none.
    pub fn is_hard(&self) -> bool {
        *self == ContactLaw::Hard
    }
}

described! {
    /// Coulomb friction, eqn (20): |F_t| <= tan φ F_n + c, where c is `cohesion` + `adhesion` times the node's tributary area.
    #[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct FrictionSpec {
        /// Friction angle φ in degrees, 0 <= φ < 90. Default: 0.
        #[serde(default)]
        pub angle: f64,
        /// Cohesion, a force per slave node. Default: 0.
        #[serde(default)]
        pub cohesion: f64,
        /// Cohesion by area of the interface, a pressure: it does not hang on the mesh. Default: 0.
        #[serde(default, skip_serializing_if = "is_zero")]
        pub adhesion: f64,
    }
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

impl From<Friction> for FrictionSpec {
    fn from(friction: Friction) -> Self {
        FrictionSpec {
            angle: friction.angle,
            cohesion: friction.cohesion,
            adhesion: 0.0,
        }
    }
}

impl FrictionSpec {
    /// The friction of a node with this tributary area. Without an area there is no cohesion by area.
    pub fn of_node(&self, area: Option<f64>) -> Friction {
        let by_area = match self.adhesion {
            0.0 => 0.0,
            adhesion => adhesion * area.unwrap_or(0.0),
        };
        Friction {
            angle: self.angle,
            cohesion: self.cohesion + by_area,
        }
    }
}
