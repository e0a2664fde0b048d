//! Checks whether the matrix of a frozen problem alone excludes a second state, for any number of nodes.
//!
//! For two states, let d be the difference of their forces and e that of their motions (of −gap along n, of the slip along t),
//! with e = −W d and the compliance W. At every node
//!
//! - d_n e_n ≥ 0, because F_n ≥ 0, gap ≥ 0 and F_n gap = 0 in both;
//! - F_t = h τ with h = tan φ F_n + c ≥ 0, |τ| ≤ 1, and τ is the sign of a nonzero slip. With the means h̄ and τ̄ over both
//!   states, d_t = h̄ (τ − τ′) + tan φ τ̄ d_n, and (τ − τ′) e_t ≥ 0; so (d_t − tan φ τ̄ d_n) e_t ≥ 0.
//!
//! With positive weights p and q for each node, the sum of both inequalities gives, for some τ̄ in −1 to 1,
//!
//! ```text
//! Σ p d_n (W d)_n + q (d_t − tan φ τ̄ d_n) (W d)_t ≤ 0
//! ```
//!
//! Take p = q = 1. The sum is at least d·W d − Σ tan φ |d_n| |(W d)_t|, and 2 |d_n| |(W d)_t| ≤ d_n² / α + α (W d)_t² for any α >
//! 0 per node. So if
//!
//! ```text
//! M = W − ½ Σ tan φ (n nᵀ / α + α (W t) (W t)ᵀ)
//! ```
//!
//! is positive definite for some α, then d = 0: there is at most one state. (n, t: the unit vectors of a node's components.) With
//! α = 1 / √(λ_max λ_min) for all nodes, M ≥ (1 − tan φ √cond W) W, so the criterion holds at least if tan φ √cond W < 1; tan φ
//! may differ between nodes.
//!
//! Special cases:
//!
//! - A node with **cohesion** loses it when it opens, so F_t = h τ is wrong there and the criterion does not apply.
//! - **Prescribed motions and previous slip** are the same in both states and cancel in e.
//! - **T_max**: in a converged minor iteration, T_max belongs to its F_n, lagged or consistent, so its states are covered.
//! - Without a surface, all forces are zero in both states, and without friction F_t is: these components are left out of W.
//! - **Supports carry** the force of a component without an unknown: e and its row of W are zero. It is left out; all other
//!   forces and all motions are the same in both states.
//!
//! The bound is only sufficient: it ignores loads and gaps. It is known that uniqueness for all loads requires a friction
//! coefficient that is small relative to the mesh size (Haslinger, Math. Methods Appl. Sci. 5, 1983; Hassani, Ionescu & Oudet,
//! Int. J. Solids Struct. 44, 2007).

use crate::InterfaceProblem;
use crate::interface::definite;
use crate::linalg::DenseFactors;
use crate::plane::max_abs;

/// Number of tried scales of α, each twice the previous one, around 1.
const SCALES: i32 = 8;
/// Number of rounds that improve α of single nodes.
const ROUNDS: usize = 12;
/// An eigenvalue counts as positive above this fraction of the largest entry, times the matrix size.
const ROUND_OFF: f64 = 1e-12;
/// Condition of the response above which its inverse is not trusted.
const SINGULAR: f64 = 1e10;

/// Conclusion about the number of states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Uniqueness {
    /// At most one state. This holds even with all friction coefficients multiplied by `spare`.
    Unique {
        /// At least 1.
        spare: f64,
        /// Whether supports carry a force at some node: the states are unique except for that force.
        carried: bool,
    },
    /// Not proven; it would be with all friction coefficients multiplied by `spare`.
    Unproven {
        /// Less than 1.
        spare: f64,
    },
    /// The criterion does not apply.
    Not(Inapplicable),
}

/// Why the criterion does not apply.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Inapplicable {
    /// A node (given by index) has cohesion.
    Cohesion(usize),
    /// Bodies are loose, or some forces cause no motion: there is no definite compliance.
    Singular,
    /// The compliance is semidefinite: this number of its eigenvalues is round-off, and forces need not be unique.
    Semidefinite(usize),
    /// The compliance is not positive definite.
    Indefinite,
}

/// Applies the criterion to a problem. It takes a few dense factorizations of the interface's size.
pub fn uniqueness(problem: &InterfaceProblem) -> Uniqueness {
    let compliance = match CompliancePart::from_problem(problem) {
        Ok(compliance) => compliance,
        Err(why @ Inapplicable::Cohesion(_)) => return Uniqueness::Not(why),
        Err(why) => return Uniqueness::Not(semidefinite(problem).unwrap_or(why)),
    };
    let spare = compliance.spare();
    if spare >= 1.0 {
        Uniqueness::Unique {
            spare,
            carried: compliance.carried,
        }
    } else {
        Uniqueness::Unproven { spare }
    }
}

