//! The window of a picture: where the scene is drawn, and at which scale.

use crate::explain::outline::{Bounds, Point, clip};
use stickslip_study::placing::Patch;

/// Part of the window filled by the shape; forces and names need the rest.
const FILLED: f64 = 0.86;
/// Length of the longest force, in pixels.
pub(super) const FORCE: f64 = 86.0;

/// The map from the scene to the sheet: the same scale in both directions, y upwards.
pub(super) struct Window {
    patch: Patch,
    /// The point of the scene at the centre of the drawing area without the margins for forces, and that
    /// centre.
    middle: Point,
    centre: (f64, f64),
    /// Pixels per unit of length.
    pub scale: f64,
}

impl Window {
    /// The map that centres these bounds in a patch, with margins at its sides.
    pub fn new(bounds: &Bounds, patch: Patch, [left, up, right, down]: [f64; 4]) -> Window {
        let [width, height] = bounds.size().map(|side| side.max(1e-300));
        let inner = Patch {
            from: (patch.from.0 + left, patch.from.1 + up),
            to: (patch.to.0 - right, patch.to.1 - down),
        };
        let wide = (inner.to.0 - inner.from.0) / width;
        let high = (inner.to.1 - inner.from.1) / height;
        Window {
            patch,
            centre: inner.middle(),
            middle: [0, 1].map(|axis| 0.5 * (bounds.low[axis] + bounds.high[axis])),
            scale: FILLED * wide.min(high),
        }
    }

    /// Position on the sheet of a point of the scene.
    pub fn at(&self, point: Point) -> (f64, f64) {
        let (x, y) = self.centre;
        (
            x + (point[0] - self.middle[0]) * self.scale,
            y - (point[1] - self.middle[1]) * self.scale,
        )
    }

    /// The parts of a polyline that lie inside the window.
    pub fn inside(&self, points: &[Point]) -> Vec<Vec<(f64, f64)>> {
        let (low, high) = (self.patch.from, self.patch.to);
        let mut chains: Vec<Vec<(f64, f64)>> = Vec::new();
        for pair in points.windows(2) {
            let (from, to) = (self.at(pair[0]), self.at(pair[1]));
            let cut = clip(
                [from.0, from.1],
                [to.0, to.1],
                [low.0, low.1],
                [high.0, high.1],
            );
            let Some((from, to)) = cut else { continue };
            let (from, to) = ((from[0], from[1]), (to[0], to[1]));
            match chains.last_mut() {
                Some(chain) if chain.last() == Some(&from) => chain.push(to),
                _ => chains.push(vec![from, to]),
            }
        }
        chains
    }

    /// Whether a point of the sheet lies inside the window.
    pub fn holds(&self, (x, y): (f64, f64)) -> bool {
        (self.patch.from.0..=self.patch.to.0).contains(&x)
            && (self.patch.from.1..=self.patch.to.1).contains(&y)
    }
}
