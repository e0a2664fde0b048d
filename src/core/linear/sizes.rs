//! Scales of a scene: which forces are large, which are negligible, and how accurate double precision makes them.
//!
//! - *scale*: residuals are divided by it. It contains the loads of the whole history and the forces in the bodies. Without loads
//!   (prescribed displacements, free displacements of matrix bodies) the solution may have no forces at all, and round-off would
//!   be its own scale. Therefore forces that move the softest body by less than the round-off of lengths are negligible.
//! - *noise*: the round-off of the stiffest terms, |K| |u|, relative to the forces of interest: loads, contact forces, and
//!   reactions of prescribed displacements. The axial forces of a beam that is 1e16 times stiffer along its axis than across are
//!   only accurate to a few times the loads: regardless of the residual, no digit of its contact forces is right.

use crate::fem::pressure::Pressures;
use crate::linalg::largest;
use crate::model::{Body, BodyKind, Factor, Form};
use crate::plane::{max_abs, range};
use crate::{LinearisationPoint, Model};

/// Round-off of an internal force or length, in units of the machine precision times the sum of its terms' magnitudes.
pub const ROUND_OFF: f64 = 8.0;
/// Unit sizes are rounded to powers of two with this step in the exponent, so large that scenes in common units have units of
/// one.
const STEP: f64 = 32.0;

/// Quantity balanced by the equation of a degree of freedom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BalancedQuantity {
    /// Forces.
    Force,
    /// Moments, which are divided by the scene's length to compare with forces.
    Moment,
    /// Lengths: the shear of a shear-rigid beam, or the displacement error of a body given by its compliance.
    Length,
}

/// Scales of a scene.
pub struct Sizes {
    /// Quantity balanced by each degree of freedom's equation.
    pub kind: Vec<BalancedQuantity>,
    /// Largest load over the history (force).
    pub reference: f64,
    /// Stiffness of the softest body as a whole.
    pub softest: f64,
    /// The scene's length.
    length: f64,
}

impl Sizes {
    /// Computes the scales of a scene.
    pub fn new(model: &Model) -> Self {
        let kind = kinds(model);
        let mut sizes = Sizes {
            reference: 0.0,
            softest: softest_body(model),
            length: model.length,
            kind,
        };
        for load in &model.loads {
            let size = load.value.abs() * peak(&model.path, &load.scale);
            if let Some(lever) = sizes.lever(load.dof) {
                sizes.reference = sizes.reference.max(size / lever);
            }
        }
        if !model.pressures.is_empty() {
            let (mut force, rest) = (vec![0.0; model.dofs.len()], vec![0.0; model.dofs.len()]);
            let size = |k: usize| {
                let pressure = &model.pressures[k];
                pressure.value * peak(&model.path, &pressure.scale)
            };
            Pressures::new(model).each(&rest, size, |dof, part| force[dof] += part);
            let largest = max_abs(&force);
            sizes.reference = sizes.reference.max(largest);
        }
        sizes
    }

    /// Divisor that converts a generalised force at a degree of freedom to a force; `None` if lengths are balanced.
    pub fn lever(&self, dof: usize) -> Option<f64> {
        match self.kind[dof] {
            BalancedQuantity::Force => Some(1.0),
            BalancedQuantity::Moment => Some(self.length),
            BalancedQuantity::Length => None,
        }
    }

    /// Minimum force scale: without loads, negligible residuals are within this tolerance of it.
    pub fn least_scale(&self, tolerance: f64) -> f64 {
        if self.reference > 0.0 {
            return 0.0;
        }
        ROUND_OFF * f64::EPSILON * self.softest * self.length / tolerance
    }

    /// The forces of interest: loads, contact forces, and reactions of prescribed displacements; `reaction` returns the reaction
    /// force. Without loads, at least the force that moves the softest body by the largest displacement of the scene.
    pub fn force_scale(
        &self,
        model: &Model,
        at: &LinearisationPoint<'_>,
        reaction: impl Fn(usize) -> f64,
    ) -> f64 {
        let mut wanted = self.reference;
        for node in at.contacts {
            wanted = wanted.max(node.f_n.abs()).max(node.f_t.abs());
        }
        for prescribed in &model.prescribed {
            if let Some(lever) = self.lever(prescribed.dof) {
                wanted = wanted.max(reaction(prescribed.dof).abs() / lever);
            }
        }
        if self.reference == 0.0 {
            let motions = at.u.iter().zip(&self.kind);
            let motions = motions.filter(|(_, kind)| **kind == BalancedQuantity::Force);
            let largest = max_abs(motions.map(|(u, _)| u));
            wanted = wanted.max(self.softest * largest);
        }
        wanted
    }