/// Whether the compliance is semidefinite.
fn semidefinite(problem: &InterfaceProblem) -> Option<Inapplicable> {
    let compliance = definite::Compliance::from_problem(problem)?;
    let round_off = compliance.round_off();
    let zero = compliance.within(round_off);
    (zero > 0 && compliance.ends()[0] >= -round_off).then_some(Inapplicable::Semidefinite(zero))
}

/// tan φ √cond W with the largest tan φ: below 1, states are unique. `None` if there is no definite compliance.
pub fn plain(problem: &InterfaceProblem) -> Option<f64> {
    let compliance = CompliancePart::from_problem(problem).ok()?;
    let (size, w) = (compliance.size, &compliance.matrix);
    let largest = power(size, |x| times(w, size, x));
    let mut factors = DenseFactors::new(size, 1).ok()?;
    factors.factor(w);
    let inverse = power(size, |x| {
        let mut y = x.to_vec();
        // The factorization succeeded, so the matrix is definite.
        let _ = factors.solve(&mut y);
        y
    });
    let steepest = compliance.pairs.iter().fold(0.0_f64, |m, p| m.max(p.2));
    Some(steepest * (largest * inverse).sqrt())
}

/// W of the components that can vary, scaled to a mean diagonal of one.
struct CompliancePart {
    size: usize,
    /// Its symmetric part, column-major.
    matrix: Vec<f64>,
    /// W, row by row; unsymmetric if the tangent is.
    rows: Vec<f64>,
    /// Round-off of W, relative to its largest entry.
    round_off: f64,
    /// Rows of n and t of each node with friction, and its tan φ.
    pairs: Vec<(usize, usize, f64)>,
    carried: bool,
}

impl CompliancePart {
    fn from_problem(problem: &InterfaceProblem) -> Result<CompliancePart, Inapplicable> {
        let count = problem.relation.count();
        let mut kept = Vec::new();
        let mut pairs = Vec::new();
        let mut carried = false;
        for (place, node) in problem.nodes.iter().enumerate() {
            if node.kinematics.is_none() {
                continue;
            }
            if node.friction.cohesion != 0.0 {
                return Err(Inapplicable::Cohesion(place));
            }
            let smooth = node.friction.is_smooth();
            let [n, t] = node.moves();
            carried |= !n || !(t || smooth);
            if !n {
                continue;
            }
            kept.push(2 * place);
            if !smooth && t {
                pairs.push((kept.len() - 1, kept.len(), node.friction.coefficient()));
                kept.push(2 * place + 1);
            }
        }
        // Motions change by W ΔF: e = −W d.
        let bodies = problem.relation.compliance();
        let bodies = bodies.filter(|bodies| bodies.inverse_norm <= SINGULAR);
        let bodies = bodies.ok_or(Inapplicable::Singular)?;
        let size = kept.len();
        let mut rows: Vec<f64> = kept
            .iter()
            .flat_map(|&i| kept.iter().map(move |&j| (i, j)))
            .map(|(i, j)| bodies.w[j * count + i])
            .collect();
        let mean = (0..size).map(|k| rows[k * size + k]).sum::<f64>() / size.max(1) as f64;
        if mean <= 0.0 && size > 0 {
            return Err(Inapplicable::Indefinite);
        }
        rows.iter_mut().for_each(|x| *x /= mean);
        let both = |k: usize| (rows[k] + rows[k % size * size + k / size]) / 2.0;
        let compliance = CompliancePart {
            size,
            matrix: (0..size * size).map(both).collect(),
            rows,
            round_off: ROUND_OFF.max(1e-15 * bodies.inverse_norm),
            pairs,
            carried,
        };
        if compliance.is_definite(&compliance.matrix) {
            Ok(compliance)
        } else {
            Err(Inapplicable::Indefinite)
        }
    }

