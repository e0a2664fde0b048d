//! 4-node quadrilateral: bilinear displacements; 2 × 2 Gauss points, or reduced integration with 1 point.
//!
//! With 2 × 2 points it is stiff in bending, and locks with nearly incompressible materials. With 1 point it has two hourglass
//! modes that strain no point; the reduced rule is therefore W = (1 − ε) W_1 + ε W_2×2, a physical hourglass control that is exact
//! for constant strain and needs no parameters of the material.

use super::continuum_kind::{ContinuumKind, Shape};
use crate::elements::quadrature::square;

/// Positions of the nodes in the parent square.
const PLACES: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

const SIDES: &[&[usize]] = &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]];

/// The kind.
pub static KIND: ContinuumKind<4, 4> = ContinuumKind::new(9, SIDES, PLACES, || square(2), shape);

/// Fraction ε of full integration in the reduced rule.
const HOURGLASS: f64 = 0.05;

/// The kind with reduced integration.
pub static REDUCED: ContinuumKind<4, 5> = ContinuumKind::new(
    9,
    SIDES,
    PLACES,
    || {
        let [a, b, c, d] = square::<4>(2).map(|(at, weight)| (at, HOURGLASS * weight));
        let middle = ([0.0; 2], 4.0 * (1.0 - HOURGLASS));
        [middle, a, b, c, d]
    },
    shape,
);

/// N_i = ¼ (1 + ξ_i ξ) (1 + η_i η).
fn shape(xi: f64, eta: f64) -> Shape<4> {
    let (mut n, mut d) = ([0.0; 4], [[0.0; 2]; 4]);
    for (i, [a, b]) in PLACES.into_iter().enumerate() {
        let (p, q) = (1.0 + a * xi, 1.0 + b * eta);
        n[i] = 0.25 * p * q;
        d[i] = [0.25 * a * q, 0.25 * b * p];
    }
    (n, d)
}
