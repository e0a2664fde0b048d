//! Deformation of solids: det F and the principal stretches at the integration points and nodes of every element, and the
//! range of validity of each material law.
//!
//! In the plane, with a = |(F11 + F22, F21 − F12)| and b = |(F11 − F22, F12 + F21)|, the principal stretches are (a ± b) / 2;
//! the smaller stretch has the sign of det F. For a body of revolution the third stretch is 1 + u_x/X. In plane stress the
//! thickness stretch enters det F only.
//!
//! The ranges follow from the nominal stress P at a stretch s:
//!
//! - **St Venant-Kirchhoff**: if the compressed directions share the stretch s, and the other directions are constrained or
//!   stress-free, S = K (s² − 1) / 2 with a constant K. This covers compression along one, two or three directions in plane
//!   strain, plane stress and axisymmetry, for every ν. P = s S has its extremum at dP/ds = K (3 s² − 1) / 2 = 0: below s = 1/√3
//!   the material softens. For other ratios of the stretches the limit depends on ν. In tension P rises monotonically.
//! - **neo-Hookean**: μ/2 (I1 − 3) − μ ln J is polyconvex; λ/2 (ln J)² is convex in J for ln J < 1. The law does not soften in
//!   compression; it may soften in volumetric expansion beyond J = e.
//! - **linear elasticity** (`update: small`): never softens. It neglects ε²/2 relative to a strain ε, 5 % at ε = 0.1.
//! - **the updated stress update**: each increment starts with the small-strain moduli, and for small increments P = M (s − 1)
//!   under uniaxial strain. The law does not soften and has no range limit; it only requires det F > 0.

use super::continuum::{self, PointGradient};
use super::material::Material;
use crate::Model;
use crate::model::{BodyKind, Elastic, Law, Plane, Update};
use serde::{Deserialize, Serialize};
use std::f64::consts::E;

/// Stretch below which St Venant-Kirchhoff softens under compression: 1/√3.
pub const SOFTENING: f64 = 0.577_350_269_189_625_8;
/// Stretch below which linear elasticity neglects more than 5 % of the strain.
pub const SMALL: f64 = 0.9;

/// Deformation of an element at an integration point or node.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PointDeformation {
    /// Number of the body.
    pub body: usize,
    /// Number of the element in its solid, from 0.
    pub element: usize,
    /// Current position of the point.
    pub at: [f64; 2],
    /// Smallest principal stretch; negative if the element is inverted in the plane.
    pub stretch: f64,
    /// det F.
    pub determinant: f64,
}

/// Extreme deformations over all solids of a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deformation {
    /// Integration point with the smallest principal stretch.
    pub smallest: PointDeformation,
    /// Integration point or node with the smallest det F.
    pub flattest: PointDeformation,
    /// Integration point furthest outside the range of its law. `None` if all points are inside.
    pub outside: Option<PointDeformation>,
}

impl Deformation {
    /// The point with the smallest det F if it is not positive.
    pub fn inverted(&self) -> Option<PointDeformation> {
        let positive = self.flattest.determinant > 0.0;
        (!positive).then_some(self.flattest)
    }
}

/// Range of validity of a material law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StretchRange {
    /// Lower bound of the principal stretches.
    Stretch(f64),
    /// Upper bound of det F.
    Volume(f64),
    /// No bound.
    Unlimited,
}

impl StretchRange {
    /// The range of a material's law.
    pub fn from_elastic(elastic: &Elastic) -> StretchRange {
        match (elastic.update, elastic.law) {
            (Update::Total, Law::Svk) => StretchRange::Stretch(SOFTENING),
            (Update::Total, Law::NeoHookean) => StretchRange::Volume(E),
            (Update::Small, _) => StretchRange::Stretch(SMALL),
            (Update::Updated, _) => StretchRange::Unlimited,
        }
    }

    /// Fraction of the range that a point uses; more than 1 outside the range.
    fn used(self, stretch: f64, determinant: f64) -> f64 {
        match self {
            StretchRange::Stretch(least) if stretch > 0.0 => least / stretch,
            StretchRange::Stretch(_) => f64::INFINITY,
            StretchRange::Volume(most) => determinant / most,
            StretchRange::Unlimited => 0.0,
        }
    }
}

/// Computes the extremes over all solids for the displacements `u`. `None` in a scene without solids.
pub fn deformation(model: &Model, u: &[f64]) -> Option<Deformation> {
    let mut worst = None;
    let mut used = 1.0;
    each_point(model, u, |point| {
        let worst = worst.get_or_insert_with(|| Deformation {
            smallest: point.deformation(),
            flattest: point.deformation(),
            outside: None,
        });
        if is_less(point.determinant, worst.flattest.determinant) {
            worst.flattest = point.deformation();
        }
        if !point.gradient.integrates {
            return;
        }
        if is_less(point.stretch, worst.smallest.stretch) {
            worst.smallest = point.deformation();
        }
        let uses = StretchRange::from_elastic(point.elastic).used(point.stretch, point.determinant);
        if uses > used {
            (used, worst.outside) = (uses, Some(point.deformation()));
        }
    });
    worst
}

