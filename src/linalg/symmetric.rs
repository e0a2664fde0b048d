//! Sparse LDLᵀ of a symmetric matrix some of whose unknowns, the interface, are eliminated last.
//!
//! The trailing block of the factors is then that of the matrix condensed to the interface: with i the other unknowns
//! and c the interface,
//!
//! ```text
//! K = L D Lᵀ,      S = K_cc − K_ci K_ii⁻¹ K_ic = L_cc D_c L_ccᵀ,
//! ```
//!
//! so condensing (eqn 6) costs no more than factoring. A body that is free to move as a whole has a singular S; therefore a
//! `shift` is added to the diagonal of K_cc, and so to that of S, and the caller subtracts it again.
//!
//! Only the upper half of the matrix is read. There is no pivoting. If a pivot is too small, the check of the solution fails,
//! and the caller turns to [`super::Factors`].

use super::check::{SolveError, largest};
use super::pattern::{Pattern, symbolic_view};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::amd;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLdltRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Accum, Conj, MatMut, MatRef, Par, Side};
use std::sync::Arc;

/// Backward error above which a solution is not believed: there is no pivoting, so growth must show here.
const BACKWARD_LIMIT: f64 = 1e-12;

/// Factors of a symmetric matrix, with all that is needed to make them again without allocating.
pub struct SymmetricFactors {
    pattern: Arc<Pattern>,
    symbolic: SymbolicCholesky<usize>,
    /// All unknowns, in the order of their elimination.
    order: Vec<usize>,
    /// The unknowns that come last, in their order.
    last: Vec<usize>,
    /// Places of the diagonal of `last` in the array of values.
    diagonal: Vec<usize>,
    factors: Vec<f64>,
    memory: MemBuffer,
    values: Vec<f64>,
    /// Size of the largest of them.
    size: f64,
    residual: Vec<f64>,
    /// L_cc, and D_c L_ccᵀ, column by column.
    lower: Vec<f64>,
    upper: Vec<f64>,
    ready: bool,
}

