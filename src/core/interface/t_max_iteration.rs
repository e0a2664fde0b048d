//! Predicts T_max while a sequence of modes repeats.
//!
//! If the same modes repeat every `period` minor iterations, the previous T_max enters each solve linearly, and T_max = ±(tan φ
//! |F_n| + c) depends linearly on the solution: over a period, T_max changes as x → x* + A (x − x*) with the fixed point x*. If
//! the spectral radius ρ of A is below 1, it converges to x* by a factor of ρ per period; otherwise it diverges. For a single
//! sliding node with period one, A is the number ∓ tan φ W_nt / W_nn (with the compliance W and ∓ the sign of T_max): F_n changes
//! with the tangential force such that the gap stays closed.
//!
//! **When it is certain.** A run repeats these modes as long as T_max satisfies the tests of every iteration of a period. These
//! are linear in x, so if they hold at some points, they hold in the convex hull. They are evaluated at x* ± r along each
//! component; so they hold where the sum of all |x − x*| is at most r. Periods are run one by one until powers of A keep x within
//! this region forever.

use crate::linalg::DenseFactors;
use crate::plane::max_abs;
use crate::{BoundUpdate, ContactState, InterfaceProblem, Method, Mode, Trials};

/// Relative distance from the fixed point below which consecutive periods are equal.
pub const REPEATS: f64 = 1e-12;
/// Ratios ρ with a smaller relative difference are equal.
const SAME_RATIO: f64 = 1e-10;
/// Number of repetitions of the same modes required for a sequence.
const ROUNDS: usize = 2;
/// Maximum number of periods that are run one by one until x stays in the region where the modes are known to repeat.
const MOST_ROUNDS: usize = 400;
/// Number of halvings of r.
const HALVINGS: usize = 12;
/// Number of matrix squarings for the spectral radius.
const SQUARINGS: i32 = 24;

/// Prediction of T_max.
#[derive(Debug, Clone, PartialEq)]
pub struct TMaxIteration {
    /// Number of minor iterations run until the modes had repeated.
    pub start: u32,
    /// Minor iterations per period.
    pub period: u32,
    /// The modes of each node in each iteration of a period.
    pub modes: Vec<Vec<Mode>>,
    /// Indices of the nodes that slide within a period, whose T_max is predicted.
    pub places: Vec<usize>,
    /// T_max of these nodes at the fixed point (force), at the start of a period.
    pub fixed: Vec<f64>,
    /// Largest distance of a node's T_max from the fixed point (force), after `start` iterations.
    pub distance: f64,
    /// Spectral radius ρ of a period.
    pub radius: f64,
    /// Predicted outcome.
    pub fate: TMaxLimit,
}

/// Outcome of a repeating sequence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TMaxLimit {
    /// The modes change within a period and will do so forever: a proven cycle.
    Cycles,
    /// The modes have converged, and T_max will converge.
    Settles,
    /// T_max diverges from the fixed point.
    Diverges,
    /// The sequence of modes will end.
    Passes,
}

impl TMaxIteration {
    /// Number of minor iterations after which T_max repeats to [`REPEATS`], for forces of this magnitude. `None` unless it
    /// converges.
    pub fn iterations(&self, force: f64) -> Option<u64> {
        let near = REPEATS * force;
        if self.radius >= 1.0 {
            return None;
        }
        if self.distance <= near || self.radius == 0.0 {
            return Some(u64::from(self.period));
        }
        let rounds = ((near / self.distance).ln() / self.radius.ln()).ceil();
        Some((rounds * f64::from(self.period)) as u64)
    }
}

/// Prediction for the minor iterations that start from a problem's states, based on at most `most` of them. `None` if they
/// converge earlier, cannot be solved, or repeat no sequence of modes, and if T_max does not lag.
pub fn spiral(
    problem: &InterfaceProblem,
    method: &dyn Method,
    most: usize,
) -> Option<TMaxIteration> {
    if method.bound(problem.settings.t_max) != BoundUpdate::Lagged {
        return None;
    }
    let mut trials = Trials::new(problem)?;
    let mut nodes = problem.states();
    let mut trail = vec![nodes.clone()];
    let mut look = 8;
    let mut apart = None;
    for minor in 1..=most {
        let (_, settled) = trials.minor(&mut nodes, method)?;
        if settled {
            return None;
        }
        trail.push(nodes.clone());
        if minor == look || minor == most {
            look += look.div_ceil(4);
            for period in periods(&trail) {
                let Some(found) = of_round(&mut trials, method, &trail, period) else {
                    continue;
                };
                match found.fate {
                    TMaxLimit::Passes => {}
                    // It may still reach a longer period.
                    TMaxLimit::Diverges => apart = apart.or(Some(found)),
                    TMaxLimit::Cycles | TMaxLimit::Settles => return Some(found),
                }
            }
        }
    }
    apart
}

