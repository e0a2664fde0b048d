//! Stability of an equilibrium state: the signs of the tangent on admissible motions.
//!
//! Admissible motions maintain contact: fixed nodes have no relative motion, sliding nodes no normal one; loads and prescribed
//! motions are constant. With K the tangent of the bodies, T the contribution of rotating and moving contact forces
//! ([`crate::contact::geometric_tangent`]), and G the rows that vanish on admissible motions, A = K + T and
//!
//! ```text
//! smooth or stuck:  ΔF = −Gᵀ λ,    u = N y with G N = 0,      R = Nᵀ A N     (symmetric)
//! sliding, rough:   ΔF = −Cᵀ λ,    C = g_n ± tan φ g_t,       R = Wᵀ A N     (not symmetric)
//! ```
//!
//! where W = N + Gᵀ Z, C W = 0, is a test motion whose part along the constraints is chosen so that λ cancels. C contains the
//! change of friction with F_n.
//!
//! If a bond has a compliance c, its spring 1 / c is added to A instead of the condition.
//!
//! - R symmetric: stable if no eigenvalue is negative (Lagrange and Dirichlet); otherwise the number of negative eigenvalues is
//!   the number of unstable directions.
//! - R unsymmetric: if det R < 0, an odd number of motions grows, which is called **divergence** (Ziegler, *Principles of
//!   Structural Stability*). If det R > 0, the state is stable if the symmetric part of R, of all unknowns, is positive definite,
//!   because no admissible motion then gains energy. Otherwise stability is unknown.
//!
//! The current modes are assumed to persist: whether a sliding node sticks when it moves back is not considered.
//!
//! The interior unknowns (i) are eliminated by a sparse LDLᵀ, whose pivots count the negative eigenvalues; the rest (c), the
//! equations that touching nodes involve, is small and dense. With S = K_cc − K_ci K_ii⁻¹ K_ic, the negative eigenvalues of K_ii
//! and of R formed with S + T add up (Haynsworth's inertia formula). For the symmetric part, K_ic couples i and the mean M = (N +
//! W) / 2: it is definite if K_ii and sym(Wᵀ (K_cc + T) N) − Mᵀ (K_cc − S) M are. Bodies with length equations, which have no
//! diagonal, are entirely in the dense part, and each such equation accounts for one negative eigenvalue.

use nalgebra::{Cholesky, DMatrix};
use serde::{Deserialize, Serialize};

/// A pivot, or an eigenvalue of a matrix with unit diagonal, up to this size may be round-off.
pub(super) const ZERO: f64 = 1e-12;
/// A row whose largest coefficient is at most this depends on earlier rows; independent rows are of order one.
const DEPENDENT: f64 = 1e-9;

/// Stability of an equilibrium state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Stability {
    /// Stable.
    Stable,
    /// The tangent is symmetric and has this number of negative eigenvalues on admissible motions, at least one.
    Unstable {
        /// Number of negative eigenvalues.
        modes: usize,
    },
    /// With sliding friction: the determinant of the tangent on admissible motions is negative.
    Divergence,
    /// Neither stability nor instability is proven.
    NotKnown,
}

impl Stability {
    /// Whether an unstable direction was found.
    pub fn is_unstable(self) -> bool {
        matches!(self, Stability::Unstable { .. } | Stability::Divergence)
    }
}

impl std::fmt::Display for Stability {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Stability::Stable => f.write_str("stable"),
            Stability::Unstable { modes } => write!(f, "unstable({modes})"),
            Stability::Divergence => f.write_str("divergence"),
            Stability::NotKnown => f.write_str("not known"),
        }
    }
}

/// The tangent condensed to the equations c that touching nodes involve.
pub(super) struct Dense {
    /// S + T.
    pub condensed: DMatrix<f64>,
    /// K_cc − S.
    pub given_way: DMatrix<f64>,
    /// Negative eigenvalues of K_ii.
    pub negative: usize,
    /// Number of length equations in c, each of which accounts for one negative eigenvalue.
    pub lengths: usize,
}

