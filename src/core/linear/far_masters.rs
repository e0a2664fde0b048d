//! Eliminates the masters that no slave node is over from the stiffness that is condensed to the interface.
//!
//! A surface is usually longer than the contact on it. With the far masters f and the other unknowns n of the interface,
//!
//! ```text
//! S_ff D = S_fn,      S' = S_nn − S_nf D,      r' = r_n − S_nf S_ff⁻¹ r_f,      u_f = S_ff⁻¹ r_f − D u_n.
//! ```
//!
//! S' depends on the bodies' factors and on which masters are far. While both stay, a major iteration only needs r' and u_f, and
//! its dense matrices have the size of the contact instead of the surface.

use crate::executor::Executor;
use crate::linalg::{DenseFactors, SolveError, subtract_product};

/// The far masters of an interface, and its stiffness without them. Matrices are stored column by column.
pub(super) struct FarMasters {
    /// Whether each unknown of the interface is near, and its index among the near or the far ones.
    is_near: Vec<bool>,
    rank: Vec<usize>,
    /// The near and the far unknowns.
    near: Vec<usize>,
    far: Vec<usize>,
    /// Whether `stiffness` is that of the current factors.
    is_current: bool,
    dense: DenseFactors,
    /// S_ff, S_nf, and D.
    inner: Vec<f64>,
    forces: Vec<f64>,
    motions: Vec<f64>,
    /// S'.
    stiffness: Vec<f64>,
    /// S_ff⁻¹ r_f.
    rest: Vec<f64>,
}

impl FarMasters {
    /// For `count` unknowns, all of which are near.
    ///
    /// # Errors
    /// [`SolveError::OutOfMemory`].
    pub fn new(count: usize) -> Result<Self, SolveError> {
        let mut dense = DenseFactors::new(count, count)?;
        dense.resize(0);
        Ok(FarMasters {
            is_near: vec![true; count],
            rank: (0..count).collect(),
            near: (0..count).collect(),
            far: Vec::with_capacity(count),
            is_current: false,
            dense,
            inner: Vec::new(),
            forces: Vec::new(),
            motions: Vec::new(),
            stiffness: vec![0.0; count * count],
            rest: Vec::new(),
        })
    }

    /// Sets which unknowns are near; returns whether that changed.
    pub fn choose(&mut self, is_near: &[bool]) -> bool {
        if self.is_near == is_near {
            return false;
        }
        self.is_near.copy_from_slice(is_near);
        self.near.clear();
        self.far.clear();
        for (unknown, (&is_near, rank)) in is_near.iter().zip(&mut self.rank).enumerate() {
            let list = if is_near {
                &mut self.near
            } else {
                &mut self.far
            };
            *rank = list.len();
            list.push(unknown);
        }
        let (n, f) = (self.near.len(), self.far.len());
        for (block, size) in [
            (&mut self.stiffness, n * n),
            (&mut self.inner, f * f),
            (&mut self.forces, n * f),
            (&mut self.motions, f * n),
            (&mut self.rest, f),
        ] {
            block.clear();
            block.reserve_exact(size);
            block.resize(size, 0.0);
        }
        self.dense.resize(f);
        self.is_current = false;
        true
    }

    /// Number of near unknowns.
    pub fn size(&self) -> usize {
        self.near.len()
    }

    /// Index of an unknown among the near ones, if it is one.
    pub fn rank(&self, unknown: usize) -> Option<usize> {
        self.is_near[unknown].then(|| self.rank[unknown])
    }

    /// S'.
    pub fn stiffness(&self) -> &[f64] {
        &self.stiffness
    }

    /// Has S' computed from new factors.
    pub fn renew(&mut self) {
        self.is_current = false;
    }

