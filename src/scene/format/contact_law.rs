//! The interaction between slave nodes and surfaces: contact law and friction.

use super::described::macros::described;
use stickslip_core::Friction;

described! {
    /// The contact law between a slave node and its surface. Coulomb friction applies to the first two.
    #[derive(Copy, Default)]
    pub enum ContactLaw {
        /// g >= 0 and F_n >= 0, one of them zero.
        #[default]
        Hard,
        /// Linear penalty: the surface yields in proportion to the pressure. While the node touches, g + F_n / (K A) = 0 with the
        /// total F_n and the node's tributary area A, which is a compliance 1 / (K A) in series. A node on the axis of an
        /// axisymmetric body carries no force; its share of the area is assigned to its neighbour.
        Penalty {
            /// K, pressure per length of penetration.
            stiffness: f64,
        },
        /// Tied to its point of the surface, in tension too, without friction. The node is first moved onto the surface without
        /// stress.
        Tied,
        /// Tied by springs, in tension too: g + F_n / (K A) = 0, and along the surface with the pair's `stick` stiffness (default:
        /// K). For points of faces (`by: surface`), whose rigid ties would be more equations than a face has unknowns.
        Bonded {
            /// K, pressure per length.
            stiffness: f64,
        },
    }
}

impl ContactLaw {
    /// Whether this is the default, which scenes may omit.
    pub fn is_hard(&self) -> bool {
        *self == ContactLaw::Hard
    }

    /// Whether it transmits tension, without friction.
    pub fn is_tied(&self) -> bool {
        matches!(self, ContactLaw::Tied | ContactLaw::Bonded { .. })
    }

    /// K (pressure per length); `None` if it is rigid.
    pub fn stiffness(&self) -> Option<f64> {
        match *self {
            ContactLaw::Penalty { stiffness } | ContactLaw::Bonded { stiffness } => Some(stiffness),
            ContactLaw::Hard | ContactLaw::Tied => None,
        }
    }
}

described! {
    /// Coulomb friction, eqn (20): |F_t| <= tan φ F_n + c, where c is `cohesion` + `adhesion` times the node's tributary area.
    #[derive(Copy, Default)]
    pub struct FrictionSpec {
        /// Friction angle φ in degrees, 0 <= φ < 90. Default: 0.
        #[serde(default)]
        pub angle: f64,
        /// Cohesion, a force per slave node. Default: 0.
        #[serde(default)]
        pub cohesion: f64,
        /// Cohesion per area of the interface, a pressure; independent of the mesh. Default: 0.
        #[serde(default, skip_serializing_if = "is_zero")]
        pub adhesion: f64,
    }
}

pub(super) fn is_zero(value: &f64) -> bool {
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
    /// Friction of a node with this tributary area. Without an area, `adhesion` does not count.
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
