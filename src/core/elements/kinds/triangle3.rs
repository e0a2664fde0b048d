//! 3-node triangle: linear displacements, constant strain; one integration point.
//!
//! Stiff in bending, and locks with nearly incompressible materials.

use super::continuum_kind::{ContinuumKind, Shape};
use crate::elements::quadrature::TRIANGLE_1;

/// Positions of the nodes in the parent triangle.
const PLACES: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];

/// The kind; its integration rule is exact for the stiffness.
pub static KIND: ContinuumKind<3, 1> = ContinuumKind::new(
    5,
    &[&[0, 1], &[1, 2], &[2, 0]],
    PLACES,
    || TRIANGLE_1,
    shape,
);

/// N = 1 − ξ − η, ξ, η.
fn shape(xi: f64, eta: f64) -> Shape<3> {
    let n = [1.0 - xi - eta, xi, eta];
    (n, [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
}