    /// The largest factor for all friction coefficients with which the criterion holds; infinite without friction. It is found by
    /// bisection and proven at its value.
    fn spare(&self) -> f64 {
        if self.pairs.is_empty() {
            return f64::INFINITY;
        }
        let alphas = self.alphas();
        let holds = |spare: f64| self.is_definite(&self.reduced(&alphas, spare));
        let (mut low, mut high) = (0.0, 1.0);
        while holds(high) {
            (low, high) = (high, 2.0 * high);
            if high > 1e6 {
                return low;
            }
        }
        for _ in 0..20 {
            let middle = (low + high) / 2.0;
            if holds(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }

    /// α of each node with friction: the best common scale, then improved node by node where the two terms of the vector that
    /// fails first differ.
    fn alphas(&self) -> Vec<f64> {
        let Ok(mut factors) = DenseFactors::new(self.size, 1) else {
            return vec![1.0; self.pairs.len()];
        };
        factors.factor(&self.matrix);
        let mut worst = |alphas: &[f64]| self.first_to_fail(alphas, &mut factors);
        let (mut least, mut alphas) = (f64::INFINITY, vec![1.0; self.pairs.len()]);
        for k in -SCALES..=SCALES {
            let tried = vec![2f64.powi(k); self.pairs.len()];
            let now = worst(&tried).0;
            if now < least {
                (least, alphas) = (now, tried);
            }
        }
        for _ in 0..ROUNDS {
            let (_, x) = worst(&alphas);
            let wx = times(&self.matrix, self.size, &x);
            let turned: Vec<f64> = self
                .pairs
                .iter()
                .zip(&alphas)
                .map(|(&(n, t, _), alpha)| {
                    let (a, b) = (x[n].abs() / alpha.sqrt(), wx[t].abs() * alpha.sqrt());
                    let lean = ((a + 1e-3) / (b + 1e-3)).clamp(0.5, 2.0);
                    alpha * lean.powf(0.5)
                })
                .collect();
            let now = worst(&turned).0;
            if now >= least {
                break;
            }
            (least, alphas) = (now, turned);
        }
        alphas
    }

    /// The largest value of ½ Σ tan φ (x_n² / α + α (W x)_t²) over x·W x, by power iteration, and its x (x·W x = 1).
    fn first_to_fail(&self, alphas: &[f64], factors: &mut DenseFactors) -> (f64, Vec<f64>) {
        let size = self.size;
        let mut x = power_start(size);
        let mut value = 0.0;
        for _ in 0..60 {
            let (wx, norm) = self.norm(&x);
            // W⁻¹ N x, with N = ½ Σ tan φ (n nᵀ / α + α W t tᵀ W): the first part is solved for, the second is t.
            let (mut first, mut second) = (vec![0.0; size], vec![0.0; size]);
            for (&(n, t, tangent), alpha) in self.pairs.iter().zip(alphas) {
                first[n] = tangent / 2.0 * x[n] / alpha / norm;
                second[t] = tangent / 2.0 * alpha * wx[t] / norm;
            }
            let _ = factors.solve(&mut first);
            value = first
                .iter()
                .zip(&second)
                .zip(&wx)
                .map(|((a, b), w)| (a + b) * w / norm)
                .sum();
            x = first.iter().zip(&second).map(|(a, b)| a + b).collect();
        }
        let (_, norm) = self.norm(&x);
        x.iter_mut().for_each(|x| *x /= norm);
        (value, x)
    }

    /// W x and √(x·W x).
    fn norm(&self, x: &[f64]) -> (Vec<f64>, f64) {
        let wx = times(&self.matrix, self.size, x);
        let norm = x.iter().zip(&wx).map(|(a, b)| a * b).sum::<f64>().sqrt();
        (wx, norm)
    }

    /// M for these α, with all coefficients multiplied by `spare`.
    fn reduced(&self, alphas: &[f64], spare: f64) -> Vec<f64> {
        let size = self.size;
        let mut m = self.matrix.clone();
        for (&(n, t, tangent), alpha) in self.pairs.iter().zip(alphas) {
            let half = spare * tangent / 2.0;
            m[n * size + n] -= half / alpha;
            let across = &self.rows[t * size..(t + 1) * size];
            for (j, column) in m.chunks_exact_mut(size).enumerate() {
                let factor = half * alpha * across[j];
                column
                    .iter_mut()
                    .zip(across)
                    .for_each(|(x, a)| *x -= factor * a);
            }
        }
        m
    }
}

impl CompliancePart {
    /// Whether a symmetric matrix is positive definite by more than round-off, which is subtracted before a Cholesky
    /// factorization.
    fn is_definite(&self, matrix: &[f64]) -> bool {
        let size = self.size;
        let mut a = matrix.to_vec();
        let largest = max_abs(&a);
        let least = self.round_off * size as f64 * largest;
        for k in 0..size {
            a[k * size + k] -= least;
        }
        for k in 0..size {
            let (before, rest) = a.split_at_mut((k + 1) * size);
            let column = &before[k * size..];
            let pivot = column[k];
            if pivot.is_nan() || pivot <= 0.0 {
                return false;
            }
            for (j, other) in (k + 1..size).zip(rest.chunks_exact_mut(size)) {
                let factor = column[j] / pivot;
                other[j..]
                    .iter_mut()
                    .zip(&column[j..])
                    .for_each(|(x, c)| *x -= factor * c);
            }
        }
        true
    }
}

fn times(matrix: &[f64], size: usize, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; size];
    for (column, x) in matrix.chunks_exact(size.max(1)).zip(x) {
        y.iter_mut().zip(column).for_each(|(y, a)| *y += a * x);
    }
    y
}

/// Start of a power iteration.
fn power_start(size: usize) -> Vec<f64> {
    (0..size)
        .map(|k| 1.0 + (0.618 * k as f64).fract())
        .collect()
}

/// The largest eigenvalue of a definite operator.
fn power(size: usize, mut apply: impl FnMut(&[f64]) -> Vec<f64>) -> f64 {
    let mut x = power_start(size);
    let mut value = 0.0;
    for _ in 0..200 {
        let norm = x.iter().map(|x| x * x).sum::<f64>().sqrt();
        x.iter_mut().for_each(|x| *x /= norm);
        let y = apply(&x);
        value = x.iter().zip(&y).map(|(a, b)| a * b).sum();
        x = y;
    }
    value
}
