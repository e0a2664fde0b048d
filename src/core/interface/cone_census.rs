//! Consistent states of a small interface problem in space: every combination of modes is tried, with the directions of sliding found by
//! Newton's method; and a bound on friction below which there is only one state.
//!
//! With De Saxcé's ũ = u + μ|u_t| n the laws are K ∋ r ⊥ ũ ∈ K*. The difference of two solutions then has
//!
//! ```text
//! Δrᵀ W Δr <= Σ μ |Δr_n| |Δu_t| <= ‖M T W‖ ‖Δr‖²
//! ```
//!
//! with T the tangential rows and M their friction coefficients, so that a smallest eigenvalue of W above ‖M T W‖ excludes two.

use super::cone::{ConeContact, lawful};
use crate::plane::max_abs;
use crate::{Friction, Mode};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::FRAC_PI_2;

/// Maximum number of contacts.
const MOST: u32 = 6;
/// Steps of Newton's method, and the largest change of a direction in one (radians).
const STEPS: usize = 30;
const LONGEST: f64 = 0.5;
/// Motion across the direction of sliding, relative to the largest motion, at which the directions are found.
const FOUND: f64 = 1e-12;
/// Step of the differences (radians).
const STEP: f64 = 1e-7;
/// Relative difference of the forces below which two states are the same.
const SAME: f64 = 1e-6;

/// The states found, and the number of combinations tried.
#[derive(Debug, Clone, PartialEq)]
pub struct ConeCensus {
    /// States that obey all laws; there may be others.
    pub states: Vec<Vec<ConeContact>>,
    /// Number of combinations of modes.
    pub combinations: usize,
}

/// Tries all combinations of modes; `None` with more than 6 contacts, or if `stop` returns true.
pub fn census(
    w: &DMatrix<f64>,
    q: &DVector<f64>,
    friction: &[Friction],
    stop: &dyn Fn() -> bool,
) -> Option<ConeCensus> {
    let count = u32::try_from(friction.len())
        .ok()
        .filter(|count| *count <= MOST)?;
    let combinations = 3_usize.pow(count);
    let mut states: Vec<Vec<ConeContact>> = Vec::new();
    for number in 0..combinations {
        if stop() {
            return None;
        }
        let modes: Vec<Mode> = (0..count)
            .map(|place| match number / 3_usize.pow(place) % 3 {
                0 => Mode::Free,
                1 => Mode::Fixed,
                _ => Mode::Sliding,
            })
            .collect();
        let turns = if modes.contains(&Mode::Sliding) { 4 } else { 1 };
        for turn in 0..turns {
            let assigned = Assigned {
                w,
                q,
                friction,
                modes: &modes,
            };
            let Some(found) = assigned.state(f64::from(turn) * FRAC_PI_2) else {
                continue;
            };
            if !states.iter().any(|known| is_same(known, &found)) {
                states.push(found);
            }
        }
    }
    Some(ConeCensus {
        states,
        combinations,
    })
}

/// Whether a bound on friction proves that there is at most one state; without cohesion.
pub fn is_unique(w: &DMatrix<f64>, friction: &[Friction]) -> bool {
    if friction.iter().any(|friction| friction.cohesion > 0.0) {
        return false;
    }
    // Units in which every normal compliance is 1; a contact whose units change keeps its cone.
    let unit = |i: usize| w[(i - i % 3, i - i % 3)].max(0.0).sqrt();
    let scaled = DMatrix::from_fn(w.nrows(), w.ncols(), |i, j| w[(i, j)] / (unit(i) * unit(j)));
    if !scaled.iter().all(|x| x.is_finite()) {
        return false;
    }
    let symmetric = 0.5 * (&scaled + scaled.transpose());
    let least = symmetric.symmetric_eigenvalues().min();
    let coefficient = |i: usize| {
        if i.is_multiple_of(3) {
            0.0
        } else {
            friction[i / 3].coefficient()
        }
    };
    let tangential = DMatrix::from_fn(w.nrows(), w.ncols(), |i, j| coefficient(i) * scaled[(i, j)]);
    let norm = tangential.singular_values().max();
    // Round-off must not prove anything.
    least > norm + FOUND * symmetric.amax()
}

fn is_same(one: &[ConeContact], other: &[ConeContact]) -> bool {
    let forces =
        |state: &[ConeContact]| -> Vec<f64> { state.iter().flat_map(|c| c.force).collect() };
    let (one, other) = (forces(one), forces(other));
    let largest = max_abs(one.iter().chain(&other));
    one.iter()
        .zip(&other)
        .all(|(a, b)| (a - b).abs() <= SAME * largest)
}

/// A problem with a mode for every contact.
struct Assigned<'a> {
    w: &'a DMatrix<f64>,
    q: &'a DVector<f64>,
    friction: &'a [Friction],
    modes: &'a [Mode],
}

