//! The sizes that a scene itself gives: which forces are large, which are nothing, and what double precision leaves of
//! them.
//!
//! - *scale*: what residuals are divided by. The loads of the whole history, and the forces in the bodies. Where no load
//!   is named (prescribed motions, bodies that want to move), the answer may be that there is no force at all; round-off
//!   would then be its own scale. So a force counts as nothing that moves the softest body by the round-off of lengths.
//! - *noise*: the round-off of the stiffest terms, |K| |u|, against the forces that are wanted: loads, contact forces,
//!   reactions of what is moved. A beam that is 1e16 times stiffer along its axis than across has axial forces that are
//!   known to a few loads only; whatever the residual says, no digit of its contact forces is right.

use crate::fem::pressure::Pressures;
use crate::linear::source::At;
use crate::model::Component;
use crate::model::{Body, BodyKind, Factor, Form, Model};

/// Round-off of an internal force, or of a length, in units of the machine precision times the terms that it sums up.
pub const ROUND_OFF: f64 = 8.0;
/// Sizes of units are rounded to powers of two with this step in the exponent: far enough for scenes in common units to
/// be in units of one.
const STEP: f64 = 32.0;

/// What the equation of a degree of freedom balances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Balanced {
    /// Forces.
    Force,
    /// Moments, which count as forces over the scene's length.
    Moment,
    /// Lengths: the shear of a shear-rigid beam, or how far a body that is given by its compliance is from where its
    /// forces put it.
    Length,
}

/// Sizes of a scene.
pub struct Sizes {
    /// Of each degree of freedom.
    pub kind: Vec<Balanced>,
    /// Largest force that the loads reach over the history.
    pub reference: f64,
    /// Stiffness of the softest body as a whole.
    pub softest: f64,
    /// The scene's length.
    length: f64,
}

impl Sizes {
    /// Computes the sizes of a scene.
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
            let peak = |scale: &Factor| peak(&model.path, scale);
            Pressures::new(model).each(model, &rest, peak, |dof, part| force[dof] += part);
            let largest = force
                .iter()
                .fold(0.0_f64, |most, force| most.max(force.abs()));
            sizes.reference = sizes.reference.max(largest);
        }
        sizes
    }

    /// What a force at a degree of freedom is divided by to count as a force; none where lengths are balanced.
    pub fn lever(&self, dof: usize) -> Option<f64> {
        match self.kind[dof] {
            Balanced::Force => Some(1.0),
            Balanced::Moment => Some(self.length),
            Balanced::Length => None,
        }
    }

    /// Least scale of forces: where no load sets one, residuals that are nothing are within this tolerance of it.
    pub fn least_scale(&self, tolerance: f64) -> f64 {
        if self.reference > 0.0 {
            return 0.0;
        }
        ROUND_OFF * f64::EPSILON * self.softest * self.length / tolerance
    }

    /// The forces that are wanted: loads, contact forces, and reactions where motions are prescribed; `reaction` is the
    /// force there. Where no load is named, at least what it takes to move the softest body as far as the scene has moved.
    pub fn wanted(&self, model: &Model, at: &At<'_>, reaction: impl Fn(usize) -> f64) -> f64 {
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
            let motions = motions.filter(|(_, kind)| **kind == Balanced::Force);
            let largest = motions.fold(0.0_f64, |most, (u, _)| most.max(u.abs()));
            wanted = wanted.max(self.softest * largest);
        }
        wanted
    }

    /// Sizes of the unknowns in the scene's own units, so that a scene in other units is as regular: with a stiffness k and
    /// the length l, the square root of k for forces and its inverse for displacements, over l for rotations. They are
    /// rounded to powers of two far apart; what is left, the scaling of the matrix evens out.
    pub fn units(&self, model: &Model, stiffness: f64, units: &mut [f64]) {
        let root = (0.5 * coarse(stiffness)).exp2();
        let length = coarse(self.length).exp2();
        units.fill(root);
        for (kind, equation) in self.kind.iter().zip(&model.dofs.equation) {
            let Some(e) = *equation else { continue };
            match kind {
                Balanced::Force => units[e] = 1.0 / root,
                Balanced::Moment => units[e] = 1.0 / (root * length),
                Balanced::Length => {}
            }
        }
    }

    /// Largest displacement; a rotation counts as the displacement that it makes over the scene's length.
    pub fn largest_motion(&self, u: &[f64]) -> f64 {
        let motion = |(u, kind): (&f64, &Balanced)| match kind {
            Balanced::Force => u.abs(),
            Balanced::Moment => u.abs() * self.length,
            Balanced::Length => 0.0,
        };
        // Not max, which takes no notice of what is no number.
        let motions = u.iter().zip(&self.kind).map(motion);
        motions.fold(0.0, |most, u| if u <= most { most } else { u })
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

/// Exponent of the power of two that a size is rounded to.
fn coarse(size: f64) -> f64 {
    STEP * (size.log2() / STEP).round()
}

/// Largest size of a load's factor over a path: at its corners, and where the factor itself turns between them.
fn peak(path: &[f64], scale: &Factor) -> f64 {
    let (low, high) = path
        .iter()
        .fold((f64::INFINITY, -f64::INFINITY), |(l, h), &p| {
            (l.min(p), h.max(p))
        });
    let corners = path.iter().map(|&p| scale.at(p));
    let turns = scale.0.iter();
    let turns = turns.filter(|(at, _)| (low..=high).contains(at));
    corners
        .chain(turns.map(|(_, factor)| *factor))
        .fold(0.0_f64, |most, factor| most.max(factor.abs()))
}

/// What the equation of each degree of freedom balances.
fn kinds(model: &Model) -> Vec<Balanced> {
    let mut kinds = vec![Balanced::Length; model.dofs.len()];
    for (&first, &count) in model.dofs.first.iter().zip(&model.dofs.count) {
        for k in 0..count as usize {
            kinds[first + k] = if k == Component::Rotation as usize {
                Balanced::Moment
            } else {
                Balanced::Force
            };
        }
    }
    kinds
}

/// Order of magnitude of the softest body's stiffness as a whole: that of a beam in bending, of a solid by itself.
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
            let largest = linear.entries.iter().fold(0.0_f64, |m, e| m.max(e.2.abs()));
            match linear.form {
                Form::Stiffness => largest,
                Form::Compliance { .. } => 1.0 / largest,
            }
        }
    };
    let softest = model.bodies.iter().map(of).fold(f64::INFINITY, f64::min);
    if softest.is_normal() { softest } else { 1.0 }
}
