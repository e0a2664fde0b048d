//! Sparse LDLᵀ of a symmetric matrix that eliminates all unknowns but some, the interface.
//!
//! What is left is the matrix condensed to the interface (eqn 6): with the other unknowns i and the interface c,
//!
//! ```text
//! K_ii = L_ii D_i L_iiᵀ,      L_ci = K_ci L_ii⁻ᵀ D_i⁻¹,      S = K_cc − L_ci D_i L_ciᵀ.
//! ```
//!
//! One pass over L condenses a right-hand side, and another one computes the interior displacements once those of the interface
//! are known: with the result y_i of the first pass,
//!
//! ```text
//! L_ii y_i = b_i,    r̃ = b_c − L_ci y_i;      L_iiᵀ u_i = D_i⁻¹ y_i − L_ciᵀ u_c.
//! ```
//!
//! Only the upper half of the matrix is used. The symbolic factorization is done on groups of unknowns with the same rows, such as
//! the two of a node, because this takes less time. The matrix is factored without pivoting. This is stable if no pivot is negative,
//! because the terms of the factorization are then no larger than the matrix. With negative pivots the size of the terms is
//! checked ([`SymmetricFactors::factor`]); if it is too large, the caller uses [`super::Factors`].

use super::check::{SolveError, UNDERFLOW, largest};
use super::executor::Executor;
use super::order::order;
use super::pattern::{Pattern, symbolic_view};
use super::substitution::Substitution;
use super::subtrees::{LowerHalf, Subtree, Workspace};
use super::supernodes::Supernodes;
use faer::Side;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::{SupernodalThreshold, SymbolicSupernodalParams};
use std::sync::Arc;

/// Backward error above which a solution is rejected. Without pivoting, growth must be detected here.
const BACKWARD_LIMIT: f64 = 1e-12;

/// Two supernodes are merged if they have at most this many columns together, and at most this fraction of their entries is zero:
/// faer's values.
const RELAX: [(usize, f64); 4] = [(4, 1.0), (16, 0.8), (48, 0.1), (usize::MAX, 0.05)];

/// A diagonal entry of S below this fraction of that of K is round-off.
const CANCELLED: f64 = 8.0 * f64::EPSILON;

/// Factors of a symmetric matrix, with preallocated memory for repeated factorization.
pub struct SymmetricFactors {
    /// Pattern of the lower half in elimination order, and the source of each of its entries.
    pattern: Pattern,
    from: Vec<u32>,
    l: Supernodes,
    tree: Subtree,
    rooms: Vec<Workspace>,
    /// All unknowns in elimination order.
    order: Vec<usize>,
    /// L, and the lower half of S.
    factors: Vec<f64>,
    values: Vec<f64>,
    /// Largest magnitude of these.
    size: f64,
    residual: Vec<f64>,
    /// D_i, in elimination order.
    pivots: Vec<f64>,
    /// y, then u, in elimination order.
    moved: Vec<f64>,
    substitution: Substitution,
    ready: bool,
}

