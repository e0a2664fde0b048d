//! Pan and zoom of the shape, and the magnification of its displacements.

use crate::view::View;
use stickslip_debugger::explain::outline::{self, Projection};

/// Pan and zoom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Magnification; 1 shows the whole shape.
    pub zoom: f64,
    /// Offset of the centre, as a fraction of the extent at zoom 1.
    pub pan: [f64; 2],
    /// Magnification of displacements; `None` chooses it.
    pub magnify: Option<f64>,
    /// How a scene in space is drawn.
    pub projection: Projection,
}

impl Camera {
    /// Shows the whole shape.
    pub const ALL: Camera = Camera {
        zoom: 1.0,
        pan: [0.0; 2],
        magnify: None,
        projection: Projection::Oblique,
    };

    /// The magnification of displacements: the chosen one, or a round number that makes the largest displacement of the shown and
    /// of the last state visible.
    pub fn magnified(&self, view: &View) -> f64 {
        self.magnify.unwrap_or_else(|| {
            let last = view.frames.last().unwrap_or(view.frame());
            let shown = [&view.frame().state, &last.state];
            outline::magnification(view.model, shown.into_iter().map(|state| &state.u[..]))
        })
    }

    /// The next magnification: automatic, to scale, ×10, ×100.
    pub fn magnified_next(self) -> Camera {
        let magnify = match self.magnify {
            None => Some(1.0),
            Some(1.0) => Some(10.0),
            Some(10.0) => Some(100.0),
            Some(_) => None,
        };
        Camera { magnify, ..self }
    }

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
