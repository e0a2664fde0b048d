//! Branch and bound over what the nodes of a frozen problem do: which assumptions can be consistent at all.
//!
//! A branch leaves each node some of free, fixed, sliding either way. Its **relaxation** has every linear condition that all
//! of a node's remaining choices share:
//!
//! - F_n ≥ 0 and gap ≥ 0, |F_t| ≤ tan φ F_n + c; one of them zero where only that is left; the sign of the slip;
//! - bounds: with F_n ≤ F and gap ≤ G, F_n/F + gap/G ≤ 1, since one of them is zero; and likewise for what friction could
//!   still give and the slip;
//! - energy: the contact forces do no work on gaps and take work out by friction, so E = Σ (F_n gap − F_t slip) ≤ 0. Where
//!   the compliance W is positive semidefinite, E is convex in the motions, and each of its tangents at a point that breaks
//!   it is a linear condition that cuts this point off. A definite W bounds all forces and motions so.
//!
//! A branch whose relaxation cannot hold ([`Forms::can_hold`] proves it, with all bounds relaxed by 1e-8) is pruned.
//! The others are split at the node that breaks its complements most. What is left are assumptions of all nodes, which the
//! census solves and checks as if it had tried them one by one.

use crate::interface::feasible::Forms;
use crate::interface::problem::{Assumed, InterfaceProblem};
use crate::linalg::DenseFactors;

/// How far every bound is relaxed, in the problem's units of force and length. An assumption is consistent if it obeys up to
/// 1e-9 of them.
const SLACK: f64 = 1e-8;
/// Forms of a node: F_n, gap, φ+ = tan φ F_n + c − F_t, φ− (with + F_t), slip, and three of bounds.
const OF_NODE: usize = 8;
/// Tangents of the energy that are kept.
const TANGENTS: usize = 30;
/// Tangents that are added to a branch before it is split, and before the first.
const ROUNDS: usize = 5;
const FIRST_ROUNDS: usize = 20;
/// Rounds in which bounds of the whole are sharpened.
const SHARPENED: usize = 3;
/// A bound smaller than this is taken as this.
const SMALLEST: f64 = 1e-9;

const FREE: u8 = 1;
const FIXED: u8 = 2;
const PLUS: u8 = 4;
const MINUS: u8 = 8;

/// What was found of a problem.
#[derive(Debug, Clone, PartialEq)]
pub struct Left {
    /// The assumptions that are not ruled out, in the order in which they were found.
    pub assumptions: Vec<Vec<Assumed>>,
    /// Branches looked at.
    pub visited: usize,
    /// Whether all branches were looked at.
    pub all: bool,
}

/// The assumptions that cannot be ruled out, looking at no more than `budget` branches, and until `stop` says so.
/// `None` where the relation does not determine the motions.
pub fn left(problem: &InterfaceProblem, budget: usize, stop: &dyn Fn() -> bool) -> Option<Left> {
    let mut branches = Branches::new(problem, budget, stop)?;
    let choices: Vec<u8> = problem.nodes.iter().map(|n| mask(n.choices())).collect();
    let all = branches.down(&choices);
    Some(Left {
        assumptions: branches.found,
        visited: branches.visited,
        all,
    })
}

/// What is linear of a node.
struct Node {
    coefficient: f64,
    cohesion: f64,
    /// Whether an unknown takes part in its normal and in its tangential motion.
    moves: [bool; 2],
    /// Whether it stands over a surface.
    over: bool,
    smooth: bool,
    /// F_n, gap, φ+, φ−, slip: lower and upper bounds that hold for the whole problem.
    within: [[f64; 2]; 5],
    /// Bounds of the three forms of bounds.
    products: [[f64; 2]; 3],
}

struct Branches<'a> {
    /// F_n, F_t, gap and slip of each node, in units of force and length: coefficients and a constant.
    numbers: Vec<[Vec<f64>; 4]>,
    nodes: Vec<Node>,
    forms: Forms,
    /// Whether the energy is convex.
    convex: bool,
    tangent: usize,
    budget: usize,
    stop: &'a dyn Fn() -> bool,
    visited: usize,
    found: Vec<Vec<Assumed>>,
}

fn mask(choices: &[Assumed]) -> u8 {
    choices.iter().fold(0, |mask, &assumed| mask | bit(assumed))
}

fn bit(assumed: Assumed) -> u8 {
    match assumed {
        Assumed::Free => FREE,
        Assumed::Fixed => FIXED,
        Assumed::Plus => PLUS,
        Assumed::Minus => MINUS,
    }
}

