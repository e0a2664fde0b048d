//! Branch and bound over the modes of a frozen problem's nodes: rules out combinations that cannot be consistent.
//!
//! A branch leaves each node a subset of free, fixed, and sliding in either direction. Its **relaxation** contains all linear
//! conditions that the node's remaining choices share:
//!
//! - F_n ≥ 0 and gap ≥ 0, |F_t| ≤ tan φ F_n + c; equality or zero if only that is left; the sign of the slip;
//! - bounds: with F_n ≤ F and gap ≤ G, F_n/F + gap/G ≤ 1, because one of them is zero; and similarly for the unused friction and
//!   the slip;
//! - energy: the contact forces do no work on gaps, and friction dissipates work, so E = Σ (F_n gap − F_t slip) ≤ 0. If the
//!   compliance W is positive semidefinite, E is convex in the motions, and its tangent at a point that violates it is a linear
//!   condition that excludes this point. A definite W thus bounds all forces and motions.
//!
//! A branch whose relaxation is infeasible (proven by [`BoundedForms::can_hold`], with all bounds relaxed by 1e-8) is pruned. Other
//! branches are split at the node that violates its complementarity most. The remaining combinations are solved and checked by
//! the census like in a complete enumeration.

use crate::interface::feasible::BoundedForms;
use crate::linalg::DenseFactors;
use crate::plane::max_abs;
use crate::{AssumedMode, InterfaceProblem};

/// Relaxation of every bound, in the problem's units of force and length. A combination is consistent if it violates them by at
/// most 1e-9.
const SLACK: f64 = 1e-8;
/// Number of forms per node: F_n, gap, φ+ = tan φ F_n + c − F_t, φ− (with + F_t), slip, and three for bounds.
const OF_NODE: usize = 8;
/// Maximum number of energy tangents.
const TANGENTS: usize = 30;
/// Maximum number of tangents added to a branch before it is split, and at the root.
const ROUNDS: usize = 5;
const FIRST_ROUNDS: usize = 20;
/// Rounds of tightening the global bounds.
const SHARPENED: usize = 3;
/// Minimum size of a bound.
const SMALLEST: f64 = 1e-9;

const FREE: u8 = 1;
const FIXED: u8 = 2;
const PLUS: u8 = 4;
const MINUS: u8 = 8;

/// Result for a problem.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchResult {
    /// The combinations that are not ruled out, in search order.
    pub assumptions: Vec<Vec<AssumedMode>>,
    /// Number of visited branches.
    pub visited: usize,
    /// Whether all branches were visited.
    pub all: bool,
}

/// The combinations that cannot be ruled out, visiting at most `budget` branches, and stopping when `stop` returns true. `None`
/// if the relation does not determine the motions.
pub fn left(
    problem: &InterfaceProblem,
    budget: usize,
    stop: &dyn Fn() -> bool,
) -> Option<BranchResult> {
    let mut branches = Branches::new(problem, budget, stop)?;
    let choices: Vec<u8> = problem.nodes.iter().map(|n| mask(n.choices())).collect();
    let all = branches.down(&choices);
    Some(BranchResult {
        assumptions: branches.found,
        visited: branches.visited,
        all,
    })
}

/// Linear data of a node.
struct BranchNode {
    coefficient: f64,
    cohesion: f64,
    /// Whether its normal and its tangential motion contain an unknown.
    moves: [bool; 2],
    /// Whether it is over a surface.
    over: bool,
    smooth: bool,
    /// F_n, gap, φ+, φ−, slip: global lower and upper bounds.
    within: [[f64; 2]; 5],
    /// Bounds of the three bound forms.
    products: [[f64; 2]; 3],
}

struct Branches<'a> {
    /// F_n, F_t, gap and slip of each node in units of force and length: coefficients and a constant.
    numbers: Vec<[Vec<f64>; 4]>,
    nodes: Vec<BranchNode>,
    forms: BoundedForms,
    /// Whether the energy is convex.
    convex: bool,
    tangent: usize,
    budget: usize,
    stop: &'a dyn Fn() -> bool,
    visited: usize,
    found: Vec<Vec<AssumedMode>>,
}

