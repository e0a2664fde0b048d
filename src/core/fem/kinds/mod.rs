//! The kinds of continuum elements, one file each: nodes, faces, shape functions, integration rule and VTK cell type. To add one,
//! add its file and a line in the list below. [`super::isoparametric`] uses them all in the same way.
//!
//! The parent triangle is ξ, η >= 0, ξ + η <= 1, the parent square −1 <= ξ, η <= 1. Nodes are ordered: the corners,
//! anticlockwise; then the midside nodes, starting on the side after the first corner; then the centre.

pub mod quad4;
pub mod quad8;
pub mod quad9;
pub mod triangle3;
pub mod triangle6;

use crate::model::documented::documented;
use serde::{Deserialize, Serialize};
use std::sync::LazyLock;

/// Defines [`ElementKind`], and a macro that calls a function with the data of a kind; the function is generic over the numbers of
/// nodes and points. `$d` is a dollar sign.
macro_rules! kinds {
    ($d:tt $($(#[$($meta:tt)*])* $kind:ident $word:literal $module:ident::$data:ident,)*) => {
        documented! {
            /// A kind of plane continuum element. Nodes are ordered: the corners, anticlockwise; then the midside nodes, starting on the
            /// side after the first corner; then the centre.
            #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
            #[non_exhaustive]
            pub enum ElementKind {
                $($(#[$($meta)*])* #[serde(rename = $word)] $kind,)*
            }
        }

        crate::words! { ElementKind, ALL, word: $($kind $word),* }

        macro_rules! with_kind {
            ($d kind:expr, $d function:ident($d($d argument:expr),*)) => {
                match $d kind {
                    $($crate::fem::kinds::ElementKind::$kind => $d function(&$crate::fem::kinds::$module::$data, $d($d argument),*),)*
                }
            };
        }
        pub(crate) use with_kind;
    };
}

kinds! { $
    /// 3-node triangle: constant strain, 1 integration point. Stiff in bending; locks if nu is near 0.5.
    Triangle3 "triangle3" triangle3::KIND,
    /// 6-node triangle: quadratic displacements, 3 integration points.
    Triangle6 "triangle6" triangle6::KIND,
    /// 4-node quadrilateral, 2 x 2 points. Stiff in bending; locks if nu is near 0.5.
    Quad4 "quad4" quad4::KIND,
    /// 8-node quadrilateral (serendipity), 3 x 3 points.
    #[default]
    Quad8 "quad8" quad8::KIND,
    /// 8-node quadrilateral with reduced integration, 2 x 2 points: softer, and does not lock.
    Quad8Reduced "quad8r" quad8::REDUCED,
    /// 9-node quadrilateral, 3 x 3 points.
    Quad9 "quad9" quad9::KIND,
}

/// A kind with N nodes and P integration points.
pub struct ContinuumKind<const N: usize, const P: usize> {
    /// Number of the cell type in VTK files.
    vtk: u8,
    /// The faces as local node indices, anticlockwise.
    faces: &'static [&'static [usize]],
    /// Positions of the nodes in the parent element.
    pub(super) places: [[f64; 2]; N],
    /// The shape functions at ξ and η.
    pub(super) shape: fn(f64, f64) -> Shape<N>,
    /// Integration rule.
    pub(super) rule: LazyLock<[Parent<N>; P]>,
    /// Shape functions at the nodes.
    pub(super) nodes: LazyLock<[Parent<N>; N]>,
}

/// Faces of a quadrilateral with midside nodes.
const QUADRATIC_SIDES: &[&[usize]] = &[&[0, 4, 1], &[1, 5, 2], &[2, 6, 3], &[3, 7, 0]];

impl ElementKind {
    /// Number of nodes per element.
    pub fn nodes(self) -> usize {
        fn nodes<const N: usize, const P: usize>(_: &ContinuumKind<N, P>) -> usize {
            N
        }
        with_kind!(self, nodes())
    }

    /// Number of integration points.
    pub fn points(self) -> usize {
        fn points<const N: usize, const P: usize>(_: &ContinuumKind<N, P>) -> usize {
            P
        }
        with_kind!(self, points())
    }

    /// Number of its cell type in VTK files.
    pub fn vtk(self) -> u8 {
        fn vtk<const N: usize, const P: usize>(kind: &ContinuumKind<N, P>) -> u8 {
            kind.vtk
        }
        with_kind!(self, vtk())
    }

    /// The faces as local node indices, anticlockwise around the element, so that the outward side is on the right. A face with m
    /// nodes is an m-node interface element.
    pub fn faces(self) -> &'static [&'static [usize]] {
        fn faces<const N: usize, const P: usize>(
            kind: &ContinuumKind<N, P>,
        ) -> &'static [&'static [usize]] {
            kind.faces
        }
        with_kind!(self, faces())
    }

    /// Whether it is a triangle.
    pub fn is_triangle(self) -> bool {
        self.faces().len() == 3
    }

    /// Number of nodes per face.
    pub fn per_face(self) -> usize {
        self.faces().first().map_or(0, |face| face.len())
    }

    /// Local indices of the corners, anticlockwise; faces start there.
    pub fn corners(self) -> impl Iterator<Item = usize> {
        self.faces().iter().filter_map(|face| face.first()).copied()
    }

    /// The faces of an element with these nodes, as node numbers.
    pub fn faces_of(self, nodes: &[usize]) -> impl Iterator<Item = Vec<usize>> {
        let faces = self.faces().iter();
        faces.map(|face| face.iter().map(|&place| nodes[place]).collect())
    }
}

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
