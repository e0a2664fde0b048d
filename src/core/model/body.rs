//! What deforms: beams, continua of elements, and bodies that are given by a matrix.

use super::documented::documented;
use super::mesh::ElementKind;
use serde::{Deserialize, Serialize};

/// A deformable body.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Name in the scene.
    pub name: String,
    /// Distinct nodes of the body, along the chain for a beam.
    pub nodes: Vec<usize>,
    /// What it is made of.
    pub kind: BodyKind,
}

/// What a body is made of.
#[derive(Debug, Clone, PartialEq)]
pub enum BodyKind {
    /// A chain of beam elements.
    Beam(Beam),
    /// A plane continuum.
    Solid(Solid),
    /// Bars between nodes.
    Truss(Truss),
    /// A body given by a stiffness or compliance matrix.
    Linear(Linear),
}

impl Body {
    /// Whether it is a body of revolution.
    pub fn is_axisymmetric(&self) -> bool {
        let round = |m: &Elastic| m.plane == Plane::Axisymmetric;
        matches!(&self.kind, BodyKind::Solid(solid) if solid.materials.iter().any(round))
    }

    /// Whether forces are in balance on its undeformed shape, all of it ([`Update::Small`]).
    pub fn is_small(&self) -> bool {
        match &self.kind {
            BodyKind::Solid(solid) => solid.materials.iter().all(|m| m.update == Update::Small),
            BodyKind::Truss(truss) => truss.small,
            BodyKind::Beam(_) | BodyKind::Linear(_) => false,
        }
    }
}

impl BodyKind {
    /// The lines of a drawing of it: a beam's elements, a solid's outline, bars between two nodes.
    pub fn lines(&self) -> &[Vec<usize>] {
        match self {
            BodyKind::Beam(beam) => &beam.elements,
            BodyKind::Solid(solid) => &solid.edges,
            BodyKind::Truss(truss) => &truss.bars,
            BodyKind::Linear(linear) => &linear.bars,
        }
    }
}

/// A chain of m-node beam elements with one section.
#[derive(Debug, Clone, PartialEq)]
pub struct Beam {
    /// Node numbers of each element, all of the same count (2 to 9).
    pub elements: Vec<Vec<usize>>,
    /// Axial stiffness (force).
    pub ea: f64,
    /// Bending stiffness (force · length²).
    pub ei: f64,
    /// Shear stiffness (force). `None` is shear-rigid.
    pub ga: Option<f64>,
    /// First shear degree of freedom of a shear-rigid body; Gauss point p of element e has
    /// `first_shear + e * (m - 1) + p`. `None` if the body has a shear stiffness.
    pub first_shear: Option<usize>,
}

/// Bars between two nodes each, hinged at both.
#[derive(Debug, Clone, PartialEq)]
pub struct Truss {
    /// The two nodes of each bar.
    pub bars: Vec<Vec<usize>>,
    /// Axial stiffness of each bar (force).
    pub ea: f64,
    /// Whether displacements are small: each bar keeps its direction.
    pub small: bool,
}

/// A continuum of elements, of one kind or of several.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    /// Its elements.
    pub elements: Vec<SolidElement>,
    /// What they are made of.
    pub materials: Vec<Elastic>,
    /// Names of the materials in the scene, in the same order.
    pub material_names: Vec<String>,
    /// The faces around it ([`boundary`](super::mesh::boundary)).
    pub edges: Vec<Vec<usize>>,
}

/// An element of a continuum.
#[derive(Debug, Clone, PartialEq)]
pub struct SolidElement {
    /// What it is.
    pub kind: ElementKind,
    /// Its nodes, in the order that [`ElementKind`] says.
    pub nodes: Vec<usize>,
    /// Index into [`Solid::materials`].
    pub material: usize,
}

/// An elastic continuum's numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastic {
    /// Young's modulus (force by area).
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// How stress follows from strain.
    pub law: Law,
    /// What is assumed across the plane.
    pub plane: Plane,
    /// Thickness across the plane, undeformed (length); without meaning in axisymmetry.
    pub thickness: f64,
    /// What strains and stresses are referred to.
    pub update: Update,
}

impl Elastic {
    /// Width across the plane at x: the thickness, or in axisymmetry the circumference 2π x.
    pub fn width(&self, x: f64) -> f64 {
        match self.plane {
            Plane::Strain | Plane::Stress => self.thickness,
            Plane::Axisymmetric => std::f64::consts::TAU * x,
        }
    }
}

documented! {
    /// How stress follows from strain.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Law {
        /// St Venant-Kirchhoff, S = λ tr(E) I + 2μ E: large rotations; softens below a stretch of 1/√3 under compression.
        #[default]
        Svk,
        /// Compressible neo-Hookean, W = μ/2 (I1 − 3 − 2 ln J) + λ/2 (ln J)²: large strains too; compression does not soften it.
        NeoHookean,
    }
}

documented! {
    /// What happens across the plane.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Plane {
        /// No strain: a long body.
        #[default]
        Strain,
        /// No stress: a thin sheet.
        Stress,
        /// A body of revolution: x is the radius, y the axis, and rings strain as they grow, E33 = u_x/X + (u_x/X)²/2. Forces
        /// (loads, contact forces, reactions, cohesion) are those of the whole circumference, 2 pi x.
        Axisymmetric,
    }
}

documented! {
    /// What strains and stresses are referred to.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Update {
        /// The undeformed shape: the answer does not depend on the increments.
        #[default]
        Total,
        /// The shape at the last accepted increment, as in the paper: stress grows by the small-strain moduli times each
        /// increment's strain, and the answer depends on the size of the increments (its Fig. 8). Law svk only.
        Updated,
        /// Small strains and rotations: strains linear in the displacements, forces in balance on the undeformed shape, a
        /// constant stiffness (linear elasticity). Turning strains such a body. Law svk only.
        Small,
    }
}

/// A body that is given by a matrix over the x and y of its nodes, in their order.
#[derive(Debug, Clone, PartialEq)]
pub struct Linear {
    /// What the matrix means.
    pub form: Form,
    /// Row, column and value of the entries of the matrix, row by row: the whole diagonal, and all others that are not
    /// zero.
    pub entries: Vec<(usize, usize, f64)>,
    /// Pairs of nodes that bars join, for a drawing.
    pub bars: Vec<Vec<usize>>,
}

/// What the matrix of a [`Linear`] body is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// f = K u.
    Stiffness,
    /// u = free λ + W f. The forces f are unknowns of their own, from this degree of freedom on, in the order of the
    /// matrix; their equations are u − W f = free λ. The displacements where no force acts are loads there.
    Compliance {
        /// Degree of freedom of the first of the forces.
        first_force: usize,
    },
}

impl Linear {
    /// Whether the matrix equals its transpose, to the last bit.
    pub fn is_symmetric(&self) -> bool {
        let mut turned: Vec<(usize, usize, f64)> =
            self.entries.iter().map(|&(i, j, v)| (j, i, v)).collect();
        turned.sort_unstable_by_key(|&(i, j, _)| (i, j));
        turned == self.entries
    }
}
