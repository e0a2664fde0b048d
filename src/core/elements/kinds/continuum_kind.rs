//! Data of a kind of continuum element.

use crate::elements::quadrature::Point;
use std::sync::OnceLock;

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

/// What is known of a kind without its shape functions.
#[derive(Debug, Clone, Copy)]
pub struct Outline {
    /// Number of nodes.
    pub nodes: usize,
    /// Number of integration points.
    pub points: usize,
    /// Number of the cell type in VTK files.
    pub vtk: u8,
    /// The faces as local node indices, anticlockwise around the element, with equally spaced nodes.
    pub faces: &'static [&'static [usize]],
}

/// A kind with N nodes and P integration points.
pub struct ContinuumKind<const N: usize, const P: usize> {
    pub(crate) outline: Outline,
    places: [[f64; 2]; N],
    shape: fn(f64, f64) -> Shape<N>,
    points: fn() -> [Point; P],
    rule: OnceLock<[Parent<N>; P]>,
    at_nodes: OnceLock<[Parent<N>; N]>,
}

impl<const N: usize, const P: usize> ContinuumKind<N, P> {
    /// A kind with this VTK cell type, these faces (as in [`Outline`]), the positions of its nodes in the parent element, its
    /// integration rule, and its shape functions at ξ and η.
    pub const fn new(
        vtk: u8,
        faces: &'static [&'static [usize]],
        places: [[f64; 2]; N],
        points: fn() -> [Point; P],
        shape: fn(f64, f64) -> Shape<N>,
    ) -> Self {
        ContinuumKind {
            outline: Outline {
                nodes: N,
                points: P,
                vtk,
                faces,
            },
            places,
            shape,
            points,
            rule: OnceLock::new(),
            at_nodes: OnceLock::new(),
        }
    }

    /// Positions of the nodes in the parent element.
    pub fn places(&self) -> &[[f64; 2]; N] {
        &self.places
    }

    /// The shape functions at ξ and η.
    pub fn shape(&self, xi: f64, eta: f64) -> Shape<N> {
        (self.shape)(xi, eta)
    }

    /// The integration rule.
    pub fn rule(&self) -> &[Parent<N>; P] {
        self.rule
            .get_or_init(|| (self.points)().map(|point| self.parent(point)))
    }

    /// The shape functions at the nodes.
    pub fn at_nodes(&self) -> &[Parent<N>; N] {
        self.at_nodes
            .get_or_init(|| self.places.map(|at| self.parent((at, 0.0))))
    }

    fn parent(&self, (at, weight): Point) -> Parent<N> {
        let (n, d) = self.shape(at[0], at[1]);
        Parent { at, n, d, weight }
    }
}

/// Faces of a quadrilateral with midside nodes.
pub(super) const QUADRATIC_SIDES: &[&[usize]] = &[&[0, 4, 1], &[1, 5, 2], &[2, 6, 3], &[3, 7, 0]];
