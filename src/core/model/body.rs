//! Deformable bodies: beams, continua, trusses, and bodies given by a matrix.

use crate::documented::documented;
use crate::elements::kinds::ElementKind;

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
    /// The mesh, if it is a solid.
    pub fn solid(&self) -> Option<&Solid> {
        match &self.kind {
            BodyKind::Solid(solid) => Some(solid),
            _ => None,
        }
    }

    /// Whether it is given by a matrix.
    pub fn is_linear(&self) -> bool {
        matches!(self.kind, BodyKind::Linear(_))
    }

    /// Whether a compliance gives its motion for any forces, so that it needs no support.
    pub fn is_compliance(&self) -> bool {
        let BodyKind::Linear(linear) = &self.kind else {
            return false;
        };
        matches!(linear.form, Form::Compliance { .. })
    }

    /// Whether it is a body of revolution.
    pub fn is_axisymmetric(&self) -> bool {
        let round = |material: &Elastic| material.plane == Plane::Axisymmetric;
        self.solid()
            .is_some_and(|solid| solid.materials.iter().any(round))
    }

    /// Whether equilibrium of the whole body is written on its undeformed shape ([`Update::Small`]).
    pub fn is_small(&self) -> bool {
        match &self.kind {
            BodyKind::Solid(solid) => solid.materials.iter().all(|m| m.update == Update::Small),
            BodyKind::Truss(truss) => truss.small,
            BodyKind::Beam(_) | BodyKind::Linear(_) => false,
        }
    }

    /// Whether equilibrium of a part of the body is written on its undeformed shape.
    pub fn has_small_part(&self) -> bool {
        let part = |solid: &Solid| solid.materials.iter().any(|m| m.update == Update::Small);
        self.is_small() || self.solid().is_some_and(part)
    }
}

impl BodyKind {
    /// Polylines that draw the body: a beam's elements, a solid's outline, a truss's bars.
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
    /// Node numbers of each element; all elements have the same number of nodes (2 to 9).
    pub elements: Vec<Vec<usize>>,
    /// Axial stiffness (force).
    pub ea: f64,
    /// Bending stiffness (force · length²).
    pub ei: f64,
    /// Shear stiffness (force). `None` means shear-rigid.
    pub ga: Option<f64>,
    /// First shear degree of freedom of a shear-rigid body; Gauss point p of element e has
    /// `first_shear + e * (m - 1) + p`. `None` if the body has a shear stiffness.
    pub first_shear: Option<usize>,
}

/// Bars between two nodes, hinged at both ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Truss {
    /// The two nodes of each bar.
    pub bars: Vec<Vec<usize>>,
    /// Axial stiffness of each bar (force).
    pub ea: f64,
    /// Whether displacements are small: each bar keeps its direction.
    pub small: bool,
}

/// A continuum of elements, of one or several kinds.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    /// The elements.
    pub elements: Vec<SolidElement>,
    /// The materials of the elements.
    pub materials: Vec<Elastic>,
    /// Names of the materials in the scene, in the same order.
    pub material_names: Vec<String>,
    /// The boundary faces ([`boundary`](super::mesh::boundary)).
    pub edges: Vec<Vec<usize>>,
}

/// An element of a continuum.
#[derive(Debug, Clone, PartialEq)]
pub struct SolidElement {
    /// Kind of element.
    pub kind: ElementKind,
    /// Nodes, in the order defined by [`ElementKind`].
    pub nodes: Vec<usize>,
    /// Index into [`Solid::materials`].
    pub material: usize,
}

/// Parameters of an elastic continuum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastic {
    /// Young's modulus (force per area).
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Stress-strain law.
    pub law: Law,
    /// Assumption about the out-of-plane direction.
    pub plane: Plane,
    /// Undeformed thickness across the plane (length); unused in axisymmetry.
    pub thickness: f64,
    /// Reference configuration of strains and stresses.
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
    /// Stress-strain law.
    pub choice Law {
        /// St Venant-Kirchhoff, S = λ tr(E) I + 2μ E: for large rotations and small strains. In compression it softens below a
        /// stretch of 1/√3.
        #[default]
        Svk,
        /// Compressible neo-Hookean, W = μ/2 (I1 − 3 − 2 ln J) + λ/2 (ln J)²: for large strains too; it does not soften in
        /// compression.
        NeoHookean,
    }
}

documented! {
    /// Assumption about the out-of-plane direction.
    pub choice Plane {
        /// No out-of-plane strain: a long body.
        #[default]
        Strain,
        /// No out-of-plane stress: a thin sheet.
        Stress,
        /// A body of revolution: x is the radius and y the axis. The hoop strain is E33 = u_x/X + (u_x/X)²/2. Forces (loads,
        /// contact forces, reactions, cohesion) refer to the whole circumference, 2 pi x.
        Axisymmetric,
    }
}

documented! {
    /// Reference configuration of strains and stresses.
    pub choice Update {
        /// The undeformed shape (total Lagrangian): the result does not depend on the increment size.
        #[default]
        Total,
        /// The shape at the last accepted increment, as in the paper: each increment adds the small-strain moduli times its
        /// strain to the stress, so the result depends on the increment size (Fig. 8 of the paper). Requires law svk.
        Updated,
        /// Linear elasticity: strains are linear in the displacements, equilibrium is written on the undeformed shape, and the
        /// stiffness is constant. Rotations strain such a body. Requires law svk.
        Small,
    }
}

/// A body given by a matrix over the x and y degrees of freedom of its nodes, in node order.
#[derive(Debug, Clone, PartialEq)]
pub struct Linear {
    /// Meaning of the matrix.
    pub form: Form,
    /// Row, column and value of the matrix entries, row by row: the whole diagonal and all nonzero off-diagonal entries.
    pub entries: Vec<(usize, usize, f64)>,
    /// Pairs of nodes connected by bars, for drawing.
    pub bars: Vec<Vec<usize>>,
}

/// Meaning of the matrix of a [`Linear`] body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// f = K u.
    Stiffness,
    /// u = free λ + W f. The forces f are additional unknowns, numbered from `first_force` in matrix order; their equations are u
    /// − W f = free λ. The displacements under zero force enter as loads.
    Compliance {
        /// Degree of freedom of the first force.
        first_force: usize,
    },
}

impl Linear {
    /// Whether the matrix is exactly (bitwise) symmetric.
    pub fn is_symmetric(&self) -> bool {
        let mut turned: Vec<(usize, usize, f64)> =
            self.entries.iter().map(|&(i, j, v)| (j, i, v)).collect();
        turned.sort_unstable_by_key(|&(i, j, _)| (i, j));
        turned == self.entries
    }
}