impl SymmetricFactors {
    /// Analyses the upper half of a symmetric pattern; the unknowns `last` are eliminated last, in their order.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if the pattern lacks the diagonal of one of `last`; [`SolveError::OutOfMemory`].
    pub fn new(pattern: Arc<Pattern>, last: &[usize]) -> Result<Self, SolveError> {
        let n = pattern.n;
        let order = order(&pattern, last)?;
        let mut inverse = vec![0; n];
        for (place, &unknown) in order.iter().enumerate() {
            inverse[unknown] = place;
        }
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let symbolic = factorize_symbolic_cholesky(
            symbolic_view(&pattern),
            Side::Upper,
            SymmetricOrdering::Custom(PermRef::new_checked(&order, &inverse, n)),
            params,
        )
        .map_err(|_| SolveError::OutOfMemory)?;
        let request = symbolic
            .factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default())
            .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let diagonal = last
            .iter()
            .map(|&i| pattern.slot(i, i).ok_or(SolveError::Singular))
            .collect::<Result<_, _>>()?;
        Ok(SymmetricFactors {
            factors: vec![0.0; symbolic.len_val()],
            memory: MemBuffer::try_new(request).map_err(|_| SolveError::OutOfMemory)?,
            values: vec![0.0; pattern.entries()],
            size: 0.0,
            residual: vec![0.0; n],
            lower: vec![0.0; last.len().pow(2)],
            upper: vec![0.0; last.len().pow(2)],
            last: last.to_vec(),
            order,
            diagonal,
            symbolic,
            pattern,
            ready: false,
        })
    }

    /// Factors the matrix with these values (in the order of the pattern), `shift` added to the diagonal of the
    /// unknowns that come last.
    ///
    /// # Errors
    /// [`SolveError::Singular`] where a pivot vanishes; small ones show in [`SymmetricFactors::solve`].
    pub fn factor(&mut self, values: &[f64], shift: f64) -> Result<(), SolveError> {
        self.ready = false;
        self.values.copy_from_slice(values);
        for &k in &self.diagonal {
            self.values[k] += shift;
        }
        // The check of the solution finds what is not a number.
        self.size = self.values.iter().fold(0.0, |m, v| m.max(v.abs()));
        self.symbolic
            .factorize_numeric_ldlt(
                &mut self.factors,
                SparseColMatRef::new(symbolic_view(&self.pattern), &self.values),
                Side::Upper,
                LdltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut self.memory),
                Default::default(),
            )
            .map_err(|_| SolveError::Singular)?;
        self.ready = true;
        Ok(())
    }

    /// Solves (K + shift) x = b and checks the answer.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if x is not finite or leaves a residual beyond round-off.
    pub fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), SolveError> {
        if !self.ready {
            return Err(SolveError::Singular);
        }
        x.copy_from_slice(b);
        LdltRef::new(&self.symbolic, &self.factors).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(x, b.len(), 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
        self.pattern
            .multiply_half(&self.values, x, &mut self.residual);
        for (r, b) in self.residual.iter_mut().zip(b) {
            *r -= b;
        }
        let size = largest(b).max(self.size * largest(x));
        if size.is_finite() && largest(&self.residual) <= BACKWARD_LIMIT * size {
            Ok(())
        } else {
            Err(SolveError::Singular)
        }
    }

    /// D of the last factorization, by unknown: with the unknowns before them all eliminated, what is left of the diagonal.
    /// By Sylvester's law as many are negative as K has negative eigenvalues.
    pub fn pivots(&self, out: &mut [f64]) {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else {
            unreachable!("the symbolic part is forced to be supernodal");
        };
        let factors = SupernodalLdltRef::new(symbolic, &self.factors);
        for s in 0..symbolic.n_supernodes() {
            let node = factors.supernode(s);
            let (values, start) = (node.val(), node.start());
            for column in 0..values.ncols() {
                out[self.order[start + column]] = values[(column, column)];
            }
        }
    }

    /// The condensed matrix S + shift, column by column, in the order of the unknowns that come last.
    pub fn condensed(&mut self, out: &mut [f64]) {
        let c = self.last.len();
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else {
            unreachable!("the symbolic part is forced to be supernodal");
        };
        let first = self.pattern.n - c;
        let factors = SupernodalLdltRef::new(symbolic, &self.factors);
        self.lower.fill(0.0);
        self.upper.fill(0.0);
        for s in (0..symbolic.n_supernodes()).rev() {
            let node = factors.supernode(s);
            let (values, start, width) = (node.val(), node.start(), node.val().ncols());
            if start + width <= first {
                break;
            }
            for column in first.saturating_sub(start)..width {
                let to = start + column - first;
                let pivot = values[(column, column)];
                let below = (column + 1..width).map(|row| (row, start + row));
                let rest = node.pattern().iter().enumerate();
                for (row, place) in below.chain(rest.map(|(k, &place)| (width + k, place))) {
                    let from = place - first;
                    self.lower[to * c + from] = values[(row, column)];
                    self.upper[from * c + to] = values[(row, column)] * pivot;
                }
                self.lower[to * c + to] = 1.0;
                self.upper[to * c + to] = pivot;
            }
        }
        matmul(
            MatMut::from_column_major_slice_mut(out, c, c),
            BlockStructure::TriangularLower,
            Accum::Replace,
            MatRef::from_column_major_slice(&self.lower, c, c),
            BlockStructure::TriangularLower,
            MatRef::from_column_major_slice(&self.upper, c, c),
            BlockStructure::TriangularUpper,
            1.0,
            Par::Seq,
        );
        for column in 0..c {
            for row in 0..column {
                out[column * c + row] = out[row * c + column];
            }
        }
    }
}