fn mask(choices: &[AssumedMode]) -> u8 {
    choices.iter().fold(0, |mask, &assumed| mask | bit(assumed))
}

fn bit(assumed: AssumedMode) -> u8 {
    match assumed {
        AssumedMode::Free => FREE,
        AssumedMode::Fixed => FIXED,
        AssumedMode::Plus => PLUS,
        AssumedMode::Minus => MINUS,
    }
}

impl<'a> Branches<'a> {
    fn new(problem: &InterfaceProblem, budget: usize, stop: &'a dyn Fn() -> bool) -> Option<Self> {
        let numbers = numbers(problem);
        let energy = Energy::from_numbers(&numbers, problem.relation.count());
        let nodes: Vec<BranchNode> = problem
            .nodes
            .iter()
            .zip(&numbers)
            .map(|(node, numbers)| {
                let [f_n, f_t, gap, slip] = energy.ranges(numbers);
                let cohesion = node.friction.cohesion / force(problem);
                let coefficient = node.friction.coefficient();
                let pressed = if coefficient > 0.0 {
                    coefficient * f_n[1]
                } else {
                    0.0
                };
                let limit = pressed + cohesion;
                let rest = limit + f_t[1].abs().max(f_t[0].abs());
                let rest = [0.0, rest.min(2.0 * limit)];
                BranchNode {
                    coefficient,
                    cohesion,
                    moves: node.moves(),
                    over: node.kinematics.is_some(),
                    smooth: node.friction.is_smooth(),
                    within: [[0.0, f_n[1]], [0.0, gap[1]], rest, rest, slip],
                    products: [[f64::NEG_INFINITY, f64::INFINITY]; 3],
                }
            })
            .collect();
        let forms = BoundedForms::new(1, vec![1.0, 0.0], SLACK)?;
        let mut branches = Branches {
            numbers,
            nodes,
            forms,
            convex: energy.convex,
            tangent: 0,
            budget,
            stop,
            visited: 0,
            found: Vec::new(),
        };
        let choices: Vec<u8> = problem.nodes.iter().map(|n| mask(n.choices())).collect();
        branches.build(&choices)?;
        branches.sharpen(&choices)?;
        Some(branches)
    }

    /// Builds the forms from the known bounds, and bounds them for these choices.
    fn build(&mut self, choices: &[u8]) -> Option<()> {
        let width = self.numbers[0][0].len();
        let mut all = Vec::new();
        for (node, [f_n, f_t, gap, slip]) in self.nodes.iter_mut().zip(&self.numbers) {
            let rest = |sign: f64| {
                let mut form = sum(f_n, node.coefficient, f_t, sign);
                form[width - 1] += node.cohesion;
                form
            };
            let (plus, minus) = (rest(-1.0), rest(1.0));
            let within = &node.within;
            let touches = node.over && node.moves[0];
            let slips = touches && node.moves[1] && !node.smooth;
            let mut products = [[f64::NEG_INFINITY, f64::INFINITY]; 3];
            // a/x + c/y ≤ 1, multiplied by the smaller of x and y; c is at least `low`.
            let mut product =
                |k: usize, holds: bool, a: &[f64], x: f64, c: &[f64], y: f64, low: f64| {
                    let (x, y) = (x.max(SMALLEST), y.abs().max(SMALLEST).copysign(y));
                    if !holds || !x.is_finite() || !y.is_finite() {
                        return vec![0.0; width];
                    }
                    let unit = x.min(y.abs());
                    products[k] = [low * unit / y.abs(), unit];
                    sum(a, unit / x, c, unit / y)
                };
            let [_, _, _, _, [least, most]] = *within;
            let of_bounds = [
                product(0, touches, f_n, within[0][1], gap, within[1][1], 0.0),
                product(
                    1,
                    slips,
                    &plus,
                    within[2][1],
                    slip,
                    most.max(SMALLEST),
                    least.min(0.0),
                ),
                product(
                    2,
                    slips,
                    &minus,
                    within[3][1],
                    slip,
                    least.min(-SMALLEST),
                    (-most).min(0.0),
                ),
            ];
            node.products = products;
            for form in [f_n, gap, &plus, &minus, slip]
                .into_iter()
                .chain(&of_bounds)
            {
                all.extend_from_slice(form);
            }
        }
        all.resize(all.len() + TANGENTS * width, 0.0);
        self.forms = BoundedForms::new(width - 1, all, SLACK)?;
        self.tangent = 0;
        self.bound_all(choices);
        Some(())
    }

