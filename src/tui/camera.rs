//! Pan and zoom of the shape.

/// Pan and zoom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Magnification; 1 shows the whole shape.
    pub zoom: f64,
    /// Offset of the centre, as a fraction of the extent at zoom 1.
    pub pan: [f64; 2],
}

impl Camera {
    /// Shows the whole shape.
    pub const ALL: Camera = Camera {
        zoom: 1.0,
        pan: [0.0; 2],
    };

    /// Zooms by a factor.
    pub fn zoomed(self, factor: f64) -> Camera {
        Camera {
            zoom: (self.zoom * factor).clamp(0.05, 1e4),
            ..self
        }
    }

    /// Pans by fractions of the visible extent.
    pub fn panned(self, x: f64, y: f64) -> Camera {
        let step = 0.1 / self.zoom;
        Camera {
            pan: [self.pan[0] + step * x, self.pan[1] + step * y],
            ..self
        }
    }
}
