//! The census: tries all combinations of modes of a frozen interface problem's nodes.
//!
//! With Coulomb's law, a frozen problem may have no consistent state, one, or several. The minor iterations cannot determine
//! which, because Table 2 only leads from one combination to the next. With k nodes there are up to 4^k combinations (free,
//! fixed, sliding in either direction); for few nodes all of them are tried. For more, [`search`] treats each block of the matrix
//! separately and tries only combinations that branch and bound ([`crate::interface::branches`]) does not rule out.

use crate::groups::Connected;
use crate::interface::branches;
use crate::interface::problem::{self, Answer, Margin, SINGULAR};
use crate::plane::max_abs;
use crate::{AssumedMode, InterfaceProblem, InterfaceResponse, NodeAnswer, NodeIncrement};

/// Maximum number of nodes of a census: 4^8 = 65,536 combinations.
pub const MOST: usize = 8;
/// Default maximum number of branches of a search.
pub const BUDGET: usize = 30_000;
/// Maximum number of nodes of a search.
pub const MOST_SEARCHED: usize = 64;
/// Maximum number of stored states of a problem with several blocks, whose states combine.
const MOST_KEPT: usize = 1000;
/// Violations below this (relative) are ignored; forces and gaps with a smaller difference are equal.
const TOLERANCE: f64 = 1e-9;

/// Result of a census.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Census {
    /// Number of combinations that were tried, or ruled out by branch and bound; `usize::MAX` if there are more.
    pub tried: usize,
    /// Number of tried combinations without a unique solution.
    pub singular: usize,
    /// Number of visited branches; 0 if all combinations were tried one by one.
    pub visited: usize,
    /// Whether the result is complete; otherwise there are at least these consistent states.
    pub exact: bool,
    /// The consistent states, which differ in forces or gaps.
    pub answers: Vec<Consistent>,
    /// Without a consistent state: the closest combination, the node (its index in the problem) and the condition that it
    /// violates. `None` if there is a consistent state, or if not all combinations were tried one by one.
    pub nearest: Option<(Answer, usize, Margin)>,
}

/// A consistent state.
#[derive(Debug, Clone, PartialEq)]
pub struct Consistent {
    /// The combination with its forces and gaps.
    pub answer: Answer,
    /// Other combinations with the same forces and gaps (ties), one letter per node.
    pub ties: Vec<String>,
}

/// Too many nodes for a census.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "a census tries all mode combinations of at most {MOST} nodes, and a search at most {MOST_SEARCHED} nodes; this problem has {nodes}; find the core of the cycle first"
)]
pub struct TooMany {
    /// Number of nodes of the problem.
    pub nodes: usize,
}

/// Tries all combinations for a problem with at most [`MOST`] nodes.
///
/// # Errors
/// [`TooMany`] if it has more.
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

/// The consistent states of a problem of any size: by [`census`] for up to [`MOST`] nodes, otherwise by branch and bound, block
/// by block. After `budget` branches, or when `stop` returns true, the result is not exact: there are at least the states found.
///
/// # Errors
/// [`TooMany`] with more than [`MOST_SEARCHED`] nodes.
pub fn search(
    problem: &InterfaceProblem,
    budget: usize,
    stop: &dyn Fn() -> bool,
) -> Result<Census, TooMany> {
    if problem.nodes.len() <= MOST {
        return census(problem);
    }
    if problem.nodes.len() > MOST_SEARCHED {
        return Err(TooMany {
            nodes: problem.nodes.len(),
        });
    }
    Ok(by_blocks(problem, budget, stop))
}

