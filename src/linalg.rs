//! Sparse linear systems: patterns, factors, checked solves. The only file that names faer.
//!
//! The augmented system of eqn (9) mixes stiffnesses of very different size with constraint rows of size one and,
//! where friction stands in the matrix, is unsymmetric. So it is scaled row by row and column by column and
//! factored by sparse LU with partial pivoting; the symbolic part is kept as long as the pattern stands. faer
//! reports a singular matrix as success and returns infinities, so every solve is checked here.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::lu::partial_pivoting::solve::{solve_in_place, solve_in_place_scratch};
use faer::perm::PermRef;
use faer::sparse::linalg::lu::{LuRef, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, MatRef, Par};
use std::sync::Arc;

/// Where a square sparse matrix has entries: compressed columns, rows ascending in each.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    n: usize,
    col_ptr: Vec<usize>,
    row_idx: Vec<usize>,
}

impl Pattern {
    /// The pattern of an n by n matrix with these `(row, column)` entries, in any order, repeated or not.
    pub fn new(n: usize, mut entries: Vec<(usize, usize)>) -> Self {
        entries.sort_unstable_by_key(|&(row, col)| (col, row));
        entries.dedup();
        let mut col_ptr = vec![0; n + 1];
        for &(_, col) in &entries {
            col_ptr[col + 1] += 1;
        }
        for col in 0..n {
            col_ptr[col + 1] += col_ptr[col];
        }
        Pattern {
            n,
            col_ptr,
            row_idx: entries.into_iter().map(|(row, _)| row).collect(),
        }
    }

    /// Number of rows and of columns.
    pub fn size(&self) -> usize {
        self.n
    }

    /// Number of stored entries.
    pub fn entries(&self) -> usize {
        self.row_idx.len()
    }

    /// Index of an entry in the array of values, if the pattern has it.
    pub fn slot(&self, row: usize, col: usize) -> Option<usize> {
        let start = self.col_ptr[col];
        self.row_idx[start..self.col_ptr[col + 1]]
            .binary_search(&row)
            .ok()
            .map(|k| start + k)
    }

    /// All entries as `(row, column)`, in the order of the values.
    pub fn iter(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        (0..self.n).flat_map(move |col| {
            self.row_idx[self.col_ptr[col]..self.col_ptr[col + 1]]
                .iter()
                .map(move |&row| (row, col))
        })
    }

    /// y = A x.
    pub fn multiply(&self, values: &[f64], x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for (col, &xc) in x.iter().enumerate() {
            for k in self.col_ptr[col]..self.col_ptr[col + 1] {
                y[self.row_idx[k]] += values[k] * xc;
            }
        }
    }

    /// y = |A| |x|: the size of the terms that [`Pattern::multiply`] adds up, the scale of its round-off.
    pub fn multiply_abs(&self, values: &[f64], x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for (col, &xc) in x.iter().enumerate() {
            for k in self.col_ptr[col]..self.col_ptr[col + 1] {
                y[self.row_idx[k]] += (values[k] * xc).abs();
            }
        }
    }
}

/// Why a system could not be solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SolveError {
    /// A pivot vanished, or the solution is not finite or does not satisfy the equations.
    Singular,
    /// No memory for the factors.
    OutOfMemory,
}

/// Number of equilibration sweeps; each takes the square root out of the spread of the rows' and columns' sizes.
const SWEEPS: usize = 4;

/// Backward error above which a solution is not believed.
const BACKWARD_LIMIT: f64 = 1e-9;

/// Factors of a sparse matrix, with all that is needed to make them again without allocating.
pub struct Factors {
    pattern: Arc<Pattern>,
    symbolic: SymbolicLu<usize>,
    numeric: NumericLu<usize, f64>,
    memory: MemBuffer,
    row_scale: Vec<f64>,
    col_scale: Vec<f64>,
    values: Vec<f64>,
    scaled: Vec<f64>,
    residual: Vec<f64>,
    sizes: Vec<f64>,
    correction: Vec<f64>,
    ready: bool,
}

