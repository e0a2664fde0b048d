//! Explains a singular system: finds the body and the rigid motion.
//!
//! Every body may translate and rotate; supports, shared nodes and touching slave nodes are linear conditions on these motions.
//! Motions that satisfy all conditions are resisted only by existing stresses.

use crate::contact::projection::{Projection, tangent};
use crate::contact::state::ContactState;
use crate::model::{BodyKind, Model};
use crate::model::{Component, Mode};
use crate::plane::minus;
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

/// Condition values and amplitudes below this count as zero; both are of order one.
const ZERO: f64 = 1e-9;

/// A singular system.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Singular {
    /// A body is free to move rigidly.
    Rigid {
        /// The rigid motions, at least one.
        motions: Vec<RigidMotion>,
    },
    /// Not due to a rigid motion: a limit point, a bifurcation, or dependent constraints.
    Unexplained,
}

/// A rigid motion without resistance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RigidMotion {
    /// Name of the body.
    pub body: String,
    /// The motion.
    pub motion: LooseMotion,
}

/// A rigid motion of the plane.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum LooseMotion {
    /// Along this unit vector.
    Translation([f64; 2]),
    /// About this point.
    Rotation([f64; 2]),
}

/// The rigid motions without resistance, for these modes and this geometry.
pub fn diagnose<'a>(
    model: &Model,
    positions: &[[f64; 2]],
    nodes: &[ContactState],
    projection: impl Fn(usize) -> Option<&'a Projection>,
) -> Singular {
    let frame = Frame { model, positions };
    let mut conditions = Vec::new();
    frame.supports(&mut conditions);
    frame.joints(&mut conditions);
    for (s, node) in nodes.iter().enumerate() {
        let (Some(projection), Some(spot)) = (projection(s), node.spot) else {
            continue;
        };
        let master = &model.surfaces[spot.surface].elements[spot.element];
        let directions = [projection.normal, tangent(projection.normal)];
        let active = match node.mode {
            Mode::Free => 0,
            Mode::Sliding => 1,
            Mode::Fixed => 2,
        };
        for direction in &directions[..active] {
            let mut row = frame.row();
            for (n, weight) in model.contacts[s].carriers() {
                frame.add(&mut row, n, *direction, -weight);
            }
            for (&n, &weight) in master.iter().zip(&projection.shape) {
                frame.add(&mut row, n, *direction, weight);
            }
            conditions.push(row);
        }
    }
    frame.linear(&mut conditions);
    let motions = null_space(conditions, frame.columns())
        .iter()
        .flat_map(|v| frame.name(v))
        .collect::<Vec<_>>();
    if motions.is_empty() {
        Singular::Unexplained
    } else {
        Singular::Rigid { motions }
    }
}

/// Rigid motions of all bodies: columns x, y and rotation (times the scene's length) for each.
struct Frame<'a> {
    model: &'a Model,
    positions: &'a [[f64; 2]],
}

