//! Borders the interface's relation with the load factor as an additional unknown and one additional equation.
//!
//! Let dλ be the change of the load factor, c · Δu = s a constraint on the displacements (Riks 1979: the plane normal to the
//! tangent; or one displacement, or the slip of one node), q the derivative of the out-of-balance force with respect to λ, and
//! all else as in [`super::condensed`]:
//!
//! ```text
//! x = x0 + X z + dλ x1,    c · x = s      ⇒    dλ = a0 + a · z,    a = −Xᵀ c / (c · x1),   a0 = (s − c · x0) / (c · x1)
//! ΔF = start + response z + dλ f1         =    (start + a0 f1) + (response + f1 aᵀ) z,
//! ```
//!
//! where x1 and f1 are the response to q (a second right-hand side with the same factors). The minor iterations, all strategies
//! and all searches thus see an ordinary interface problem whose response has a rank-one change. If prescribed displacements move
//! the interface with the load factor by p, z contains the springs' gaps plus dλ p, and the effect of p is subtracted from f1 and
//! x1.
//!
//! A limit point due to the modes of contacts is not a singular point of this relation, because springs support the contacts when
//! the bodies are factored. At a limit point of the bodies themselves, x0, X and x1 are large but their sum is not. Therefore the
//! check is whether the bordered inverse is bounded ([`System::bordered_norm`]), not that of the bodies.

use super::source::{LinearisationPoint, LoadEquation};
use super::system::System;
use crate::Model;
use crate::linalg::SolveError;
use crate::plane::{dot, max_abs};

/// A border is singular if its pivot is below this fraction of its terms.
const NO_PIVOT: f64 = 1e-13;
/// Norm of the scaled inverse below which the bodies on their springs are regular, regardless of the border.
const ORDINARY: f64 = 1e6;

impl System {
    /// Computes c, q and p at the last linearisation.
    pub(super) fn lay_border(
        &mut self,
        model: &Model,
        at: &LinearisationPoint<'_>,
        along: &LoadEquation<'_>,
    ) {
        self.find_rates(model, at);
        let border = &mut self.border;
        border.row.clear();
        border.row.resize(model.dofs.equations, 0.0);
        border.given = [0.0; 2];
        let mut add = |dof: usize, weight: f64| match model.dofs.equation[dof] {
            Some(equation) => border.row[equation] += weight,
            None => {
                border.given[0] += weight * self.step[dof];
                border.given[1] += weight * border.rates[dof];
            }
        };
        match along {
            LoadEquation::Load { .. } => border.given[1] = 1.0,
            LoadEquation::Displacements { row, .. } => {
                let weights = row.iter().enumerate().filter(|(_, weight)| **weight != 0.0);
                weights.for_each(|(dof, &weight)| add(dof, weight));
            }
            LoadEquation::Dof { dof, .. } => add(*dof, 1.0),
            LoadEquation::Slip { contact, .. } => {
                let frame = self.frames[*contact];
                let interface = &self.interfaces[*contact];
                for (i, link) in interface.links.iter().enumerate() {
                    add(link.dof, interface.row(i, 1, &frame));
                }
            }
        }
    }

    /// Computes q and the rates of prescribed displacements with respect to the load factor.
    fn find_rates(&mut self, model: &Model, at: &LinearisationPoint<'_>) {
        let border = &mut self.border;
        border.rates.clear();
        border.rates.resize(model.dofs.len(), 0.0);
        border.rate.clear();
        border.rate.resize(model.dofs.equations, 0.0);
        border.carried.clear();
        border.carried.resize(self.interfaces.len(), [0.0; 2]);
        for load in &model.loads {
            if let Some(equation) = model.dofs.equation[load.dof] {
                border.rate[equation] += load.value * load.scale.slope(at.target);
            }
        }
        let rate = |k: usize| model.pressure_rate(k, at.target);
        self.pressures.each(at.u, rate, |dof, part| {
            if let Some(equation) = model.dofs.equation[dof] {
                border.rate[equation] += part;
            }
        });
        if model.prescribed.is_empty() {
            return;
        }
        for p in &model.prescribed {
            border.rates[p.dof] = p.value * p.scale.slope(at.target);
        }
        for (s, interface) in self.interfaces.iter().enumerate() {
            let mut motion = [0.0; 2];
            for link in &interface.links {
                motion[link.axis] += link.weight * border.rates[link.dof];
            }
            border.carried[s] = self.frames[s].map(|direction| dot(direction, motion));
            if let Some(point) = interface.point.first() {
                let links = || interface.links.iter().enumerate();
                border.carried[s] = [0, 1].map(|k| {
                    let parts = links().map(|(i, l)| point.rows[k][i] * border.rates[l.dof]);
                    parts.sum()
                });
            }
        }
        self.couple_rates(model, at);
    }