    /// Units of the unknowns, which make the regularity of a scene independent of its physical units: with a stiffness k and the
    /// length l, √k for forces and 1/√k for displacements, divided by l for rotations. They are rounded to widely spaced powers
    /// of two; the scaling of the matrix equilibrates the rest.
    pub fn units(&self, model: &Model, stiffness: f64, units: &mut [f64]) {
        let root = (0.5 * coarse(stiffness)).exp2();
        let length = coarse(self.length).exp2();
        units.fill(root);
        for (kind, equation) in self.kind.iter().zip(&model.dofs.equation) {
            let Some(e) = *equation else { continue };
            match kind {
                BalancedQuantity::Force => units[e] = 1.0 / root,
                BalancedQuantity::Moment => units[e] = 1.0 / (root * length),
                BalancedQuantity::Length => {}
            }
        }
    }

    /// Largest displacement; rotations are multiplied by the scene's length.
    pub fn largest_motion(&self, u: &[f64]) -> f64 {
        let motion = |(u, kind): (&f64, &BalancedQuantity)| match kind {
            BalancedQuantity::Force => *u,
            BalancedQuantity::Moment => u * self.length,
            BalancedQuantity::Length => 0.0,
        };
        largest(u.iter().zip(&self.kind).map(motion))
    }
}

/// Number of the stiffest body, and the expected relative round-off of its forces: machine precision times the ratio of its
/// stiffness to that of the softest body. The reference is the load that moves the softest body by the same distance. `None`
/// without a body of elements.
pub fn expected_noise(model: &Model) -> Option<(usize, f64)> {
    let stiffness = |body: &Body| match &body.kind {
        BodyKind::Beam(beam) => Some(beam.ea / model.length),
        BodyKind::Truss(truss) => Some(truss.ea / model.length),
        BodyKind::Solid(solid) => {
            let all = solid.materials.iter();
            let all = all.map(|m| m.young * m.width(model.length));
            Some(all.fold(0.0, f64::max))
        }
        BodyKind::Linear(_) => None,
    };
    let all = model.bodies.iter().map(stiffness).enumerate();
    let all = all.filter_map(|(body, stiffness)| Some((body, stiffness?)));
    let (body, largest) = all.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some((
        body,
        ROUND_OFF * f64::EPSILON * largest / softest_body(model),
    ))
}

/// Exponent of the power of two to which a size is rounded.
fn coarse(size: f64) -> f64 {
    STEP * (size.log2() / STEP).round()
}

/// Largest magnitude of a load's factor over a path: at its corners, and at corners of the amplitude between them.
fn peak(path: &[f64], scale: &Factor) -> f64 {
    let [low, high] = range(path.iter().copied());
    let corners = path.iter().map(|&p| scale.at(p));
    let turns = scale.0.iter();
    let turns = turns.filter(|(at, _)| (low..=high).contains(at));
    max_abs(corners.chain(turns.map(|(_, factor)| *factor)))
}

/// Quantity balanced by the equation of each degree of freedom.
fn kinds(model: &Model) -> Vec<BalancedQuantity> {
    let mut kinds = vec![BalancedQuantity::Length; model.dofs.len()];
    for (&first, &count) in model.dofs.first.iter().zip(&model.dofs.count) {
        for (component, kind) in kinds[first..first + usize::from(count)]
            .iter_mut()
            .enumerate()
        {
            *kind = match component {
                2 => BalancedQuantity::Moment,
                _ => BalancedQuantity::Force,
            };
        }
    }
    kinds
}

/// Order of magnitude of the softest body's overall stiffness: bending stiffness for a beam.
fn softest_body(model: &Model) -> f64 {
    let of = |body: &Body| match &body.kind {
        BodyKind::Beam(beam) => beam.ei / model.length.powi(3),
        BodyKind::Solid(solid) => {
            let stiffness = solid
                .materials
                .iter()
                .map(|m| m.young * m.width(model.length));
            stiffness.fold(f64::INFINITY, f64::min)
        }
        BodyKind::Truss(truss) => truss.ea / model.length,
        BodyKind::Linear(linear) => {
            let largest = max_abs(linear.entries.iter().map(|(_, _, entry)| entry));
            match linear.form {
                Form::Stiffness => largest,
                Form::Compliance { .. } => 1.0 / largest,
            }
        }
    };
    let softest = model.bodies.iter().map(of).fold(f64::INFINITY, f64::min);
    if softest.is_normal() { softest } else { 1.0 }
}
