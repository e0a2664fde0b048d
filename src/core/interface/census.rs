//! The census: every assumption of what the nodes of a frozen interface problem do, tried.
//!
//! With Coulomb's law, a frozen problem may have no consistent state, one, or several. The minor iterations cannot tell
//! which, since they go from assumption to assumption by Table 2. With k nodes there are up to 4^k assumptions (free, fixed,
//! sliding either way); for few nodes all of them can be tried.

use crate::interface::kinematics::NodeIncrement;
use crate::interface::problem::{
    self, Answer, Assumed, InterfaceProblem, Margin, NodeAnswer, SINGULAR,
};

/// Largest number of nodes of a census: 4^8 = 65,536 assumptions.
pub const MOST: usize = 8;
/// Conditions that are broken by less than this (relative) count as obeyed; forces and gaps that differ by less are equal.
const TOLERANCE: f64 = 1e-9;

/// What a census found.
#[derive(Debug, Clone, PartialEq)]
pub struct Census {
    /// Number of assumptions that were tried.
    pub tried: usize,
    /// Number of those that have no unique solution.
    pub singular: usize,
    /// The consistent states, each different in forces or gaps.
    pub answers: Vec<Consistent>,
    /// If there is no consistent state: the assumption that comes closest, the node (its place in the problem) and the
    /// condition that it breaks. `None` if there is one.
    pub nearest: Option<(Answer, usize, Margin)>,
}

/// A consistent state.
#[derive(Debug, Clone, PartialEq)]
pub struct Consistent {
    /// The assumption with its forces and gaps.
    pub answer: Answer,
    /// Other assumptions that lead to the same forces and gaps (ties), a letter a node.
    pub ties: Vec<String>,
}

/// More nodes than a census can be held over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "a census is held over at most {MOST} nodes, and these are {nodes}; find the core of the cycle first"
)]
pub struct TooMany {
    /// Number of nodes of the problem.
    pub nodes: usize,
}

/// Tries every assumption of a problem of at most [`MOST`] nodes.
///
/// # Errors
/// [`TooMany`] where it has more.
pub fn census(problem: &InterfaceProblem) -> Result<Census, TooMany> {
    let count = problem.nodes.len();
    if count > MOST {
        return Err(TooMany { nodes: count });
    }
    let mut walk = Walk::new(problem);
    walk.down(0);
    let mut found = walk.found;
    if !found.answers.is_empty() {
        found.nearest = None;
    }
    Ok(found)
}

/// The walk through all assumptions, node by node, the last node first, so that only the equations of few nodes differ
/// between two assumptions in a row. A node's equations are reduced by those before them when they are assumed, and all
/// assumptions of the nodes that follow share that work.
struct Walk<'a> {
    problem: &'a InterfaceProblem,
    /// The two equations of each choice of each node, in z: coefficients, right-hand side, and that of the probe by which
    /// the norm of the inverse is estimated; scaled to a largest coefficient of 1.
    equations: Vec<Vec<[Vec<f64>; 2]>>,
    /// The equations assumed so far, reduced: each has 1 in its pivot's column, and 0 in those of the ones before it.
    reduced: Vec<Vec<f64>>,
    pivots: Vec<usize>,
    /// What each node is assumed to do.
    assumed: Vec<Assumed>,
    /// Solutions for the right-hand side and for the probe.
    z: [Vec<f64>; 2],
    found: Census,
}

impl<'a> Walk<'a> {
    fn new(problem: &'a InterfaceProblem) -> Self {
        let count = problem.relation.count();
        let mut matrix = vec![0.0; count * count];
        let mut equations = Vec::with_capacity(problem.nodes.len());
        for (s, node) in problem.nodes.iter().enumerate() {
            let mut of_node = Vec::new();
            for &assumed in node.choices() {
                let rows = node.equations(assumed, &problem.settings);
                of_node.push([0, 1].map(|k| {
                    let (relation, row) = (&problem.relation, &rows[k]);
                    let value = relation.place_row(s, k, row, node.prescribed, &mut matrix);
                    let mut line: Vec<f64> =
                        (0..count).map(|j| matrix[j * count + 2 * s + k]).collect();
                    let largest = line.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                    let scale = if largest > 0.0 { 1.0 / largest } else { 1.0 };
                    line.iter_mut().for_each(|x| *x *= scale);
                    line.extend([value * scale, probe(2 * s + k)]);
                    line
                }));
            }
            equations.push(of_node);
        }
        Walk {
            problem,
            equations,
            reduced: vec![vec![0.0; count + 2]; count],
            pivots: vec![0; count],
            assumed: vec![Assumed::Free; problem.nodes.len()],
            z: [vec![0.0; count], vec![0.0; count]],
            found: Census {
                tried: 0,
                singular: 0,
                answers: Vec::new(),
                nearest: None,
            },
        }
    }

