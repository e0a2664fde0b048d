//! The loads of a scene file, and how each goes with the load factor.

use super::described::macros::described;
use serde::{Deserialize, Serialize};
use stickslip_core::model::Component;

described! {
    /// A reference load; what acts is its value times the load factor (or times `scale` of it).
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
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
            /// Load factor of the scene to that of this load, as points `(load factor, own factor)`. Default: the same.
            #[serde(default)]
            scale: Scale,
        },
        /// A moment on a beam node, anticlockwise positive.
        Moment {
            /// Name of the node.
            node: String,
            /// Force times length.
            value: f64,
            /// Load factor of the scene to that of this load, as points `(load factor, own factor)`. Default: the same.
            #[serde(default)]
            scale: Scale,
        },
        /// A uniform dead load along a chain: on each unit of its undeformed length; in axisymmetry on each unit of undeformed
        /// area, all around (2 pi x).
        Traction {
            /// Id of the chain, or name of the edge.
            along: String,
            /// Along the outward normal of the undeformed chain, to the right of its walk. Default: 0.
            #[serde(default)]
            normal: f64,
            /// Component along x, force by length (axisymmetry: by area). Default: 0.
            #[serde(default)]
            x: f64,
            /// Component along y, force by length (axisymmetry: by area). Default: 0.
            #[serde(default)]
            y: f64,
            /// Load factor of the scene to that of this load, as points `(load factor, own factor)`. Default: the same.
            #[serde(default)]
            scale: Scale,
        },
        /// A pressure on the faces of solids along a chain, which follows them: force by current area (times the thickness, or
        /// the circumference 2 pi x in axisymmetry), along the current normal. On a solid with `update: small` it stays as it is
        /// on the undeformed face.
        Pressure {
            /// Id of the chain, or name of the edge.
            along: String,
            /// Force by area; positive pushes into the body, whichever way the chain is walked.
            value: f64,
            /// Load factor of the scene to that of this load, as points `(load factor, own factor)`. Default: the same.
            #[serde(default)]
            scale: Scale,
        },
        /// A dead load on each unit of undeformed volume of a solid, as its weight: density times gravity.
        Volume {
            /// Id of the solid, or of a block or mesh that solids stand on.
            on: String,
            /// Component along x, force by volume. Default: 0.
            #[serde(default)]
            x: f64,
            /// Component along y, force by volume. Default: 0.
            #[serde(default)]
            y: f64,
            /// Load factor of the scene to that of this load, as points `(load factor, own factor)`. Default: the same.
            #[serde(default)]
            scale: Scale,
        },
        /// A prescribed displacement (or rotation) of a node; `ID.all` moves a whole chain.
        Displacement {
            /// Name of a node; `ID.all` for a whole chain.
            node: String,
            /// Along which degree of freedom.
            component: Component,
            /// Length, or angle in radians.
            value: f64,
            /// Load factor of the scene to that of this load, as points `(load factor, own factor)`. Default: the same.
            #[serde(default)]
            scale: Scale,
        },
    }
}

/// Piecewise-linear map from the scene's load factor to a load's own, as points `(load factor, own factor)` with
/// rising load factors; constant beyond its ends. Default (no points): the load factor itself.
pub type Scale = Vec<(f64, f64)>;