/// Whether `one` is less than `other`, or NaN.
fn is_less(one: f64, other: f64) -> bool {
    one.is_nan() || one < other
}

/// Smallest principal stretch at the integration points and smallest det F at all points of each solid element, by body and
/// element; the list of a body that is not a solid is empty.
pub fn by_element(model: &Model, u: &[f64]) -> Vec<Vec<[f64; 2]>> {
    let count = |kind: &BodyKind| match kind {
        BodyKind::Solid(solid) => solid.elements.len(),
        _ => 0,
    };
    let start = |body: &crate::model::Body| vec![[f64::INFINITY; 2]; count(&body.kind)];
    let mut all: Vec<Vec<[f64; 2]>> = model.bodies.iter().map(start).collect();
    each_point(model, u, |point| {
        let [stretch, determinant] = &mut all[point.body][point.element];
        if point.gradient.integrates {
            *stretch = stretch.min(point.stretch);
        }
        *determinant = determinant.min(point.determinant);
    });
    all
}

/// A point of an element that is being looked at.
struct SampledPoint<'a> {
    elastic: &'a Elastic,
    body: usize,
    element: usize,
    stretch: f64,
    determinant: f64,
    gradient: &'a PointGradient<'a>,
}

impl SampledPoint<'_> {
    fn deformation(&self) -> PointDeformation {
        PointDeformation {
            body: self.body,
            element: self.element,
            at: (self.gradient.at)(),
            stretch: self.stretch,
            determinant: self.determinant,
        }
    }
}

/// Calls a function for every point of every solid element, integration points before nodes.
fn each_point(model: &Model, u: &[f64], mut see: impl FnMut(&SampledPoint<'_>)) {
    for (body, one) in model.bodies.iter().enumerate() {
        let BodyKind::Solid(solid) = &one.kind else {
            continue;
        };
        for (number, element) in solid.elements.iter().enumerate() {
            let elastic = &solid.materials[element.material];
            let node = |k: usize| {
                let node = element.nodes[k];
                let first = model.dofs.first[node];
                (model.nodes[node].at, [u[first], u[first + 1]])
            };
            let formulation = continuum::formulation(element.kind);
            formulation.sample(element.nodes.len(), &node, &mut |gradient| {
                let [stretch, determinant] = measures(elastic, gradient);
                see(&SampledPoint {
                    elastic,
                    body,
                    element: number,
                    stretch,
                    determinant,
                    gradient,
                });
            });
        }
    }
}

/// Smallest principal stretch and det F.
fn measures(elastic: &Elastic, point: &PointGradient<'_>) -> [f64; 2] {
    let [[h11, h12], [h21, h22]] = point.h;
    // `hypot` would take most of the time, and its last digits depend on the system.
    let length = |x: f64, y: f64| (x * x + y * y).sqrt();
    let a = length(2.0 + h11 + h22, h21 - h12);
    let b = length(h11 - h22, h12 + h21);
    let (smaller, in_plane) = (0.5 * (a - b), 0.25 * (a - b) * (a + b));
    match (elastic.plane, elastic.update) {
        (Plane::Axisymmetric, _) => {
            let hoop = 1.0 + (point.hoop)();
            // An inversion in the plane and one around the axis would cancel, so a hoop stretch <= 0 counts as inverted.
            let determinant = match hoop > 0.0 {
                true => in_plane * hoop,
                false => -(in_plane * hoop).abs(),
            };
            [smaller.min(hoop), determinant]
        }
        (Plane::Stress, Update::Total) => [smaller, in_plane * thickness(elastic, point)],
        _ => [smaller, in_plane],
    }
}

/// Thickness stretch in plane stress; −1 if the law admits no positive thickness.
fn thickness(elastic: &Elastic, point: &PointGradient<'_>) -> f64 {
    let [[h11, h12], [h21, h22]] = point.h;
    let strain = nalgebra::Vector3::new(
        h11 + 0.5 * (h11 * h11 + h21 * h21),
        h22 + 0.5 * (h12 * h12 + h22 * h22),
        h12 + h21 + h11 * h12 + h21 * h22,
    );
    let response = Material::new(elastic).response(&strain);
    let squared = response.map_or(-1.0, |response| 1.0 + 2.0 * response.thickening);
    if squared > 0.0 { squared.sqrt() } else { -1.0 }
}
