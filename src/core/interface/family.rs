//! States of a frozen problem that differ only in their forces.
//!
//! If the compliance W is singular on the touching nodes, some forces d cause no motion: W d = 0 (a body on more contacts than it
//! needs, two nodes on one spring). With a consistent state F, every F + d is consistent that satisfies F_n ≥ 0 and the friction
//! limit, and is on that limit for slipping nodes: the motions are the same, and the forces form a **family**, a convex set. The
//! census finds its corners, where the acting forces are uniquely determined; states in between solve singular equations and
//! count as such.
//!
//! Constant forces: those of nodes that do not touch, those carried by supports, and those of a node with cohesion but without
//! pressure, because it would jump.

use crate::InterfaceProblem;
use crate::interface::census::{Census, Consistent};
use crate::interface::feasible::BoundedForms;
use crate::interface::vertex::{motionless, orthonormal};
use nalgebra::DMatrix;

/// Relative tolerance for equal or zero gaps and slips (times the problem's length).
const SAME: f64 = 1e-9;
/// Tolerance for equal forces, relative to the largest force of a state.
const SAME_FORCE: f64 = 1e-6;
/// Largest forces up to which a family is followed, relative to the largest force of a state.
const REACH: f64 = 1e4;
/// Slack of the conditions.
const SLACK: f64 = 1e-10;

/// States with the same motions.
#[derive(Debug, Clone, PartialEq)]
pub struct Family {
    /// The consistent states of the census in this family, by index.
    pub states: Vec<usize>,
    /// Number of directions in which forces can change, at least 1.
    pub dimension: usize,
    /// For the nodes with variable forces, by index: lowest and highest F_n, and F_t; equal if constant, infinite if unbounded.
    pub ranges: Vec<Range>,
}

/// A node (its index), and the lowest and highest of its F_n and of its F_t (force).
pub type Range = (usize, [[f64; 2]; 2]);

/// The families among the states of a census.
pub fn families(problem: &InterfaceProblem, census: &Census) -> Vec<Family> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (number, state) in census.answers.iter().enumerate() {
        match groups
            .iter_mut()
            .find(|group| moves_alike(problem, state, &census.answers[group[0]]))
        {
            Some(group) => group.push(number),
            None => groups.push(vec![number]),
        }
    }
    let found = groups.into_iter().filter_map(|states| {
        let all: Vec<&Consistent> = states.iter().map(|&k| &census.answers[k]).collect();
        let (dimension, ranges) = ForceFamily::from_states(problem, &all)?.family()?;
        Some(Family {
            states,
            dimension,
            ranges,
        })
    });
    found.collect()
}

fn moves_alike(problem: &InterfaceProblem, a: &Consistent, b: &Consistent) -> bool {
    let near = |a: f64, b: f64| a == b || (a - b).abs() <= SAME * problem.length;
    a.answer
        .nodes
        .iter()
        .zip(&b.answer.nodes)
        .all(|(a, b)| near(a.gap, b.gap) && near(a.slip, b.slip))
}

/// Forces without motion, about a mean of states with equal motions; in multiples of `unit`.
struct ForceFamily<'a> {
    problem: &'a InterfaceProblem,
    /// The largest force of these states, or of the problem.
    unit: f64,
    /// F_n and F_t of the mean state.
    force: Vec<[f64; 2]>,
    /// The touching nodes with variable forces, and whether their F_t varies within the limit: others slide, have no friction, or
    /// a support carries F_t.
    variable: Vec<(usize, bool)>,
    /// Orthonormal directions, two entries per node.
    directions: Vec<Vec<f64>>,
}

