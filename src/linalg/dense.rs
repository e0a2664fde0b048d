//! Dense LU for systems of the size of the interface.

use super::{SolveError, fill_probe, largest};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::lu::partial_pivoting::solve::{solve_in_place, solve_in_place_scratch};
use faer::perm::PermRef;
use faer::{MatMut, MatRef, Par};

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

#[cfg(test)]
mod tests {
    use super::*;

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
}
