//! Linearisation of a contact on an element with local flexibility: gap and forces with all derivatives.
//!
//! With D_i, L_i, X_i, k and m of [`crate::contact::geometric_tangent`], T_i = (τ·D_i + g L_i)/√m the motion of the node relative
//! to the displaced projection, F = F_n cos α, and sums over the forces F_j on the element,
//!
//! ```text
//! gap:     g + Σ c_j F_j = 0,                   tan α = (√m/(m − g k)) Σ ∂c_j/∂ξ F_j
//! force:   f_i = A n·D_i + B T_i,               A = F_n cos α − F_t sin α,   B = F_n sin α + F_t cos α
//! ```
//!
//! Without friction the forces are the derivative of F g + ½ c F² with respect to the displacements: the force F (n + t tan α) on
//! the node, its reaction on the element, and the moment of its lever g on the element. T_i also contains the moment of friction
//! at that point.

use super::dual::{DOFS, Dual, dot};
use super::pair::Pair;
use crate::contact::projection::tangent;
use crate::fem::lagrange::{self, MAX_NODES};
use crate::model::PointGive;

const BY_NORMAL: usize = DOFS;
const BY_TANGENTIAL: usize = DOFS + 1;
const BY_TURN: usize = DOFS + 2;
/// Minimum and maximum number of fixed-point iterations for tan α: each reduces the error by the factor tan² α.
const STEPS: [usize; 2] = [12, 100];

/// Deflection and slopes at a point of an element due to the other forces on it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OtherForces {
    /// Σ c_j F_j (length).
    pub give: f64,
    /// Σ ∂c_j/∂ξ F_j (length).
    pub slope: f64,
    /// Σ ∂²c_j/∂ξ² F_j (length).
    pub bend: f64,
}

impl OtherForces {
    /// Adds the contribution of a force F_j.
    pub fn add(&mut self, pair: &Pair, force: f64) {
        self.give += pair.give * force;
        self.slope += pair.slope * force;
        self.bend += pair.bend * force;
    }
}

/// A slave node over an element, with the force on it.
#[derive(Debug, Clone, Copy)]
pub struct NodeOverElement<'a> {
    /// Position of the slave node.
    pub slave: [f64; 2],
    /// Positions of the element's nodes.
    pub nodes: &'a [[f64; 2]],
    /// Coordinate ξ of its closest point.
    pub xi: f64,
    /// F_n and F_t in the rotated frame.
    pub force: [f64; 2],
    /// Local flexibilities of the element.
    pub give: &'a PointGive,
    /// Contribution of the other forces on the element at this point.
    pub others: OtherForces,
}

/// A linearised contact. Its degrees of freedom are x and y of the slave node, then x and y of each node of the element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearisedForce {
    /// n, rotated by α (unit).
    pub normal: [f64; 2],
    /// g + Σ c_j F_j (length).
    pub gap: f64,
    /// Σ c_j F_j (length).
    pub given: f64,
    /// c (length per force).
    pub compliance: f64,
    /// ∂gap/∂F_n (length per force).
    pub give: f64,
    /// F = F_n cos α.
    pub force: f64,
    /// ∂F/∂F_n.
    pub force_slope: f64,
    /// Derivatives of F with respect to the degrees of freedom at constant F_n.
    pub force_by: [f64; DOFS],
    /// Generalised force on each degree of freedom.
    pub forces: [f64; DOFS],
    /// Derivatives of −gap and of the slip (both lengths) with respect to the degrees of freedom.
    pub rows: [[f64; DOFS]; 2],
    /// Derivatives of the forces with respect to F_n, to F_t, and to Σ ∂c_j/∂ξ F_j over the other forces.
    pub columns: [[f64; DOFS]; 3],
    /// Derivatives of the forces with respect to the degrees of freedom at constant F_n and F_t.
    pub stiffness: [[f64; DOFS]; DOFS],
    /// Derivatives of ξ with respect to the degrees of freedom.
    pub travel: [f64; DOFS],
}

/// n rotated by the angle α with tan α = `a`.
pub fn turned(normal: [f64; 2], a: f64) -> [f64; 2] {
    let (t, cos) = (tangent(normal), 1.0 / (1.0 + a * a).sqrt());
    [0, 1].map(|k| cos * (normal[k] + a * t[k]))
}

/// tan α of a force F_n at a point with the lever √m / (m − g k).
pub fn tilt(own: &Pair, lever: f64, f_n: f64, others: &OtherForces) -> f64 {
    let mut a = others.slope * lever;
    for step in 1..=STEPS[1] {
        let next = (others.slope + own.slope * f_n / (1.0 + a * a).sqrt()) * lever;
        let last = ends(step, a, next);
        a = next;
        if last {
            break;
        }
    }
    a
}

/// Whether the iteration for tan α ends with this step.
fn ends(step: usize, before: f64, after: f64) -> bool {
    step >= STEPS[0] && (after - before).abs() <= f64::EPSILON * after.abs()
}

