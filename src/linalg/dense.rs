//! Dense LU for systems of the interface's size.

use super::check::{SolveError, fill_probe, largest};
use super::executor::{Executor, SequentialExecutor};
use super::registers;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::lu::partial_pivoting::solve::{
    solve_in_place, solve_in_place_scratch, solve_transpose_in_place,
};
use faer::linalg::matmul::matmul;
use faer::perm::PermRef;
use faer::{Accum, MatMut, MatRef, Par};

/// Columns of right-hand sides that are solved together. The blocks do not depend on the executor, and so neither do the bits.
const BLOCK: usize = 128;

/// Factors of a small dense matrix, with preallocated memory for repeated factorization.
///
/// Rows are scaled by their largest entry, because some contain forces and others lengths.
pub struct DenseFactors {
    n: usize,
    /// Column-major; first the matrix, then its factors.
    values: Vec<f64>,
    row_scale: Vec<f64>,
    perm: Vec<usize>,
    perm_inverse: Vec<usize>,
    /// One for each block of right-hand sides.
    memory: Vec<MemBuffer>,
    probe: Vec<f64>,
}

impl DenseFactors {
    /// Allocates an n by n matrix, and workspace for `columns` right-hand sides.
    ///
    /// # Errors
    /// [`SolveError::OutOfMemory`].
    pub fn new(n: usize, columns: usize) -> Result<Self, SolveError> {
        let request = lu_in_place_scratch::<usize, f64>(n, n, Par::Seq, Default::default()).or(
            solve_in_place_scratch::<usize, f64>(n, columns.clamp(1, BLOCK), Par::Seq),
        );
        let memory = (0..columns.div_ceil(BLOCK).max(1)).map(|_| MemBuffer::try_new(request));
        Ok(DenseFactors {
            n,
            values: vec![0.0; n * n],
            row_scale: vec![1.0; n],
            perm: vec![0; n],
            perm_inverse: vec![0; n],
            memory: memory
                .collect::<Result<_, _>>()
                .map_err(|_| SolveError::OutOfMemory)?,
            probe: vec![0.0; n],
        })
    }

    /// Changes the size to n, which must not exceed that of [`DenseFactors::new`].
    pub fn resize(&mut self, n: usize) {
        self.n = n;
        self.values.resize(n * n, 0.0);
        self.row_scale.resize(n, 1.0);
        self.probe.resize(n, 0.0);
        self.perm.resize(n, 0);
        self.perm_inverse.resize(n, 0);
    }

    /// Factors the matrix with these values in column-major order.
    pub fn factor(&mut self, values: &[f64]) {
        self.factor_part(values, self.n);
    }

    /// The same with the first rows and columns of a matrix that has `rows` rows.
    pub fn factor_part(&mut self, values: &[f64], rows: usize) {
        let n = self.n;
        self.row_scale.fill(0.0);
        let columns = self.values.chunks_exact_mut(n.max(1));
        for (own, column) in columns.zip(values.chunks_exact(rows.max(1))) {
            for ((own, scale), value) in own.iter_mut().zip(&mut self.row_scale).zip(column) {
                *own = *value;
                *scale = scale.max(value.abs());
            }
        }
        for scale in &mut self.row_scale {
            *scale = if *scale > 0.0 { 1.0 / *scale } else { 1.0 };
        }
        for column in self.values.chunks_exact_mut(n.max(1)) {
            for (value, scale) in column.iter_mut().zip(&self.row_scale) {
                *value *= scale;
            }
        }
        lu_in_place(
            MatMut::from_column_major_slice_mut(&mut self.values, n, n),
            &mut self.perm,
            &mut self.perm_inverse,
            Par::Seq,
            MemStack::new(&mut self.memory[0]),
            Default::default(),
        );
        registers::release();
    }

    /// Solves A X = B for the columns of B, which are consecutive in `b`; X replaces B. There must not be more columns than
    /// [`DenseFactors::new`] was given.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if X is not finite.
    pub fn solve(&mut self, b: &mut [f64]) -> Result<(), SolveError> {
        self.solve_with(&SequentialExecutor, b)
    }

    /// The same with an executor, for blocks of columns.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if X is not finite.
    pub fn solve_with(&mut self, executor: &dyn Executor, b: &mut [f64]) -> Result<(), SolveError> {
        let (scale, size) = (&self.row_scale, self.n.max(1));
        for column in b.chunks_exact_mut(size) {
            for (b, scale) in column.iter_mut().zip(scale) {
                *b *= scale;
            }
        }
        self.apply_inverse(executor, b);
        finite(b)
    }

    /// Solves Aᵀ X = B in place.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if X is not finite.
    pub fn solve_transposed(&mut self, b: &mut [f64]) -> Result<(), SolveError> {
        let n = self.n;
        let factors = MatRef::from_column_major_slice(&self.values, n, n);
        let columns = b.len().checked_div(n).unwrap_or(0);
        solve_transpose_in_place(
            factors,
            factors,
            PermRef::new_checked(&self.perm, &self.perm_inverse, n),
            MatMut::from_column_major_slice_mut(b, n, columns),
            Par::Seq,
            MemStack::new(&mut self.memory[0]),
        );
        registers::release();
        for column in b.chunks_exact_mut(n.max(1)) {
            for (b, scale) in column.iter_mut().zip(&self.row_scale) {
                *b *= scale;
            }
        }
        finite(b)
    }

    /// An estimate of the norm of the scaled inverse, as [`super::Factors::inverse_norm`] computes it.
    pub fn inverse_norm(&mut self) -> f64 {
        let mut probe = std::mem::take(&mut self.probe);
        fill_probe(&mut probe);
        self.apply_inverse(&SequentialExecutor, &mut probe);
        let norm = largest(&probe);
        self.probe = probe;
        norm
    }