/// The smallest periods with which the modes at the end of a trail have repeated [`ROUNDS`] times: counting all iterations, and
/// counting only those with a mode change, because a long period may end with many equal iterations.
fn periods(trail: &[Vec<ContactState>]) -> Vec<usize> {
    let last = trail.len() - 1;
    let alike = |a: usize, b: usize| trail[a].iter().zip(&trail[b]).all(|(a, b)| is_same(a, b));
    let repeats = |period: &usize| {
        let rest = last + 1 - (ROUNDS - 1) * period..=last;
        rest.into_iter().all(|at| alike(at, at - period))
    };
    let all = last / ROUNDS;
    let smallest = (1..=all).find(repeats);
    let run = (0..=last).rev().take_while(|&at| alike(at, last)).count();
    let changing = (run.max(1) + 1..=all).find(repeats);
    let mut found: Vec<usize> = smallest.into_iter().chain(changing).collect();
    found.dedup();
    found
}

/// Whether two states have the same mode, direction of T_max and ratio.
fn is_same(a: &ContactState, b: &ContactState) -> bool {
    let ratio = (a.ratio - b.ratio).abs() <= SAME_RATIO * (1.0 + a.ratio.abs());
    let slides = a.mode == Mode::Sliding;
    a.mode == b.mode && (!slides || a.sign == b.sign) && (a.mode == Mode::Free || ratio)
}

/// One period of the modes at the end of a trail.
fn of_round(
    trials: &mut Trials<'_>,
    method: &dyn Method,
    trail: &[Vec<ContactState>],
    period: usize,
) -> Option<TMaxIteration> {
    let round = &trail[trail.len() - 1 - period..];
    let (first, last) = (&round[0], &round[period]);
    let places: Vec<usize> = (0..first.len())
        .filter(|s| round[..period].iter().any(|n| n[*s].mode == Mode::Sliding))
        .collect();
    let map = map(trials, &round[..period], &places)?;
    let size = places.len();
    let at =
        |nodes: &[ContactState]| -> Vec<f64> { places.iter().map(|&s| nodes[s].t_max).collect() };
    // x* = x + (1 − A)⁻¹ (x′ − x).
    let (had, has) = (at(first), at(last));
    let mut step: Vec<f64> = has.iter().zip(&had).map(|(b, a)| b - a).collect();
    let mut rest: Vec<f64> = map.iter().map(|x| -x).collect();
    for k in 0..size {
        rest[k * size + k] += 1.0;
    }
    let mut dense = DenseFactors::new(size, 1).ok()?;
    dense.factor(&rest);
    dense.solve(&mut step).ok()?;
    let fixed: Vec<f64> = had.iter().zip(&step).map(|(x, s)| x + s).collect();
    let away: Vec<f64> = has.iter().zip(&fixed).map(|(x, f)| x - f).collect();
    let mut found = TMaxIteration {
        start: trail.len() as u32 - 1,
        period: period as u32,
        modes: (0..first.len())
            .map(|s| round[..period].iter().map(|nodes| nodes[s].mode).collect())
            .collect(),
        distance: max_abs(&away),
        radius: radius(&map, size),
        fate: TMaxLimit::Diverges,
        places,
        fixed,
    };
    if found.radius < 1.0 {
        let stays = stays(trials, method, round, &found, (&map, away));
        let changes = found
            .modes
            .iter()
            .any(|m| m.iter().any(|mode| *mode != m[0]));
        found.fate = match (stays, changes) {
            (false, _) => TMaxLimit::Passes,
            (true, true) => TMaxLimit::Cycles,
            (true, false) => TMaxLimit::Settles,
        };
    }
    Some(found)
}

