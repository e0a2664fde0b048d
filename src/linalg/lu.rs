//! LU of sparse systems with scaling, iterative refinement and checks.
//!
//! The augmented system of eqn (9) combines stiffnesses of very different magnitude with constraint rows of size one, and is
//! unsymmetric if friction is in the matrix. Its rows and columns are therefore scaled by powers of two, which is exact. The
//! matrices of a major iteration differ only in their last rows, the interface equations, so one scale serves all of them except
//! for these rows. Systems with known groups of unknowns use the multifrontal factorization ([`super::fronts`]); others, and
//! those for which its solution has a large residual, use faer with partial pivoting. The symbolic part is reused as long as the
//! pattern is unchanged.
//!
//! Cheap checks come first: a solution is refined only if its residual is above round-off, and the norm of the inverse is
//! estimated by a solve only if a pivot is small. Both decisions depend only on the matrix and the right-hand side.

use super::check::{SolveError, UNDERFLOW, are_equal, fill_probe, largest};
use super::fronts::Fronts;
use super::pattern::{Pattern, symbolic_view};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::lu::{LuRef, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::{Conj, MatMut, Par};
use std::sync::Arc;

/// Number of equilibration sweeps; each replaces the ratio of the largest to the smallest row by about its square root.
const SWEEPS: usize = 3;

/// Backward error above which a solution is rejected.
const BACKWARD_LIMIT: f64 = 1e-9;
/// Backward error above which a solution is refined: a few units of round-off. In systems with more unknowns than `MANY`, sums are
/// longer, and it grows with their number.
const REFINED: f64 = 1e-15;
const MANY: f64 = 4000.0;
/// If the smallest pivot is above this, the matrix is regular, and the norm of its inverse is not estimated by a solve.
const REGULAR: f64 = 1e-6;
/// Values with a smaller exponent count as zero.
const NOTHING: i32 = -600;

/// Factors of a sparse matrix, with preallocated memory for repeated factorization.
pub struct Factors {
    pattern: Arc<Pattern>,
    fronts: Option<Fronts>,
    general: Option<General>,
    /// Which of the two contains the factors.
    used: LuKind,
    /// Backward error above which a solution is refined.
    refined: f64,
    row_scale: Vec<f64>,
    col_scale: Vec<f64>,
    /// Exponents of the values, of the scale, and of the largest value of each column.
    exponents: Vec<i32>,
    scale: Vec<i32>,
    largest: Vec<i32>,
    /// Whether `scaled` contains all of `values`.
    applied: bool,
    values: Vec<f64>,
    scaled: Vec<f64>,
    residual: Vec<f64>,
    sizes: Vec<f64>,
    correction: Vec<f64>,
    /// Rows from this one on are rescaled in each factorization; with the indices of their entries, and their rows and columns.
    first_own: usize,
    own: Vec<usize>,
    own_places: Vec<(usize, usize)>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum LuKind {
    Neither,
    Fronts,
    General,
}

/// faer's factors.
struct General {
    symbolic: SymbolicLu<u32>,
    numeric: NumericLu<u32, f64>,
    memory: MemBuffer,
}

impl Factors {
    /// Maximum number of right-hand sides per call of [`Factors::solve_block`].
    pub const BLOCK: usize = 32;

    /// Analyses a pattern.
    ///
    /// # Errors
    /// [`SolveError`] if the pattern is structurally singular or memory runs out.
    pub fn new(pattern: Arc<Pattern>) -> Result<Self, SolveError> {
        let general = General::new(&pattern)?;
        Ok(Factors::with(pattern, None, Some(general)))
    }

    /// Analyses a pattern of symmetric structure; `groups` is the group of each unknown, and rows from `first` on may differ
    /// between matrices that share a scale. It is cheapest if no saddle point spans several groups.
    ///
    /// # Errors
    /// As [`Factors::new`].
    pub fn in_groups(
        pattern: Arc<Pattern>,
        groups: &[usize],
        first: usize,
    ) -> Result<Self, SolveError> {
        let fronts = Fronts::new(&pattern, groups, first)?;
        Ok(Factors::with(pattern, Some(fronts), None))
    }

    fn with(pattern: Arc<Pattern>, fronts: Option<Fronts>, general: Option<General>) -> Self {
        let (n, entries) = (pattern.n, pattern.entries());
        Factors {
            pattern,
            fronts,
            general,
            used: LuKind::Neither,
            refined: REFINED * f64::max(n as f64 / MANY, 1.0),
            row_scale: vec![1.0; n],
            col_scale: vec![1.0; n],
            exponents: vec![0; entries],
            scale: vec![0; n],
            largest: vec![0; n],
            applied: false,
            values: vec![0.0; entries],
            scaled: vec![0.0; entries],
            residual: vec![0.0; n],
            sizes: vec![0.0; n],
            correction: vec![0.0; n],
            first_own: n,
            own: Vec::new(),
            own_places: Vec::new(),
        }
    }

    /// The pattern of the factors.
    pub fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// Computes the scale for all following matrices that differ from this one only in the rows from `first` on. Each row before
    /// `first` must have about the same magnitude as its column (the matrix is nearly symmetric there).
    ///
    /// `units` are the magnitudes of the unknowns (powers of two), from which the sweeps start. The start matters: in a saddle
    /// point with constraints of size one and a tiny stiffness, rows of equal size may still be nearly singular.
    pub fn scale(&mut self, values: &[f64], first: usize, units: &[f64]) {
        self.used = LuKind::Neither;
        self.applied = false;
        self.equilibrate(values, units);
        if self.first_own != first {
            self.first_own = first;
            let entries = self.pattern.iter().enumerate();
            let own = entries.filter(|(_, (row, _))| *row >= first);
            (self.own, self.own_places) = own.unzip();
        }
    }

    /// Copies values of the rows and columns from the `first` of [`Factors::scale`] on.
    pub fn copy_last(&self, from: &[f64], to: &mut [f64]) {
        self.own.iter().for_each(|&k| to[k] = from[k]);
        let columns = self.pattern.start(self.first_own)..;
        to[columns.clone()].copy_from_slice(&from[columns]);
    }

    /// Factors the matrix with these values (in pattern order), using the scale from [`Factors::scale`].
    ///
    /// # Errors
    /// [`SolveError::Singular`] if a pivot column is empty; near-singularity shows in [`Factors::solve`] and
    /// [`Factors::inverse_norm`].
    pub fn factor(&mut self, values: &[f64]) -> Result<(), SolveError> {
        self.used = LuKind::Neither;
        let only_own = self.take(values);
        if let Some(fronts) = &mut self.fronts
            && fronts
                .factor(&self.scaled, only_own.then_some(&self.own[..]))
                .is_ok()
        {
            self.used = LuKind::Fronts;
            return Ok(());
        }
        self.factor_generally()
    }

    fn factor_generally(&mut self) -> Result<(), SolveError> {
        self.used = LuKind::Neither;
        let general = match &mut self.general {
            Some(general) => general,
            none => none.insert(General::new(&self.pattern)?),
        };
        general.factor(&self.pattern, &self.scaled)?;
        self.used = LuKind::General;
        Ok(())
    }

    /// Solves A x = b with one step of iterative refinement, and checks the solution.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if x is not finite or its residual exceeds round-off.
    pub fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), SolveError> {
        let solved = self.solve_as_factored(b, x);
        if solved.is_err() && self.used == LuKind::Fronts {
            self.factor_generally()?;
            return self.solve_as_factored(b, x);
        }
        solved
    }

    fn solve_as_factored(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), SolveError> {
        if self.used == LuKind::Neither {
            return Err(SolveError::Singular);
        }
        x.copy_from_slice(b);
        self.apply_inverse(x);
        let mut error = self.backward_error(b, x);
        if error > self.refined || error.is_nan() {
            let mut correction = std::mem::take(&mut self.correction);
            for (c, (r, b)) in correction.iter_mut().zip(self.residual.iter().zip(b)) {
                *c = b - r;
            }
            self.apply_inverse(&mut correction);
            for (x, c) in x.iter_mut().zip(&correction) {
                *x += c;
            }
            self.correction = correction;
            error = self.backward_error(b, x);
        }
        if error <= BACKWARD_LIMIT && x.iter().all(|v| v.is_finite()) {
            Ok(())
        } else {
            Err(SolveError::Singular)
        }
    }

    /// Solves A X = B for at most [`Factors::BLOCK`] columns of B, which are consecutive in `x`; X replaces B. The solution is
    /// not refined, and only checked to be finite: intended for the many columns of a response, in addition to one checked solve.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if X is not finite.
    pub fn solve_block(&mut self, x: &mut [f64]) -> Result<(), SolveError> {
        if self.used == LuKind::Neither {
            return Err(SolveError::Singular);
        }
        self.apply_inverse(x);
        if x.iter().all(|x| x.is_finite()) {
            Ok(())
        } else {
            Err(SolveError::Singular)
        }
    }

    /// A lower bound of the norm of the inverse of the scaled matrix (whose entries are at most one): from one solve with a fixed
    /// vector of all frequencies, or from the pivots if none is small. Near 1e16 for a singular matrix, and infinite without
    /// factors.
    pub fn inverse_norm(&mut self) -> f64 {
        if self.used == LuKind::Neither {
            return f64::INFINITY;
        }
        if let (LuKind::Fronts, Some(fronts)) = (self.used, &self.fronts) {
            let smallest = fronts.smallest_pivot();
            if smallest > REGULAR {
                return 1.0 / smallest;
            }
        }
        let mut probe = std::mem::take(&mut self.correction);
        fill_probe(&mut probe);
        self.apply_scaled_inverse(&mut probe);
        let size = largest(&probe);
        self.correction = probe;
        size
    }

    /// Backward error of x as a solution of A x = b in the scaled system, where all entries are at most one; leaves A x in
    /// `residual`.
    fn backward_error(&mut self, b: &[f64], x: &[f64]) -> f64 {
        self.pattern.multiply(&self.values, x, &mut self.residual);
        let rows = b.iter().zip(&self.residual).zip(&self.row_scale);
        let error = largest(rows.map(|((b, product), scale)| (b - product) * scale));
        let loads = largest(b.iter().zip(&self.row_scale).map(|(b, scale)| b * scale));
        let motions = largest(x.iter().zip(&self.col_scale).map(|(x, scale)| x / scale));
        error / loads.max(motions).max(UNDERFLOW)
    }

    fn apply_inverse(&mut self, x: &mut [f64]) {
        let n = self.pattern.n.max(1);
        for column in x.chunks_exact_mut(n) {
            for (x, s) in column.iter_mut().zip(&self.row_scale) {
                *x *= s;
            }
        }
        self.apply_scaled_inverse(x);
        for column in x.chunks_exact_mut(n) {
            for (x, s) in column.iter_mut().zip(&self.col_scale) {
                *x *= s;
            }
        }
    }

    fn apply_scaled_inverse(&mut self, x: &mut [f64]) {
        let n = self.pattern.n;
        match (self.used, &mut self.fronts, &mut self.general) {
            (LuKind::Fronts, Some(fronts), _) => {
                x.chunks_exact_mut(n.max(1)).for_each(|x| fronts.solve(x));
            }
            (_, _, Some(general)) => general.solve(n, x),
            _ => {}
        }
    }

    /// Ruiz equilibration: in each sweep, row and column i are divided by about the square root of the largest entry. Powers of
    /// two are stored as exponents.
    fn equilibrate(&mut self, values: &[f64], units: &[f64]) {
        for (to, &value) in self.exponents.iter_mut().zip(values) {
            *to = (value.to_bits() >> 52 & 0x7ff) as i32 - 1023;
        }
        for (scale, &unit) in self.scale.iter_mut().zip(units) {
            *scale = exponent(unit).unwrap_or(0);
        }
        for _ in 0..SWEEPS {
            // The sizes of this sweep; the column scales change only after all sizes are known.
            for (col, size) in self.largest.iter_mut().enumerate() {
                let range = self.pattern.column(col);
                let entries = self.exponents[range.clone()].iter();
                let entries = entries.zip(&self.pattern.row_idx[range]);
                let largest = entries.map(|(exponent, &row)| exponent + self.scale[row as usize]);
                *size = largest.fold(i32::MIN, i32::max);
            }
            let mut settled = true;
            for (scale, &size) in self.scale.iter_mut().zip(&self.largest) {
                if size > NOTHING {
                    let too_large = (size + *scale).div_euclid(2);
                    *scale -= too_large;
                    settled &= too_large == 0;
                }
            }
            if settled {
                break;
            }
        }
        for (to, &scale) in self.col_scale.iter_mut().zip(&self.scale) {
            *to = power_of_two(scale);
        }
        self.row_scale.copy_from_slice(&self.col_scale);
    }

    /// Takes the values and scales them; returns whether only the own rows have changed.
    fn take(&mut self, values: &[f64]) -> bool {
        for &k in &self.own {
            self.values[k] = values[k];
        }
        if self.applied && are_equal(&self.values, values) {
            self.scale_own_rows();
            for (&k, &(row, col)) in self.own.iter().zip(&self.own_places) {
                self.scaled[k] = self.values[k] * self.col_scale[col] * self.row_scale[row];
            }
            return true;
        }
        self.values.copy_from_slice(values);
        self.scale_own_rows();
        self.apply_scale();
        self.applied = true;
        false
    }

    /// Divides each row from `first_own` on by about its largest entry.
    fn scale_own_rows(&mut self) {
        let sizes = &mut self.sizes[self.first_own..];
        sizes.fill(0.0);
        for (&k, &(row, col)) in self.own.iter().zip(&self.own_places) {
            let size = (self.values[k] * self.col_scale[col]).abs();
            let largest = &mut sizes[row - self.first_own];
            *largest = largest.max(size);
        }
        for (scale, &size) in self.row_scale[self.first_own..].iter_mut().zip(&*sizes) {
            *scale = inverse(size);
        }
    }

    fn apply_scale(&mut self) {
        for col in 0..self.pattern.n {
            let range = self.pattern.column(col);
            let rows = &self.pattern.row_idx[range.clone()];
            let own = self.col_scale[col];
            let values = self.scaled[range.clone()].iter_mut();
            for ((scaled, value), &row) in values.zip(&self.values[range]).zip(rows) {
                *scaled = value * own * self.row_scale[row as usize];
            }
        }
    }
}

impl General {
    fn new(pattern: &Pattern) -> Result<Self, SolveError> {
        let symbolic = factorize_symbolic_lu(symbolic_view(pattern), Default::default())
            .map_err(|_| SolveError::OutOfMemory)?;
        let request = symbolic
            .factorize_numeric_lu_scratch::<f64>(Par::Seq, Default::default())
            .or(symbolic.solve_in_place_scratch::<f64>(Factors::BLOCK, Par::Seq));
        Ok(General {
            memory: MemBuffer::try_new(request).map_err(|_| SolveError::OutOfMemory)?,
            numeric: NumericLu::new(),
            symbolic,
        })
    }

    fn factor(&mut self, pattern: &Pattern, values: &[f64]) -> Result<(), SolveError> {
        let matrix = SparseColMatRef::new(symbolic_view(pattern), values);
        self.symbolic
            .factorize_numeric_lu(
                &mut self.numeric,
                matrix,
                Par::Seq,
                MemStack::new(&mut self.memory),
                Default::default(),
            )
            .map_err(|_| SolveError::Singular)?;
        Ok(())
    }

    fn solve(&mut self, n: usize, x: &mut [f64]) {
        let columns = x.len().checked_div(n).unwrap_or(0);
        LuRef::new_unchecked(&self.symbolic, &self.numeric).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(x, n, columns),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }
}

/// The power of two that scales a size to between one and two.
fn inverse(size: f64) -> f64 {
    exponent(size).map_or(1.0, |exponent| power_of_two(-exponent))
}

/// Exponent of a size. `None` for zero and NaN.
fn exponent(size: f64) -> Option<i32> {
    let exponent = || (size.to_bits() >> 52) as i32 - 1023;
    (size > 0.0 && size.is_finite()).then(exponent)
}

fn power_of_two(exponent: i32) -> f64 {
    let biased = u64::try_from(exponent.clamp(-1000, 1000) + 1023).unwrap_or(1023);
    f64::from_bits(biased << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONES: [f64; 3] = [1.0; 3];

    fn dense(n: usize, a: &[f64]) -> (Arc<Pattern>, Vec<f64>) {
        let pattern = Pattern::new(n, (0..n * n).map(|k| (k / n, k % n))).unwrap();
        let values = pattern.iter().map(|(r, c)| a[r * n + c]).collect();
        (Arc::new(pattern), values)
    }

    #[test]
    fn a_badly_scaled_saddle_point_is_solved_to_round_off() {
        let (pattern, values) = dense(3, &[1.2e7, 3.0, 1.0, 3.0, 1e-3, 1.0, 1.0, 1.0, 0.0]);
        let mut factors = Factors::new(pattern.clone()).unwrap();
        factors.scale(&values, 2, &ONES[..pattern.size()]);
        solves(&mut factors, &values, [1.0, -2.0, 3e5], 1e-12);
    }

    #[test]
    fn a_solution_that_underflows_is_a_solution() {
        let (pattern, values) = dense(3, &[12.3, 3.7, 1.1, 3.7, 0.1, 1.3, 1.1, 1.3, 0.7]);
        let mut factors = Factors::new(pattern.clone()).unwrap();
        factors.scale(&values, 2, &ONES[..pattern.size()]);
        factors.factor(&values).unwrap();
        for size in (0..20).map(|k| 1e-300 / 10f64.powi(k)) {
            let b = [1.0, -2.3, 4.7].map(|b| size * b);
            assert!(factors.solve(&b, &mut [0.0; 3]).is_ok(), "{size:e}");
        }
    }

    /// Factors a matrix, which must give back `exact` within a relative tolerance.
    fn solves(factors: &mut Factors, values: &[f64], exact: [f64; 3], tolerance: f64) {
        factors.factor(values).unwrap();
        let (mut b, mut x) = ([0.0; 3], [0.0; 3]);
        factors.pattern.multiply(values, &exact, &mut b);
        factors.solve(&b, &mut x).unwrap();
        for (x, e) in x.iter().zip(exact) {
            assert!((x - e).abs() <= tolerance * e.abs(), "{x} {e}");
        }
        assert!(factors.inverse_norm() < 1e6);
    }

    #[test]
    fn one_scale_serves_matrices_that_differ_in_their_last_rows() {
        let (pattern, first) = dense(3, &[1.2e7, 3.0, 1.0, 3.0, 1e-3, 1.0, 1.0, 1.0, 0.0]);
        let (_, second) = dense(3, &[1.2e7, 3.0, 1.0, 3.0, 1e-3, 1.0, 0.0, 0.0, 4e9]);
        let mut factors = Factors::new(pattern.clone()).unwrap();
        factors.scale(&first, 2, &ONES[..3]);
        for values in [&first, &second, &first] {
            solves(&mut factors, values, [1.0, -2.0, 3.0], 1e-11);
        }
    }

    #[test]
    fn a_saddle_point_with_a_tiny_stiffness_is_not_singular() {
        let tiny = 1e-13;
        let a = [
            3.0 * tiny,
            tiny,
            1.0,
            tiny,
            3.0 * tiny,
            -1.0,
            1.0,
            -1.0,
            0.0,
        ];
        let (pattern, values) = dense(3, &a);
        let mut factors = Factors::new(pattern).unwrap();
        let root = power_of_two(-22);
        factors.scale(&values, 3, &[1.0 / root, 1.0 / root, root]);
        factors.factor(&values).unwrap();
        assert!(factors.inverse_norm() < 10.0);
        factors.scale(&values, 3, &ONES);
        factors.factor(&values).unwrap();
        assert!(
            factors.inverse_norm() > 1e9,
            "the units make the difference"
        );
    }

    #[test]
    fn a_singular_matrix_is_detected_by_the_norm_of_its_inverse_or_by_the_solve() {
        let (pattern, values) = dense(2, &[1.0, 2.0, 2.0, 4.0]);
        let mut factors = Factors::new(pattern.clone()).unwrap();
        factors.scale(&values, 2, &ONES[..pattern.size()]);
        if factors.factor(&values).is_ok() {
            let mut x = [0.0; 2];
            assert!(factors.inverse_norm() > 1e12 || factors.solve(&[1.0, 1.0], &mut x).is_err());
        }
    }
}
