//! Data of a kind of continuum element.

use std::sync::LazyLock;

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
pub(super) fn parents<const N: usize, const P: usize>(
    rule: [([f64; 2], f64); P],
    shape: fn(f64, f64) -> Shape<N>,
) -> [Parent<N>; P] {
    rule.map(|(at, weight)| {
        let (n, d) = shape(at[0], at[1]);
        Parent { at, n, d, weight }
    })
}

/// A kind with N nodes and P integration points.
pub struct ContinuumKind<const N: usize, const P: usize> {
    /// Number of the cell type in VTK files.
    pub(super) vtk: u8,
    /// The faces as local node indices, anticlockwise.
    pub(super) faces: &'static [&'static [usize]],
    /// Positions of the nodes in the parent element.
    pub(crate) places: [[f64; 2]; N],
    /// The shape functions at ξ and η.
    pub(crate) shape: fn(f64, f64) -> Shape<N>,
    /// Integration rule.
    pub(crate) rule: LazyLock<[Parent<N>; P]>,
    /// Shape functions at the nodes.
    pub(crate) nodes: LazyLock<[Parent<N>; N]>,
}

/// Faces of a quadrilateral with midside nodes.
pub(super) const QUADRATIC_SIDES: &[&[usize]] = &[&[0, 4, 1], &[1, 5, 2], &[2, 6, 3], &[3, 7, 0]];
