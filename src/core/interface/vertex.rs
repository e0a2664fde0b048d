//! Replaces forces that are not unique by forces that belong to a single combination of modes.
//!
//! If some forces of the touching nodes cause no motion (W d = 0), the equations of the modes are singular, and a solve finds no
//! forces although many exist. Along such a d the motions are constant, and forces within their friction cones remain a solution
//! until one of them reaches the edge of its cone. A node on the edge slides by zero, and one without force is free with zero
//! gap; each of them removes an unknown, until the equations have a unique solution. Forces of a node with cohesion are kept when
//! they reach F_n = 0, where no mode change is possible. This is analogous to finding a vertex of a polyhedron in linear
//! programming (Megiddo, ORSA J. Computing 3, 1991).

use crate::plane::max_abs;
use crate::{AssumedMode, InterfaceProblem};

/// Columns whose remainder is below this fraction of the largest are linearly dependent.
const DEPENDENT: f64 = 1e-10;

/// Mode and forces of a node.
pub type NodeForce = (AssumedMode, [f64; 2]);

/// Changes modes and forces (one entry per node) such that no forces in these modes are without motion. The motions stay the
/// same, and the forces obey Coulomb's law if they did before.
pub fn vertex(problem: &InterfaceProblem, nodes: &mut [NodeForce]) {
    let directions: Vec<_> = nodes
        .iter()
        .enumerate()
        .flat_map(|(place, (does, _))| {
            let coefficient = problem.nodes[place].friction.coefficient();
            let own: &[[f64; 2]] = match does {
                AssumedMode::Free => &[],
                AssumedMode::Fixed => &[[1.0, 0.0], [0.0, 1.0]],
                does => &[[1.0, does.sign() * coefficient]],
            };
            own.iter().map(|parts| (place, *parts)).collect::<Vec<_>>()
        })
        .collect();
    let mut still = motionless(problem, &directions);
    orthonormal(&mut still);
    while let Some(along) = still.last() {
        let Some(bound) = nearest(problem, nodes, along) else {
            still.pop();
            continue;
        };
        for (k, (_, force)) in nodes.iter_mut().enumerate() {
            force[0] += bound.step * along[2 * k];
            force[1] += bound.step * along[2 * k + 1];
        }
        nodes[bound.place].0 = bound.then;
        let put = &mut nodes[bound.place].1;
        match bound.then {
            AssumedMode::Free => *put = [0.0; 2],
            does => {
                let friction = &problem.nodes[bound.place].friction;
                put[1] = does.sign() * friction.limit(put[0]);
            }
        }
        keep(&bound, &mut still);
    }
}

/// Gram-Schmidt orthogonalisation, applied twice; removes dependent vectors.
pub(super) fn orthonormal(still: &mut Vec<Vec<f64>>) {
    let mut done: Vec<Vec<f64>> = Vec::with_capacity(still.len());
    for mut along in still.drain(..) {
        let size = dot(&along, &along).sqrt();
        for _ in 0..2 {
            for other in &done {
                let share = dot(&along, other);
                subtract(&mut along, share, other);
            }
        }
        let rest = dot(&along, &along).sqrt();
        if rest > DEPENDENT * size {
            along.iter_mut().for_each(|x| *x /= rest);
            done.push(along);
        }
    }
    *still = done;
}

