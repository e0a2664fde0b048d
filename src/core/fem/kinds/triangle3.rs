//! 3-node triangle: linear displacements, constant strain; one integration point.
//!
//! Stiff in bending, and locks with nearly incompressible materials.

use super::{Parent, Shape, parents};
use crate::fem::quadrature::TRIANGLE_1;
use std::sync::LazyLock;

/// Positions of the nodes in the parent triangle.
pub const PLACES: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];

/// Shape functions at the nodes.
pub static NODES: LazyLock<[Parent<3>; 3]> =
    LazyLock::new(|| parents(PLACES.map(|at| (at, 0.0)), shape));

/// Integration rule, exact for the stiffness.
pub static RULE: LazyLock<[Parent<3>; 1]> = LazyLock::new(|| parents(TRIANGLE_1, shape));

/// N = 1 − ξ − η, ξ, η.
pub fn shape(xi: f64, eta: f64) -> Shape<3> {
    let n = [1.0 - xi - eta, xi, eta];
    (n, [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
}