impl<'a> ForceFamily<'a> {
    /// `None` if every force causes motion.
    fn from_states(problem: &'a InterfaceProblem, states: &[&Consistent]) -> Option<Self> {
        let unit = states
            .iter()
            .flat_map(|state| &state.answer.nodes)
            .fold(problem.force, |m, n| m.max(n.f_n.abs()).max(n.f_t.abs()));
        let force: Vec<[f64; 2]> = (0..problem.nodes.len())
            .map(|place| {
                let sum = states
                    .iter()
                    .map(|state| &state.answer.nodes[place])
                    .fold([0.0; 2], |s, n| [s[0] + n.f_n, s[1] + n.f_t]);
                sum.map(|x| x / states.len() as f64 / unit)
            })
            .collect();
        let (mut variable, mut columns) = (Vec::new(), Vec::new());
        for (place, node) in problem.nodes.iter().enumerate() {
            let at = &states[0].answer.nodes[place];
            let [normal, tangential] = node.moves();
            let jumps = node.friction.cohesion != 0.0 && force[place][0] <= SAME_FORCE;
            if !normal || jumps || at.gap.abs() > SAME * problem.length {
                continue;
            }
            let rough = tangential && !node.friction.is_smooth();
            let slips = at.slip.abs() > SAME * problem.length;
            let slope = match (rough, slips) {
                (true, true) => node.friction.coefficient() * at.slip.signum(),
                _ => 0.0,
            };
            columns.push((place, [1.0, slope]));
            if rough && !slips {
                columns.push((place, [0.0, 1.0]));
            }
            variable.push((place, rough && !slips));
        }
        let mut directions = motionless(problem, &columns);
        orthonormal(&mut directions);
        (!directions.is_empty()).then_some(ForceFamily {
            problem,
            unit,
            force,
            variable,
            directions,
        })
    }

    /// Its dimension and ranges; `None` if the friction cones exclude it.
    fn family(&self) -> Option<(usize, Vec<Range>)> {
        let size = self.directions.len();
        let mut forms = Vec::new();
        for k in 0..size {
            forms.extend((0..=size).map(|j| if j == k { 1.0 } else { 0.0 }));
        }
        // F_n of each node, then F_t; then quantities that must not be negative.
        let mut asked = Vec::new();
        for &(place, _) in &self.variable {
            let [f_n, f_t] = self.of_node(place);
            asked.push((forms.len() / (size + 1), place));
            forms.extend(f_n.iter().chain(&f_t).copied());
        }
        let mut bounded: Vec<usize> = asked.iter().map(|(form, _)| *form).collect();
        for &(place, _) in self.variable.iter().filter(|(_, within)| *within) {
            let friction = &self.problem.nodes[place].friction;
            let cohesion = friction.cohesion / self.unit;
            let [f_n, f_t] = self.of_node(place);
            for sign in [-1.0, 1.0] {
                bounded.push(forms.len() / (size + 1));
                let pairs = f_n.iter().zip(&f_t).enumerate();
                forms.extend(pairs.map(|(k, (n, t))| {
                    let given = if k == size { cohesion } else { 0.0 };
                    friction.coefficient() * n + sign * t + given
                }));
            }
        }
        let rows = |form: usize| forms[form * (size + 1)..(form + 1) * (size + 1) - 1].to_vec();
        let of_bounded: Vec<Vec<f64>> = bounded.iter().map(|&form| rows(form)).collect();
        let mut inside = BoundedForms::new(size, forms, SLACK)?;
        (0..size).for_each(|k| inside.bound(k, -REACH, REACH));
        for &form in &bounded {
            inside.bound(form, 0.0, f64::INFINITY);
        }
        if !inside.can_hold() {
            return None;
        }
        // A condition that can only be zero removes a direction.
        let mut fixed = Vec::new();
        for (&form, row) in bounded.iter().zip(of_bounded) {
            if inside.most(form, 1.0) <= SAME_FORCE {
                fixed.extend(row);
            }
        }
        let dimension = match fixed.len() / size {
            0 => size,
            rows => size - DMatrix::from_row_slice(rows, size, &fixed).rank(SAME_FORCE),
        };
        if dimension == 0 {
            return None;
        }
        let mut range = |form: usize| {
            let mut end = |sign: f64| {
                let most = inside.most(form, sign);
                let far = most > REACH / 10.0;
                sign * if far { f64::INFINITY } else { most } * self.unit
            };
            let [low, high] = [end(-1.0), end(1.0)];
            if high - low > SAME_FORCE * self.unit {
                [low, high]
            } else {
                [(low + high) / 2.0; 2]
            }
        };
        let all = asked
            .iter()
            .map(|&(form, place)| (place, [range(form), range(form + 1)]));
        Some((
            dimension,
            all.filter(|(_, ranges)| ranges.iter().any(|[low, high]| low < high))
                .collect(),
        ))
    }

    /// F_n and F_t of a node: one coefficient per direction, and the constant.
    fn of_node(&self, place: usize) -> [Vec<f64>; 2] {
        [0, 1].map(|k| {
            let along = self.directions.iter().map(|along| along[2 * place + k]);
            along.chain([self.force[place][k]]).collect()
        })
    }
}
