//! Out-of-balance forces of a linearisation (eqn 22), their norms, and their round-off.

use super::drag::add_drag;
use super::norms::Norms;
use super::partners::find_points;
use super::sizes::{ROUND_OFF, Sizes};
use super::source::LinearisationPoint;
use super::system::{Layout, System, executor_for, moved};
use super::violation::violation;
use crate::Model;
use crate::fem::pressure::Pressures;
use crate::linalg::Factors;
use crate::plane::larger;

impl System {
    /// Computes the out-of-balance force R − F of eqn (22) and its norms.
    pub(super) fn balance(&mut self, model: &Model, at: &LinearisationPoint<'_>) {
        self.interaction.fill(0.0);
        if self.has_points {
            let pattern = self.whole.as_ref().map(Factors::pattern);
            find_points(
                (&mut self.points, &mut self.interfaces),
                (&self.positions, &self.step),
                pattern.map(AsRef::as_ref),
                model,
                at,
            );
        }
        let slaves = at.contacts.iter().zip(&model.contacts);
        for (interface, (node, slave)) in self.interfaces.iter_mut().zip(slaves) {
            interface.bond = slave.bond;
            interface.given = slave.bond.give()[0] * node.f_n;
            if let Some(point) = interface.point.first() {
                interface.given += point.given;
                for (link, force) in interface.links.iter().zip(&point.forces) {
                    self.interaction[link.dof] += force;
                }
                continue;
            }
            let force = node.force();
            for link in &interface.links {
                self.interaction[link.dof] -= link.weight * force[link.axis];
            }
        }
        let tolerance = at.chosen.tolerance;
        let mut scale = self.sizes.reference.max(self.sizes.least_scale(tolerance));
        let (mut force, mut length) = (0.0_f64, 0.0_f64);
        for (d, equation) in model.dofs.equation.iter().enumerate() {
            let balance = self.external[d] + self.interaction[d] - self.force[d];
            match self.sizes.lever(d) {
                None => length = larger(length, balance.abs() / model.length),
                Some(lever) => {
                    let size = larger(self.external[d].abs(), self.size[d]);
                    scale = larger(scale, size / lever);
                    if equation.is_some() {
                        force = larger(force, balance.abs() / lever);
                    }
                }
            }
            if let Some(equation) = equation {
                self.residual[*equation] = balance;
            }
        }
        let [floor, mut length_floor] = self.floors;
        // Positions are exact up to their round-off, which is the lower limit if it exceeds the tolerance.
        let placed = ROUND_OFF * f64::EPSILON * self.reach;
        if placed > tolerance * model.length {
            length_floor = length_floor.max(placed);
        }
        let relative = |force: f64| if force > 0.0 { force / scale } else { 0.0 };
        let wanted = self
            .sizes
            .force_scale(model, at, |dof| self.nodal_force(dof));
        let noise = if floor > 0.0 { floor / wanted } else { 0.0 };
        self.norms = Norms {
            force,
            relative: relative(force).max(length),
            interface: 0.0,
            correction: at.correction,
            scale,
            limit: tolerance
                .max(relative(floor))
                .max(length_floor / model.length),
            noise: noise.max(length_floor / model.length),
        };
        self.norms.interface = self.violation(model, at);
    }

    /// Largest force that a solve has to balance: the current out-of-balance force, plus the contribution of prescribed motions;
    /// relative to the force scale.
    pub fn required_force(&self, model: &Model) -> f64 {
        let mut largest = 0.0_f64;
        for (d, equation) in model.dofs.equation.iter().enumerate() {
            if let (Some(e), Some(lever)) = (*equation, self.sizes.lever(d)) {
                let asked = (self.residual[e] - self.coupling[e]).abs();
                largest = larger(largest, asked / lever);
            }
        }
        largest / self.norms.scale.max(f64::MIN_POSITIVE)
    }

