//! Linear bodies given by a matrix about the undeformed state.
//!
//! ```text
//! stiffness:   f = K u
//! compliance:  f = y,   u − W y = free λ
//! ```
//!
//! W may be singular, so its forces y are unknowns in addition to the displacements. The right-hand side `free λ` is a load on
//! their equations.

use crate::ElementOutput;
use crate::linalg::Pattern;
use crate::model::{Body, Dofs, Form, Linear};

/// Index of an entry that is not in the system because it is restrained.
pub(super) const NOWHERE: u32 = u32::MAX;

/// The matrix, in degrees of freedom of the scene.
pub struct MatrixElement {
    /// Degree of freedom of each row, and the end of its entries; they start at the end of the previous row.
    rows: Vec<(usize, usize)>,
    /// Degree of freedom of each entry's column.
    columns: Vec<usize>,
    values: Vec<f64>,
    /// Index of each entry in the array of values.
    slots: Vec<u32>,
}

impl MatrixElement {
    /// The matrix of a body of the scene.
    pub fn new(dofs: &Dofs, body: &Body, linear: &Linear) -> Self {
        let place = |k: usize| dofs.first[body.nodes[k / 2]] + k % 2;
        let mut element = MatrixElement {
            rows: Vec::new(),
            columns: Vec::new(),
            values: Vec::new(),
            slots: Vec::new(),
        };
        match linear.form {
            Form::Stiffness => {
                for row in linear.entries.chunk_by(|a, b| a.0 == b.0) {
                    let entries = row.iter().map(|&(_, j, value)| (place(j), value));
                    element.add_row(place(row[0].0), entries);
                }
            }
            Form::Compliance { first_force } => {
                for k in 0..2 * body.nodes.len() {
                    element.add_row(place(k), std::iter::once((first_force + k, 1.0)));
                }
                for row in linear.entries.chunk_by(|a, b| a.0 == b.0) {
                    let k = row[0].0;
                    let forces = row.iter().map(|&(_, j, value)| (first_force + j, -value));
                    let entries = std::iter::once((place(k), 1.0)).chain(forces);
                    element.add_row(first_force + k, entries);
                }
            }
        }
        element
    }

    fn add_row(&mut self, dof: usize, entries: impl Iterator<Item = (usize, f64)>) {
        for (column, value) in entries {
            self.columns.push(column);
            self.values.push(value);
        }
        self.rows.push((dof, self.columns.len()));
    }

    /// Row, in degrees of freedom, and range of entries of each row.
    fn ranges(&self) -> impl Iterator<Item = (usize, std::ops::Range<usize>)> + Clone + '_ {
        let starts = std::iter::once(0).chain(self.rows.iter().map(|row| row.1));
        let rows = self.rows.iter().zip(starts);
        rows.map(|(&(dof, end), start)| (dof, start..end))
    }

    /// Entries `(row, column)` in equations.
    pub fn entries<'a>(
        &'a self,
        dofs: &'a Dofs,
    ) -> impl Iterator<Item = (usize, usize)> + Clone + 'a {
        self.ranges().flat_map(move |(dof, range)| {
            let row = dofs.equation[dof];
            let columns = self.columns[range].iter();
            columns.filter_map(move |&column| Some((row?, dofs.equation[column]?)))
        })
    }

    /// Looks up every entry in a pattern that contains them all.
    pub fn bind(&mut self, dofs: &Dofs, pattern: &Pattern) {
        let mut slots = Vec::with_capacity(self.columns.len());
        for (dof, range) in self.ranges() {
            for &column in &self.columns[range] {
                let slot = dofs.equation[dof]
                    .zip(dofs.equation[column])
                    .and_then(|(i, j)| pattern.slot(i, j))
                    .and_then(|slot| u32::try_from(slot).ok());
                slots.push(slot.unwrap_or(NOWHERE));
            }
        }
        self.slots = slots;
    }

    /// Adds forces at displacements `u`.
    pub fn resist(&self, u: &[f64], force: &mut [f64], size: &mut [f64]) {
        for (dof, range) in self.ranges() {
            let own: f64 = range.map(|k| self.values[k] * u[self.columns[k]]).sum();
            force[dof] += own;
            size[dof] += own.abs();
        }
    }

    /// Adds the effect of `step` of the restrained degrees of freedom.
    pub fn couple(&self, dofs: &Dofs, step: &[f64], coupling: &mut [f64]) {
        for (dof, range) in self.ranges() {
            let Some(row) = dofs.equation[dof] else {
                continue;
            };
            for k in range {
                let column = self.columns[k];
                if self.slots[k] == NOWHERE && dofs.equation[column].is_none() {
                    coupling[row] += self.values[k] * step[column];
                }
            }
        }
    }

    /// Adds forces at displacements `u`, the matrix, and the effect of `step` of the restrained degrees of freedom.
    pub fn add(&self, dofs: &Dofs, u: &[f64], step: &[f64], out: &mut ElementOutput<'_>) {
        for (dof, range) in self.ranges() {
            let mut force = 0.0;
            for k in range {
                let (column, value) = (self.columns[k], self.values[k]);
                force += value * u[column];
                if self.slots[k] != NOWHERE {
                    out.values[self.slots[k] as usize] += value;
                } else if let (Some(row), None) = (dofs.equation[dof], dofs.equation[column]) {
                    out.coupling[row] += value * step[column];
                }
            }
            out.force[dof] += force;
            out.size[dof] += force.abs();
        }
    }
}