impl Frame<'_> {
    fn columns(&self) -> usize {
        3 * self.model.bodies.len()
    }

    fn row(&self) -> Vec<f64> {
        vec![0.0; self.columns()]
    }

    fn center(&self, body: usize) -> [f64; 2] {
        let nodes = &self.model.bodies[body].nodes;
        let sum = nodes.iter().fold([0.0; 2], |s, &n| {
            [s[0] + self.positions[n][0], s[1] + self.positions[n][1]]
        });
        sum.map(|s| s / nodes.len() as f64)
    }

    fn body_of(&self, node: usize) -> Option<usize> {
        self.model
            .bodies
            .iter()
            .position(|b| b.nodes.contains(&node))
    }

    /// Adds weight times the motion of a body's node in a direction.
    fn add_as(&self, row: &mut [f64], body: usize, node: usize, direction: [f64; 2], weight: f64) {
        let (center, x) = (self.center(body), self.positions[node]);
        let arm = minus(x, center);
        row[3 * body] += weight * direction[0];
        row[3 * body + 1] += weight * direction[1];
        row[3 * body + 2] +=
            weight * (direction[1] * arm[0] - direction[0] * arm[1]) / self.model.length;
    }

    fn add(&self, row: &mut [f64], node: usize, direction: [f64; 2], weight: f64) {
        if let Some(body) = self.body_of(node) {
            self.add_as(row, body, node, direction, weight);
        }
    }

    /// A component of a body's node: a displacement or the rotation.
    fn add_component(
        &self,
        row: &mut [f64],
        body: usize,
        node: usize,
        component: Component,
        weight: f64,
    ) {
        match component {
            Component::X => self.add_as(row, body, node, [1.0, 0.0], weight),
            Component::Y => self.add_as(row, body, node, [0.0, 1.0], weight),
            Component::Rotation => row[3 * body + 2] += weight,
        }
    }

    fn supports(&self, conditions: &mut Vec<Vec<f64>>) {
        for (b, body) in self.model.bodies.iter().enumerate() {
            for &n in &body.nodes {
                for component in [Component::X, Component::Y, Component::Rotation] {
                    let Some(dof) = self.model.dofs.dof(n, component) else {
                        continue;
                    };
                    // The rotation of a node shared by a solid and a beam is the beam's.
                    if component == Component::Rotation && !matches!(body.kind, BodyKind::Beam(_)) {
                        continue;
                    }
                    if self.model.dofs.equation[dof].is_none() {
                        let mut row = self.row();
                        self.add_component(&mut row, b, n, component, 1.0);
                        conditions.push(row);
                    }
                }
            }
        }
    }

    fn joints(&self, conditions: &mut Vec<Vec<f64>>) {
        for (b, body) in self.model.bodies.iter().enumerate() {
            for &n in &body.nodes {
                let Some(first) = self.body_of(n).filter(|&first| first != b) else {
                    continue;
                };
                // A solid's node has no rotation.
                let stiff = [first, b]
                    .iter()
                    .all(|&b| matches!(self.model.bodies[b].kind, BodyKind::Beam(_)));
                let components = [Component::X, Component::Y, Component::Rotation];
                for &component in &components[..if stiff { 3 } else { 2 }] {
                    let mut row = self.row();
                    self.add_component(&mut row, first, n, component, 1.0);
                    self.add_component(&mut row, b, n, component, -1.0);
                    conditions.push(row);
                }
            }
        }
    }

    /// Bodies given by a matrix or made of bars have no identifiable rigid motion, nor do bodies that share nodes with them.
    fn linear(&self, conditions: &mut Vec<Vec<f64>>) {
        for (b, body) in self.model.bodies.iter().enumerate() {
            // A body of revolution can only translate along the axis.
            let stiff: &[usize] = match &body.kind {
                BodyKind::Linear(_) | BodyKind::Truss(_) => &[0, 1, 2],
                BodyKind::Solid(_) if body.is_axisymmetric() => &[0, 2],
                BodyKind::Beam(_) | BodyKind::Solid(_) => &[],
            };
            for component in stiff.iter().copied() {
                let mut row = self.row();
                row[3 * b + component] = 1.0;
                conditions.push(row);
            }
        }
    }

    /// Describes the motion of each body in a null vector.
    fn name(&self, v: &[f64]) -> Vec<RigidMotion> {
        let size = v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let moved = |b: &usize| v[3 * b..3 * b + 3].iter().any(|x| x.abs() > ZERO * size);
        (0..self.model.bodies.len())
            .filter(moved)
            .map(|b| {
                let (x, y, turn) = (v[3 * b], v[3 * b + 1], v[3 * b + 2] / self.model.length);
                let center = self.center(b);
                let motion = if (turn * self.model.length).abs() > ZERO * size {
                    LooseMotion::Rotation([center[0] - y / turn, center[1] + x / turn])
                } else {
                    let length = x.hypot(y);
                    LooseMotion::Translation([x / length, y / length])
                };
                RigidMotion {
                    body: self.model.bodies[b].name.clone(),
                    motion,
                }
            })
            .collect()
    }
}

/// Basis of the vectors that satisfy all conditions, in reduced echelon form so that each describes one motion.
fn null_space(mut conditions: Vec<Vec<f64>>, columns: usize) -> Vec<Vec<f64>> {
    let zero = vec![0.0; columns];
    while conditions.len() < columns {
        conditions.push(zero.clone());
    }
    let matrix = DMatrix::from_fn(conditions.len(), columns, |i, j| conditions[i][j]);
    let svd = matrix.svd(false, true);
    let Some(v_t) = svd.v_t else {
        return Vec::new();
    };
    let mut basis: Vec<Vec<f64>> = (0..columns)
        .filter(|&k| svd.singular_values[k] < ZERO)
        .map(|k| v_t.row(k).iter().copied().collect())
        .collect();
    reduce(&mut basis, columns);
    basis
}

/// Gauss-Jordan elimination.
fn reduce(basis: &mut [Vec<f64>], columns: usize) {
    let mut done = 0;
    for col in 0..columns {
        let Some(pivot) = (done..basis.len())
            .max_by(|&a, &b| basis[a][col].abs().total_cmp(&basis[b][col].abs()))
        else {
            return;
        };
        if basis[pivot][col].abs() < 1e-6 {
            continue;
        }
        basis.swap(done, pivot);
        let row: Vec<f64> = basis[done].iter().map(|x| x / basis[done][col]).collect();
        for (k, other) in basis.iter_mut().enumerate() {
            let factor = if k == done { 0.0 } else { other[col] };
            other
                .iter_mut()
                .zip(&row)
                .for_each(|(x, r)| *x -= factor * r);
        }
        basis[done] = row;
        done += 1;
    }
}