impl SymmetricFactors {
    /// Analyses the upper half of a symmetric pattern; the unknowns `last` are not eliminated. `positions` are those of the
    /// unknowns, from which large matrices get a better elimination order, or empty.
    ///
    /// # Errors
    /// [`SolveError::OutOfMemory`], also if L of the groups of unknowns with the same rows has more than 2³¹ entries.
    pub fn new(
        pattern: Arc<Pattern>,
        last: &[usize],
        positions: &[[f64; 2]],
    ) -> Result<Self, SolveError> {
        let n = pattern.n;
        let order = order(&pattern, last, positions)?;
        let (lower, from) = pattern.in_order(&order);
        let groups = lower.groups(n - last.len());
        let size = (n as f64 / (groups.len() - 1) as f64).round().max(1.0) as usize;
        let relax = RELAX.map(|(columns, zeros)| (columns / size, zeros));
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            supernodal_params: SymbolicSupernodalParams {
                relax: Some(&relax),
            },
            ..Default::default()
        };
        let upper = lower.of_groups(&groups).transposed();
        let symbolic = factorize_symbolic_cholesky(
            symbolic_view(&upper),
            Side::Upper,
            SymmetricOrdering::Identity,
            params,
        )
        .map_err(|_| SolveError::OutOfMemory)?;
        drop(upper);
        let SymbolicCholeskyRaw::Supernodal(raw) = symbolic.raw() else {
            unreachable!("the symbolic part must be supernodal")
        };
        let l = Supernodes::from_symbolic(raw, &groups, n - last.len());
        let tree = Subtree::new(&l);
        Ok(SymmetricFactors {
            substitution: Substitution::new(&l, &tree),
            factors: vec![0.0; l.values(&(0..l.nodes.len())).end],
            rooms: (0..tree.leaves)
                .map(|_| Workspace::new(&l))
                .collect::<Result<_, _>>()?,
            pivots: vec![0.0; l.inner],
            tree,
            l,
            values: vec![0.0; lower.entries()],
            size: 0.0,
            residual: vec![0.0; n],
            moved: vec![0.0; n],
            order,
            pattern: lower,
            from,
            ready: false,
        })
    }

    /// Factors the matrix with these values (in pattern order).
    ///
    /// # Errors
    /// [`SolveError::Singular`] if a pivot vanishes, or if terms grow so much that their round-off matters.
    pub fn factor(&mut self, values: &[f64], executor: &dyn Executor) -> Result<(), SolveError> {
        self.ready = false;
        for (value, &k) in self.values.iter_mut().zip(&self.from) {
            *value = values[k as usize];
        }
        self.size = largest(&self.values);
        let matrix = LowerHalf {
            pattern: &self.pattern,
            values: &self.values,
        };
        self.tree.factor(
            &self.l,
            matrix,
            &mut self.factors,
            &mut self.rooms,
            executor,
        )?;
        for node in &self.l.nodes[..self.l.tail] {
            let own = &mut self.pivots[node.columns.clone()];
            for (k, pivot) in own.iter_mut().enumerate() {
                *pivot = node.column(&self.factors, k)[k];
            }
        }
        self.ready =
            self.size.is_finite() && f64::EPSILON * self.growth() <= BACKWARD_LIMIT * self.size;
        if self.ready {
            Ok(())
        } else {
            Err(SolveError::Singular)
        }
    }

    /// Largest sum of the terms |L| |D| |L|ᵀ, and |S|, in a diagonal entry. Without negative entries in D and on the diagonal of S
    /// it is the entry itself, and is not computed.
    fn growth(&mut self) -> f64 {
        let negative = |d: &f64| d.is_nan() || *d <= 0.0;
        let mut left = self.l.columns(&self.factors, self.l.left());
        if !self.pivots.iter().any(negative) && !left.any(|column| negative(&column.pivot)) {
            return self.size;
        }
        let sums = &mut self.moved;
        sums.fill(0.0);
        let all = 0..self.l.nodes.len();
        for column in self.l.columns(&self.factors, all) {
            let size = column.pivot.abs();
            sums[column.place] += size;
            if column.place >= self.l.inner {
                continue;
            }
            let rows = column.place + 1..column.place + 1 + column.own.len();
            let rows = rows.chain(column.rows.iter().map(|&row| row as usize));
            for (row, l) in rows.zip(column.own.iter().chain(column.below)) {
                sums[row] += l * l * size;
            }
        }
        largest(sums)
    }

    /// Whether all digits of a diagonal entry of S cancel.
    pub fn cancels(&self) -> bool {
        let mut left = self.l.columns(&self.factors, self.l.left());
        left.any(|column| {
            let slot = self.pattern.slot(column.place, column.place);
            let given = slot.map_or(0.0, |k| self.values[k]);
            column.pivot.abs() < CANCELLED * given.abs()
        })
    }

    /// r̃ of a right-hand side, in the order of `last`; [`SymmetricFactors::recover`] continues with it.
    pub fn condense(&mut self, b: &[f64], out: &mut [f64], executor: &dyn Executor) {
        for (moved, &unknown) in self.moved.iter_mut().zip(&self.order) {
            *moved = b[unknown];
        }
        let l = (&self.l, &self.factors[..]);
        self.substitution.forward(l, &mut self.moved, executor);
        out.copy_from_slice(&self.moved[self.l.inner..]);
    }

    /// All unknowns, given those of `last` and the right-hand side `b` that was condensed just before.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if x is not finite or the residual in the other equations exceeds round-off.
    pub fn recover(
        &mut self,
        b: &[f64],
        known: &[f64],
        x: &mut [f64],
        executor: &dyn Executor,
    ) -> Result<(), SolveError> {
        let (inner, last) = self.moved.split_at_mut(self.l.inner);
        for (value, pivot) in inner.iter_mut().zip(&self.pivots) {
            *value /= pivot;
        }
        last.copy_from_slice(known);
        let l = (&self.l, &self.factors[..]);
        self.substitution.backward(l, &mut self.moved, executor);
        self.check(b, x, executor)
    }

    /// Restores the original order of x, and checks the equations of the eliminated unknowns.
    fn check(
        &mut self,
        b: &[f64],
        x: &mut [f64],
        executor: &dyn Executor,
    ) -> Result<(), SolveError> {
        if !self.ready {
            return Err(SolveError::Singular);
        }
        for (&unknown, value) in self.order.iter().zip(&self.moved) {
            x[unknown] = *value;
        }
        let matrix = LowerHalf {
            pattern: &self.pattern,
            values: &self.values,
        };
        let inner = self.l.inner;
        self.substitution
            .multiply(matrix, &self.moved, &mut self.residual, inner, executor);
        let residual = &mut self.residual[..inner];
        for (product, &unknown) in residual.iter_mut().zip(&self.order) {
            *product -= b[unknown];
        }
        let worst = largest(residual);
        let size = largest(b).max(self.size * largest(x)).max(UNDERFLOW);
        if size.is_finite() && worst <= BACKWARD_LIMIT * size {
            Ok(())
        } else {
            Err(SolveError::Singular)
        }
    }

    /// D_i of the last factorization, by unknown. By Sylvester's law, as many entries are negative as eigenvalues of K_ii.
    pub fn pivots(&self) -> impl Iterator<Item = (usize, f64)> {
        self.order.iter().copied().zip(self.pivots.iter().copied())
    }

    /// The condensed matrix S, column-major, in the order of `last`.
    pub fn condensed(&self, out: &mut [f64]) {
        let inner = self.l.inner;
        let c = self.order.len() - inner;
        out.fill(0.0);
        for column in self.l.columns(&self.factors, self.l.left()) {
            let to = column.place - inner;
            let own = (to + 1..to + 1 + column.own.len()).zip(column.own);
            let rest = column.rows.iter().map(|&row| row as usize - inner);
            out[to * c + to] = column.pivot;
            for (from, value) in own.chain(rest.zip(column.below)) {
                out[to * c + from] = *value;
                out[from * c + to] = *value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::executor::{SequentialExecutor, Threads};
    use nalgebra::{DMatrix, DVector};

    /// A symmetric matrix with the pattern of a plane grid, indefinite if `pull` is large.
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
        let entries = places.filter(|&place| a[place] != 0.0);
        (Arc::new(Pattern::new(n, entries).unwrap()), a)
    }

    fn values(pattern: &Pattern, a: &DMatrix<f64>) -> Vec<f64> {
        pattern.iter().map(|place| a[place]).collect()
    }

    /// The solution of the whole system, of which nothing is left.
    fn solve(
        factors: &mut SymmetricFactors,
        b: &[f64],
        executor: &dyn Executor,
    ) -> Result<Vec<f64>, SolveError> {
        let mut x = vec![0.0; b.len()];
        factors.condense(b, &mut [], executor);
        factors.recover(b, &[], &mut x, executor)?;
        Ok(x)
    }

    #[test]
    fn the_condensed_matrix_is_the_schur_complement_and_solutions_are_exact() {
        for pull in [0.0, 2.9] {
            let (pattern, a) = grid(9, pull);
            let last: Vec<usize> = (0..81).filter(|i| i % 9 == 0 || i % 13 == 5).collect();
            let mut factors = SymmetricFactors::new(pattern.clone(), &last, &[]).unwrap();
            factors
                .factor(&values(&pattern, &a), &SequentialExecutor)
                .unwrap();
            let c = last.len();
            let inverse = a.clone().try_inverse().unwrap();
            let corner = DMatrix::from_fn(c, c, |i, j| inverse[(last[i], last[j])]);
            let schur = corner.try_inverse().unwrap();
            let mut out = vec![0.0; c * c];
            factors.condensed(&mut out);
            let error = (DMatrix::from_column_slice(c, c, &out) - &schur).amax();
            assert!(error < 1e-11 * schur.amax(), "pull {pull}: {error}");
            let b = DVector::from_fn(81, |i, _| (i as f64).sin());
            let (mut load, mut x) = (vec![0.0; c], vec![0.0; 81]);
            factors.condense(b.as_slice(), &mut load, &SequentialExecutor);
            let known = schur.clone().lu().solve(&DVector::from_vec(load)).unwrap();
            factors
                .recover(b.as_slice(), known.as_slice(), &mut x, &SequentialExecutor)
                .unwrap();
            assert!((&a * DVector::from_vec(x) - &b).amax() < 1e-11);
        }
    }

    #[test]
    fn a_body_that_only_its_interface_supports_has_a_singular_condensed_matrix() {
        // Springs of stiffness 1 in a row, of which the ends are the interface: one spring is left.
        let entries = (0..5).flat_map(|i| [(i, i), (i, i + 1)]);
        let entries = entries.filter(|&(_, j)| j < 5);
        let pattern = Arc::new(Pattern::new(5, entries).unwrap());
        let stiffness = pattern.iter().map(|(i, j)| match (i, j) {
            (0, 0) | (4, 4) => 1.0,
            _ if i == j => 2.0,
            _ => -1.0,
        });
        let stiffness: Vec<f64> = stiffness.collect();
        let mut one_end = SymmetricFactors::new(pattern.clone(), &[4], &[]).unwrap();
        one_end.factor(&stiffness, &SequentialExecutor).unwrap();
        assert!(one_end.cancels(), "it moves as a whole");
        let mut factors = SymmetricFactors::new(pattern, &[0, 4], &[]).unwrap();
        factors.factor(&stiffness, &SequentialExecutor).unwrap();
        assert!(!factors.cancels());
        let mut out = [0.0; 4];
        factors.condensed(&mut out);
        for (value, exact) in out.iter().zip([0.25, -0.25, -0.25, 0.25]) {
            assert!((value - exact).abs() < 1e-15, "{out:?}");
        }
    }

    #[test]
    fn a_solution_that_underflows_is_a_solution() {
        let (pattern, a) = grid(9, 0.0);
        let mut factors = SymmetricFactors::new(pattern.clone(), &[], &[]).unwrap();
        factors
            .factor(&values(&pattern, &a), &SequentialExecutor)
            .unwrap();
        for size in [1e-300, 3e-319] {
            let b: Vec<f64> = (0..81).map(|i| size * f64::from(i).sin()).collect();
            assert!(
                solve(&mut factors, &b, &SequentialExecutor).is_ok(),
                "{size:e}"
            );
        }
    }

    /// A matrix that is large enough for a dissection, with the values and the positions of its unknowns. Rows of the grid from
    /// `apart` on are not coupled to earlier ones.
    fn large_grid(apart: usize) -> (Arc<Pattern>, Vec<f64>, Vec<[f64; 2]>) {
        let n = SIDE * SIDE;
        let steps = [0, 1, SIDE - 1, SIDE, SIDE + 1, 2 * SIDE];
        let entries = (0..n).flat_map(|i| steps.map(|step| (i, i + step)));
        let is_second = |i: usize| i >= apart * SIDE;
        let entries = entries.filter(|&(i, j)| j < n && is_second(i) == is_second(j));
        let pattern = Arc::new(Pattern::new(n, entries).unwrap());
        let value = |(k, (i, j)): (usize, (usize, usize))| {
            let part = (k as f64).sin();
            if i == j { 20.0 + part } else { part }
        };
        let values = pattern.iter().enumerate().map(value).collect();
        let positions = (0..n).map(|i| [i % SIDE, i / SIDE].map(|k| k as f64));
        let positions = positions.collect();
        (pattern, values, positions)
    }

    const SIDE: usize = 200;

    #[test]
    fn factors_and_solutions_have_the_same_bits_on_one_thread_and_on_many() {
        let (pattern, values, positions) = large_grid(0);
        let (n, last) = (pattern.size(), (0..SIDE).collect::<Vec<usize>>());
        let b: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
        let sizes = [&positions[..], &[]].map(|positions| {
            let mut factors = SymmetricFactors::new(pattern.clone(), &last, positions).unwrap();
            assert!(factors.substitution.is_split_twice());
            let mut solve = |executor: &dyn Executor| {
                let (mut x, mut load) = (vec![0.0; n], vec![0.0; SIDE]);
                let mut condensed = vec![0.0; SIDE * SIDE];
                factors.factor(&values, executor).unwrap();
                factors.condensed(&mut condensed);
                factors.condense(&b, &mut load, executor);
                let stiffness = DMatrix::from_vec(SIDE, SIDE, condensed);
                let known = stiffness.lu().solve(&DVector::from_column_slice(&load));
                let known = known.unwrap();
                factors
                    .recover(&b, known.as_slice(), &mut x, executor)
                    .unwrap();
                (factors.factors.clone(), x, load)
            };
            let solved = solve(&SequentialExecutor);
            assert!(solved == solve(&Threads));
            let mut product = vec![0.0; n];
            for ((i, j), value) in pattern.iter().zip(&values) {
                product[i] += value * solved.1[j];
                product[j] += if i == j { 0.0 } else { value * solved.1[i] };
            }
            let error = largest(product.iter().zip(&b).map(|(product, b)| product - b));
            assert!(error < 1e-13, "{error}");
            factors.factors.len()
        });
        assert!(sizes[0] < sizes[1], "a dissection fills less: {sizes:?}");
    }

    #[test]
    fn two_uncoupled_bodies_without_a_common_rest_are_solved() {
        let (pattern, values, positions) = large_grid(SIDE / 2);
        let n = pattern.size();
        let b: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
        // An interface unknown of each follows both.
        for last in [&[][..], &[0, n - 1]] {
            let mut factors = SymmetricFactors::new(pattern.clone(), last, &positions).unwrap();
            assert!(factors.substitution.is_split_twice());
            factors.factor(&values, &Threads).unwrap();
            let known = vec![0.0; last.len()];
            factors.condense(&b, &mut known.clone(), &Threads);
            factors
                .recover(&b, &known, &mut vec![0.0; n], &Threads)
                .unwrap();
        }
    }

    #[test]
    fn growth_beyond_round_off_is_detected_when_factoring() {
        let pattern = Arc::new(Pattern::new(2, [(0, 0), (0, 1), (1, 1)].into_iter()).unwrap());
        let mut factors = SymmetricFactors::new(pattern, &[1], &[]).unwrap();
        assert!(
            factors
                .factor(&[-0.1, 1.0, 0.0], &SequentialExecutor)
                .is_ok()
        );
        for small in [-1e-9, 1e-9] {
            let grown = factors.factor(&[small, 1.0, 0.0], &SequentialExecutor);
            assert!(grown.is_err(), "S is large and negative, or positive");
        }
    }

    #[test]
    fn as_many_pivots_are_negative_as_eigenvalues() {
        let mut seen = Vec::new();
        for pull in [0.0, 2.0, 2.9, 4.55] {
            let (pattern, a) = grid(9, pull);
            let mut factors = SymmetricFactors::new(pattern.clone(), &[], &[]).unwrap();
            factors
                .factor(&values(&pattern, &a), &SequentialExecutor)
                .unwrap();
            let negative = factors.pivots().filter(|(_, d)| *d < 0.0).count();
            let eigenvalues = a.symmetric_eigenvalues();
            let exact = eigenvalues.iter().filter(|value| **value < 0.0).count();
            assert_eq!(negative, exact, "pull {pull}");
            seen.push(exact);
        }
        assert!(seen[0] == 0 && seen[1] > 0 && seen[1] < seen[3], "{seen:?}");
    }

    #[test]
    fn a_vanishing_pivot_is_detected() {
        let pattern = Arc::new(Pattern::new(2, [(0, 0), (0, 1), (1, 1)].into_iter()).unwrap());
        let mut factors = SymmetricFactors::new(pattern, &[], &[]).unwrap();
        for (values, b) in [([1e-30, 1.0, 0.0], [1.0, 2.0]), ([1.0, 2.0, 4.0], [1.0; 2])] {
            let factored = factors.factor(&values, &SequentialExecutor);
            let solved = factored.and_then(|()| solve(&mut factors, &b, &SequentialExecutor));
            assert!(solved.is_err());
        }
    }
}
