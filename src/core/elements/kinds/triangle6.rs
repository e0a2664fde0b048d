//! 6-node triangle: quadratic displacements; three interior integration points.

use super::continuum_kind::{ContinuumKind, Shape};
use crate::elements::quadrature::TRIANGLE_3;

/// Positions of the nodes in the parent triangle.
const PLACES: [[f64; 2]; 6] = [
    [0.0, 0.0],
    [1.0, 0.0],
    [0.0, 1.0],
    [0.5, 0.0],
    [0.5, 0.5],
    [0.0, 0.5],
];

/// The kind.
pub static KIND: ContinuumKind<6, 3> = ContinuumKind::new(
    22,
    &[&[0, 3, 1], &[1, 4, 2], &[2, 5, 0]],
    PLACES,
    || TRIANGLE_3,
    shape,
);

/// With L = (1 − ξ − η, ξ, η): N = L (2 L − 1) at a corner, 4 L_a L_b between the corners a and b.
fn shape(xi: f64, eta: f64) -> Shape<6> {
    const SLOPES: [[f64; 2]; 3] = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
    let l = [1.0 - xi - eta, xi, eta];
    let (mut n, mut d) = ([0.0; 6], [[0.0; 2]; 6]);
    for a in 0..3 {
        let b = (a + 1) % 3;
        n[a] = l[a] * (2.0 * l[a] - 1.0);
        n[3 + a] = 4.0 * l[a] * l[b];
        for k in 0..2 {
            d[a][k] = (4.0 * l[a] - 1.0) * SLOPES[a][k];
            d[3 + a][k] = 4.0 * (SLOPES[a][k] * l[b] + l[a] * SLOPES[b][k]);
        }
    }
    (n, d)
}
