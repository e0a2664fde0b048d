//! The condensed interface (eqn 6), as the minor iterations use it.
//!
//! With springs of stiffness k between every slave node and its S*, the interface forces depend on the gaps z imposed on the
//! springs by `ΔF = start + response z`, and the relative motion is `v = z + ΔF / k`. Table 1's equations in v and ΔF then form a
//! dense system for z with two unknowns per slave node, independent of the size of the bodies. If k is infinite, z is the motion
//! itself: motions prescribed by Table 1 are known, and only the other motions are unknowns.

use crate::linalg::{DenseFactors, SolveError};
use crate::{Equation, InterfaceResponse, RelativeMotion};

/// The condensed interface of a major iteration, and the result of the last minor iteration.
#[derive(Default)]
pub struct CondensedSystem {
    /// Whether `relation` belongs to the current linearisation.
    pub fresh: bool,
    /// Estimated norm of the inverse of the factored matrices.
    pub norm: f64,
    /// Relation between forces and motions.
    pub relation: InterfaceResponse,
    /// Table 1's equations in z, in column-major order.
    matrix: Vec<f64>,
    /// Their right-hand sides.
    rhs: Vec<f64>,
    /// For rigid springs: the force equations with their slave nodes, and the indices of the unknown motions.
    rows: Vec<(usize, Equation)>,
    unknown: Vec<usize>,
    /// ΔF of the last minor iteration.
    answer: Vec<f64>,
    /// z of the last minor iteration.
    pub gaps: Vec<f64>,
    dense: Option<DenseFactors>,
    /// ΔF_n, ΔF_t of each slave node in the last minor iteration.
    pub forces: Vec<[f64; 2]>,
    /// Normal and tangential relative motion of each slave node in the last minor iteration, including prescribed motion.
    pub motions: Vec<[f64; 2]>,
}

impl CondensedSystem {
    /// Allocates results for this many slave nodes; the condensed matrices are allocated on demand.
    pub fn new(slaves: usize) -> Self {
        CondensedSystem {
            relation: InterfaceResponse {
                stiffness: 1.0,
                ..InterfaceResponse::default()
            },
            forces: vec![[0.0; 2]; slaves],
            motions: vec![[0.0; 2]; slaves],
            ..Self::default()
        }
    }

    /// Allocates the condensed matrices.
    ///
    /// # Errors
    /// [`SolveError::OutOfMemory`].
    pub fn resize(&mut self, slaves: usize) -> Result<(), SolveError> {
        let count = 2 * slaves;
        if self.dense.is_some() {
            return Ok(());
        }
        let vectors = [&mut self.relation.start, &mut self.rhs, &mut self.gaps];
        for vector in vectors.into_iter().chain([&mut self.answer]) {
            vector.resize(count, 0.0);
        }
        self.rows.reserve(count);
        self.unknown.reserve(count);
        for matrix in [&mut self.relation.response, &mut self.matrix] {
            // Memory that is not written yet costs nothing.
            *matrix = vec![0.0; count * count];
        }
        self.dense = Some(DenseFactors::new(count, 1)?);
        Ok(())
    }

    /// Whether z is the motion itself.
    fn is_rigid(&self) -> bool {
        self.relation.stiffness.is_infinite()
    }

    /// Removes all equations.
    pub fn clear(&mut self) {
        self.rows.clear();
        self.unknown.clear();
    }

    /// Sets equation k (0 normal, 1 tangential) of a slave node; see [`InterfaceResponse::place_row`].
    pub fn place_row(&mut self, slave: usize, k: usize, row: &Equation, prescribed: [f64; 2]) {
        if !self.is_rigid() {
            let (relation, matrix) = (&self.relation, &mut self.matrix);
            self.rhs[2 * slave + k] = relation.place_row(slave, k, row, prescribed, matrix);
            return;
        }
        // A motion equation belongs to the component with the same index.
        if row.motion == RelativeMotion::None {
            self.rows.push((slave, *row));
            self.unknown.push(2 * slave + k);
            self.gaps[2 * slave + k] = 0.0;
        } else {
            self.gaps[2 * slave + k] = row.value - prescribed[k];
        }
    }

    /// Solves the equations for z; returns an estimate of the norm of their matrix's inverse.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if they have no solution.
    pub fn solve(&mut self) -> Result<f64, SolveError> {
        if self.is_rigid() {
            return self.solve_motions();
        }
        self.gaps.copy_from_slice(&self.rhs);
        let Some(dense) = &mut self.dense else {
            return Err(SolveError::Singular);
        };
        dense.resize(self.rhs.len());
        dense.factor(&self.matrix);
        dense.solve(&mut self.gaps)?;
        Ok(dense.inverse_norm())
    }

    /// The same if z is the motion itself.
    fn solve_motions(&mut self) -> Result<f64, SolveError> {
        let (count, size) = (self.gaps.len(), self.unknown.len());
        self.answer.copy_from_slice(&self.relation.start);
        self.add_response(|_| true);
        for (rhs, (slave, row)) in self.rhs.iter_mut().zip(&self.rows) {
            let [normal, tangential] = [self.answer[2 * slave], self.answer[2 * slave + 1]];
            *rhs = row.value - row.d_n * normal - row.d_t * tangential;
        }
        for (column, &j) in self.matrix.chunks_exact_mut(size.max(1)).zip(&self.unknown) {
            let response = &self.relation.response[j * count..(j + 1) * count];
            for (entry, (slave, row)) in column.iter_mut().zip(&self.rows) {
                *entry = row.d_n * response[2 * slave] + row.d_t * response[2 * slave + 1];
            }
        }
        let Some(dense) = self.dense.as_mut().filter(|_| size > 0) else {
            return Ok(1.0);
        };
        dense.resize(size);
        dense.factor(&self.matrix[..size * size]);
        dense.solve(&mut self.rhs[..size])?;
        let norm = dense.inverse_norm();
        for (&j, &z) in self.unknown.iter().zip(&self.rhs) {
            self.gaps[j] = z;
        }
        let unknown = std::mem::take(&mut self.unknown);
        self.add_response(|j| unknown.binary_search(&j).is_ok());
        self.unknown = unknown;
        Ok(norm)
    }

    /// Adds the contribution of the motions with these indices to the forces.
    fn add_response(&mut self, wanted: impl Fn(usize) -> bool) {
        let columns = self.relation.response.chunks_exact(self.gaps.len().max(1));
        for (j, (column, &z)) in columns.zip(&self.gaps).enumerate() {
            if z != 0.0 && wanted(j) {
                for (answer, response) in self.answer.iter_mut().zip(column) {
                    *answer += response * z;
                }
            }
        }
    }

    /// Computes a slave node's force and motion from the solution z.
    pub fn read(&mut self, slave: usize, prescribed: [f64; 2]) {
        if self.is_rigid() {
            let here = [2 * slave, 2 * slave + 1];
            self.forces[slave] = here.map(|k| self.answer[k]);
            self.motions[slave] = [0, 1].map(|k| self.gaps[here[k]] + prescribed[k]);
            return;
        }
        [self.forces[slave], self.motions[slave]] =
            self.relation.answer(&self.gaps, slave, prescribed);
    }
}
