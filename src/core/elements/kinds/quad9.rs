//! 9-node Lagrange quadrilateral: biquadratic displacements; 3 × 3 Gauss points.

use super::continuum_kind::{ContinuumKind, QUADRATIC_SIDES, Shape};
use crate::elements::quadrature::square;

/// Positions of the nodes in the parent square: corners, midside nodes, centre.
pub(super) const PLACES: [[f64; 2]; 9] = [
    [-1.0, -1.0],
    [1.0, -1.0],
    [1.0, 1.0],
    [-1.0, 1.0],
    [0.0, -1.0],
    [1.0, 0.0],
    [0.0, 1.0],
    [-1.0, 0.0],
    [0.0, 0.0],
];

/// The kind.
pub static KIND: ContinuumKind<9, 9> =
    ContinuumKind::new(28, QUADRATIC_SIDES, PLACES, || square(3), shape);

/// Products of two parabolas: N_i = L(ξ; ξ_i) L(η; η_i).
fn shape(xi: f64, eta: f64) -> Shape<9> {
    let (mut n, mut d) = ([0.0; 9], [[0.0; 2]; 9]);
    for (i, [a, b]) in PLACES.into_iter().enumerate() {
        let ((p, dp), (q, dq)) = (parabola(a, xi), parabola(b, eta));
        n[i] = p * q;
        d[i] = [dp * q, p * dq];
    }
    (n, d)
}

/// The parabola through −1, 0 and 1 that is 1 at `node` and 0 at the other two, and its slope.
fn parabola(node: f64, x: f64) -> (f64, f64) {
    if node == 0.0 {
        (1.0 - x * x, -2.0 * x)
    } else {
        (0.5 * x * (x + node), x + 0.5 * node)
    }
}