/// [`search`], but never by complete enumeration.
pub fn by_blocks(problem: &InterfaceProblem, budget: usize, stop: &dyn Fn() -> bool) -> Census {
    let mut whole = Census::empty();
    whole.tried = 1;
    let none = Consistent {
        answer: Answer {
            nodes: vec![NOTHING; problem.nodes.len()],
        },
        ties: Vec::new(),
    };
    whole.answers = vec![none];
    for places in blocks(problem) {
        let found = branched(
            &part(problem, &places),
            budget - whole.visited.min(budget),
            stop,
        );
        whole.tried = whole.tried.saturating_mul(found.tried);
        whole.singular += found.singular;
        whole.visited += found.visited;
        whole.exact &= found.exact;
        let combined = whole.answers.iter().flat_map(|had| {
            let places = &places;
            found
                .answers
                .iter()
                .map(move |own| joined(had, own, places))
        });
        let combined: Vec<Consistent> = combined.take(MOST_KEPT + 1).collect();
        whole.answers = combined;
        if whole.answers.len() > MOST_KEPT {
            whole.answers.truncate(MOST_KEPT);
            whole.exact = false;
        }
        // A block without any state excludes states of the whole problem; an incomplete block does not.
        if whole.answers.is_empty() && found.exact {
            whole.exact = true;
            break;
        }
    }
    whole
}

/// Placeholder for a node of a block that has not been searched.
const NOTHING: NodeAnswer = NodeAnswer {
    assumed: AssumedMode::Free,
    f_n: 0.0,
    f_t: 0.0,
    limit: 0.0,
    gap: 0.0,
    slip: 0.0,
    worst: Margin {
        condition: problem::Condition::NoPenetration,
        value: f64::INFINITY,
        relative: f64::INFINITY,
    },
};

/// Combines a state with that of a block, whose nodes have these indices.
fn joined(had: &Consistent, own: &Consistent, places: &[usize]) -> Consistent {
    let mut answer = had.answer.clone();
    for (&place, node) in places.iter().zip(&own.answer.nodes) {
        answer.nodes[place] = *node;
    }
    let with = |letters: &str, of_block: &str| -> String {
        letters
            .chars()
            .enumerate()
            .map(|(at, letter)| {
                let own = places.iter().position(|&place| place == at);
                own.and_then(|k| of_block.chars().nth(k)).unwrap_or(letter)
            })
            .collect()
    };
    let (first, of_block) = (had.answer.letters(), own.answer.letters());
    let olds = std::iter::once(&first).chain(&had.ties);
    let news = || std::iter::once(&of_block).chain(&own.ties);
    let all = olds.flat_map(|old| news().map(|new| with(old, new)).collect::<Vec<_>>());
    Consistent {
        answer,
        ties: all.skip(1).take(MOST_KEPT).collect(),
    }
}

/// The nodes connected by forces, by index; one list per block.
fn blocks(problem: &InterfaceProblem) -> Vec<Vec<usize>> {
    let (count, nodes) = (problem.relation.count(), problem.nodes.len());
    let touches = |a: usize, b: usize| {
        let entry = |i: usize, j: usize| problem.relation.response[j * count + i] != 0.0;
        (0..4).any(|k| entry(2 * a + k % 2, 2 * b + k / 2) || entry(2 * b + k % 2, 2 * a + k / 2))
    };
    let mut groups = Connected::new(nodes);
    for b in 0..nodes {
        let touching = (0..b).filter(|&a| touches(a, b));
        touching.for_each(|a| groups.join(a, b));
    }
    groups.parts()
}

/// The sub-problem of a block.
fn part(problem: &InterfaceProblem, places: &[usize]) -> InterfaceProblem {
    let count = problem.relation.count();
    let own: Vec<usize> = places.iter().flat_map(|&s| [2 * s, 2 * s + 1]).collect();
    let entries = own
        .iter()
        .flat_map(|&j| own.iter().map(move |&i| j * count + i));
    InterfaceProblem {
        relation: InterfaceResponse {
            stiffness: problem.relation.stiffness,
            start: own.iter().map(|&i| problem.relation.start[i]).collect(),
            response: entries.map(|at| problem.relation.response[at]).collect(),
        },
        nodes: places.iter().map(|&s| problem.nodes[s]).collect(),
        ..problem.clone()
    }
}

