//! What drives a scene: loads, prescribed motions, and the path of the load factor.

use super::documented::documented;
use serde::{Deserialize, Serialize};

/// A dead load on one degree of freedom (a force, or a moment).
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// Number of the degree of freedom.
    pub dof: usize,
    /// Force, or moment on a rotation, at a factor of 1.
    pub value: f64,
    /// Factor of the value, as a function of the load factor.
    pub scale: Factor,
}

/// A pressure on faces of solids, which follows them: a force by current area, into the body.
#[derive(Debug, Clone, PartialEq)]
pub struct Pressure {
    /// The faces.
    pub faces: Vec<PressedFace>,
    /// Pressure (force by area) at a factor of 1; positive pushes into the body.
    pub value: f64,
    /// Factor of the value, as a function of the load factor.
    pub scale: Factor,
}

/// A face under pressure.
#[derive(Debug, Clone, PartialEq)]
pub struct PressedFace {
    /// Its nodes, walked with the body on the left.
    pub nodes: Vec<usize>,
    /// Thickness across the plane (length); `None` in axisymmetry, where it is a ring.
    pub thickness: Option<f64>,
}

/// A prescribed value of one degree of freedom.
#[derive(Debug, Clone, PartialEq)]
pub struct Prescribed {
    /// Number of the degree of freedom.
    pub dof: usize,
    /// Length, or angle of a rotation (radians), at a factor of 1.
    pub value: f64,
    /// Factor of the value, as a function of the load factor.
    pub scale: Factor,
}

/// A load's own factor as a function of the scene's load factor: pairs of load factor and own factor, the load factors
/// ascending.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Factor(pub Vec<(f64, f64)>);

impl Factor {
    /// The factor at a load factor: piecewise linear, constant beyond the ends; without points the load factor
    /// itself.
    pub fn at(&self, load_factor: f64) -> f64 {
        let points = &self.0;
        let (Some(first), Some(last)) = (points.first(), points.last()) else {
            return load_factor;
        };
        if load_factor <= first.0 {
            return first.1;
        }
        for pair in points.windows(2) {
            let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
            if load_factor <= x1 {
                return y0 + (y1 - y0) * (load_factor - x0) / (x1 - x0);
            }
        }
        last.1
    }

    /// Its derivative by the load factor; at a kink that of the piece below.
    pub fn slope(&self, load_factor: f64) -> f64 {
        let points = &self.0;
        let Some(first) = points.first() else {
            return 1.0;
        };
        if load_factor < first.0 {
            return 0.0;
        }
        let mut pieces = points.windows(2);
        let piece = pieces.find(|pair| load_factor <= pair[1].0);
        piece.map_or(0.0, |pair| {
            (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0)
        })
    }
}

documented! {
    /// What an increment does that jumps to another branch of equilibrium.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Jumps {
        /// It is accepted whole, marked where it moved beyond what its tangent and the increments before it predict.
        Accept,
        /// It is cut; where the least increment still jumps, that is accepted, marked.
        #[default]
        Cut,
        /// It is cut; where the least increment still jumps, the history fails.
        Stop,
        /// The load at which equilibrium ends is found by halves, to `settings.limit_load`; then a damped motion leads from the
        /// last equilibrium to the next stable one, which is marked.
        Dynamic,
    }
}

impl Jumps {
    /// Whether it is what a scene that does not name it has.
    pub fn is_default(&self) -> bool {
        *self == Jumps::default()
    }
}

/// Size of the increments on a leg of the path: what the list says, or `increment` where it ends.
pub fn on_leg(increments: &[f64], increment: f64, leg: usize) -> f64 {
    increments.get(leg).copied().unwrap_or(increment)
}

/// Size below which an increment is not cut further: `given`, or 1/64 of `increment`.
pub fn least(given: Option<f64>, increment: f64) -> f64 {
    given.unwrap_or(increment / FINEST)
}

/// An increment is cut to no less than this part (1/64) of its size, unless the scene says otherwise.
const FINEST: f64 = 64.0;