impl Assigned<'_> {
    /// The state with these modes; sliding starts in the direction against the motion without forces, turned by an angle.
    fn state(&self, turn: f64) -> Option<Vec<ConeContact>> {
        let sliding: Vec<usize> = (0..self.modes.len())
            .filter(|&k| self.modes[k] == Mode::Sliding)
            .collect();
        let mut angles = DVector::from_iterator(
            sliding.len(),
            sliding
                .iter()
                .map(|&k| (-self.q[3 * k + 2]).atan2(-self.q[3 * k + 1]) + turn),
        );
        let (mut f, mut across) = self.solve(&sliding, &angles)?;
        for _ in 0..STEPS {
            if across.amax() <= FOUND * self.q.amax() {
                break;
            }
            let mut slopes = DMatrix::zeros(sliding.len(), sliding.len());
            for k in 0..sliding.len() {
                let mut moved = angles.clone();
                moved[k] += STEP;
                let (_, other) = self.solve(&sliding, &moved)?;
                slopes.set_column(k, &((other - &across) / STEP));
            }
            let step = slopes.lu().solve(&across)?;
            angles -= &step * (LONGEST / step.amax().max(LONGEST));
            (f, across) = self.solve(&sliding, &angles)?;
        }
        let motion = self.w * &f + self.q;
        let sizes = [f.amax(), motion.amax().max(self.q.amax())];
        let of = |all: &DVector<f64>, k: usize| [all[3 * k], all[3 * k + 1], all[3 * k + 2]];
        self.friction
            .iter()
            .enumerate()
            .map(|(k, friction)| {
                let found = lawful(of(&f, k), of(&motion, k), friction, sizes)?;
                (found.mode == self.modes[k]).then_some(found)
            })
            .collect()
    }

    /// The forces for directions of the sliding contacts, and the motion of these across them.
    fn solve(
        &self,
        sliding: &[usize],
        angles: &DVector<f64>,
    ) -> Option<(DVector<f64>, DVector<f64>)> {
        let size = self.q.len();
        let mut matrix = DMatrix::identity(size, size);
        let mut right = DVector::zeros(size);
        for (k, mode) in self.modes.iter().enumerate() {
            let rows = match mode {
                Mode::Free => 0,
                Mode::Fixed => 3,
                Mode::Sliding => 1,
            };
            for row in 3 * k..3 * k + rows {
                matrix.set_row(row, &self.w.row(row));
                right[row] = -self.q[row];
            }
        }
        for (&k, angle) in sliding.iter().zip(angles) {
            let (mu, cohesion) = (self.friction[k].coefficient(), self.friction[k].cohesion);
            for (row, part) in [(3 * k + 1, angle.cos()), (3 * k + 2, angle.sin())] {
                matrix[(row, 3 * k)] = -mu * part;
                right[row] = cohesion * part;
            }
        }
        let f = matrix.lu().solve(&right)?;
        let u = self.w * &f + self.q;
        let across = sliding.iter().zip(angles);
        let across =
            across.map(|(&k, angle)| u[3 * k + 1] * angle.sin() - u[3 * k + 2] * angle.cos());
        let across = DVector::from_iterator(sliding.len(), across);
        (f.iter().chain(&across).all(|x| x.is_finite())).then_some((f, across))
    }
}

#[cfg(test)]
mod tests {
    use super::super::cone::solve;
    use super::*;

    fn friction(mu: f64, count: usize) -> Vec<Friction> {
        vec![Friction::from_coefficient(mu, 0.0); count]
    }

    fn all(w: &DMatrix<f64>, q: &[f64], mu: f64) -> Vec<Vec<ConeContact>> {
        let q = DVector::from_row_slice(q);
        let found = census(w, &q, &friction(mu, q.len() / 3), &|| false);
        found.expect("few contacts").states
    }

    #[test]
    fn strong_friction_on_a_coupled_contact_has_three_states() {
        // Motion along t lifts the contact: pressed and stuck, pressed and sliding, or open.
        let w = DMatrix::from_row_slice(3, 3, &[1.0, 0.9, 0.0, 0.9, 1.0, 0.0, 0.0, 0.0, 1.0]);
        let found = all(&w, &[0.1, 1.0, 0.0], 2.0);
        let modes: Vec<Mode> = found.iter().map(|state| state[0].mode).collect();
        assert_eq!(modes, [Mode::Free, Mode::Fixed, Mode::Sliding], "{found:?}");
        assert!(!is_unique(&w, &friction(2.0, 1)));
        let found = all(&w, &[-1.0, 1.0, 0.5], 0.05);
        assert!(
            found.len() == 1 && is_unique(&w, &friction(0.05, 1)),
            "{found:?}"
        );
    }

    #[test]
    fn the_state_of_the_sweeps_is_among_them_and_the_only_one_where_that_is_proven() {
        let mut proven = 0;
        for seed in 0..12 {
            let number = |i: usize, j: usize| ((7 * i + 13 * j + 5 * seed + i * j) as f64).sin();
            let factor = DMatrix::from_fn(9, 9, |i, j| 0.25 * number(i, j));
            let w = DMatrix::identity(9, 9) + &factor * factor.transpose();
            let q: Vec<f64> = (0..9)
                .map(|i| number(i, 20) - if i.is_multiple_of(3) { 0.5 } else { 0.0 })
                .collect();
            let mu = [0.1, 0.3, 0.6][seed % 3];
            let swept = solve(&w, &DVector::from_row_slice(&q), &friction(mu, 3));
            let swept = swept.expect("they converge");
            let found = all(&w, &q, mu);
            assert!(
                found.iter().any(|state| is_same(state, &swept)),
                "{seed}: {found:?}"
            );
            if is_unique(&w, &friction(mu, 3)) {
                proven += 1;
                assert_eq!(found.len(), 1, "{seed}");
            }
        }
        assert!(proven > 0);
    }
}