    /// Tightens the bounds of all forms for these choices.
    fn sharpen(&mut self, choices: &[u8]) -> Option<()> {
        for _ in 0..SHARPENED {
            if (self.stop)() || !self.holds(FIRST_ROUNDS) {
                break;
            }
            for (place, &own) in choices.iter().enumerate() {
                for k in 0..5 {
                    let form = OF_NODE * place + k;
                    let within = &mut self.nodes[place].within[k];
                    within[1] = within[1].min(self.forms.most(form, 1.0));
                    if k == 4 {
                        within[0] = within[0].max(-self.forms.most(form, -1.0));
                    }
                }
                self.bound(place, own);
            }
            self.build(choices)?;
        }
        Some(())
    }

    fn bound_all(&mut self, choices: &[u8]) {
        for (place, &choices) in choices.iter().enumerate() {
            self.bound(place, choices);
        }
    }

    /// Bounds the forms of a node by the conditions common to its choices.
    fn bound(&mut self, place: usize, choices: u8) {
        const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
        const NONE: [f64; 2] = [0.0, 0.0];
        let node = &self.nodes[place];
        let [mut f_n, mut gap, mut plus, mut minus, mut slip] = node.within;
        let touches = choices & FREE == 0;
        if !node.over || (!node.moves[0] && choices != FREE) {
            gap = ANY;
        }
        if !node.moves[0] && touches {
            f_n = NONE;
        }
        if choices == FREE {
            (f_n, plus, minus) = (NONE, [node.cohesion; 2], [node.cohesion; 2]);
        } else if touches && node.moves[0] {
            gap = NONE;
        }
        if !node.smooth && touches {
            let sticks = choices & FIXED == 0 || node.moves[1];
            match choices {
                FIXED if node.moves[1] => slip = NONE,
                PLUS => plus = NONE,
                MINUS => minus = NONE,
                _ => {}
            }
            if sticks && choices & MINUS == 0 {
                slip[0] = slip[0].max(0.0);
            }
            if sticks && choices & PLUS == 0 {
                slip[1] = slip[1].min(0.0);
            }
        }
        let [pressed, plus_slips, minus_slips] = node.products;
        // A free node with cohesion may have forces and slips that friction does not allow.
        let both = touches || node.cohesion == 0.0;
        let bounds = [
            f_n,
            gap,
            plus,
            minus,
            slip,
            pressed,
            if both { plus_slips } else { ANY },
            if both { minus_slips } else { ANY },
        ];
        for (k, [low, high]) in bounds.into_iter().enumerate() {
            self.forms.bound(OF_NODE * place + k, low, high);
        }
    }

    /// Whether the relaxation is feasible, adding up to `rounds` tangents of the energy.
    fn holds(&mut self, rounds: usize) -> bool {
        for _ in 0..rounds {
            if !self.forms.can_hold() {
                return false;
            }
            if !self.cut_energy() {
                return true;
            }
        }
        self.forms.can_hold()
    }

    fn value(&self, place: usize, k: usize) -> f64 {
        self.forms.value(OF_NODE * place + k)
    }

