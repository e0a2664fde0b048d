//! The load factor as one more unknown, and one more equation: the interface's relation bordered.
//!
//! With the load factor's change dλ, one constraint c · Δu = s on the displacements (Riks 1979: the plane normal to the
//! tangent; or one displacement, or the slip of one node), q the change of the out-of-balance force by λ, and everything
//! else as in [`super::condensed`],
//!
//! ```text
//! x = x0 + X z + dλ x1,    c · x = s      ⇒    dλ = a0 + a · z,    a = −Xᵀ c / (c · x1),   a0 = (s − c · x0) / (c · x1)
//! ΔF = start + response z + dλ f1         =    (start + a0 f1) + (response + f1 aᵀ) z,
//! ```
//!
//! where x1 and f1 are what q does (a second right-hand side of the same factors). So the minor iterations, every strategy,
//! and every search see an interface problem as ever, whose response has changed by a matrix of rank one. Where prescribed
//! motions move the interface with the load factor by p, z stands for the springs' gaps and dλ p together, and f1 and x1 are
//! less by what p does.
//!
//! A limit point of the contacts' modes is no singular point of this relation, since the springs hold the contacts apart
//! when the bodies are factored. One of the bodies themselves makes x0, X and x1 large, and their sum not: what is asked
//! is whether the bordered inverse is bounded ([`System::bordered_norm`]), not that of the bodies.

use super::source::{Along, At};
use super::system::{System, dot};
use crate::linalg::SolveError;
use crate::model::{Factor, Model};

/// A border whose pivot is smaller than this part of its terms has none.
const NO_PIVOT: f64 = 1e-13;
/// Norm of the scaled inverse up to which the bodies on their springs are regular, whatever the border.
const ORDINARY: f64 = 1e6;

impl System {
    /// Finds c, q and p about the last linearisation.
    pub(super) fn lay_border(&mut self, model: &Model, at: &At<'_>, along: &Along<'_>) {
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
            Along::Load { .. } => border.given[1] = 1.0,
            Along::Displacements { row, .. } => {
                let weights = row.iter().enumerate().filter(|(_, weight)| **weight != 0.0);
                weights.for_each(|(dof, &weight)| add(dof, weight));
            }
            Along::Dof { dof, .. } => add(*dof, 1.0),
            Along::Slip { contact, .. } => {
                let frame = self.frames[*contact];
                let interface = &self.interfaces[*contact];
                for (i, link) in interface.links.iter().enumerate() {
                    add(link.dof, interface.row(i, 1, &frame));
                }
            }
        }
    }

    /// q, and how prescribed motions go with the load factor.
    fn find_rates(&mut self, model: &Model, at: &At<'_>) {
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
        let slope = |scale: &Factor| scale.slope(at.target);
        self.pressures.each(model, at.u, slope, |dof, part| {
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

    /// Takes off q what prescribed motions do through the stiffness: the linearisation's coupling for the rates in place of
    /// the steps.
    fn couple_rates(&mut self, model: &Model, at: &At<'_>) {
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

    /// Notes what the displacements of z = 0, which were solved just before, put into the constraint.
    pub(super) fn begin_border(&mut self, along: &Along<'_>) {
        let border = &mut self.border;
        let found = border.row.iter().zip(&self.x).map(|(c, x)| c * x);
        border.start = along.step() - border.given[0] - found.sum::<f64>();
        border.share.clear();
    }

    /// Finds x1 and f1, and eliminates dλ from the relation.
    ///
    /// # Errors
    /// [`SolveError::Singular`] where the constraint does not hold the load factor.
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

    /// Completes a solve: the displacements for z and dλ.
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

    /// An estimate of the norm of the bordered inverse where that of the bodies on their springs is `norm`: a fixed vector is
    /// solved for, and what the border takes off the solution it takes off the norm.
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
        let largest = |x: &[f64]| x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let plain = largest(&self.x);
        let product = |x: &[f64]| border.row.iter().zip(x).map(|(c, x)| c * x).sum::<f64>();
        let step = -product(&self.x) / (product(&border.moved) + border.given[1]);
        for (x, moved) in self.x.iter_mut().zip(&border.moved) {
            *x += step * moved;
        }
        Ok(norm * largest(&self.x) / plain)
    }
}
