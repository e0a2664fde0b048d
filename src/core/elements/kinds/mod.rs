//! The kinds of continuum elements, one file each: nodes, faces, shape functions, integration rule and VTK cell type. To add one,
//! add its file and a line in the list below; [`register`](crate::fem::continuum::register) adds one from another package.
//! [`crate::fem::isoparametric`] uses them all in the same way.
//!
//! The parent triangle is ξ, η >= 0, ξ + η <= 1, the parent square −1 <= ξ, η <= 1. Nodes are ordered: the corners,
//! anticlockwise; then the midside nodes, starting on the side after the first corner; then the centre.

pub mod continuum_kind;
pub mod custom;
pub mod quad4;
pub mod quad8;
pub mod quad9;
pub mod triangle3;
pub mod triangle6;

use crate::documented::documented;
use continuum_kind::Outline;
use custom::{CustomKind, KindError};
use serde::de::{self, Deserialize, Deserializer, EnumAccess, VariantAccess, Visitor};
use serde::{Serialize, Serializer};
use std::any::Any;

/// Defines [`ElementKind`], and a macro that returns the data of a kind, which have another type for each number of nodes and
/// points. `$d` is a dollar sign.
macro_rules! kinds {
    ($d:tt $(#[$($meta:tt)*])* {
        $($(#[$($part:tt)*])* $kind:ident $word:literal $module:ident::$data:ident,)*
    }) => {
        $(#[$($meta)*])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
        #[non_exhaustive]
        pub enum ElementKind {
            $($(#[$($part)*])* $kind,)*
            /// A kind from another package.
            Custom(&'static CustomKind),
        }

        documented!(@docs ElementKind [$([$($meta)*])*] $($kind [$([$($part)*])*])*);

        impl ElementKind {
            /// The words of the kinds of this package, in order.
            pub const NAMES: [&'static str; [$($word),*].len()] = [$($word),*];
            /// The kinds of this package, in order.
            pub const ALL: [ElementKind; Self::NAMES.len()] = [$(ElementKind::$kind),*];

            /// Its word in files and messages.
            pub fn word(self) -> &'static str {
                match self {
                    $(ElementKind::$kind => $word,)*
                    ElementKind::Custom(kind) => kind.name,
                }
            }

            fn outline(self) -> &'static Outline {
                match self {
                    $(ElementKind::$kind => &$module::$data.outline,)*
                    ElementKind::Custom(kind) => &kind.outline,
                }
            }
        }

        macro_rules! data_of {
            ($d kind:expr, $d custom:expr) => {
                match $d kind {
                    $($crate::elements::kinds::ElementKind::$kind => &$crate::elements::kinds::$module::$data,)*
                    $crate::elements::kinds::ElementKind::Custom(kind) => $d custom(kind),
                }
            };
        }
        pub(crate) use data_of;
    };
}

kinds! { $
    /// A kind of plane continuum element. Nodes are ordered: the corners, anticlockwise; then the midside nodes, starting on the
    /// side after the first corner; then the centre.
    {
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
}

impl ElementKind {
    /// Adds a kind from another package, which files can then name.
    pub(crate) fn register(
        name: &'static str,
        outline: Outline,
        formulation: Box<dyn Any + Send + Sync>,
    ) -> Result<ElementKind, KindError> {
        let kind = CustomKind {
            name,
            outline,
            formulation,
        };
        kind.register(&Self::NAMES).map(ElementKind::Custom)
    }

    /// The one with this word.
    pub fn from_word(word: &str) -> Option<ElementKind> {
        let own = Self::ALL.into_iter().find(|kind| kind.word() == word);
        own.or_else(|| CustomKind::named(word).map(ElementKind::Custom))
    }

    /// Number of nodes per element.
    pub fn nodes(self) -> usize {
        self.outline().nodes
    }

    /// Number of integration points.
    pub fn points(self) -> usize {
        self.outline().points
    }

    /// Number of its cell type in VTK files.
    pub fn vtk(self) -> u8 {
        self.outline().vtk
    }

    /// The faces as local node indices, anticlockwise around the element, so that the outward side is on the right. A face with m
    /// nodes is an m-node interface element.
    pub fn faces(self) -> &'static [&'static [usize]] {
        self.outline().faces
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
        self.faces()
            .iter()
            .map(|face| face.iter().map(|&place| nodes[place]).collect())
    }
}

impl Serialize for ElementKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let place = Self::ALL
            .iter()
            .position(|kind| kind == self)
            .unwrap_or(Self::ALL.len()) as u32;
        serializer.serialize_unit_variant("ElementKind", place, self.word())
    }
}

impl<'de> Deserialize<'de> for ElementKind {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_enum("ElementKind", &Self::NAMES, ByWord)
    }
}

/// Reads an element kind: a variant without content, whose name it reads as an identifier.
struct ByWord;

impl<'de> Visitor<'de> for ByWord {
    type Value = ElementKind;

    fn expecting(&self, text: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        text.write_str("a kind of element")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<ElementKind, A::Error> {
        let (kind, rest) = data.variant_seed(self)?;
        rest.unit_variant()?;
        Ok(kind)
    }

    fn visit_str<E: de::Error>(self, word: &str) -> Result<ElementKind, E> {
        let kind = ElementKind::from_word(word);
        kind.ok_or_else(|| E::unknown_variant(word, &ElementKind::NAMES))
    }
}

impl<'de> de::DeserializeSeed<'de> for ByWord {
    type Value = ElementKind;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<ElementKind, D::Error> {
        deserializer.deserialize_identifier(self)
    }
}
