//! Minor iterations on the full system of bodies and interface (eqn 9), which is factored for every combination of modes.

use super::partners::{partners_motion, place_partners};
use super::source::{LinearisationPoint, SolveResult};
use super::system::System;
use crate::interface::kinematics::through;
use crate::plane::dot;
use crate::{ContactState, Equation, Model, RelativeMotion};

impl System {
    pub(super) fn solve_augmented(
        &mut self,
        model: &Model,
        at: &LinearisationPoint<'_>,
    ) -> SolveResult {
        self.condensed.fresh = false;
        self.scale(model, at);
        self.start_values();
        let unknowns = model.dofs.equations;
        for s in 0..self.interfaces.len() {
            let rows = self.rows(s, at);
            let frame = self.interfaces[s].frame(&at.contacts[s]);
            for (k, row) in rows.iter().enumerate() {
                let row = through(*row, self.interfaces[s].give());
                self.rhs[unknowns + 2 * s + k] = self.place_row(s, k, &row, frame);
            }
        }
        let solved = self.factor_and_solve();
        for (s, node) in at.contacts.iter().enumerate() {
            let row = unknowns + 2 * s;
            self.condensed.forces[s] = [self.x[row], self.x[row + 1]];
            let motion = self.motion_of_solution(model, s, node);
            let (give, force) = (self.interfaces[s].give(), self.condensed.forces[s]);
            self.condensed.motions[s] = [0, 1].map(|k| match give[k] {
                0.0 => motion[k],
                give => motion[k] - give * force[k],
            });
        }
        for s in 0..self.interfaces.len() {
            if !self.interfaces[s].partners.is_empty() {
                let increment = |dof: usize| self.increment(model, dof);
                let forces = &self.condensed.forces;
                let did = partners_motion(&self.interfaces, s, increment, forces);
                self.condensed.motions[s][0] -= did;
            }
        }
        solved
    }

    /// Computes the common scale for all systems of this linearisation, using the one in which every node is held.
    pub(super) fn scale(&mut self, model: &Model, at: &LinearisationPoint<'_>) {
        if std::mem::replace(&mut self.scaled, true) {
            return;
        }
        self.start_values();
        for s in 0..self.interfaces.len() {
            let frame = self.interfaces[s].frame(&at.contacts[s]);
            for (k, row) in springs(0.0).iter().enumerate() {
                let row = through(*row, self.interfaces[s].give());
                self.place_row(s, k, &row, frame);
            }
        }
        self.sizes.units(model, self.spring(model), &mut self.work);
        if let Some(factors) = &mut self.whole {
            factors.scale(&self.values, model.dofs.equations, &self.work);
        }
    }

    /// Stiffness and out-of-balance forces without the interface.
    pub(super) fn start_values(&mut self) {
        match &self.whole {
            Some(factors) if self.copied => {
                factors.copy_last(&self.stiffness, &mut self.values);
            }
            _ => self.values.copy_from_slice(&self.stiffness),
        }
        self.copied = true;
        self.start_rhs();
    }

    pub(super) fn start_rhs(&mut self) {
        let balance = self.residual.iter().zip(&self.coupling);
        for (rhs, (residual, coupling)) in self.rhs.iter_mut().zip(balance) {
            *rhs = residual - coupling;
        }
    }

    /// Writes an equation of a slave node and the column of its force; returns the equation's right-hand side.
    pub(super) fn place_row(
        &mut self,
        s: usize,
        k: usize,
        row: &Equation,
        frame: [[f64; 2]; 2],
    ) -> f64 {
        let interface = &self.interfaces[s];
        self.values[interface.block[2 * k]] = row.d_n;
        self.values[interface.block[2 * k + 1]] = row.d_t;
        let component = match row.motion {
            RelativeMotion::None => None,
            RelativeMotion::Normal => Some(0),
            RelativeMotion::Tangential => Some(1),
        };
        for (i, link) in interface.links.iter().enumerate() {
            let Some(slots) = link.slots else { continue };
            if let Some(component) = component {
                self.values[slots[2 * k]] += interface.row(i, component, &frame);
            }
            self.values[slots[2 * k + 1]] += interface.column(i, k, &frame);
        }
        if k == 0 {
            place_partners(&self.interfaces, &mut self.values, s, component.is_some());
        }
        let interface = &self.interfaces[s];
        row.value - component.map_or(0.0, |k| interface.prescribed_along(k, &frame))
    }

    pub(super) fn factor_and_solve(&mut self) -> SolveResult {
        let Some(factors) = &mut self.whole else {
            return SolveResult::Not;
        };
        self.done.factorizations += 1;
        if factors.factor(&self.values).is_err() || factors.solve(&self.rhs, &mut self.x).is_err() {
            return SolveResult::Not;
        }
        SolveResult::from_norm(factors.inverse_norm())
    }

    pub(super) fn motion_of_solution(
        &self,
        model: &Model,
        slave: usize,
        node: &ContactState,
    ) -> [f64; 2] {
        let interface = &self.interfaces[slave];
        if let Some(point) = interface.point.first() {
            return [0, 1].map(|k| {
                let links = interface.links.iter().zip(&point.rows[k]);
                let parts = links.map(|(link, row)| row * self.increment(model, link.dof));
                parts.sum::<f64>()
            });
        }
        let mut motion = [0.0; 2];
        for link in &interface.links {
            motion[link.axis] += link.weight * self.increment(model, link.dof);
        }
        let frame = interface.frame(node);
        [dot(frame[0], motion), dot(frame[1], motion)]
    }
}

/// `motion − ΔF / stiffness = 0` in both directions, for `give` = −1 / stiffness.
pub(super) fn springs(give: f64) -> [Equation; 2] {
    [
        Equation {
            motion: RelativeMotion::Normal,
            d_n: give,
            d_t: 0.0,
            value: 0.0,
        },
        Equation {
            motion: RelativeMotion::Tangential,
            d_n: 0.0,
            d_t: give,
            value: 0.0,
        },
    ]
}
