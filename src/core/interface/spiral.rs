//! Where T_max is going while the modes repeat.
//!
//! While the same modes come again every `period` minor iterations, T_max of the one before enters each solve linearly, and
//! T_max = ±(tan φ |F_n| + c) follows from it: over a round, T_max goes x → x* + A (x − x*), with x* the fixed point. With
//! the spectral radius ρ of A below 1 it spirals into x*, by a factor of ρ a round; otherwise it swings apart. At a single
//! sliding node, one iteration a round, A is the number ∓ tan φ W_nt / W_nn (with the compliance W; ∓ the sign of T_max):
//! F_n goes with the tangential force so that the gap stays closed.
//!
//! **When it is certain.** A run goes through these modes as long as T_max satisfies the tests of every iteration of a round.
//! These are linear in x, so where they hold at some points they hold in all of their convex hull. They are tried at
//! x* ± r along each component; so they hold where the sum of all |x − x*| is at most r. Rounds are run one by one until
//! powers of A keep x in there for ever.

use crate::contact::state::ContactState;
use crate::interface::method::Method;
use crate::interface::problem::InterfaceProblem;
use crate::interface::trials::Trials;
use crate::linalg::DenseFactors;
use crate::model::{BoundUpdate, Mode};

/// Relative distance from the fixed point at which a round repeats the one before.
pub const REPEATS: f64 = 1e-12;
/// Ratios ρ that differ by less than this, relatively, are the same.
const SAME_RATIO: f64 = 1e-10;
/// Rounds of the same modes that make a sequence.
const ROUNDS: usize = 2;
/// Rounds that are run one by one, at most, until x stays where the modes are known to repeat.
const MOST_ROUNDS: usize = 400;
/// Halvings of r.
const HALVINGS: usize = 12;
/// Squarings by which the spectral radius is found.
const SQUARINGS: i32 = 24;

/// Where T_max goes.
#[derive(Debug, Clone, PartialEq)]
pub struct Spiral {
    /// Minor iterations that were run until the modes had repeated.
    pub start: u32,
    /// Minor iterations a round.
    pub period: u32,
    /// The modes of each node in each iteration of a round.
    pub modes: Vec<Vec<Mode>>,
    /// Places of the nodes whose T_max takes part: those that slide in a round.
    pub places: Vec<usize>,
    /// T_max of these nodes at the fixed point (force), at the beginning of a round.
    pub fixed: Vec<f64>,
    /// How far the farthest of them is from it (force), after `start` iterations.
    pub distance: f64,
    /// Spectral radius ρ of a round.
    pub radius: f64,
    /// What comes of it.
    pub fate: Fate,
}

/// What comes of a spiral.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fate {
    /// The modes change within a round, and will for ever: a cycle, certainly.
    Cycles,
    /// The modes have settled, and T_max will, too.
    Settles,
    /// T_max leaves the neighbourhood of the fixed point.
    SwingsApart,
    /// The modes will not go on like this.
    Passes,
}

impl Spiral {
    /// Minor iterations after which T_max repeats to [`REPEATS`], for forces of this size. `None` unless it spirals in.
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

/// What the minor iterations from a problem's states come to, as far as can be told from `most` of them. `None` where they
/// settle before, cannot be solved, or repeat no sequence of modes, and where T_max does not lag.
pub fn spiral(problem: &InterfaceProblem, method: &dyn Method, most: usize) -> Option<Spiral> {
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
                    Fate::Passes => {}
                    // It may yet come to a longer round.
                    Fate::SwingsApart => apart = apart.or(Some(found)),
                    Fate::Cycles | Fate::Settles => return Some(found),
                }
            }
        }
    }
    apart
}

/// The smallest numbers of iterations after which the modes at the end of a trail repeat, [`ROUNDS`] times: of all, and of
/// those in which a mode changes, since a long round may end with many iterations that are alike.
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

/// A round of the modes at the end of a trail.
fn of_round(
    trials: &mut Trials<'_>,
    method: &dyn Method,
    trail: &[Vec<ContactState>],
    period: usize,
) -> Option<Spiral> {
    let round = &trail[trail.len() - 1 - period..];
    let (first, last) = (&round[0], &round[period]);
    let slides = |s: &usize| round[..period].iter().any(|n| n[*s].mode == Mode::Sliding);
    let places: Vec<usize> = (0..first.len()).filter(slides).collect();
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
    let mut found = Spiral {
        start: trail.len() as u32 - 1,
        period: period as u32,
        modes: (0..first.len())
            .map(|s| round[..period].iter().map(|nodes| nodes[s].mode).collect())
            .collect(),
        distance: away.iter().fold(0.0, |m, x| x.abs().max(m)),
        radius: radius(&map, size),
        fate: Fate::SwingsApart,
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
            (false, _) => Fate::Passes,
            (true, true) => Fate::Cycles,
            (true, false) => Fate::Settles,
        };
    }
    Some(found)
}

/// How T_max of the nodes `places` after a round depends on that before: a matrix, column by column.
fn map(trials: &mut Trials<'_>, round: &[Vec<ContactState>], places: &[usize]) -> Option<Vec<f64>> {
    let size = places.len();
    let mut all = vec![0.0; size * size];
    for k in 0..size {
        all[k * size + k] = 1.0;
    }
    for nodes in round {
        let given = trials.given(nodes)?;
        let mut once = vec![0.0; size * size];
        for (j, &from) in places.iter().enumerate() {
            if nodes[from].mode != Mode::Sliding {
                continue;
            }
            let answers = trials.answers_to(from, 1)?;
            for (i, &to) in places.iter().enumerate() {
                let node = &trials.problem().nodes[to];
                let f_n = nodes[to].f_n + given[to].force[0];
                let sign = next_sign(&nodes[to], nodes[to].f_t + given[to].force[1]);
                once[j * size + i] =
                    sign * f_n.signum() * node.friction.coefficient() * answers[to].force[0];
            }
        }
        all = product(&once, &all, size);
    }
    Some(all)
}

/// The direction of T_max after an iteration that found F_t.
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

/// Largest sum of the sizes of a column.
fn norm(a: &[f64], size: usize) -> f64 {
    let columns = a.chunks_exact(size.max(1));
    columns.fold(0.0, |m, c| c.iter().map(|x| x.abs()).sum::<f64>().max(m))
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

/// Whether the modes of a round repeat for ever while T_max spirals in from `away` of the fixed point.
fn stays(
    trials: &mut Trials<'_>,
    method: &dyn Method,
    round: &[Vec<ContactState>],
    spiral: &Spiral,
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

/// The largest norm of all powers of A; `None` if they do not fall within reason.
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
