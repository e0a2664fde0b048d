//! The loads of a scene file and their amplitudes.

use super::described::macros::described;
use stickslip_core::Component;

described! {
    /// A reference load; the applied load is its value times the load factor (or times the factor that `scale` assigns to it).
    pub enum LoadSpec {
        /// A dead point load.
        Force {
            /// Name of the node.
            node: String,
            /// Component along x, a force. Default: 0.
            #[serde(default)]
            x: f64,
            /// Component along y, a force. Default: 0.
            #[serde(default)]
            y: f64,
            /// Amplitude as points `(load factor of the scene, factor of this load)`. Default: the same.
            #[serde(default)]
            scale: Scale,
        },
        /// A moment on a beam node; anticlockwise is positive.
        Moment {
            /// Name of the node.
            node: String,
            /// Force times length.
            value: f64,
            /// Amplitude as points `(load factor of the scene, factor of this load)`. Default: the same.
            #[serde(default)]
            scale: Scale,
        },
        /// A uniform dead load along a chain, per undeformed length; in axisymmetry per undeformed area of the whole
        /// circumference (2 pi x).
        Traction {
            /// Id of the chain, or name of the edge.
            along: String,
            /// Component along the undeformed chain's outward normal, which is on the right of the walk. Default: 0.
            #[serde(default)]
            normal: f64,
            /// Component along x, force per length (axisymmetry: per area). Default: 0.
            #[serde(default)]
            x: f64,
            /// Component along y, force per length (axisymmetry: per area). Default: 0.
            #[serde(default)]
            y: f64,
            /// Amplitude as points `(load factor of the scene, factor of this load)`. Default: the same.
            #[serde(default)]
            scale: Scale,
        },
        /// A following pressure on the faces of solids along a chain: force per current area along the current normal (times the
        /// thickness, or in axisymmetry the circumference 2 pi x). On a solid with `update: small` it acts on the undeformed
        /// face.
        Pressure {
            /// Id of the chain, or name of the edge.
            along: String,
            /// Force per area; positive pushes into the body, regardless of the walking direction.
            value: f64,
            /// Amplitude as points `(load factor of the scene, factor of this load)`. Default: the same.
            #[serde(default)]
            scale: Scale,
        },
        /// A dead load per undeformed volume of a solid. For its weight, give density times gravity.
        Volume {
            /// Id of the solid, or of a block or mesh that solids use.
            on: String,
            /// Component along x, force per volume. Default: 0.
            #[serde(default)]
            x: f64,
            /// Component along y, force per volume. Default: 0.
            #[serde(default)]
            y: f64,
            /// Amplitude as points `(load factor of the scene, factor of this load)`. Default: the same.
            #[serde(default)]
            scale: Scale,
        },
        /// A thermal expansion of a solid: its material is free of stress when it is longer by this strain in all directions.
        /// Requires `law: svk`, and `update: total` or `small`.
        Expansion {
            /// Id of the solid.
            on: String,
            /// Strain; coefficient of expansion times the rise of the temperature.
            strain: f64,
            /// Amplitude as points `(load factor of the scene, factor of this load)`. Default: the same.
            #[serde(default)]
            scale: Scale,
        },
        /// A prescribed displacement (or rotation) of a node; `ID.all` moves a whole chain.
        Displacement {
            /// Name of a node; `ID.all` for a whole chain.
            node: String,
            /// The prescribed degree of freedom.
            component: Component,
            /// Length, or angle in radians.
            value: f64,
            /// Amplitude as points `(load factor of the scene, factor of this load)`. Default: the same.
            #[serde(default)]
            scale: Scale,
        },
    }
}

impl LoadSpec {
    /// The amplitude.
    pub fn scale(&self) -> &Scale {
        use LoadSpec::*;
        match self {
            Force { scale, .. } | Moment { scale, .. } | Traction { scale, .. } => scale,
            Pressure { scale, .. } | Volume { scale, .. } | Expansion { scale, .. } => scale,
            Displacement { scale, .. } => scale,
        }
    }
}

/// Piecewise-linear amplitude of a load: points `(load factor of the scene, factor of this load)` with ascending load factors;
/// constant beyond its ends. Without points, the load factor itself.
pub type Scale = Vec<(f64, f64)>;
