//! The map from the scene to the dots of a canvas.

use crate::camera::Camera;
use crate::canvas::{Canvas, Dot};
use crate::view::View;
use stickslip_debugger::explain::outline::{Bounds, Point, Projection};

/// The map from the scene to dots: uniform scale, y upwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Window {
    pub middle: Point,
    /// Dots per unit length.
    pub scale: f64,
    pub size: [f64; 2],
    /// Length shown by the shorter side of the canvas.
    pub extent: f64,
    /// Magnification of displacements.
    pub magnified: f64,
    pub projection: Projection,
}

impl Window {
    /// Zooming keeps `towards` (the selected node) visible; the whole shape is centred.
    pub fn new(canvas: &Canvas, bounds: &Bounds, camera: &Camera, towards: Option<Point>) -> Self {
        let size = canvas.size();
        let [width, height] = bounds.size().map(|side| side.max(1e-300));
        let whole = (size[0] / width).min(size[1] / height) * 0.94;
        let scale = whole * camera.zoom;
        let middle = [0, 1].map(|axis| {
            let middle = 0.5 * (bounds.low[axis] + bounds.high[axis]);
            let towards = towards.map_or(middle, |place| place[axis]);
            let part = (1.0 - 1.0 / camera.zoom).max(0.0);
            middle + part * (towards - middle) + camera.pan[axis] * size[axis] / whole
        });
        Window {
            middle,
            scale,
            size,
            extent: size[0].min(size[1]) / scale,
            magnified: 1.0,
            projection: camera.projection,
        }
    }

    /// Position of a node in the picture.
    pub fn place(&self, view: &View, node: usize) -> Point {
        view.magnified(node, (self.magnified, self.projection))
    }

    /// Whether something at `place`, `size` dots large, can be visible.
    pub fn sees(&self, place: Point, size: f64) -> bool {
        let dot = self.dot(place);
        (0..2).all(|axis| dot[axis] > -size && dot[axis] < self.size[axis] + size)
    }

    /// The dot at a point of the sheet.
    pub fn dot(&self, point: Point) -> Dot {
        let x = 0.5 * self.size[0] + (point[0] - self.middle[0]) * self.scale;
        let y = 0.5 * self.size[1] - (point[1] - self.middle[1]) * self.scale;
        [x, y]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ratatui::layout::Rect;

    #[test]
    fn scale_is_equal_in_both_directions_and_y_points_up() {
        let canvas = Canvas::new(Rect::new(0, 0, 50, 10));
        let bounds = Bounds {
            low: [0.0, 0.0],
            high: [1.0, 1.0],
        };
        let window = Window::new(&canvas, &bounds, &Camera::ALL, None);
        let [a, b, c] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|p| window.dot(p));
        assert!((b[0] - a[0] - (a[1] - c[1])).abs() < 1e-9);
        assert!(c[1] < a[1]);
    }
}
