//! 8-node serendipity quadrilateral: quadratic along each side; 3 × 3 or 2 × 2 Gauss points.
//!
//! With 2 × 2 points (reduced integration) it is softer and does not lock with nearly incompressible materials. It then has one
//! hourglass mode, which strains no point but cannot propagate to a neighbouring element. Nodes are the corners anticlockwise,
//! then the midside nodes of the sides 1-2, 2-3, 3-4, 4-1.

use super::continuum_kind::{ContinuumKind, QUADRATIC_SIDES, Shape};
use crate::elements::quadrature::square;

/// Positions of the nodes in the parent square: those of the 9-node quadrilateral without its centre.
const PLACES: [[f64; 2]; 8] = {
    let [a, b, c, d, e, f, g, h, _] = super::quad9::PLACES;
    [a, b, c, d, e, f, g, h]
};

/// The kind with full integration.
pub static KIND: ContinuumKind<8, 9> =
    ContinuumKind::new(23, QUADRATIC_SIDES, PLACES, || square(3), shape);

/// The kind with reduced integration.
pub static REDUCED: ContinuumKind<8, 4> =
    ContinuumKind::new(23, QUADRATIC_SIDES, PLACES, || square(2), shape);

/// The shape functions and their derivatives with respect to ξ and η.
fn shape(xi: f64, eta: f64) -> Shape<8> {
    let (mut n, mut d) = ([0.0; 8], [[0.0; 2]; 8]);
    for (i, [a, b]) in PLACES.into_iter().enumerate() {
        let (p, q) = (1.0 + a * xi, 1.0 + b * eta);
        if a == 0.0 {
            let bubble = 1.0 - xi * xi;
            n[i] = 0.5 * bubble * q;
            d[i] = [-xi * q, 0.5 * bubble * b];
        } else if b == 0.0 {
            let bubble = 1.0 - eta * eta;
            n[i] = 0.5 * bubble * p;
            d[i] = [0.5 * bubble * a, -eta * p];
        } else {
            let rest = a * xi + b * eta - 1.0;
            n[i] = 0.25 * p * q * rest;
            d[i] = [0.25 * a * q * (rest + p), 0.25 * b * p * (rest + q)];
        }
    }
    (n, d)
}