    /// Computes S', unless it is current. `parts` are the condensed stiffnesses of the bodies, each with its unknowns. Returns an
    /// estimate of the norm of the scaled inverse of S_ff.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if S_ff is.
    pub fn eliminate<'a>(
        &mut self,
        parts: impl Iterator<Item = (&'a [usize], &'a [f64])>,
        executor: &dyn Executor,
    ) -> Result<f64, SolveError> {
        if !self.is_current {
            self.gather(parts);
            let (n, f) = (self.near.len(), self.far.len());
            self.dense.factor(&self.inner);
            self.dense.solve_with(executor, &mut self.motions)?;
            let (forces, motions) = ((&self.forces[..], n), (&self.motions[..], f));
            let stiffness = (&mut self.stiffness[..], n);
            subtract_product(executor, stiffness, forces, motions, [n, f, n]);
            self.is_current = true;
        }
        Ok(self.dense.inverse_norm())
    }

    /// Writes the blocks of S: S_fn to `motions`, S_nn to `stiffness`.
    fn gather<'a>(&mut self, parts: impl Iterator<Item = (&'a [usize], &'a [f64])>) {
        let (n, f) = (self.near.len(), self.far.len());
        for block in [
            &mut self.inner,
            &mut self.forces,
            &mut self.motions,
            &mut self.stiffness,
        ] {
            block.fill(0.0);
        }
        for (unknowns, schur) in parts {
            let columns = schur.chunks_exact(unknowns.len().max(1));
            for (&j, column) in unknowns.iter().zip(columns) {
                let k = self.rank[j];
                let (to_near, to_far) = match self.is_near[j] {
                    true => (
                        &mut self.stiffness[k * n..(k + 1) * n],
                        &mut self.motions[k * f..(k + 1) * f],
                    ),
                    false => (
                        &mut self.forces[k * n..(k + 1) * n],
                        &mut self.inner[k * f..(k + 1) * f],
                    ),
                };
                for (&i, value) in unknowns.iter().zip(column) {
                    match self.is_near[i] {
                        true => to_near[self.rank[i]] = *value,
                        false => to_far[self.rank[i]] = *value,
                    }
                }
            }
        }
    }

    /// r' of the forces on all unknowns.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if it is not finite.
    pub fn condense(&mut self, load: &[f64], out: &mut [f64]) -> Result<(), SolveError> {
        for (rest, &unknown) in self.rest.iter_mut().zip(&self.far) {
            *rest = load[unknown];
        }
        self.dense.solve(&mut self.rest)?;
        for (out, &unknown) in out.iter_mut().zip(&self.near) {
            *out = load[unknown];
        }
        let columns = self.forces.chunks_exact(self.near.len().max(1));
        for (column, rest) in columns.zip(&self.rest) {
            for (out, force) in out.iter_mut().zip(column) {
                *out -= force * rest;
            }
        }
        Ok(())
    }

    /// The displacements of all unknowns, given those of the near ones.
    pub fn recover(&self, near: &[f64], all: &mut [f64]) {
        for (&unknown, moved) in self.near.iter().zip(near) {
            all[unknown] = *moved;
        }
        for (&unknown, rest) in self.far.iter().zip(&self.rest) {
            all[unknown] = *rest;
        }
        let columns = self.motions.chunks_exact(self.far.len().max(1));
        for (column, moved) in columns.zip(near) {
            for (&unknown, motion) in self.far.iter().zip(column) {
                all[unknown] -= motion * moved;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::executor::SequentialExecutor;
    use nalgebra::{DMatrix, DVector};

    /// Two bodies with 7 and 5 unknowns, which alternate, and stiffnesses with large entries off the diagonal.
    fn bodies() -> [(Vec<usize>, DMatrix<f64>); 2] {
        [7, 5].map(|count| {
            let entry = |i: usize, j: usize| (1.3 * (i * j + i + j) as f64).sin();
            let stiffness = DMatrix::from_fn(count, count, |i, j| match i == j {
                true => 5.0 + i as f64,
                false => entry(i, j),
            });
            let unknowns = (0..12).filter(|k| (k % 12 < 10 && k % 2 == 1) == (count == 5));
            (unknowns.collect(), stiffness)
        })
    }

    #[test]
    fn what_is_eliminated_moves_as_in_the_whole_system_however_the_choice_changes() {
        let bodies = bodies();
        let mut whole = DMatrix::zeros(12, 12);
        for (unknowns, stiffness) in &bodies {
            for (i, &row) in unknowns.iter().enumerate() {
                for (j, &column) in unknowns.iter().enumerate() {
                    whole[(row, column)] = stiffness[(i, j)];
                }
            }
        }
        let load = DVector::from_fn(12, |i, _| (0.7 * i as f64).cos());
        let exact = whole.lu().solve(&load).unwrap();
        let mut masters = FarMasters::new(12).unwrap();
        let choices: [&[usize]; 4] = [&[], &[0, 3, 4, 11], &[1, 2, 3], &[0, 1, 2, 5, 7, 9, 10]];
        for far in choices {
            let is_near: Vec<bool> = (0..12).map(|k| !far.contains(&k)).collect();
            assert_eq!(masters.choose(&is_near), !far.is_empty());
            assert!(!masters.choose(&is_near), "the same choice");
            let parts = bodies.iter();
            let parts = parts.map(|(unknowns, stiffness)| (&unknowns[..], stiffness.as_slice()));
            let norm = masters.eliminate(parts, &SequentialExecutor).unwrap();
            assert!(norm < 1e3, "{norm}");
            let n = 12 - far.len();
            let mut reduced = vec![0.0; n];
            masters.condense(load.as_slice(), &mut reduced).unwrap();
            let stiffness = DMatrix::from_column_slice(n, n, masters.stiffness());
            let near = stiffness.lu().solve(&DVector::from_vec(reduced)).unwrap();
            let mut all = [0.0; 12];
            masters.recover(near.as_slice(), &mut all);
            let error = (DVector::from_row_slice(&all) - &exact).amax();
            assert!(error < 1e-12, "{far:?}: {error}");
        }
    }

    #[test]
    fn far_masters_that_nothing_holds_are_an_error_or_have_a_large_norm() {
        let stiffness = [1.0, -1.0, 0.0, -1.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let mut masters = FarMasters::new(3).unwrap();
        masters.choose(&[false, false, true]);
        let part = std::iter::once((&[0, 1, 2][..], &stiffness[..]));
        let norm = masters.eliminate(part, &SequentialExecutor);
        assert!(norm.is_err() || norm.is_ok_and(|norm| norm > 1e12));
    }
}