    /// Adds the tangent of the energy at the current point, if that point violates it.
    fn cut_energy(&mut self) -> bool {
        if !self.convex {
            return false;
        }
        let (mut energy, mut size, mut tangent) = (0.0, 0.0_f64, Vec::new());
        for place in 0..self.nodes.len() {
            if !self.nodes[place].over {
                continue;
            }
            let [f_n, gap, plus, minus, slip] = [0, 1, 2, 3, 4].map(|k| self.value(place, k));
            let f_t = (minus - plus) / 2.0;
            energy += f_n * gap - f_t * slip;
            size += (f_n * gap).abs() + (f_t * slip).abs();
            let factors = [gap, f_n, slip / 2.0, -slip / 2.0, -f_t];
            let forms = (OF_NODE * place..).zip(factors);
            tangent.extend(forms);
        }
        if energy < 1e-6 || energy < 0.03 * size {
            return false;
        }
        let largest = max_abs(tangent.iter().map(|(_, factor)| factor));
        tangent.iter_mut().for_each(|t| t.1 /= largest);
        // A weakened tangent: the loss of convexity by round-off is much smaller than the margin.
        let high = (energy + 1e-9 * size) / largest;
        for _ in 0..TANGENTS {
            self.tangent = (self.tangent + 1) % TANGENTS;
            let form = OF_NODE * self.nodes.len() + self.tangent;
            if self.forms.replace(form, &tangent, high) {
                return true;
            }
        }
        false
    }

    /// Visits a branch; returns false if it was not completed.
    fn down(&mut self, choices: &[u8]) -> bool {
        if self.visited >= self.budget || (self.stop)() {
            return false;
        }
        self.visited += 1;
        if !self.holds(ROUNDS) {
            return true;
        }
        let open = (0..choices.len()).filter(|&place| choices[place].count_ones() > 1);
        let broken = |place: &usize| self.broken(*place);
        let Some(place) = open.max_by(|a, b| broken(a).total_cmp(&broken(b)).then(b.cmp(a))) else {
            self.found.push(choices.iter().map(|&c| only(c)).collect());
            return true;
        };
        for part in self.split(place, choices[place]) {
            let mut fewer = choices.to_vec();
            fewer[place] = part;
            self.bound_all(&fewer);
            if !self.down(&fewer) {
                return false;
            }
        }
        true
    }

    /// Violation of a node's complementarity at the current point.
    fn broken(&self, place: usize) -> f64 {
        let [f_n, gap, plus, minus, slip] = [0, 1, 2, 3, 4].map(|k| self.value(place, k));
        f_n * gap + plus * slip.max(0.0) + minus * (-slip).max(0.0)
    }

    /// Splits a node's choices, with the part favoured by the current point first.
    fn split(&self, place: usize, choices: u8) -> [u8; 2] {
        let slip = self.value(place, 4);
        let one = if choices & FREE != 0 {
            FREE
        } else {
            let first = if slip > 0.0 {
                [PLUS, MINUS]
            } else {
                [MINUS, PLUS]
            };
            let found = first.into_iter().find(|one| choices & one != 0);
            found.unwrap_or(FIXED)
        };
        if self.value(place, 0) > self.value(place, 1) {
            [choices & !one, one]
        } else {
            [one, choices & !one]
        }
    }
}

/// The only remaining choice.
fn only(choices: u8) -> AssumedMode {
    match choices {
        FREE => AssumedMode::Free,
        FIXED => AssumedMode::Fixed,
        PLUS => AssumedMode::Plus,
        _ => AssumedMode::Minus,
    }
}

/// x a + y b.
fn sum(a: &[f64], x: f64, b: &[f64], y: f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| x * a + y * b).collect()
}

/// The unit of forces: the problem's, or the largest force for zero motions.
fn force(problem: &InterfaceProblem) -> f64 {
    let largest = problem
        .relation
        .start
        .iter()
        .fold(problem.force, |m, x| m.max(x.abs()));
    if largest > 0.0 { largest } else { 1.0 }
}

/// F_n, F_t, gap and slip of each node as functions of z, in units of force and length.
fn numbers(problem: &InterfaceProblem) -> Vec<[Vec<f64>; 4]> {
    let relation = &problem.relation;
    let count = relation.count();
    let (force, length) = (force(problem), problem.length);
    let of_node = |(place, node): (usize, &crate::interface::problem::ProblemNode)| {
        let force_of = |k: usize, had: f64| {
            let row = 2 * place + k;
            let mut form: Vec<f64> = (0..count)
                .map(|j| relation.response[j * count + row] * (length / force))
                .collect();
            form.push((relation.start[row] + had) / force);
            form
        };
        let motion_of = |k: usize, offset: f64, sign: f64| {
            let row = 2 * place + k;
            let mut form: Vec<f64> = (0..count)
                .map(|j| {
                    let own = if j == row { 1.0 } else { 0.0 };
                    sign * (own + relation.response[j * count + row] / relation.stiffness)
                })
                .collect();
            let start = relation.start[row] / relation.stiffness + node.prescribed[k];
            form.push((offset + sign * start) / length);
            form
        };
        let gap = node.kinematics.map_or(0.0, |k| k.gap);
        [
            force_of(0, node.state.f_n),
            force_of(1, node.state.f_t),
            motion_of(0, gap, -1.0),
            motion_of(1, node.state.slipped(&problem.settings), 1.0),
        ]
    };
    problem.nodes.iter().enumerate().map(of_node).collect()
}