/// Linear conditions on the motions in c.
#[derive(Default)]
pub(super) struct Conditions {
    /// G: rows that vanish on admissible motions.
    pub motion: Vec<Vec<f64>>,
    /// C: directions of the constraint forces.
    pub force: Vec<Vec<f64>>,
    /// Whether friction makes C different from G.
    pub slides: bool,
    /// Motions that bonds resist elastically, each with its stiffness (force per length).
    pub springs: Vec<(Vec<f64>, f64)>,
}

impl Conditions {
    /// Scales the unknowns: each unknown becomes the motion times its lever.
    pub fn divide_by(&mut self, levers: &[f64]) {
        let springs = self.springs.iter_mut().map(|(row, _)| row);
        for row in self.motion.iter_mut().chain(&mut self.force).chain(springs) {
            row.iter_mut()
                .zip(levers)
                .for_each(|(x, lever)| *x /= lever);
        }
    }

    /// Adds the springs to S + T.
    pub fn stiffen(&self, condensed: &mut DMatrix<f64>) {
        for (row, stiffness) in &self.springs {
            for (i, a) in row.iter().enumerate().filter(|(_, a)| **a != 0.0) {
                for (j, b) in row.iter().enumerate() {
                    condensed[(i, j)] += stiffness * a * b;
                }
            }
        }
    }

    /// Removes dependent conditions, which supports or other nodes already satisfy.
    pub fn keep_independent(&mut self) {
        let reduced = Reduced::from_rows(&self.motion);
        let mut kept = reduced.kept.iter();
        self.motion.retain(|_| *kept.next().unwrap_or(&true));
        let mut kept = reduced.kept.iter();
        self.force.retain(|_| *kept.next().unwrap_or(&true));
    }

    /// N: a basis of the admissible motions of c unknowns, as columns.
    pub fn admissible(&self, c: usize) -> DMatrix<f64> {
        let reduced = Reduced::from_rows(&self.motion);
        let free: Vec<usize> = (0..c).filter(|k| !reduced.pivots.contains(k)).collect();
        let mut basis = DMatrix::zeros(c, free.len());
        for (column, &k) in free.iter().enumerate() {
            basis[(k, column)] = 1.0;
            for (row, &pivot) in reduced.rows.iter().zip(&reduced.pivots) {
                basis[(pivot, column)] = -row[k];
            }
        }
        basis
    }
}

/// Rows in reduced echelon form: the largest entry of each is one, and zero in all other rows.
struct Reduced {
    rows: Vec<Vec<f64>>,
    pivots: Vec<usize>,
    /// Whether each given row was independent of the earlier ones.
    kept: Vec<bool>,
}

impl Reduced {
    fn from_rows(rows: &[Vec<f64>]) -> Self {
        let mut reduced = Reduced {
            rows: Vec::new(),
            pivots: Vec::new(),
            kept: Vec::new(),
        };
        for row in rows {
            let kept = reduced.add(row.clone());
            reduced.kept.push(kept);
        }
        reduced
    }

    fn add(&mut self, mut row: Vec<f64>) -> bool {
        for (other, &pivot) in self.rows.iter().zip(&self.pivots) {
            let factor = row[pivot];
            subtract(&mut row, other, factor);
        }
        let largest = row.iter().enumerate();
        let largest = largest.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let Some((pivot, &value)) = largest.filter(|(_, value)| value.abs() > DEPENDENT) else {
            return false;
        };
        row.iter_mut().for_each(|x| *x /= value);
        for other in &mut self.rows {
            let factor = other[pivot];
            subtract(other, &row, factor);
        }
        self.rows.push(row);
        self.pivots.push(pivot);
        true
    }
}

fn subtract(row: &mut [f64], other: &[f64], factor: f64) {
    if factor != 0.0 {
        let both = row.iter_mut().zip(other);
        both.for_each(|(x, other)| *x -= factor * other);
    }
}

/// Without sliding friction: from the inertia.
pub(super) fn smooth(dense: &Dense, basis: &DMatrix<f64>) -> Option<Stability> {
    let reduced = basis.transpose() * &dense.condensed * basis;
    let negative = dense.negative + negative_eigenvalues(&reduced)?;
    Some(match negative.checked_sub(dense.lengths)? {
        0 => Stability::Stable,
        modes => Stability::Unstable { modes },
    })
}

