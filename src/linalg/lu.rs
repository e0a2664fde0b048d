//! Sparse LU with partial pivoting, scaled, refined and checked.
//!
//! The augmented system of eqn (9) mixes stiffnesses of very different size with constraint rows of size one and,
//! where friction stands in the matrix, is unsymmetric. So it is scaled row by row and column by column; the symbolic
//! part is kept as long as the pattern stands.

use super::{Pattern, SolveError, fill_probe, largest, symbolic_view};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::lu::{LuRef, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::{Conj, MatMut, Par};
use std::sync::Arc;

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
    /// Most right-hand sides that [`Factors::solve_block`] takes at a time.
    pub const BLOCK: usize = 32;

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
            .or(symbolic.solve_in_place_scratch::<f64>(Self::BLOCK, Par::Seq));
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

    /// Solves A X = B for at most [`Factors::BLOCK`] columns of B, one after the other in `x`; X replaces B. Neither
    /// refined nor checked but for being finite: meant for the many columns of a response, beside one checked solve.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if X is not finite.
    pub fn solve_block(&mut self, x: &mut [f64]) -> Result<(), SolveError> {
        if !self.ready {
            return Err(SolveError::Singular);
        }
        let n = self.pattern.n;
        for column in x.chunks_exact_mut(n) {
            for (x, s) in column.iter_mut().zip(&self.row_scale) {
                *x *= s;
            }
        }
        let columns = x.len() / n;
        LuRef::new_unchecked(&self.symbolic, &self.numeric).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(x, n, columns),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
        for column in x.chunks_exact_mut(n) {
            for (x, s) in column.iter_mut().zip(&self.col_scale) {
                *x *= s;
            }
        }
        if x.iter().all(|x| x.is_finite()) {
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

fn inverse_root(size: f64) -> f64 {
    if size > 0.0 && size.is_finite() {
        1.0 / size.sqrt()
    } else {
        1.0
    }
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
    fn a_singular_matrix_is_told_by_the_norm_of_its_inverse_or_by_the_solve() {
        let (pattern, values) = dense(2, &[1.0, 2.0, 2.0, 4.0]);
        let mut factors = Factors::new(pattern).unwrap();
        if factors.factor(&values).is_ok() {
            let mut x = [0.0; 2];
            assert!(factors.inverse_norm() > 1e12 || factors.solve(&[1.0, 1.0], &mut x).is_err());
        }
    }
}