/// E = Σ (F_n gap − F_t slip) = z·H z + b·z + c ≤ 0.
struct Energy {
    count: usize,
    convex: bool,
    /// Factored H, centre −H⁻¹ b / 2, and −E at the centre; `None` if the energy bounds nothing.
    ball: Option<(std::cell::RefCell<DenseFactors>, Vec<f64>, f64)>,
}

impl Energy {
    fn from_numbers(numbers: &[[Vec<f64>; 4]], count: usize) -> Energy {
        let mut form = vec![0.0; count * count];
        let (mut linear, mut constant) = (vec![0.0; count], 0.0);
        for [f_n, f_t, gap, slip] in numbers {
            for (a, b, sign) in [(f_n, gap, 1.0), (f_t, slip, -1.0)] {
                for i in 0..count {
                    for j in 0..count {
                        form[j * count + i] += sign * (a[i] * b[j] + b[i] * a[j]) / 2.0;
                    }
                    linear[i] += sign * (a[i] * b[count] + b[i] * a[count]);
                }
                constant += sign * a[count] * b[count];
            }
        }
        let convex = is_semidefinite(&form, count);
        let ball = || {
            let mut factors = DenseFactors::new(count, 1).ok()?;
            factors.factor(&form);
            if factors.inverse_norm() > 1e9 {
                return None;
            }
            let mut middle: Vec<f64> = linear.iter().map(|b| -b / 2.0).collect();
            let own = middle.clone();
            factors.solve(&mut middle).ok()?;
            let depth: f64 = own.iter().zip(&middle).map(|(b, m)| b * m).sum();
            Some((factors.into(), middle, (depth - constant).max(0.0)))
        };
        Energy {
            count,
            convex,
            ball: if convex { ball() } else { None },
        }
    }

    /// Smallest and largest values of a node's numbers for E ≤ 0.
    fn ranges(&self, numbers: &[Vec<f64>; 4]) -> [[f64; 2]; 4] {
        let range = |form: &Vec<f64>| {
            let any = [f64::NEG_INFINITY, f64::INFINITY];
            let Some((factors, middle, depth)) = &self.ball else {
                return any;
            };
            let own = &form[..self.count];
            let mut across = own.to_vec();
            if factors.borrow_mut().solve(&mut across).is_err() {
                return any;
            }
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let at = dot(own, middle) + form[self.count];
            let reach = (dot(own, &across).max(0.0) * depth).sqrt();
            // A margin far above round-off, for inverses up to 1e9.
            let reach = reach + 1e-6 * (reach + at.abs() + form[self.count].abs()) + SLACK;
            [at - reach, at + reach]
        };
        [0, 1, 2, 3].map(|k| range(&numbers[k]))
    }
}

/// Whether a symmetric matrix has no eigenvalue below round-off: LDLᵀ with a shift of the round-off's size.
fn is_semidefinite(matrix: &[f64], count: usize) -> bool {
    let mut a = matrix.to_vec();
    let largest = max_abs(a.iter().step_by(count + 1));
    let shift = 1e-14 * count as f64 * largest;
    for k in 0..count {
        let pivot = a[k * count + k] + shift;
        if pivot <= 0.0 {
            return false;
        }
        for j in k + 1..count {
            let factor = a[k * count + j] / pivot;
            for i in j..count {
                a[j * count + i] -= factor * a[k * count + i];
            }
        }
    }
    true
}
