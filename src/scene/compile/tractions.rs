//! Nodal forces of uniform loads along chains.

use super::super::curves::shape;
use super::super::geometry;
use super::super::limits;
use super::super::nodes::Names;
use crate::format::error::{AtPath, Fault, Path};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use stickslip_core::plane::plus;

/// A uniform load per undeformed length, or in axisymmetry per undeformed area.
pub(super) struct Load<'a> {
    pub along: &'a str,
    /// Component along the outward normal, which is on the right of the walk.
    pub normal: f64,
    /// Components along x and y.
    pub vector: [f64; 2],
    /// Whether the chain represents a surface of revolution: the load is then per area of the circumference.
    pub round: bool,
}

/// Consistent forces ∫ N_i q ds at the nodes of a chain, by ascending node number.
pub(super) fn forces(
    here: &Path,
    names: &Names,
    load: &Load<'_>,
) -> Result<Vec<(usize, [f64; 2])>, Fault> {
    let parts = [
        ("normal", load.normal),
        ("x", load.vector[0]),
        ("y", load.vector[1]),
    ];
    for (field, value) in parts {
        limits::finite(&here.then(field), value, "the load")?;
    }
    let chain = names.chain(load.along).at(here.then("along"))?;
    let mut forces = BTreeMap::new();
    for element in chain.elements() {
        for (node, force) in on_nodes(names, &element, load) {
            let sum = forces.entry(node).or_insert([0.0; 2]);
            *sum = plus(*sum, force);
        }
    }
    Ok(forces.into_iter().collect())
}

/// The forces at the nodes of one element.
pub(super) fn on_nodes(
    names: &Names,
    element: &[usize],
    load: &Load<'_>,
) -> Vec<(usize, [f64; 2])> {
    let at: Vec<[f64; 2]> = element.iter().map(|&n| names.nodes[n].at).collect();
    element.iter().copied().zip(on_element(&at, load)).collect()
}

/// Gauss-Legendre points and weights on −1 to 1, exact up to degree nine. Applied between neighbouring nodes, they are exact for
/// loads on straight elements, and for normal loads on curved elements with up to five nodes.
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

fn on_element(at: &[[f64; 2]], load: &Load<'_>) -> Vec<[f64; 2]> {
    let m = at.len();
    let mut forces = vec![[0.0; 2]; m];
    for interval in 0..m - 1 {
        for (xi, weight) in GAUSS {
            let t = interval as f64 + 0.5 * (1.0 + xi);
            let along = |k: usize| {
                (0..m)
                    .map(|i| geometry::slope(m, i, t) * at[i][k])
                    .sum::<f64>()
            };
            let (dx, dy) = (along(0), along(1));
            let length = dx.hypot(dy);
            let width = if load.round {
                TAU * (0..m).map(|i| shape(m, i, t) * at[i][0]).sum::<f64>()
            } else {
                1.0
            };
            let q = [
                load.normal * dy + load.vector[0] * length,
                -load.normal * dx + load.vector[1] * length,
            ];
            for (i, force) in forces.iter_mut().enumerate() {
                let share = 0.5 * weight * shape(m, i, t) * width;
                *force = [force[0] + share * q[0], force[1] + share * q[1]];
            }
        }
    }
    forces
}