impl Factors {
    /// Analyses a pattern.
    ///
    /// # Errors
    /// [`SolveError`] if the pattern is structurally singular or memory runs out.
    pub fn new(pattern: Arc<Pattern>) -> Result<Self, SolveError> {
        let n = pattern.n;
        let symbolic = factorize_symbolic_lu(symbolic_view(&pattern), Default::default())
            .map_err(|_| SolveError::OutOfMemory)?;
        let request = symbolic
            .factorize_numeric_lu_scratch::<f64>(Par::Seq, Default::default())
            .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let memory = MemBuffer::try_new(request).map_err(|_| SolveError::OutOfMemory)?;
        let entries = pattern.entries();
        Ok(Factors {
            pattern,
            symbolic,
            numeric: NumericLu::new(),
            memory,
            row_scale: vec![1.0; n],
            col_scale: vec![1.0; n],
            values: vec![0.0; entries],
            scaled: vec![0.0; entries],
            residual: vec![0.0; n],
            sizes: vec![0.0; n],
            correction: vec![0.0; n],
            ready: false,
        })
    }

    /// The pattern that the factors belong to.
    pub fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// Factors the matrix with these values (in the order of the pattern).
    ///
    /// # Errors
    /// [`SolveError::Singular`] where a pivot column is empty; near-singularity shows in [`Factors::solve`] and
    /// [`Factors::inverse_norm`].
    pub fn factor(&mut self, values: &[f64]) -> Result<(), SolveError> {
        self.ready = false;
        self.values.copy_from_slice(values);
        self.equilibrate();
        let matrix = SparseColMatRef::new(symbolic_view(&self.pattern), &self.scaled);
        self.symbolic
            .factorize_numeric_lu(
                &mut self.numeric,
                matrix,
                Par::Seq,
                MemStack::new(&mut self.memory),
                Default::default(),
            )
            .map_err(|_| SolveError::Singular)?;
        self.ready = true;
        Ok(())
    }

    /// Solves A x = b with one step of iterative refinement and checks the answer.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if x is not finite or leaves a residual beyond round-off.
    pub fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), SolveError> {
        if !self.ready {
            return Err(SolveError::Singular);
        }
        x.copy_from_slice(b);
        self.apply_inverse(x);
        self.pattern.multiply(&self.values, x, &mut self.residual);
        let mut correction = std::mem::take(&mut self.correction);
        for (c, (r, b)) in correction.iter_mut().zip(self.residual.iter().zip(b)) {
            *c = b - r;
        }
        self.apply_inverse(&mut correction);
        for (x, c) in x.iter_mut().zip(&correction) {
            *x += c;
        }
        self.correction = correction;
        if x.iter().all(|v| v.is_finite()) && self.backward_error(b, x) <= BACKWARD_LIMIT {
            Ok(())
        } else {
            Err(SolveError::Singular)
        }
    }

    /// A lower bound of the norm of the inverse of the scaled matrix (whose entries are at most one), from one
    /// solve with a fixed vector of all frequencies; near 1e16 where the matrix is singular.
    pub fn inverse_norm(&mut self) -> f64 {
        if !self.ready {
            return f64::INFINITY;
        }
        let mut probe = std::mem::take(&mut self.correction);
        fill_probe(&mut probe);
        self.apply_scaled_inverse(&mut probe);
        let size = largest(&probe);
        self.correction = probe;
        size
    }

    /// Backward error of x as a solution of A x = b, in the scaled system, where all entries are at most one.
    fn backward_error(&mut self, b: &[f64], x: &[f64]) -> f64 {
        self.pattern.multiply(&self.values, x, &mut self.residual);
        let largest =
            |values: &mut dyn Iterator<Item = f64>| values.fold(0.0_f64, |m, v| m.max(v.abs()));
        let scales = || b.iter().zip(&self.residual).zip(&self.row_scale);
        let error = largest(&mut scales().map(|((b, product), scale)| (b - product) * scale));
        let size = largest(&mut scales().map(|((b, _), scale)| b * scale)).max(largest(
            &mut x.iter().zip(&self.col_scale).map(|(x, scale)| x / scale),
        ));
        if error > 0.0 { error / size } else { 0.0 }
    }

    fn apply_inverse(&mut self, x: &mut [f64]) {
        for (x, s) in x.iter_mut().zip(&self.row_scale) {
            *x *= s;
        }
        self.apply_scaled_inverse(x);
        for (x, s) in x.iter_mut().zip(&self.col_scale) {
            *x *= s;
        }
    }

    fn apply_scaled_inverse(&mut self, x: &mut [f64]) {
        let n = self.pattern.n;
        LuRef::new_unchecked(&self.symbolic, &self.numeric).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(x, n, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }

    /// Ruiz equilibration: rows and columns are divided by the square roots of their largest entries, some times.
    fn equilibrate(&mut self) {
        let n = self.pattern.n;
        self.row_scale.fill(1.0);
        self.col_scale.fill(1.0);
        self.scaled.copy_from_slice(&self.values);
        for _ in 0..SWEEPS {
            self.sizes.fill(0.0);
            self.residual.fill(0.0);
            for col in 0..n {
                for k in self.pattern.col_ptr[col]..self.pattern.col_ptr[col + 1] {
                    let size = self.scaled[k].abs();
                    let row = self.pattern.row_idx[k];
                    self.sizes[row] = self.sizes[row].max(size);
                    self.residual[col] = self.residual[col].max(size);
                }
            }
            for i in 0..n {
                self.row_scale[i] *= inverse_root(self.sizes[i]);
                self.col_scale[i] *= inverse_root(self.residual[i]);
            }
            for col in 0..n {
                for k in self.pattern.col_ptr[col]..self.pattern.col_ptr[col + 1] {
                    self.scaled[k] = self.values[k]
                        * self.row_scale[self.pattern.row_idx[k]]
                        * self.col_scale[col];
                }
            }
        }
    }
}

