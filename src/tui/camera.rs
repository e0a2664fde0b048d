//! The camera of the shape.

/// How the shape is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// 1 shows all of it.
    pub zoom: f64,
    /// Shift of the middle, as a fraction of what is seen at zoom 1.
    pub pan: [f64; 2],
}

impl Camera {
    /// All of the shape.
    pub const ALL: Camera = Camera {
        zoom: 1.0,
        pan: [0.0; 2],
    };

    /// Nearer or farther by a factor.
    pub fn zoomed(self, factor: f64) -> Camera {
        Camera {
            zoom: (self.zoom * factor).clamp(0.05, 1e4),
            ..self
        }
    }

    /// Moved by steps of what is seen.
    pub fn panned(self, x: f64, y: f64) -> Camera {
        let step = 0.1 / self.zoom;
        Camera {
            pan: [self.pan[0] + step * x, self.pan[1] + step * y],
            ..self
        }
    }
}