/// The consistent states among the combinations that branch and bound leaves, in the order of [`census`].
fn branched(problem: &InterfaceProblem, budget: usize, stop: &dyn Fn() -> bool) -> Census {
    let mut walk = Walk::new(problem);
    let Some(mut left) = branches::left(problem, budget, stop) else {
        walk.found.exact = false;
        return walk.found;
    };
    left.assumptions
        .sort_by(|a, b| a.iter().rev().cmp(b.iter().rev()));
    for assumed in &left.assumptions {
        walk.try_one(assumed);
    }
    let choices = problem.nodes.iter().map(|node| node.choices().len());
    let tried = choices.fold(1_usize, |all, choices| all.saturating_mul(choices));
    Census {
        tried,
        visited: left.visited,
        exact: left.all,
        nearest: None,
        ..walk.found
    }
}

/// Enumerates all combinations, node by node with the last node varying fastest, so that consecutive combinations differ in the
/// equations of few nodes. A node's equations are reduced by the previous ones once, and all combinations of the following nodes
/// share that work.
struct Walk<'a> {
    problem: &'a InterfaceProblem,
    /// The two equations of each choice of each node in z: coefficients, right-hand side, and that of the probe for estimating
    /// the norm of the inverse; scaled to a largest coefficient of 1.
    equations: Vec<Vec<[Vec<f64>; 2]>>,
    /// The current equations in reduced form: each has 1 in its pivot's column, and 0 in the pivot columns of the previous ones.
    reduced: Vec<Vec<f64>>,
    pivots: Vec<usize>,
    /// Current mode of each node.
    assumed: Vec<AssumedMode>,
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
                    let largest = max_abs(&line);
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
            assumed: vec![AssumedMode::Free; problem.nodes.len()],
            z: [vec![0.0; count], vec![0.0; count]],
            found: Census::empty(),
        }
    }

    /// Tries all choices of the remaining nodes; `depth` nodes are fixed.
    fn down(&mut self, depth: usize) {
        let Some(place) = self.problem.nodes.len().checked_sub(depth + 1) else {
            self.found.tried += 1;
            if self.solve() {
                self.take_solution()
            } else {
                self.found.singular += 1
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

    /// Tries one combination.
    fn try_one(&mut self, assumed: &[AssumedMode]) {
        let nodes = self.problem.nodes.len();
        self.assumed.copy_from_slice(assumed);
        for depth in 0..nodes {
            let place = nodes - depth - 1;
            let choices = self.problem.nodes[place].choices();
            let choice = choices.iter().position(|c| *c == assumed[place]);
            let reduced = choice.is_some_and(|choice| {
                self.reduce(2 * depth, place, choice, 0)
                    && self.reduce(2 * depth + 1, place, choice, 1)
            });
            if !reduced {
                self.found.singular += 1;
                return;
            }
        }
        if self.solve() {
            self.take_solution()
        } else {
            self.found.singular += 1
        }
    }

    /// Reduces an equation by the `at` previous ones and selects its pivot; returns false if nothing is left of it.
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
        self.z[1]
            .iter()
            .all(|z| z.is_finite() && z.abs() <= SINGULAR)
            && self.z[0].iter().all(|z| z.is_finite())
    }

    /// Records the solution, unless it is worse than a previous one.
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

/// Right-hand side of an equation for estimating the norm of the inverse: with both signs, in irregular order.
fn probe(k: usize) -> f64 {
    let size = 1.0 + (1.618_033_988_749_895 * k as f64).fract();
    if k % 2 == 1 { -size } else { size }
}

impl Census {
    fn empty() -> Self {
        Census {
            exact: true,
            ..Self::default()
        }
    }

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
        match self
            .answers
            .iter_mut()
            .find(|found| is_same(problem, &found.answer, &answer))
        {
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