    fn apply_inverse(&mut self, executor: &dyn Executor, x: &mut [f64]) {
        let n = self.n;
        let factors = MatRef::from_column_major_slice(&self.values, n, n);
        let perm = PermRef::new_checked(&self.perm, &self.perm_inverse, n);
        let solve = |x: &mut [f64], memory: &mut MemBuffer| {
            let columns = x.len().checked_div(n).unwrap_or(0);
            solve_in_place(
                factors,
                factors,
                perm,
                MatMut::from_column_major_slice_mut(x, n, columns),
                Par::Seq,
                MemStack::new(memory),
            );
            registers::release();
        };
        in_blocks(executor, x, n.max(1) * BLOCK, &mut self.memory, &solve);
    }
}

/// Does a job on every block of `size` numbers, with separate memory.
fn in_blocks(
    executor: &dyn Executor,
    x: &mut [f64],
    size: usize,
    memory: &mut [MemBuffer],
    job: &(dyn Fn(&mut [f64], &mut MemBuffer) + Sync),
) {
    let half = x.len().div_ceil(size) / 2;
    if half == 0 {
        return job(x, &mut memory[0]);
    }
    let (first, second) = x.split_at_mut(half * size);
    let (own, others) = memory.split_at_mut(half);
    executor.join(
        &mut || in_blocks(executor, first, size, own, job),
        &mut || in_blocks(executor, second, size, others, job),
    );
}

fn finite(x: &[f64]) -> Result<(), SolveError> {
    match x.iter().all(|x| x.is_finite()) {
        true => Ok(()),
        false => Err(SolveError::Singular),
    }
}

/// C = C − A B. Each matrix is column-major and given with its column stride; the sizes are [rows of A and C, columns of A and
/// rows of B, columns of B and C].
pub fn subtract_product(
    executor: &dyn Executor,
    c: (&mut [f64], usize),
    a: (&[f64], usize),
    b: (&[f64], usize),
    [rows, inner, columns]: [usize; 3],
) {
    if rows == 0 || inner == 0 || columns == 0 {
        return;
    }
    let half = columns.div_ceil(BLOCK) / 2 * BLOCK;
    if half > 0 {
        let (first, second) = c.0.split_at_mut(half * c.1);
        let (own, others) = b.0.split_at(half * b.1);
        let sizes = [half, columns - half].map(|columns| [rows, inner, columns]);
        return executor.join(
            &mut || subtract_product(executor, (first, c.1), a, (own, b.1), sizes[0]),
            &mut || subtract_product(executor, (second, c.1), a, (others, b.1), sizes[1]),
        );
    }
    matmul(
        MatMut::from_column_major_slice_with_stride_mut(c.0, rows, columns, c.1),
        Accum::Add,
        MatRef::from_column_major_slice_with_stride(a.0, rows, inner, a.1),
        MatRef::from_column_major_slice_with_stride(b.0, inner, columns, b.1),
        -1.0,
        Par::Seq,
    );
    registers::release();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::executor::Threads;

    #[test]
    fn blocks_of_columns_are_solved_and_multiplied_with_the_same_bits_on_threads() {
        let (n, columns) = (40, 2 * BLOCK + 17);
        let entry = |k: usize| (1.618 * k as f64).sin();
        let diagonal = |k: usize| if k.is_multiple_of(n + 1) { 9.0 } else { 0.0 };
        let a: Vec<f64> = (0..n * n).map(|k| entry(k) + diagonal(k)).collect();
        let b: Vec<f64> = (0..n * columns).map(|k| entry(k + 7)).collect();
        let mut dense = DenseFactors::new(n, columns).unwrap();
        dense.factor(&a);
        let mut solve = |executor: &dyn Executor| {
            let mut x = b.clone();
            dense.solve_with(executor, &mut x).unwrap();
            let mut residual = b.clone();
            let sizes = [n, n, columns];
            subtract_product(executor, (&mut residual, n), (&a, n), (&x, n), sizes);
            (x, residual)
        };
        let (x, residual) = solve(&Threads);
        assert!(largest(&residual) < 1e-12, "{}", largest(&residual));
        assert!((x, residual) == solve(&SequentialExecutor));
    }

    #[test]
    fn a_dense_system_is_solved_and_a_singular_one_detected() {
        let mut dense = DenseFactors::new(3, 2).unwrap();
        let a = [0.0, 2e8, 1.0, 1e-4, 1.0, 3.0, 2e-4, 0.0, -1.0];
        let exact = [1.0, -2.0, 0.5];
        let mut b: Vec<f64> = (0..3)
            .map(|i| (0..3).map(|j| a[3 * j + i] * exact[j]).sum())
            .collect();
        b.extend(b.clone().iter().map(|b| -2.0 * b));
        dense.factor(&a);
        dense.solve(&mut b).unwrap();
        assert!(dense.inverse_norm() < 1e6);
        assert!(
            (0..6).all(|k| (b[k] - exact[k % 3] * [1.0, -2.0][k / 3]).abs() < 1e-12),
            "{b:?}"
        );
        let mut b: Vec<f64> = (0..3)
            .map(|j| (0..3).map(|i| a[3 * j + i] * exact[i]).sum())
            .collect();
        dense.solve_transposed(&mut b).unwrap();
        assert!(
            b.iter().zip(exact).all(|(b, x)| (b - x).abs() < 1e-12),
            "{b:?}"
        );
        let singular = [1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 0.0, 1.0, 1.0];
        dense.factor(&singular);
        assert!(dense.inverse_norm() > 1e12 || dense.solve(&mut [1.0, 1.0, 1.0]).is_err());
    }
}
