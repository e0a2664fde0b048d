//! The kinds of continuum elements, one file each: positions of the nodes in the parent element, shape functions, and integration
//! rule. [`super::isoparametric`] uses them all in the same way.
//!
//! The parent triangle is ξ, η >= 0, ξ + η <= 1, the parent square −1 <= ξ, η <= 1. Nodes are ordered: the corners,
//! anticlockwise; then the midside nodes, starting on the side after the first corner; then the centre.

pub mod quad4;
pub mod quad8;
pub mod quad9;
pub mod triangle3;
pub mod triangle6;

/// Values of N shape functions at a point of the parent element, and their derivatives with respect to ξ and η.
pub type Shape<const N: usize> = ([f64; N], [[f64; 2]; N]);

/// Data of a kind with N nodes at an integration point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parent<const N: usize> {
    /// ξ and η.
    pub at: [f64; 2],
    /// The shape functions.
    pub n: [f64; N],
    /// ∂N/∂ξ, ∂N/∂η.
    pub d: [[f64; 2]; N],
    /// Weight of the point.
    pub weight: f64,
}

/// The shape functions at points with weights.
fn parents<const N: usize, const P: usize>(
    rule: [([f64; 2], f64); P],
    shape: fn(f64, f64) -> Shape<N>,
) -> [Parent<N>; P] {
    rule.map(|(at, weight)| {
        let (n, d) = shape(at[0], at[1]);
        Parent { at, n, d, weight }
    })
}