    /// Subtracts from q the effect of prescribed displacements through the stiffness: the coupling of the linearisation, with
    /// rates instead of steps.
    fn couple_rates(&mut self, model: &Model, at: &LinearisationPoint<'_>) {
        let kept = [
            self.stiffness.clone(),
            self.force.clone(),
            self.size.clone(),
            self.coupling.clone(),
        ];
        std::mem::swap(&mut self.step, &mut self.border.rates);
        self.assemble(model, at);
        self.turn(model, at);
        std::mem::swap(&mut self.step, &mut self.border.rates);
        for (rate, coupling) in self.border.rate.iter_mut().zip(&self.coupling) {
            *rate -= coupling;
        }
        [self.stiffness, self.force, self.size, self.coupling] = kept;
    }

    /// Records the contribution to the constraint of the displacements for z = 0, which have just been computed.
    pub(super) fn begin_border(&mut self, along: &LoadEquation<'_>) {
        let border = &mut self.border;
        let found = border.row.iter().zip(&self.x).map(|(c, x)| c * x);
        border.start = along.step() - border.given[0] - found.sum::<f64>();
        border.share.clear();
    }

    /// Computes x1 and f1, and eliminates dλ from the relation.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if the constraint does not determine the load factor.
    pub(super) fn close_border(&mut self, model: &Model) -> Result<(), SolveError> {
        let unknowns = model.dofs.equations;
        let Some(factors) = &mut self.whole else {
            return Err(SolveError::Singular);
        };
        let border = &mut self.border;
        border.rhs.clear();
        border.rhs.extend(&border.rate);
        border
            .rhs
            .extend(border.carried.iter().flatten().map(|p| -p));
        border.moved.clear();
        border.moved.resize(self.x.len(), 0.0);
        factors.solve(&border.rhs, &mut border.moved)?;
        let terms = border.row.iter().zip(&border.moved).map(|(c, x)| c * x);
        let (sum, size) = terms.fold(
            (border.given[1], border.given[1].abs()),
            |(sum, size), t| (sum + t, size + t.abs()),
        );
        if !sum.is_finite() || sum.abs() <= NO_PIVOT * size {
            return Err(SolveError::Singular);
        }
        border.start /= sum;
        border.share.iter_mut().for_each(|share| *share /= -sum);
        let relation = &mut self.condensed.relation;
        let forces = &border.moved[unknowns..];
        for (start, f) in relation.start.iter_mut().zip(forces) {
            *start += border.start * f;
        }
        let columns = relation.response.chunks_exact_mut(forces.len().max(1));
        for (column, a) in columns.zip(&border.share) {
            for (entry, f) in column.iter_mut().zip(forces) {
                *entry += a * f;
            }
        }
        Ok(())
    }

    /// dλ of the last solve for z.
    pub(super) fn find_load_step(&mut self) {
        let border = &mut self.border;
        let parts = border.share.iter().zip(&self.condensed.gaps);
        border.load_step = border.start + parts.map(|(a, z)| a * z).sum::<f64>();
    }

    /// Completes a solve: computes the displacements for z and dλ.
    ///
    /// # Errors
    /// [`SolveError`] of the solve.
    pub(super) fn recover_bordered(&mut self) -> Result<(), SolveError> {
        let Some(factors) = &mut self.whole else {
            return Err(SolveError::Singular);
        };
        let border = &mut self.border;
        let step = border.load_step;
        border.rhs.clear();
        let balance = self.rhs.iter().zip(&border.rate);
        border
            .rhs
            .extend(balance.map(|(rhs, rate)| rhs + step * rate));
        let carried = border.carried.iter().flatten();
        let gaps = self.condensed.gaps.iter().zip(carried);
        border.rhs.extend(gaps.map(|(z, p)| z - step * p));
        factors.solve(&border.rhs, &mut self.x)?;
        for (moved, rate) in self.step.iter_mut().zip(&border.rates) {
            *moved += step * rate;
        }
        Ok(())
    }

    /// Estimated norm of the bordered inverse, given the `norm` for the bodies on their springs. A fixed vector is solved for,
    /// and the norm is scaled by the border's reduction of the solution.
    pub(super) fn bordered_norm(&mut self, norm: f64) -> Result<f64, SolveError> {
        let Some(factors) = self.whole.as_mut().filter(|_| norm > ORDINARY) else {
            return Ok(norm);
        };
        let border = &mut self.border;
        let probe = |k: usize| 1.0 + (0.618_033_988_749_895 * k as f64).fract();
        for (k, rhs) in border.rhs.iter_mut().enumerate() {
            *rhs = probe(k);
        }
        factors.solve(&border.rhs, &mut self.x)?;
        let largest = |x: &[f64]| max_abs(x);
        let plain = largest(&self.x);
        let product = |x: &[f64]| border.row.iter().zip(x).map(|(c, x)| c * x).sum::<f64>();
        let step = -product(&self.x) / (product(&border.moved) + border.given[1]);
        for (x, moved) in self.x.iter_mut().zip(&border.moved) {
            *x += step * moved;
        }
        Ok(norm * largest(&self.x) / plain)
    }
}