    /// Tries everything that the nodes can do which are not assumed yet; `depth` of them are.
    fn down(&mut self, depth: usize) {
        let Some(place) = self.problem.nodes.len().checked_sub(depth + 1) else {
            self.found.tried += 1;
            match self.solve() {
                true => self.take_solution(),
                false => self.found.singular += 1,
            }
            return;
        };
        for (choice, &assumed) in self.problem.nodes[place].choices().iter().enumerate() {
            self.assumed[place] = assumed;
            if self.reduce(2 * depth, place, choice, 0)
                && self.reduce(2 * depth + 1, place, choice, 1)
            {
                self.down(depth + 1);
            } else {
                let below = &self.problem.nodes[..place];
                let all: usize = below.iter().map(|node| node.choices().len()).product();
                self.found.tried += all;
                self.found.singular += all;
            }
        }
    }

    /// Reduces an equation by the `at` before it and finds its pivot; false where nothing is left of it.
    fn reduce(&mut self, at: usize, place: usize, choice: usize, k: usize) -> bool {
        let (before, rest) = self.reduced.split_at_mut(at);
        let line = &mut rest[0];
        line.copy_from_slice(&self.equations[place][choice][k]);
        for (other, &pivot) in before.iter().zip(&self.pivots) {
            let factor = line[pivot];
            if factor != 0.0 {
                line.iter_mut()
                    .zip(other)
                    .for_each(|(x, y)| *x -= factor * y);
                line[pivot] = 0.0;
            }
        }
        let count = line.len() - 2;
        let (mut pivot, mut largest) = (0, 0.0);
        for (column, value) in line[..count].iter().enumerate() {
            if value.abs() > largest {
                (pivot, largest) = (column, value.abs());
            }
        }
        if largest == 0.0 {
            return false;
        }
        let scale = 1.0 / line[pivot];
        line.iter_mut().for_each(|x| *x *= scale);
        self.pivots[at] = pivot;
        true
    }

    /// Solves for z; false where the equations are singular to working precision.
    fn solve(&mut self) -> bool {
        let count = self.pivots.len();
        for at in (0..count).rev() {
            let line = &self.reduced[at];
            let (mut value, mut probe) = (line[count], line[count + 1]);
            for &pivot in &self.pivots[at + 1..] {
                value -= line[pivot] * self.z[0][pivot];
                probe -= line[pivot] * self.z[1][pivot];
            }
            self.z[0][self.pivots[at]] = value;
            self.z[1][self.pivots[at]] = probe;
        }
        let sound = |z: &f64| z.is_finite() && z.abs() <= SINGULAR;
        self.z[1].iter().all(sound) && self.z[0].iter().all(|z| z.is_finite())
    }

    /// Takes the solution, unless it is worse than what was found already.
    fn take_solution(&mut self) {
        let problem = self.problem;
        let worst = match (self.found.answers.first(), &self.found.nearest) {
            (Some(_), _) => -TOLERANCE,
            (None, Some(nearest)) => nearest.2.relative,
            (None, None) => f64::NEG_INFINITY,
        };
        let mut nodes = Vec::with_capacity(problem.nodes.len());
        for (s, node) in problem.nodes.iter().enumerate() {
            let [force, motion] = problem.relation.answer(&self.z[0], s, node.prescribed);
            let answer = problem::node_answer(
                problem,
                node,
                self.assumed[s],
                NodeIncrement { force, motion },
            );
            if answer.worst.relative < worst.min(-TOLERANCE) {
                return;
            }
            nodes.push(answer);
        }
        self.found.take(problem, Answer { nodes });
    }
}

/// The right-hand side of an equation by which the norm of the inverse is estimated: of both signs, and in no order.
fn probe(k: usize) -> f64 {
    let size = 1.0 + (1.618_033_988_749_895 * k as f64).fract();
    if k % 2 == 1 { -size } else { size }
}

impl Census {
    fn take(&mut self, problem: &InterfaceProblem, answer: Answer) {
        if !answer.obeys(TOLERANCE) {
            let Some((node, margin)) = answer.worst() else {
                return;
            };
            let best = self
                .nearest
                .as_ref()
                .map_or(f64::NEG_INFINITY, |n| n.2.relative);
            if margin.relative > best {
                self.nearest = Some((answer, node, margin));
            }
            return;
        }
        let same = |found: &&mut Consistent| is_same(problem, &found.answer, &answer);
        match self.answers.iter_mut().find(same) {
            Some(found) => found.ties.push(answer.letters()),
            None => self.answers.push(Consistent {
                answer,
                ties: Vec::new(),
            }),
        }
    }
}

/// Whether two states have the same forces, gaps and slips.
fn is_same(problem: &InterfaceProblem, a: &Answer, b: &Answer) -> bool {
    let force = TOLERANCE * problem.force;
    let length = TOLERANCE * problem.length;
    let close = |a: &NodeAnswer, b: &NodeAnswer| {
        let equal = |a: f64, b: f64, size: f64| a == b || (a - b).abs() <= size;
        equal(a.f_n, b.f_n, force)
            && equal(a.f_t, b.f_t, force)
            && equal(a.gap, b.gap, length)
            && equal(a.slip, b.slip, length)
    };
    a.nodes.iter().zip(&b.nodes).all(|(a, b)| close(a, b))
}