/// With sliding friction: from the sign of the determinant and the symmetric part.
pub(super) fn sliding(
    dense: &Dense,
    conditions: &Conditions,
    basis: &DMatrix<f64>,
) -> Option<Stability> {
    let (m, c) = (conditions.motion.len(), basis.nrows());
    let motion = DMatrix::from_fn(m, c, |i, j| conditions.motion[i][j]);
    let force = DMatrix::from_fn(m, c, |i, j| conditions.force[i][j]);
    let across = &force * motion.transpose();
    let orientation = sign_of_determinant(&across)?;
    let share = across.lu().solve(&(&force * basis))?;
    let test = basis - motion.transpose() * share;
    let reduced = test.transpose() * &dense.condensed * basis;
    let odd = |count: usize| if count.is_multiple_of(2) { 1.0 } else { -1.0 };
    let sign =
        sign_of_determinant(&reduced)? * orientation * odd(dense.negative) * odd(dense.lengths);
    if sign < 0.0 {
        return Some(Stability::Divergence);
    }
    if dense.negative > 0 || dense.lengths > 0 {
        return None;
    }
    let whole = &dense.condensed + &dense.given_way;
    let work = test.transpose() * whole * basis;
    let mean = (basis + &test) / 2.0;
    let part = (&work + work.transpose()) / 2.0 - mean.transpose() * &dense.given_way * &mean;
    let definite = negative_eigenvalues(&part)? == 0;
    definite.then_some(Stability::Stable)
}

/// Factors that scale a matrix to a diagonal of size one; for a zero diagonal, to a largest entry of size one.
fn scales(matrix: &DMatrix<f64>) -> Vec<f64> {
    let n = matrix.nrows();
    let largest = matrix.amax();
    let given = |k: usize| matrix[(k, k)].abs() > ZERO * largest;
    let mut scales: Vec<f64> = (0..n)
        .map(|k| match given(k) {
            true => 1.0 / matrix[(k, k)].abs().sqrt(),
            false => 0.0,
        })
        .collect();
    for k in (0..n).filter(|&k| !given(k)) {
        let reach = (0..n).map(|j| matrix[(j, k)].abs() * scales[j]);
        let reach = reach.fold(0.0, f64::max);
        scales[k] = if reach > 0.0 { 1.0 / reach } else { 1.0 };
    }
    scales
}

fn scaled(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let scales = scales(matrix);
    let n = matrix.nrows();
    DMatrix::from_fn(n, n, |i, j| scales[i] * matrix[(i, j)] * scales[j])
}

/// Number of negative eigenvalues of the symmetric part. `None` if one is within round-off.
fn negative_eigenvalues(matrix: &DMatrix<f64>) -> Option<usize> {
    let matrix = scaled(matrix);
    if matrix.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let symmetric = (&matrix + matrix.transpose()) / 2.0;
    let n = symmetric.nrows();
    let nothing = ZERO * n as f64;
    let raised = &symmetric - DMatrix::from_diagonal_element(n, n, nothing);
    if Cholesky::new(raised).is_some() {
        return Some(0);
    }
    let values = symmetric.symmetric_eigenvalues();
    let certain = values.iter().all(|value| value.abs() > nothing);
    certain.then(|| values.iter().filter(|value| **value < 0.0).count())
}

/// 1 or −1. `None` if the matrix may be singular.
fn sign_of_determinant(matrix: &DMatrix<f64>) -> Option<f64> {
    let n = matrix.nrows();
    let lu = scaled(matrix).full_piv_lu();
    let pivots = lu.u().diagonal();
    let nothing = ZERO * n as f64 * pivots.amax();
    if pivots.iter().any(|x| !x.is_finite() || x.abs() <= nothing) {
        return None;
    }
    let exchanged = lu.p().determinant::<f64>() * lu.q().determinant::<f64>();
    Some(pivots.iter().fold(exchanged, |sign, x| sign * x.signum()))
}