/// Computes gap, forces and derivatives of a contact.
pub fn linearise(over: &NodeOverElement<'_>) -> LinearisedForce {
    let count = over.nodes.len();
    let dofs = 2 * (count + 1);
    let xi = travel(over);
    let s = lagrange::shape(count, over.xi);
    let third = lagrange::third(count, over.xi);
    let zero = Dual::constant(0.0);
    let mut at = [[zero; 2]; MAX_NODES];
    let (mut to, mut d, mut dd) = ([zero; 2], [zero; 2], [zero; 2]);
    for axis in 0..2 {
        to[axis] = Dual::variable(over.slave[axis], axis);
        for (i, node) in over.nodes.iter().enumerate() {
            at[i][axis] = Dual::variable(node[axis], 2 * (i + 1) + axis);
            to[axis] = to[axis] - xi.then(s.n[i], s.d[i]) * at[i][axis];
            d[axis] = d[axis] + xi.then(s.d[i], s.dd[i]) * at[i][axis];
            dd[axis] = dd[axis] + xi.then(s.dd[i], third[i]) * at[i][axis];
        }
    }
    let m = dot(d, d);
    let size = m.sqrt();
    let t = d.map(|d| d / size);
    let n = [t[1], zero - t[0]];
    let gap = dot(to, n);
    let stiffness = m - gap * dot(dd, n);
    let pair = Pair::new(over.give, count - 1, over.xi, over.xi);
    let [f_n, f_t] = [(0, BY_NORMAL), (1, BY_TANGENTIAL)]
        .map(|(k, number)| Dual::variable(over.force[k], number));
    let own_slope = xi.then(pair.slope, pair.bend + pair.cross);
    let mut others_slope = xi.then(over.others.slope, over.others.bend);
    others_slope.by[BY_TURN] = 1.0;
    let lever = size / stiffness;
    let (one, mut a) = (Dual::constant(1.0), others_slope * lever);
    for step in 1..=STEPS[1] {
        let next = (others_slope + own_slope * f_n / (one + a * a).sqrt()) * lever;
        let last = ends(step, a.value, next.value);
        a = next;
        if last {
            break;
        }
    }
    let cos = one / (one + a * a).sqrt();
    let sin = a * cos;
    let force = f_n * cos;
    let own_give = xi.then(pair.give, 2.0 * pair.slope);
    let law = gap + xi.then(over.others.give, over.others.slope) + own_give * force;
    let (along_n, along_t) = (f_n * cos - f_t * sin, f_n * sin + f_t * cos);
    let mut found = LinearisedForce {
        normal: turned(n.map(|n| n.value), a.value),
        gap: law.value,
        given: law.value - gap.value,
        compliance: pair.give,
        give: law.by[BY_NORMAL],
        force: force.value,
        force_slope: force.by[BY_NORMAL],
        force_by: [0.0; DOFS],
        forces: [0.0; DOFS],
        rows: [[0.0; DOFS]; 2],
        columns: [[0.0; DOFS]; 3],
        stiffness: [[0.0; DOFS]; DOFS],
        travel: [0.0; DOFS],
    };
    for i in 0..dofs {
        let (weight, slope) = match i / 2 {
            0 => (Dual::constant(-1.0), zero),
            node => (
                xi.then(s.n[node - 1], s.d[node - 1]),
                xi.then(s.d[node - 1], s.dd[node - 1]),
            ),
        };
        let axis = i % 2;
        // −D_i and L_i: the weight in u_S* − u_S, and the tilt of the element.
        let tilt = gap * slope * n[axis];
        let way = tilt / size - weight * t[axis];
        let part = along_t * way - along_n * weight * n[axis];
        found.forces[i] = part.value;
        for (column, by) in found
            .columns
            .iter_mut()
            .zip([BY_NORMAL, BY_TANGENTIAL, BY_TURN])
        {
            column[i] = part.by[by];
        }
        found.stiffness[i][..dofs].copy_from_slice(&part.by[..dofs]);
        found.rows[0][i] = -law.by[i];
        found.rows[1][i] = -size.value * xi.by[i];
        found.travel[i] = xi.by[i];
        found.force_by[i] = force.by[i];
    }
    found
}

/// ξ of the closest point, with its derivatives X_i.
fn travel(over: &NodeOverElement<'_>) -> Dual {
    let s = lagrange::shape(over.nodes.len(), over.xi);
    let sum = |weights: &[f64; MAX_NODES], axis: usize| -> f64 {
        over.nodes
            .iter()
            .zip(weights)
            .map(|(at, w)| w * at[axis])
            .sum()
    };
    let [x, d, dd] = [&s.n, &s.d, &s.dd].map(|weights| [sum(weights, 0), sum(weights, 1)]);
    let to = [over.slave[0] - x[0], over.slave[1] - x[1]];
    let curvature = d[0] * d[0] + d[1] * d[1] - to[0] * dd[0] - to[1] * dd[1];
    let mut xi = Dual::constant(over.xi);
    for axis in 0..2 {
        xi.by[axis] = d[axis] / curvature;
        for i in 0..over.nodes.len() {
            xi.by[2 * (i + 1) + axis] = (to[axis] * s.d[i] - d[axis] * s.n[i]) / curvature;
        }
    }
    xi
}
