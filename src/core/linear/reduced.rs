//! Minor iterations on the interface alone; the bodies are condensed to it once per major iteration (eqn 6).

use super::augmented::springs;
use super::source::{LinearisationPoint, SolveResult};
use super::system::{Layout, System};
use crate::interface::kinematics::through;
use crate::linalg::{Factors, SolveError};
use crate::plane::max_abs;
use crate::{InterfaceProblem, Model};

/// Estimated norm of the scaled inverse above which the interface's system is suspected to be singular. The limit is lower than
/// for the full system because the springs that support a loose body cost digits before they cancel.
const SUSPICIOUS: f64 = 1e9;

impl System {
    /// Solves for the interface alone, using its compliance, which is computed once per major iteration.
    pub(super) fn solve_condensed(
        &mut self,
        model: &Model,
        at: &LinearisationPoint<'_>,
    ) -> SolveResult {
        if !self.condensed.fresh {
            self.condensed.norm = match self.condense(model, at) {
                Ok(norm) => norm,
                Err(_) => return SolveResult::Not,
            };
            self.condensed.fresh = true;
        }
        self.condensed.clear();
        for s in 0..self.interfaces.len() {
            let rows = self.rows(s, at);
            let frame = self.frames[s];
            let prescribed = [0, 1].map(|k| self.interfaces[s].prescribed_along(k, &frame));
            for (k, row) in rows.iter().enumerate() {
                self.condensed.place_row(s, k, row, prescribed);
            }
        }
        let Ok(norm) = self.condensed.solve() else {
            return SolveResult::Not;
        };
        for (s, frame) in self.frames.iter().enumerate() {
            let prescribed = [0, 1].map(|k| self.interfaces[s].prescribed_along(k, frame));
            self.condensed.read(s, prescribed);
        }
        if at.along.is_some() {
            self.find_load_step();
        }
        if norm > SUSPICIOUS {
            return SolveResult::NearlySingular;
        }
        SolveResult::from_norm(self.condensed.norm)
    }

    /// The interface problem of the last linearisation for analysis, with tied nodes eliminated. Costs a condensation unless the
    /// minor iterations have already done it.
    ///
    /// # Errors
    /// [`SolveError`] if the bodies cannot be condensed.
    pub fn problem(
        &mut self,
        model: &Model,
        at: &LinearisationPoint<'_>,
    ) -> Result<InterfaceProblem, SolveError> {
        if !self.condensed.fresh {
            if self.estimate.condensed.bytes > self.estimate.budget {
                return Err(SolveError::OutOfMemory);
            }
            self.condensed.norm = self.condense(model, at)?;
            self.condensed.fresh = true;
        }
        let relation = self.condensed.relation.clone();
        let nodes = at.nodes(|slave| {
            let (interface, frame) = (&self.interfaces[slave], &self.frames[slave]);
            let prescribed = [0, 1].map(|k| interface.prescribed_along(k, frame));
            (self.kinematics(slave), prescribed)
        });
        let largest = max_abs(&relation.start);
        let problem = InterfaceProblem {
            nodes,
            force: if self.norms.scale > 0.0 {
                self.norms.scale
            } else {
                largest
            },
            length: model.length,
            spring: self.spring(model),
            settings: at.settings,
            relation,
        };
        // Tied nodes have no mode to choose, so they are eliminated.
        let tied = model.contacts.iter().any(|slave| slave.bond.is_tied());
        if !tied {
            return Ok(problem);
        }
        let contacts = 0..model.contacts.len();
        let keep: Vec<usize> = contacts
            .filter(|&s| !model.contacts[s].bond.is_tied())
            .collect();
        problem.reduced(&keep).ok_or(SolveError::Singular)
    }

    /// Condenses the bodies to the interface; returns an estimate of the norm of the inverse of the factored matrix.
    ///
    /// Bodies that [`Bodies`] cannot factor in this state are factored together with the interface, with pivoting.
    pub(super) fn condense(
        &mut self,
        model: &Model,
        at: &LinearisationPoint<'_>,
    ) -> Result<f64, SolveError> {
        self.condensed.resize(self.interfaces.len())?;
        self.frames.clear();
        let nodes = self.interfaces.iter().zip(at.contacts);
        self.frames.extend(nodes.map(|(i, node)| i.frame(node)));
        self.border.active = false;
        if self.layout == Some(Layout::Bodies) {
            self.condensed.relation.stiffness = self.spring(model);
            self.start_rhs();
            self.done.factorizations += u64::from(!self.is_factored);
            let stands = std::mem::take(&mut self.is_factored);
            if let Some(bodies) = &mut self.bodies
                && let Ok(norm) = bodies.condense(
                    stands,
                    &self.stiffness,
                    &self.rhs,
                    &self.interfaces,
                    &self.frames,
                    &mut self.condensed.relation,
                )
            {
                self.is_factored = true;
                return Ok(norm);
            }
            self.linearise_in(Layout::Whole, model, at)?;
            self.turn(model, at);
        }
        self.condensed.relation.stiffness = self.spring(model);
        self.condense_whole(model, at)
    }