/// A fill-reducing order of the unknowns in which `last` come last.
fn order(pattern: &Pattern, last: &[usize]) -> Result<Vec<usize>, SolveError> {
    const LAST: usize = usize::MAX;
    let n = pattern.n;
    let mut number = vec![0; n];
    for &i in last {
        number[i] = LAST;
    }
    let mut inner = Vec::with_capacity(n - last.len());
    for (i, number) in number.iter_mut().enumerate() {
        if *number != LAST {
            *number = inner.len();
            inner.push(i);
        }
    }
    let (mut starts, mut rows) = (vec![0], Vec::new());
    for &column in &inner {
        let range = pattern.col_ptr[column]..pattern.col_ptr[column + 1];
        let entries = pattern.row_idx[range].iter().map(|&row| number[row]);
        rows.extend(entries.filter(|&row| row != LAST));
        starts.push(rows.len());
    }
    let m = inner.len();
    let graph = SymbolicSparseColMatRef::new_checked(m, m, &starts, None, &rows);
    let (mut forward, mut inverse) = (vec![0; m], vec![0; m]);
    let request = amd::order_scratch::<usize>(m, rows.len());
    let mut memory = MemBuffer::try_new(request).map_err(|_| SolveError::OutOfMemory)?;
    amd::order(
        &mut forward,
        &mut inverse,
        graph,
        Default::default(),
        MemStack::new(&mut memory),
    )
    .map_err(|_| SolveError::OutOfMemory)?;
    let reduced = forward.iter().map(|&k| inner[k]);
    Ok(reduced.chain(last.iter().copied()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// A symmetric matrix of the pattern of a plane grid, indefinite where `pull` is large.
    fn grid(side: usize, pull: f64) -> (Arc<Pattern>, DMatrix<f64>) {
        let n = side * side;
        let mut a = DMatrix::zeros(n, n);
        for i in 0..n {
            a[(i, i)] = 4.0 + 0.1 * (i % 7) as f64 - pull;
            for j in [i + 1, i + side] {
                if j < n && (j == i + side || j % side != 0) {
                    a[(i, j)] = -1.0 + 0.01 * (i % 5) as f64;
                    a[(j, i)] = a[(i, j)];
                }
            }
        }
        let places = (0..n).flat_map(|i| (i..n).map(move |j| (i, j)));
        let entries = places.filter(|&place| a[place] != 0.0).collect();
        (Arc::new(Pattern::new(n, entries)), a)
    }

    fn values(pattern: &Pattern, a: &DMatrix<f64>) -> Vec<f64> {
        pattern.iter().map(|place| a[place]).collect()
    }

    #[test]
    fn the_condensed_matrix_is_the_schur_complement_and_solutions_are_exact() {
        for (pull, shift) in [(0.0, 0.0), (0.0, 2.5), (2.9, 1.0)] {
            let (pattern, mut a) = grid(9, pull);
            let last: Vec<usize> = (0..81).filter(|i| i % 9 == 0 || i % 13 == 5).collect();
            let mut factors = SymmetricFactors::new(pattern.clone(), &last).unwrap();
            factors.factor(&values(&pattern, &a), shift).unwrap();
            last.iter().for_each(|&i| a[(i, i)] += shift);
            let c = last.len();
            let inverse = a.clone().try_inverse().unwrap();
            let corner = DMatrix::from_fn(c, c, |i, j| inverse[(last[i], last[j])]);
            let schur = corner.try_inverse().unwrap();
            let mut out = vec![0.0; c * c];
            factors.condensed(&mut out);
            let error = (DMatrix::from_column_slice(c, c, &out) - &schur).amax();
            assert!(error < 1e-11 * schur.amax(), "pull {pull}: {error}");
            let b = DVector::from_fn(81, |i, _| (i as f64).sin());
            let mut x = vec![0.0; 81];
            factors.solve(b.as_slice(), &mut x).unwrap();
            assert!((a * DVector::from_vec(x) - b).amax() < 1e-12);
        }
    }

    #[test]
    fn as_many_pivots_are_negative_as_eigenvalues() {
        let mut seen = Vec::new();
        for pull in [0.0, 2.0, 2.9, 4.55] {
            let (pattern, a) = grid(9, pull);
            let last: Vec<usize> = (0..81).filter(|i| i % 9 == 0).collect();
            let mut factors = SymmetricFactors::new(pattern.clone(), &last).unwrap();
            factors.factor(&values(&pattern, &a), 0.0).unwrap();
            let mut pivots = vec![0.0; 81];
            factors.pivots(&mut pivots);
            let negative = pivots.iter().filter(|d| **d < 0.0).count();
            let eigenvalues = a.symmetric_eigenvalues();
            let exact = eigenvalues.iter().filter(|value| **value < 0.0).count();
            assert_eq!(negative, exact, "pull {pull}");
            seen.push(exact);
        }
        assert!(seen[0] == 0 && seen[1] > 0 && seen[1] < seen[3], "{seen:?}");
    }

    #[test]
    fn a_vanishing_pivot_is_told() {
        let pattern = Arc::new(Pattern::new(2, vec![(0, 0), (0, 1), (1, 1)]));
        let mut factors = SymmetricFactors::new(pattern, &[]).unwrap();
        let told = factors.factor(&[1e-30, 1.0, 0.0], 0.0).is_err()
            || factors.solve(&[1.0, 2.0], &mut [0.0; 2]).is_err();
        assert!(told);
        let singular = factors.factor(&[1.0, 2.0, 4.0], 0.0).is_err()
            || factors.solve(&[1.0, 1.0], &mut [0.0; 2]).is_err();
        assert!(singular);
    }
}
