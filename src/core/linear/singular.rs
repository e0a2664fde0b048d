//! Explains a singular system: finds the body and the rigid motion.
//!
//! Every body may translate and rotate; supports, shared nodes and touching slave nodes are linear conditions on these motions.
//! Motions that satisfy all conditions are resisted only by existing stresses.

use crate::contact::projection::{Projection, tangent};
use crate::groups::distinct;
use crate::model::BodyKind;
use crate::model::Component;
use crate::plane::{max_abs, minus, plus};
use crate::{ContactState, Mode, Model};
use nalgebra::{DMatrix, RowVector3};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashMap};

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

/// The rigid motions without resistance, for these modes and this geometry, first those on which the loads (force by degree of
/// freedom) do work.
pub fn diagnose<'a>(
    model: &Model,
    (positions, loads): (&[[f64; 2]], &[f64]),
    nodes: &[ContactState],
    projection: impl Fn(usize) -> Option<&'a Projection>,
) -> Singular {
    let frame = Frame::new(model, positions);
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
            let mut row = Row::new();
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
    let mut free = null_space(conditions, model.bodies.len());
    let loads = frame.loads(loads);
    free.sort_by_key(|v| !does_work(&loads, v));
    let motions = free.iter().flat_map(|v| frame.name(v)).collect::<Vec<_>>();
    if motions.is_empty() {
        Singular::Unexplained
    } else {
        Singular::Rigid { motions }
    }
}

/// A condition: the coefficients of its columns, which are x, y and rotation (times the scene's length) of each body.
type Row = BTreeMap<usize, f64>;

/// Rigid motions of all bodies.
struct Frame<'a> {
    model: &'a Model,
    positions: &'a [[f64; 2]],
    /// The first body of each node.
    owners: HashMap<usize, usize>,
    centers: Vec<[f64; 2]>,
}

impl<'a> Frame<'a> {
    fn new(model: &'a Model, positions: &'a [[f64; 2]]) -> Self {
        let mut owners = HashMap::new();
        let mut centers = Vec::new();
        for (b, body) in model.bodies.iter().enumerate() {
            let mut sum = [0.0; 2];
            for &n in &body.nodes {
                owners.entry(n).or_insert(b);
                sum = plus(sum, positions[n]);
            }
            centers.push(sum.map(|s| s / body.nodes.len() as f64));
        }
        Frame {
            model,
            positions,
            owners,
            centers,
        }
    }

    /// Adds weight times the motion of a body's node in a direction.
    fn add_as(&self, row: &mut Row, body: usize, node: usize, direction: [f64; 2], weight: f64) {
        let arm = minus(self.positions[node], self.centers[body]);
        let turn = (direction[1] * arm[0] - direction[0] * arm[1]) / self.model.length;
        for (component, part) in [direction[0], direction[1], turn].into_iter().enumerate() {
            *row.entry(3 * body + component).or_default() += weight * part;
        }
    }

    fn add(&self, row: &mut Row, node: usize, direction: [f64; 2], weight: f64) {
        if let Some(&body) = self.owners.get(&node) {
            self.add_as(row, body, node, direction, weight);
        }
    }

    /// A component of a body's node: a displacement or the rotation.
    fn add_component(
        &self,
        row: &mut Row,
        body: usize,
        node: usize,
        component: Component,
        weight: f64,
    ) {
        match component {
            Component::X => self.add_as(row, body, node, [1.0, 0.0], weight),
            Component::Y => self.add_as(row, body, node, [0.0, 1.0], weight),
            Component::Rotation => *row.entry(3 * body + 2).or_default() += weight,
        }
    }