/// Derivative of T_max of the nodes `places` after a period with respect to that before: a column-major matrix.
fn map(trials: &mut Trials<'_>, round: &[Vec<ContactState>], places: &[usize]) -> Option<Vec<f64>> {
    let size = places.len();
    let mut all = vec![0.0; size * size];
    for k in 0..size {
        all[k * size + k] = 1.0;
    }
    for nodes in round {
        let given = trials.solve_states(nodes)?;
        let mut once = vec![0.0; size * size];
        for (i, &to) in places.iter().enumerate() {
            let [of_f_n, ..] = trials.answers_of(to)?;
            let node = &trials.problem().nodes[to];
            let f_n = nodes[to].f_n + given[to].force[0];
            let sign = next_sign(&nodes[to], nodes[to].f_t + given[to].force[1]);
            let sliding = places
                .iter()
                .enumerate()
                .filter(|(_, from)| nodes[**from].mode == Mode::Sliding);
            for (j, &from) in sliding {
                once[j * size + i] =
                    sign * f_n.signum() * node.friction.coefficient() * of_f_n[2 * from + 1];
            }
        }
        all = product(&once, &all, size);
    }
    Some(all)
}

/// The direction of T_max after an iteration with this F_t.
fn next_sign(node: &ContactState, f_t: f64) -> f64 {
    if f_t == 0.0 { node.sign } else { f_t.signum() }
}

fn product(a: &[f64], b: &[f64], size: usize) -> Vec<f64> {
    let mut c = vec![0.0; size * size];
    for j in 0..size {
        for k in 0..size {
            let factor = b[j * size + k];
            if factor != 0.0 {
                for i in 0..size {
                    c[j * size + i] += a[k * size + i] * factor;
                }
            }
        }
    }
    c
}

/// Largest column sum of magnitudes.
fn norm(a: &[f64], size: usize) -> f64 {
    a.chunks_exact(size.max(1))
        .fold(0.0, |m, c| c.iter().map(|x| x.abs()).sum::<f64>().max(m))
}

/// The spectral radius: the limit of ‖Aᵐ‖^(1/m), m = 2^[`SQUARINGS`].
fn radius(map: &[f64], size: usize) -> f64 {
    let (mut a, mut log) = (map.to_vec(), 0.0);
    for k in 0..SQUARINGS {
        let size_of = norm(&a, size);
        if size_of == 0.0 {
            return 0.0;
        }
        log += size_of.ln() / 2f64.powi(k);
        a.iter_mut().for_each(|x| *x /= size_of);
        a = product(&a, &a, size);
    }
    log.exp()
}

/// Whether the modes of a period repeat forever while T_max converges from a distance of `away` to the fixed point.
fn stays(
    trials: &mut Trials<'_>,
    method: &dyn Method,
    round: &[Vec<ContactState>],
    spiral: &TMaxIteration,
    (map, mut away): (&[f64], Vec<f64>),
) -> bool {
    let size = spiral.places.len();
    let period = spiral.period as usize;
    let Some(most) = growth(map, size) else {
        return false;
    };
    let total = |x: &[f64]| x.iter().map(|x| x.abs()).sum::<f64>();
    let mut goes = |x: &[f64]| {
        let mut nodes = round[period].clone();
        for ((&s, fixed), x) in spiral.places.iter().zip(&spiral.fixed).zip(x) {
            nodes[s].t_max = fixed + x;
        }
        (1..=period).all(|k| {
            let went = trials.minor(&mut nodes, method).is_some();
            let then = &round[k];
            went && nodes.iter().zip(then).all(|(a, b)| is_same(a, b))
        })
    };
    if !goes(&vec![0.0; size]) {
        return false;
    }
    let mut reach = most * total(&away);
    let holds = |reach: f64, goes: &mut dyn FnMut(&[f64]) -> bool| {
        (0..2 * size).all(|k| {
            let mut x = vec![0.0; size];
            x[k / 2] = if k % 2 == 0 { reach } else { -reach };
            goes(&x)
        })
    };
    let mut halvings = 0;
    while !holds(reach, &mut goes) {
        halvings += 1;
        reach /= 2.0;
        if halvings > HALVINGS {
            return false;
        }
    }
    for _ in 0..MOST_ROUNDS {
        if most * total(&away) <= reach {
            return true;
        }
        if !goes(&away) {
            return false;
        }
        let mut next = vec![0.0; size];
        for (column, x) in map.chunks_exact(size).zip(&away) {
            next.iter_mut().zip(column).for_each(|(y, a)| *y += a * x);
        }
        away = next;
    }
    false
}

/// The largest norm of all powers of A; `None` if they do not decay soon enough.
fn growth(map: &[f64], size: usize) -> Option<f64> {
    let (mut power, mut most) = (map.to_vec(), 1.0_f64);
    for _ in 0..4000 {
        let of = norm(&power, size);
        most = most.max(of);
        if of <= 0.5 {
            return Some(most);
        }
        power = product(map, &power, size);
    }
    None
}