    /// The degree of freedom with the largest out-of-balance force in the last linearisation, and that force; moments are
    /// divided by the scene's length.
    pub fn largest(&self, model: &Model) -> Option<(usize, f64)> {
        let equations = model.dofs.equation.iter().enumerate();
        let forces = equations.filter_map(|(d, equation)| {
            let lever = self.sizes.lever(d)?;
            Some((d, self.residual[(*equation)?].abs() / lever))
        });
        forces.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Changes the target load of the last linearisation at the same displacements. Apart from prescribed displacements, nothing
    /// else changes if no element has a history.
    pub fn aim(&mut self, model: &Model, at: &LinearisationPoint<'_>) {
        self.load(model, at);
        self.allow(model, at);
        if !model.prescribed.is_empty() {
            self.prescribe(model, at);
            self.couple(model, at);
            self.measure_interfaces(model, at);
        }
        self.balance(model, at);
    }

    pub(super) fn load(&mut self, model: &Model, at: &LinearisationPoint<'_>) {
        let known = (&self.pressures, &self.sizes);
        loads(model, at, at.target, known, &mut self.external);
    }

    /// Computes the internal forces, unless the assembly did, and at the same time their round-off and that of lengths that should
    /// vanish: the machine precision times |K| |u|. It belongs to a linearisation, independent of later changes of forces and
    /// loads.
    pub(super) fn resist(&mut self, model: &Model, at: &LinearisationPoint<'_>) {
        let pattern = self.pattern().cloned();
        let (half, u) = (self.layout == Some(Layout::Bodies), at.u);
        let moved = moved(u, &self.step, at);
        let (assembly, force, size) = (&mut self.assembly, &mut self.force, &mut self.size);
        let (stiffness, sizes) = (&self.stiffness, &self.sizes);
        let (x, work, floors) = (&mut self.x, &mut self.work, &mut self.floors);
        let entries = pattern.as_ref().map_or(0, |pattern| pattern.entries());
        executor_for(entries, &*self.executor).join(
            &mut || {
                if at.factored.is_some() {
                    assembly.resist(moved, force, size);
                }
            },
            &mut || {
                let Some(pattern) = &pattern else { return };
                x.fill(0.0);
                for (d, equation) in model.dofs.equation.iter().enumerate() {
                    if let Some(e) = equation {
                        x[*e] = u[d];
                    }
                }
                pattern.multiply_abs(stiffness, x, work, half);
                let mut worst = [0.0_f64; 2];
                for (d, equation) in model.dofs.equation.iter().enumerate() {
                    let Some(e) = *equation else { continue };
                    match sizes.lever(d) {
                        Some(lever) => worst[0] = larger(worst[0], work[e] / lever),
                        None => worst[1] = larger(worst[1], work[e]),
                    }
                }
                *floors = worst.map(|worst| ROUND_OFF * f64::EPSILON * worst);
            },
        );
    }

    /// Largest relative violation of the interface conditions by a state's forces and gaps.
    fn violation(&self, model: &Model, at: &LinearisationPoint<'_>) -> f64 {
        let kinematics = |contact: usize| self.kinematics(contact);
        violation(at, model.length, self.norms.scale, kinematics)
    }

    /// Norms of the last linearisation with the interface conditions of this state. They must not depend on whether the workspace
    /// has been rebuilt since.
    pub fn norms_of(&mut self, model: &Model, at: &LinearisationPoint<'_>) -> Norms {
        self.norms.interface = self.violation(model, at);
        self.norms
    }

    /// Internal force at each degree of freedom in the last linearisation.
    pub fn internal(&self) -> &[f64] {
        &self.force
    }

    /// Internal force minus applied load at a degree of freedom: the force from the support or surface.
    pub fn nodal_force(&self, dof: usize) -> f64 {
        self.force[dof] - self.external[dof]
    }

    /// Interaction force at a degree of freedom in the last linearisation.
    pub fn interaction(&self, dof: usize) -> f64 {
        self.interaction[dof]
    }
}

/// Computes the loads on all degrees of freedom at a load factor.
pub(super) fn loads(
    model: &Model,
    at: &LinearisationPoint<'_>,
    target: f64,
    (pressures, sizes): (&Pressures, &Sizes),
    out: &mut [f64],
) {
    out.fill(0.0);
    for load in &model.loads {
        out[load.dof] += load.value * load.scale.at(target);
    }
    let size = |k: usize| model.pressure(k, target);
    pressures.each(at.u, size, |dof, part| out[dof] += part);
    add_drag(model, at, sizes, out);
}
