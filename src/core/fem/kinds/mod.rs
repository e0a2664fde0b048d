//! The kinds of continuum elements, one file each: places of the nodes in the parent element, shape functions, and the rule
//! by which it is integrated. What is done with them is the same for all: [`super::isoparametric`].
//!
//! Triangles have the parent ξ, η >= 0, ξ + η <= 1, quadrilaterals the square −1 <= ξ, η <= 1. Corners come first,
//! anticlockwise, then the middles of the sides that start at them, then the middle.

pub mod quad4;
pub mod quad8;
pub mod quad9;
pub mod triangle3;
pub mod triangle6;

/// Values of N shape functions at a point of the parent element, and their derivatives by ξ and η.
pub type Shape<const N: usize> = ([f64; N], [[f64; 2]; N]);

/// What a kind with N nodes has at a point of its rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parent<const N: usize> {
    /// ξ and η.
    pub at: [f64; 2],
    /// The shape functions there.
    pub n: [f64; N],
    /// ∂N/∂ξ, ∂N/∂η.
    pub d: [[f64; 2]; N],
    /// Weight of the point.
    pub weight: f64,
}

/// The shape functions at the points of a rule, points with their weights.
fn parents<const N: usize, const P: usize>(
    rule: [([f64; 2], f64); P],
    shape: fn(f64, f64) -> Shape<N>,
) -> [Parent<N>; P] {
    rule.map(|(at, weight)| {
        let (n, d) = shape(at[0], at[1]);
        Parent { at, n, d, weight }
    })
}