/// Restricts the motionless forces to those that satisfy a bound, keeping them orthonormal: a Householder reflection concentrates
/// the bound's component in the last one, which is removed.
fn keep(bound: &VertexBound, still: &mut Vec<Vec<f64>>) {
    let mut mirror: Vec<f64> = still.iter().map(|along| bound.of(along)).collect();
    let size = dot(&mirror, &mirror).sqrt();
    let Some(last) = mirror.last_mut() else {
        return;
    };
    *last += size.copysign(*last);
    let square = dot(&mirror, &mirror);
    let mut sum = vec![0.0; still[0].len()];
    for (along, part) in still.iter().zip(&mirror) {
        subtract(&mut sum, -part, along);
    }
    for (along, part) in still.iter_mut().zip(&mirror) {
        subtract(along, 2.0 * part / square, &sum);
    }
    still.pop();
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn subtract(from: &mut [f64], times: f64, what: &[f64]) {
    from.iter_mut().zip(what).for_each(|(x, y)| *x -= times * y);
}

/// [`vertex`] for a proposal of a search: mode of every node with F_n, F_t, gap and slip.
pub fn vertices(problem: &InterfaceProblem, nodes: &mut [(AssumedMode, [f64; 4])]) {
    let mut held: Vec<NodeForce> = nodes
        .iter()
        .map(|&(does, [f_n, f_t, ..])| (does, [f_n, f_t]))
        .collect();
    vertex(problem, &mut held);
    for (node, (does, [f_n, f_t])) in nodes.iter_mut().zip(held) {
        node.0 = does;
        (node.1[0], node.1[1]) = (f_n, f_t);
    }
}

/// The first cone edge that the forces reach.
struct VertexBound {
    place: usize,
    step: f64,
    then: AssumedMode,
    /// The quantity that is zero there, as factors of the node's F_n and F_t.
    factors: [f64; 2],
    /// Whether a mode change is possible there.
    open: bool,
}

impl VertexBound {
    fn of(&self, along: &[f64]) -> f64 {
        self.factors[0] * along[2 * self.place] + self.factors[1] * along[2 * self.place + 1]
    }
}

/// The first edge along d or −d. `None` if there is none.
fn nearest(problem: &InterfaceProblem, nodes: &[NodeForce], along: &[f64]) -> Option<VertexBound> {
    let mut found: Option<VertexBound> = None;
    let mut look = |place: usize, then: AssumedMode, factors: [f64; 2], left: f64| {
        let bound = VertexBound {
            place,
            step: 0.0,
            then,
            factors,
            open: then != AssumedMode::Free || problem.nodes[place].friction.cohesion == 0.0,
        };
        let falls = -bound.of(along);
        let size = max_abs(along);
        if falls.abs() <= DEPENDENT * size {
            return;
        }
        let step = left.max(0.0) / falls;
        if found
            .as_ref()
            .is_none_or(|best| step.abs() < best.step.abs())
        {
            found = Some(VertexBound { step, ..bound });
        }
    };
    for (place, (does, [f_n, f_t])) in nodes.iter().enumerate() {
        let friction = &problem.nodes[place].friction;
        let limit = friction.limit(*f_n);
        match does {
            AssumedMode::Free => {}
            AssumedMode::Plus | AssumedMode::Minus => {
                look(place, AssumedMode::Free, [1.0, 0.0], *f_n)
            }
            AssumedMode::Fixed => {
                if friction.cohesion > 0.0 {
                    look(place, AssumedMode::Free, [1.0, 0.0], *f_n);
                }
                look(
                    place,
                    AssumedMode::Plus,
                    [friction.coefficient(), -1.0],
                    limit - f_t,
                );
                look(
                    place,
                    AssumedMode::Minus,
                    [friction.coefficient(), 1.0],
                    limit + f_t,
                );
            }
        }
    }
    found.filter(|bound| bound.open)
}

/// Basis of the forces that cause no motion among those along these directions (node, parts of F_n and F_t); two entries per node.
///
/// W need not be computed: these form the null space of (I + R / k), where R is the response of the interface to z with springs of
/// stiffness k ([`crate::interface::response`]); this product is k W d / (k W + 1), and finite for loose bodies too. Its columns for
/// the directions are eliminated with the largest remaining entry as pivot.
pub(super) fn motionless(
    problem: &InterfaceProblem,
    directions: &[(usize, [f64; 2])],
) -> Vec<Vec<f64>> {
    let (relation, count) = (&problem.relation, problem.relation.count());
    let mut columns: Vec<Vec<f64>> = directions
        .iter()
        .map(|&(place, parts)| {
            let mut column = vec![0.0; count];
            for (part, j) in parts.iter().zip([2 * place, 2 * place + 1]) {
                let response = &relation.response[j * count..(j + 1) * count];
                for (to, r) in column.iter_mut().zip(response) {
                    *to += part * r / relation.stiffness;
                }
                column[j] += part;
            }
            column
        })
        .collect();
    let size = columns.len();
    let mut order: Vec<usize> = (0..size).collect();
    let mut rows: Vec<usize> = (0..count).collect();
    let (mut rank, mut first) = (0, 0.0);
    while rank < size.min(count) {
        let mut best = (0.0, rank, rank);
        for (c, &column) in order.iter().enumerate().skip(rank) {
            for (r, &row) in rows.iter().enumerate().skip(rank) {
                let entry = columns[column][row].abs();
                if entry > best.0 {
                    best = (entry, c, r);
                }
            }
        }
        if rank == 0 {
            first = best.0;
        }
        if best.0 <= DEPENDENT * first {
            break;
        }
        order.swap(rank, best.1);
        rows.swap(rank, best.2);
        let pivot = std::mem::take(&mut columns[order[rank]]);
        for &column in &order[rank + 1..] {
            let times = columns[column][rows[rank]] / pivot[rows[rank]];
            if times != 0.0 {
                for &row in &rows[rank + 1..] {
                    columns[column][row] -= times * pivot[row];
                }
            }
        }
        columns[order[rank]] = pivot;
        rank += 1;
    }
    (rank..size)
        .map(|dependent| {
            // Back substitution in the upper triangle.
            let mut factors = vec![0.0; size];
            factors[order[dependent]] = 1.0;
            for k in (0..rank).rev() {
                let sum: f64 = order[k + 1..rank]
                    .iter()
                    .chain([&order[dependent]])
                    .map(|&c| columns[c][rows[k]] * factors[c])
                    .sum();
                factors[order[k]] = -sum / columns[order[k]][rows[k]];
            }
            let mut along = vec![0.0; count];
            for (&(place, parts), factor) in directions.iter().zip(&factors) {
                along[2 * place] += factor * parts[0];
                along[2 * place + 1] += factor * parts[1];
            }
            along
        })
        .collect()
}