impl<'a> Branches<'a> {
    fn new(problem: &InterfaceProblem, budget: usize, stop: &'a dyn Fn() -> bool) -> Option<Self> {
        let numbers = numbers(problem);
        let energy = Energy::of(&numbers, problem.relation.count());
        let nodes: Vec<Node> = problem
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
                Node {
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
        let forms = Forms::new(1, vec![1.0, 0.0], SLACK)?;
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

    /// Makes the forms for the bounds that are known, and bounds them for these choices.
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
            // a/x + c/y ≤ 1, times the smaller of x and y; c is at least `low`.
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
        self.forms = Forms::new(width - 1, all, SLACK)?;
        self.tangent = 0;
        self.bound_all(choices);
        Some(())
    }

    /// Sharpens the bounds of all forms for these choices.
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

    /// Bounds the forms of a node by what its choices share.
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
        // A free node with cohesion has forces and slips that friction alone could not leave it.
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

    /// Whether the relaxation can hold, with up to so many tangents of the energy added.
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

    /// Adds the tangent of the energy at the present point, if that breaks it.
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
        let largest = tangent.iter().fold(0.0_f64, |m, t| m.max(t.1.abs()));
        tangent.iter_mut().for_each(|t| t.1 /= largest);
        // Not all of the tangent: what round-off takes from convexity is far less.
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

    /// Looks at a branch; false where it was not looked at to its end.
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

    /// How far a node is from being complementary at the present point.
    fn broken(&self, place: usize) -> f64 {
        let [f_n, gap, plus, minus, slip] = [0, 1, 2, 3, 4].map(|k| self.value(place, k));
        f_n * gap + plus * slip.max(0.0) + minus * (-slip).max(0.0)
    }

    /// The parts of a node's choices, that into which the present point leans first.
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

/// The choice that is left.
fn only(choices: u8) -> Assumed {
    match choices {
        FREE => Assumed::Free,
        FIXED => Assumed::Fixed,
        PLUS => Assumed::Plus,
        _ => Assumed::Minus,
    }
}

/// x a + y b.
fn sum(a: &[f64], x: f64, b: &[f64], y: f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| x * a + y * b).collect()
}

/// The unit of forces: the problem's, or the largest that acts where nothing moves.
fn force(problem: &InterfaceProblem) -> f64 {
    let starts = problem.relation.start.iter();
    let largest = starts.fold(problem.force, |m, x| m.max(x.abs()));
    if largest > 0.0 { largest } else { 1.0 }
}

/// F_n, F_t, gap and slip of each node in z, in units of force and length.
fn numbers(problem: &InterfaceProblem) -> Vec<[Vec<f64>; 4]> {
    let relation = &problem.relation;
    let count = relation.count();
    let (force, length) = (force(problem), problem.length);
    let of_node = |(place, node): (usize, &crate::interface::problem::ProblemNode)| {
        let force_of = |k: usize, had: f64| {
            let row = 2 * place + k;
            let column = |j: usize| relation.response[j * count + row] * (length / force);
            let mut form: Vec<f64> = (0..count).map(column).collect();
            form.push((relation.start[row] + had) / force);
            form
        };
        let motion_of = |k: usize, offset: f64, sign: f64| {
            let row = 2 * place + k;
            let column = |j: usize| {
                let own = if j == row { 1.0 } else { 0.0 };
                sign * (own + relation.response[j * count + row] / relation.stiffness)
            };
            let mut form: Vec<f64> = (0..count).map(column).collect();
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
    /// H, factored, the middle −H⁻¹ b / 2, and E there with its sign turned; `None` where that bounds nothing.
    ball: Option<(std::cell::RefCell<DenseFactors>, Vec<f64>, f64)>,
}

impl Energy {
    fn of(numbers: &[[Vec<f64>; 4]], count: usize) -> Energy {
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

    /// Least and largest values of a node's numbers where E ≤ 0.
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
            // Far more than round-off, for an inverse of up to 1e9.
            let reach = reach + 1e-6 * (reach + at.abs() + form[self.count].abs()) + SLACK;
            [at - reach, at + reach]
        };
        [0, 1, 2, 3].map(|k| range(&numbers[k]))
    }
}

/// Whether a symmetric matrix has no eigenvalue below round-off: LDLᵀ of it with a shift of round-off's size.
fn is_semidefinite(matrix: &[f64], count: usize) -> bool {
    let mut a = matrix.to_vec();
    let largest = (0..count).fold(0.0_f64, |m, i| m.max(a[i * count + i].abs()));
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
