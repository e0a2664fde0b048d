//! Loads, prescribed displacements, and the path of the load factor.

use crate::documented::documented;

/// A dead load (force or moment) on one degree of freedom.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// Number of the degree of freedom.
    pub dof: usize,
    /// Force, or moment on a rotation, at factor 1.
    pub value: f64,
    /// Amplitude as a function of the load factor.
    pub scale: Factor,
    /// Number of the load per volume in the scene that it is a part of. At nodes of second-order elements the parts of one load
    /// have either sign.
    pub volume: Option<usize>,
}

/// A following pressure on faces of solids: force per current area, positive into the body. Or the thermal expansion of a solid,
/// whose nodal forces also follow the body.
#[derive(Debug, Clone, PartialEq)]
pub struct Pressure {
    /// The faces.
    pub faces: Vec<PressedFace>,
    /// The body that expands; then there are no faces.
    pub expands: Option<usize>,
    /// Pressure (force per area) at factor 1; positive pushes into the body. Of an expansion the strain at factor 1.
    pub value: f64,
    /// Amplitude as a function of the load factor.
    pub scale: Factor,
}

/// A face under pressure.
#[derive(Debug, Clone, PartialEq)]
pub struct PressedFace {
    /// Nodes, walked with the body on the left.
    pub nodes: Vec<usize>,
    /// Thickness across the plane (length); `None` in axisymmetry, where the face is a ring.
    pub thickness: Option<f64>,
}

/// A prescribed value of one degree of freedom.
#[derive(Debug, Clone, PartialEq)]
pub struct Prescribed {
    /// Number of the degree of freedom.
    pub dof: usize,
    /// Length, or rotation angle (radians), at factor 1.
    pub value: f64,
    /// Amplitude as a function of the load factor.
    pub scale: Factor,
}

/// Amplitude of a load as a function of the scene's load factor: pairs (load factor, factor) with ascending load factors.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Factor(pub Vec<(f64, f64)>);

impl Factor {
    /// The factor at a load factor: piecewise linear and constant beyond the ends. Without points, the load factor itself.
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

    /// Derivative with respect to the load factor; at a kink, that of the segment below.
    pub fn slope(&self, load_factor: f64) -> f64 {
        let points = &self.0;
        let Some(first) = points.first() else {
            return 1.0;
        };
        if load_factor < first.0 {
            return 0.0;
        }
        let piece = points.windows(2).find(|pair| load_factor <= pair[1].0);
        piece.map_or(0.0, |pair| {
            (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0)
        })
    }
}

documented! {
    /// What to do with an increment that jumps to another equilibrium branch.
    pub choice Jumps {
        /// Accept and mark the increment if it moved further than its tangent and the previous increments predict.
        Accept,
        /// Cut the increment; if the smallest increment still jumps, accept and mark it.
        #[default]
        Cut,
        /// Cut the increment; if the smallest increment still jumps, the history fails.
        Stop,
        /// Find the limit load by bisection, to the tolerance `settings.limit_load`. A damped motion then leads from the last
        /// equilibrium to the next stable one, which is marked.
        Dynamic,
    }
}

/// Increment size on a leg of the path: the entry of the list, or `increment` beyond its end.
pub fn on_leg(increments: &[f64], increment: f64, leg: usize) -> f64 {
    increments.get(leg).copied().unwrap_or(increment)
}

/// Size below which an increment is no longer cut: `given`, or 1/64 of `increment`.
pub fn least(given: Option<f64>, increment: f64) -> f64 {
    given.unwrap_or(increment / FINEST)
}

/// By default, an increment is cut to no less than 1/64 of its size.
const FINEST: f64 = 64.0;
