//! An element with its positions in the system: gathers its displacements, and adds its forces and its tangent.

use super::element::{Element, Previous};
use super::matrix::NOWHERE;
use crate::ElementOutput;
use crate::linalg::Pattern;
use crate::model::Dofs;
use std::ops::Range;

/// An element with its positions in the system.
pub(super) struct AssembledElement {
    pub(super) element: Box<dyn Element>,
    /// Degrees of freedom of the scene, in the element's order.
    pub(super) dofs: Vec<usize>,
    /// Where the entries of the element's matrix, or of its upper half, are in the array of values, row by row; [`NOWHERE`]
    /// without an equation.
    pub(super) slots: Vec<u32>,
    /// Whether any of its degrees of freedom has no equation.
    pub(super) held: bool,
    /// Its range of the scene's history variables.
    pub(super) history: Range<usize>,
}

/// Start indices of degrees of freedom, entries of the stiffness, and equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct ScatterMap {
    pub(super) dof: usize,
    pub(super) slot: usize,
    pub(super) equation: usize,
}

/// Sums, from given start indices on.
pub(super) struct AssemblySums<'a> {
    pub(super) first: ScatterMap,
    pub(super) out: ElementOutput<'a>,
}

/// Displacements for an assembly.
#[derive(Debug, Clone, Copy)]
pub struct AssemblyMotion<'a> {
    /// Displacements.
    pub u: &'a [f64],
    /// Remaining change of the degrees of freedom without an equation in this major iteration.
    pub step: &'a [f64],
    /// Displacements at the last accepted increment.
    pub before: &'a [f64],
    /// History variables at that increment: [`super::assembly::history_len`] numbers, all zero before the first.
    pub history: &'a [f64],
}

impl AssembledElement {
    pub(super) fn bind(&mut self, dofs: &Dofs, pattern: &Pattern, half: bool) {
        let equation = |d: &usize| dofs.equation[*d];
        self.held = self.dofs.iter().any(|d| equation(d).is_none());
        self.slots.clear();
        for (i, row) in self.dofs.iter().enumerate() {
            // For the upper half, each pair once, regardless of which entry the pattern contains.
            let first = if half { i } else { 0 };
            for column in &self.dofs[first..] {
                let slot = match (equation(row), equation(column)) {
                    (Some(row), Some(column)) if half => {
                        pattern.slot(row.min(column), row.max(column))
                    }
                    (Some(row), Some(column)) => pattern.slot(row, column),
                    _ => None,
                };
                let slot = slot.and_then(|slot| u32::try_from(slot).ok());
                self.slots.push(slot.unwrap_or(NOWHERE));
            }
        }
    }

    /// Gathers the element's displacements, and its data at the last accepted increment.
    pub(super) fn gather_all<'a>(
        &self,
        moved: &AssemblyMotion<'a>,
        u: &mut [f64],
        before: &'a mut [f64],
    ) -> Previous<'a> {
        self.gather(moved.u, u);
        let history = &moved.history[self.history.clone()];
        if !history.is_empty() {
            self.gather(moved.before, before);
        }
        Previous { u: before, history }
    }

    pub(super) fn gather(&self, from: &[f64], to: &mut [f64]) {
        for (to, &d) in to.iter_mut().zip(&self.dofs) {
            *to = from[d];
        }
    }

    /// The range of its degrees of freedom.
    pub(super) fn span(&self) -> Range<usize> {
        let start = self.dofs.iter().min().map_or(0, |least| *least);
        start..self.dofs.iter().max().map_or(0, |most| most + 1)
    }

    pub(super) fn add_forces(&self, force: &[f64], sums: &mut AssemblySums<'_>) {
        let (first, out) = (sums.first, &mut sums.out);
        for (&d, force) in self.dofs.iter().zip(force) {
            out.force[d - first.dof] += force;
            out.size[d - first.dof] += force.abs();
        }
    }

    /// Adds the tangent.
    pub(super) fn scatter(&self, tangent: &[f64], sums: &mut AssemblySums<'_>) {
        let (first, out) = (sums.first, &mut sums.out);
        let n = self.dofs.len();
        let is_half = self.slots.len() < n * n;
        let mut slots = self.slots.iter();
        for (i, row) in tangent.chunks_exact(n).take(n).enumerate() {
            let row = &row[if is_half { i } else { 0 }..];
            for (value, &slot) in row.iter().zip(slots.by_ref()) {
                if slot != NOWHERE {
                    out.values[slot as usize - first.slot] += value;
                }
            }
        }
    }

    /// Forces due to the steps of degrees of freedom without an equation, by equation from `first` on.
    pub(super) fn couple(
        &self,
        dofs: &Dofs,
        tangent: &[f64],
        step: &[f64],
        coupling: &mut [f64],
        first: usize,
    ) {
        for (row, &d) in tangent.chunks_exact(self.dofs.len()).zip(&self.dofs) {
            let Some(equation) = dofs.equation[d] else {
                continue;
            };
            for (value, &other) in row.iter().zip(&self.dofs) {
                if dofs.equation[other].is_none() {
                    coupling[equation - first] += value * step[other];
                }
            }
        }
    }

    /// Sets infinite forces, which no finite force balances. The force scale stays finite, so that the residual is infinite too.
    pub(super) fn give_up(&self, sums: &mut AssemblySums<'_>) {
        let (first, force) = (sums.first.dof, &mut *sums.out.force);
        self.dofs
            .iter()
            .for_each(|&d| force[d - first] = f64::INFINITY);
    }
}

impl AssemblySums<'_> {
    pub(super) fn reborrow(&mut self) -> AssemblySums<'_> {
        AssemblySums {
            first: self.first,
            out: ElementOutput {
                force: &mut *self.out.force,
                size: &mut *self.out.size,
                values: &mut *self.out.values,
                coupling: &mut *self.out.coupling,
            },
        }
    }

    pub(super) fn clear(&mut self) {
        let out = &mut self.out;
        for sums in [&mut *out.force, out.size, out.values, out.coupling] {
            sums.fill(0.0);
        }
    }

    /// Splits the sums at given start indices. Without tangents, entries and coupling are empty.
    pub(super) fn split_at(&mut self, at: ScatterMap) -> (AssemblySums<'_>, AssemblySums<'_>) {
        let first = self.first;
        let out = &mut self.out;
        let force = out.force.split_at_mut(at.dof - first.dof);
        let size = out.size.split_at_mut(at.dof - first.dof);
        let values = (at.slot - first.slot).min(out.values.len());
        let values = out.values.split_at_mut(values);
        let coupling = (at.equation - first.equation).min(out.coupling.len());
        let coupling = out.coupling.split_at_mut(coupling);
        let sums = |first, force, size, values, coupling| AssemblySums {
            first,
            out: ElementOutput {
                force,
                size,
                values,
                coupling,
            },
        };
        (
            sums(first, force.0, size.0, values.0, coupling.0),
            sums(at, force.1, size.1, values.1, coupling.1),
        )
    }
}
