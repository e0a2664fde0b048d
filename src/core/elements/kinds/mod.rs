//! The kinds of continuum elements, one file each: nodes, faces, shape functions, integration rule and VTK cell type. To add one,
//! add its file and a line in the list below. [`crate::fem::isoparametric`] uses them all in the same way.
//!
//! The parent triangle is ξ, η >= 0, ξ + η <= 1, the parent square −1 <= ξ, η <= 1. Nodes are ordered: the corners,
//! anticlockwise; then the midside nodes, starting on the side after the first corner; then the centre.

pub mod continuum_kind;
pub mod quad4;
pub mod quad8;
pub mod quad9;
pub mod triangle3;
pub mod triangle6;

use crate::documented::documented;
use continuum_kind::ContinuumKind;
use serde::{Deserialize, Serialize};

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
                    $($crate::elements::kinds::ElementKind::$kind => $d function(&$crate::elements::kinds::$module::$data, $d($d argument),*),)*
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
    /// 4-node quadrilateral with reduced integration: 1 point, and 2 x 2 points with 5 % of the stiffness against hourglass
    /// modes. Softer, and does not lock.
    Quad4Reduced "quad4r" quad4::REDUCED,
    /// 8-node quadrilateral (serendipity), 3 x 3 points.
    #[default]
    Quad8 "quad8" quad8::KIND,
    /// 8-node quadrilateral with reduced integration, 2 x 2 points: softer, and does not lock.
    Quad8Reduced "quad8r" quad8::REDUCED,
    /// 9-node quadrilateral, 3 x 3 points.
    Quad9 "quad9" quad9::KIND,
}

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