/// Factors of a small dense matrix, with all that is needed to make them again without allocating.
///
/// Rows are scaled by their largest entry, since some hold forces and others lengths.
pub struct DenseFactors {
    n: usize,
    /// Column by column; the matrix, then its factors.
    values: Vec<f64>,
    row_scale: Vec<f64>,
    perm: Vec<usize>,
    perm_inverse: Vec<usize>,
    memory: MemBuffer,
    probe: Vec<f64>,
}

impl DenseFactors {
    /// Room for an n by n matrix.
    ///
    /// # Errors
    /// [`SolveError::OutOfMemory`].
    pub fn new(n: usize) -> Result<Self, SolveError> {
        let request = lu_in_place_scratch::<usize, f64>(n, n, Par::Seq, Default::default())
            .or(solve_in_place_scratch::<usize, f64>(n, 1, Par::Seq));
        Ok(DenseFactors {
            n,
            values: vec![0.0; n * n],
            row_scale: vec![1.0; n],
            perm: vec![0; n],
            perm_inverse: vec![0; n],
            memory: MemBuffer::try_new(request).map_err(|_| SolveError::OutOfMemory)?,
            probe: vec![0.0; n],
        })
    }

    /// Solves A x = b for the matrix with these values (column by column); x replaces b. Returns an estimate of the
    /// norm of the scaled inverse, as [`Factors::inverse_norm`] does.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if x is not finite.
    pub fn solve(&mut self, values: &[f64], b: &mut [f64]) -> Result<f64, SolveError> {
        let n = self.n;
        self.values.copy_from_slice(values);
        self.row_scale.fill(0.0);
        for (k, value) in values.iter().enumerate() {
            self.row_scale[k % n] = self.row_scale[k % n].max(value.abs());
        }
        for scale in &mut self.row_scale {
            *scale = if *scale > 0.0 { 1.0 / *scale } else { 1.0 };
        }
        for (k, value) in self.values.iter_mut().enumerate() {
            *value *= self.row_scale[k % n];
        }
        for (b, scale) in b.iter_mut().zip(&self.row_scale) {
            *b *= scale;
        }
        lu_in_place(
            MatMut::from_column_major_slice_mut(&mut self.values, n, n),
            &mut self.perm,
            &mut self.perm_inverse,
            Par::Seq,
            MemStack::new(&mut self.memory),
            Default::default(),
        );
        fill_probe(&mut self.probe);
        let mut probe = std::mem::take(&mut self.probe);
        self.apply_inverse(&mut probe);
        self.apply_inverse(b);
        let norm = largest(&probe);
        self.probe = probe;
        if b.iter().all(|x| x.is_finite()) {
            Ok(norm)
        } else {
            Err(SolveError::Singular)
        }
    }