    /// Condenses with every interface equation replaced by `motion − ΔF / stiffness = z`; the forces are then a linear function
    /// of z, computed column by column. If a bond has a compliance, the motion is that of its touching point
    /// ([`crate::interface::kinematics`]).
    pub(super) fn condense_whole(
        &mut self,
        model: &Model,
        at: &LinearisationPoint<'_>,
    ) -> Result<f64, SolveError> {
        self.scale(model, at);
        self.start_values();
        let unknowns = model.dofs.equations;
        let give = -1.0 / self.condensed.relation.stiffness;
        for s in 0..self.interfaces.len() {
            for (k, row) in springs(give).iter().enumerate() {
                let row = through(*row, self.interfaces[s].give());
                self.place_row(s, k, &row, self.frames[s]);
                self.rhs[unknowns + 2 * s + k] = 0.0;
            }
        }
        let Some(factors) = &mut self.whole else {
            return Err(SolveError::Singular);
        };
        self.done.factorizations += 1;
        factors.factor(&self.values)?;
        factors.solve(&self.rhs, &mut self.x)?;
        let norm = factors.inverse_norm();
        self.condensed
            .relation
            .start
            .copy_from_slice(&self.x[unknowns..]);
        self.border.active = at.along.is_some();
        if let Some(along) = &at.along {
            self.lay_border(model, at, along);
            self.begin_border(along);
        }
        let Some(factors) = &mut self.whole else {
            return Err(SolveError::Singular);
        };
        let (count, size) = (2 * self.interfaces.len(), self.x.len());
        for first in (0..count).step_by(Factors::BLOCK) {
            let columns = first..count.min(first + Factors::BLOCK);
            self.block.clear();
            self.block.resize(size * columns.len(), 0.0);
            for (column, k) in self.block.chunks_exact_mut(size).zip(columns.clone()) {
                column[unknowns + k] = 1.0;
            }
            factors.solve_block(&mut self.block)?;
            let response = &mut self.condensed.relation.response[first * count..];
            for (to, column) in response
                .chunks_exact_mut(count)
                .zip(self.block.chunks_exact(size))
            {
                to.copy_from_slice(&column[unknowns..]);
                if at.along.is_some() {
                    self.border.extend(column);
                }
            }
        }
        if at.along.is_some() {
            self.close_border(model)?;
            return self.bordered_norm(norm);
        }
        Ok(norm)
    }

    /// Stiffness of the springs. A stiffness k times larger or smaller loses a corresponding number of digits when the springs
    /// cancel, so this one is the geometric mean of the stiffest degree of freedom of the interface and the softest body as a
    /// whole.
    pub fn spring(&self, model: &Model) -> f64 {
        let Some(pattern) = self.pattern() else {
            return 1.0;
        };
        let diagonal = |e: usize| pattern.slot(e, e).map_or(0.0, |k| self.stiffness[k].abs());
        let slaves = self
            .interfaces
            .iter()
            .flat_map(|i| &i.links)
            .filter_map(|l| model.dofs.equation[l.dof]);
        let stiffest = slaves.map(diagonal).fold(0.0, f64::max);
        if stiffest > 0.0 {
            (stiffest * self.sizes.softest).sqrt()
        } else {
            self.sizes.softest
        }
    }

    /// Completes a solve by computing the displacements of the bodies. Costs one back substitution if the bodies were condensed,
    /// otherwise nothing.
    pub fn recover(&mut self, model: &Model) -> SolveResult {
        if !self.condensed.fresh {
            return SolveResult::Well;
        }
        if self.border.active {
            return match self.recover_bordered() {
                Ok(()) => SolveResult::Well,
                Err(_) => SolveResult::Not,
            };
        }
        let done = match (self.layout, &mut self.bodies, &mut self.whole) {
            (Some(Layout::Bodies), Some(bodies), _) => {
                let (interfaces, frames) = (&self.interfaces, &self.frames);
                bodies.recover(&self.condensed.gaps, interfaces, frames, &mut self.x)
            }
            (_, _, Some(factors)) => {
                self.rhs[model.dofs.equations..].copy_from_slice(&self.condensed.gaps);
                factors.solve(&self.rhs, &mut self.x)
            }
            _ => Err(SolveError::Singular),
        };
        match done {
            Ok(()) => SolveResult::Well,
            Err(_) => SolveResult::Not,
        }
    }
}