    fn supports(&self, conditions: &mut Vec<Row>) {
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
                        let mut row = Row::new();
                        self.add_component(&mut row, b, n, component, 1.0);
                        conditions.push(row);
                    }
                }
            }
        }
    }

    fn joints(&self, conditions: &mut Vec<Row>) {
        for (b, body) in self.model.bodies.iter().enumerate() {
            for &n in &body.nodes {
                let Some(&first) = self.owners.get(&n).filter(|&&first| first != b) else {
                    continue;
                };
                // A solid's node has no rotation.
                let stiff = [first, b]
                    .iter()
                    .all(|&b| matches!(self.model.bodies[b].kind, BodyKind::Beam(_)));
                let components = [Component::X, Component::Y, Component::Rotation];
                for &component in &components[..if stiff { 3 } else { 2 }] {
                    let mut row = Row::new();
                    self.add_component(&mut row, first, n, component, 1.0);
                    self.add_component(&mut row, b, n, component, -1.0);
                    conditions.push(row);
                }
            }
        }
    }

    /// Bodies given by a matrix or made of bars have no identifiable rigid motion, nor do bodies that share nodes with them.
    fn linear(&self, conditions: &mut Vec<Row>) {
        for (b, body) in self.model.bodies.iter().enumerate() {
            // A body of revolution can only translate along the axis.
            let stiff: &[usize] = match &body.kind {
                BodyKind::Linear(_) | BodyKind::Truss(_) => &[0, 1, 2],
                BodyKind::Solid(_) if body.is_axisymmetric() => &[0, 2],
                BodyKind::Beam(_) | BodyKind::Solid(_) => &[],
            };
            for component in stiff.iter().copied() {
                let mut row = Row::new();
                row.insert(3 * b + component, 1.0);
                conditions.push(row);
            }
        }
    }

    /// The loads as forces and moments on the bodies.
    fn loads(&self, loads: &[f64]) -> Row {
        let mut row = Row::new();
        for (dof, load) in loads.iter().enumerate().filter(|(_, load)| **load != 0.0) {
            let at = self.model.dofs.node_of(dof);
            let Some((node, component)) = at else {
                continue;
            };
            let component = [Component::X, Component::Y, Component::Rotation][component];
            if let Some(&body) = self.owners.get(&node) {
                self.add_component(&mut row, body, node, component, *load);
            }
        }
        row
    }

    /// Describes the motion of each body in a null vector.
    fn name(&self, v: &Row) -> Vec<RigidMotion> {
        let size = max_abs(v.values());
        let mut bodies: Vec<usize> = v.keys().map(|column| column / 3).collect();
        bodies.dedup();
        bodies
            .into_iter()
            .map(|b| (b, [0, 1, 2].map(|k| entry(v, 3 * b + k))))
            .filter(|(_, moved)| moved.iter().any(|x| x.abs() > ZERO * size))
            .map(|(b, [x, y, turn])| {
                let turn = turn / self.model.length;
                let center = self.centers[b];
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
///
/// The bodies are eliminated one after the other, by a QR decomposition of the conditions that contain them, so that the cost grows
/// with the number of bodies where each touches few others.
fn null_space(conditions: Vec<Row>, bodies: usize) -> Vec<Row> {
    let mut waiting = vec![Vec::new(); bodies];
    let wait = |waiting: &mut Vec<Vec<Row>>, row: Row| {
        if let Some(first) = row.keys().next() {
            waiting[first / 3].push(row);
        }
    };
    for row in conditions {
        wait(&mut waiting, row);
    }
    let mut pivots = Vec::new();
    for body in 0..bodies {
        let rows = std::mem::take(&mut waiting[body]);
        for row in eliminated(&rows, body, &mut pivots) {
            wait(&mut waiting, row);
        }
    }
    let columns = 3 * bodies;
    let mut is_free = vec![true; columns];
    pivots.iter().for_each(|(pivot, _)| is_free[*pivot] = false);
    // The pivots whose values contain each column, by their places in the elimination; all come before the column's own.
    let mut parts = vec![Vec::new(); columns];
    for (place, (_, row)) in pivots.iter().enumerate() {
        row.keys().for_each(|&column| parts[column].push(place));
    }
    let (mut values, mut waits) = (vec![0.0; columns], vec![false; pivots.len()]);
    let mut basis = Vec::new();
    for column in (0..columns).filter(|column| is_free[*column]) {
        let mut moved = vec![column];
        values[column] = 1.0;
        parts[column].iter().for_each(|&place| waits[place] = true);
        for (place, (pivot, row)) in pivots.iter().enumerate().rev() {
            if !std::mem::take(&mut waits[place]) {
                continue;
            }
            values[*pivot] = -row.iter().map(|(&c, a)| a * values[c]).sum::<f64>();
            if values[*pivot] != 0.0 {
                moved.push(*pivot);
                parts[*pivot].iter().for_each(|&place| waits[place] = true);
            }
        }
        moved.sort_unstable();
        let size = moved
            .iter()
            .map(|&c| values[c] * values[c])
            .sum::<f64>()
            .sqrt();
        let v: Row = moved.iter().map(|&c| (c, values[c] / size)).collect();
        moved.iter().for_each(|&c| values[c] = 0.0);
        basis.push(v);
    }
    reduce(&mut basis, columns);
    basis
}

/// Eliminates a body from the conditions whose first body it is. Adds columns of the body with their values in terms of the other
/// columns to `pivots`, and returns the conditions on the bodies after it.
fn eliminated(rows: &[Row], body: usize, pivots: &mut Vec<(usize, Row)>) -> Vec<Row> {
    if rows.is_empty() {
        return Vec::new();
    }
    let columns = rows.iter().flat_map(BTreeMap::keys).copied();
    let others = distinct(columns.filter(|c| c / 3 != body));
    let own = DMatrix::from_fn(rows.len(), 3, |i, j| entry(&rows[i], 3 * body + j));
    let mut rest = DMatrix::from_fn(rows.len(), others.len(), |i, j| entry(&rows[i], others[j]));
    let qr = own.col_piv_qr();
    qr.q_tr_mul(&mut rest);
    let (r, mut own) = (qr.r(), RowVector3::new(0, 1, 2));
    qr.p().permute_columns(&mut own);
    let rank = (0..r.nrows())
        .take_while(|&k| r[(k, k)].abs() >= ZERO)
        .count();
    for k in 0..rank {
        let beside = (k + 1..3).map(|j| (3 * body + own[j], r[(k, j)]));
        let row = beside.chain(others.iter().enumerate().map(|(j, c)| (*c, rest[(k, j)])));
        let row = row.map(|(column, a)| (column, a / r[(k, k)])).collect();
        pivots.push((3 * body + own[k], row));
    }
    if others.is_empty() || rank == rows.len() {
        return Vec::new();
    }
    // As many as columns at most.
    let left = rest.rows(rank, rows.len() - rank).into_owned().qr().r();
    let kept = left.row_iter().map(|row| {
        let entries = others.iter().zip(row.iter());
        entries
            .map(|(c, a)| (*c, *a))
            .filter(|(_, a)| *a != 0.0)
            .collect()
    });
    kept.collect()
}

/// Gauss-Jordan elimination.
fn reduce(basis: &mut [Row], columns: usize) {
    let mut done = 0;
    for column in 0..columns {
        let size = |v: &Row| entry(v, column).abs();
        let Some(pivot) =
            (done..basis.len()).max_by(|&a, &b| size(&basis[a]).total_cmp(&size(&basis[b])))
        else {
            return;
        };
        if size(&basis[pivot]) < 1e-6 {
            continue;
        }
        basis.swap(done, pivot);
        let scale = entry(&basis[done], column);
        basis[done].values_mut().for_each(|x| *x /= scale);
        let row = basis[done].clone();
        for (k, other) in basis.iter_mut().enumerate() {
            let factor = entry(other, column);
            if k != done && factor != 0.0 {
                for (&column, x) in &row {
                    *other.entry(column).or_default() -= factor * x;
                }
                other.retain(|_, x| *x != 0.0);
            }
        }
        done += 1;
    }
}

/// Whether the work of these loads in a motion is more than round-off.
fn does_work(loads: &Row, v: &Row) -> bool {
    let largest = max_abs(loads.values()) * max_abs(v.values());
    let work: f64 = loads.iter().map(|(&column, x)| x * entry(v, column)).sum();
    work.abs() > ZERO * largest
}

/// Value of a vector in a column.
fn entry(v: &Row, column: usize) -> f64 {
    v.get(&column).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;

    /// Random chains of bodies with some conditions: as many motions are free as the singular values say, and all conditions hold.
    #[test]
    fn the_motions_found_satisfy_all_conditions_and_none_is_missing() {
        let mut drawn = 0;
        let mut random = move || {
            drawn += 1;
            (f64::from(drawn) * 12.9898)
                .sin()
                .mul_add(43758.5453, 1e5)
                .fract()
        };
        for _ in 0..300 {
            let bodies = 1 + (random() * 6.0) as usize;
            let count = (random() * 4.0 * bodies as f64) as usize;
            let conditions: Vec<Row> = (0..count)
                .map(|_| {
                    let [first, second] = [(); 2].map(|()| (random() * bodies as f64) as usize);
                    let columns = (3 * first..3 * first + 3).chain(3 * second..3 * second + 3);
                    columns.map(|c| (c, random() - 0.5)).collect()
                })
                .collect();
            let repeated: Vec<Row> = conditions.iter().chain(&conditions).cloned().collect();
            let dense = DMatrix::from_fn(repeated.len().max(3 * bodies), 3 * bodies, |i, j| {
                let row = repeated.get(i);
                row.and_then(|row| row.get(&j)).copied().unwrap_or(0.0)
            });
            let values = dense.clone().svd(false, false).singular_values;
            let basis = null_space(repeated, bodies);
            assert_eq!(
                basis.len(),
                values.iter().filter(|value| **value < ZERO).count()
            );
            for v in basis {
                let size = max_abs(v.values());
                let mut whole = DVector::zeros(3 * bodies);
                v.iter().for_each(|(&column, &x)| whole[column] = x);
                let missed = (&dense * whole).amax();
                assert!(missed < 1e-10 * size, "{missed} of {size}");
            }
        }
    }
}