    fn apply_inverse(&mut self, x: &mut [f64]) {
        let n = self.n;
        let factors = MatRef::from_column_major_slice(&self.values, n, n);
        solve_in_place(
            factors,
            factors,
            PermRef::new_checked(&self.perm, &self.perm_inverse, n),
            MatMut::from_column_major_slice_mut(x, n, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }
}

/// A fixed vector of all frequencies, with entries between 1 and 2 in size.
fn fill_probe(probe: &mut [f64]) {
    for (i, p) in probe.iter_mut().enumerate() {
        *p = 1.0 + (1.618_033_988_749_895 * i as f64).fract();
        if i % 2 == 1 {
            *p = -*p;
        }
    }
}

/// Largest size of an entry; infinite where one is not finite.
fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0_f64, |m, v| {
        if v.is_finite() {
            m.max(v.abs())
        } else {
            f64::INFINITY
        }
    })
}

fn inverse_root(size: f64) -> f64 {
    if size > 0.0 && size.is_finite() {
        1.0 / size.sqrt()
    } else {
        1.0
    }
}

fn symbolic_view(pattern: &Pattern) -> SymbolicSparseColMatRef<'_, usize> {
    SymbolicSparseColMatRef::new_checked(
        pattern.n,
        pattern.n,
        &pattern.col_ptr,
        None,
        &pattern.row_idx,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dense(n: usize, a: &[f64]) -> (Arc<Pattern>, Vec<f64>) {
        let pattern = Pattern::new(n, (0..n * n).map(|k| (k / n, k % n)).collect());
        let values = pattern.iter().map(|(r, c)| a[r * n + c]).collect();
        (Arc::new(pattern), values)
    }

    #[test]
    fn a_badly_scaled_saddle_point_is_solved_to_round_off() {
        let (pattern, values) = dense(3, &[1.2e7, 3.0, 1.0, 3.0, 1e-3, 1.0, 1.0, 1.0, 0.0]);
        let mut factors = Factors::new(pattern.clone()).unwrap();
        factors.factor(&values).unwrap();
        let exact = [1.0, -2.0, 3e5];
        let (mut b, mut x) = ([0.0; 3], [0.0; 3]);
        pattern.multiply(&values, &exact, &mut b);
        factors.solve(&b, &mut x).unwrap();
        for (x, e) in x.iter().zip(exact) {
            assert!((x - e).abs() <= 1e-12 * e.abs(), "{x} {e}");
        }
        assert!(factors.inverse_norm() < 1e6);
    }

    #[test]
    fn a_dense_system_is_solved_and_a_singular_one_told() {
        let mut dense = DenseFactors::new(3).unwrap();
        let a = [0.0, 2e8, 1.0, 1e-4, 1.0, 3.0, 2e-4, 0.0, -1.0];
        let exact = [1.0, -2.0, 0.5];
        let mut b: Vec<f64> = (0..3)
            .map(|i| (0..3).map(|j| a[3 * j + i] * exact[j]).sum())
            .collect();
        assert!(dense.solve(&a, &mut b).unwrap() < 1e6);
        assert!(
            b.iter().zip(exact).all(|(x, e)| (x - e).abs() < 1e-12),
            "{b:?}"
        );
        let singular = [1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 0.0, 1.0, 1.0];
        let norm = dense.solve(&singular, &mut [1.0, 1.0, 1.0]);
        assert!(norm.is_err() || norm.is_ok_and(|n| n > 1e12));
    }

    #[test]
    fn a_singular_matrix_is_told_by_the_norm_of_its_inverse_or_by_the_solve() {
        let (pattern, values) = dense(2, &[1.0, 2.0, 2.0, 4.0]);
        let mut factors = Factors::new(pattern).unwrap();
        if factors.factor(&values).is_ok() {
            let mut x = [0.0; 2];
            assert!(factors.inverse_norm() > 1e12 || factors.solve(&[1.0, 1.0], &mut x).is_err());
        }
    }
}
