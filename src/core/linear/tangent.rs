//! The tangent of an equilibrium state for [`super::stability`]: the bodies' tangent, condensed to the equations that touching
//! nodes involve, and the conditions that these nodes impose.
//!
//! It is assembled separately from the minor iterations, and only on demand.

use super::coupling::Interface;
use super::drag::stiffen;
use super::sizes::{BalancedQuantity, Sizes};
use super::source::LinearisationPoint;
use super::stability::{Conditions, Dense, Stability, ZERO, sliding, smooth};
use super::system::{System, moved};
use crate::contact::geometric_tangent::{Variation, geometric_tangent};
use crate::fem::assembly::Assembly;
use crate::linalg::{Pattern, SolveError, SymmetricFactors};
use crate::model::{Body, BodyKind, Form};
use crate::{ElementOutput, Mode, Model};
use nalgebra::DMatrix;
use std::sync::Arc;

/// Maximum number of unknowns of the dense part.
const MOST: usize = 1500;
/// Local flexibility is neglected if the scene's force deflects the element by less than this fraction of the scene's length.
const RIGID: f64 = 1e-9;

/// The bodies' tangent for stability checks.
pub struct Tangent {
    assembly: Assembly,
    /// Pattern and values of its upper half.
    pattern: Arc<Pattern>,
    values: Vec<f64>,
    /// Whether each equation belongs to a body that requires pivoting.
    pivoted: Vec<bool>,
    /// Whether each equation is a length equation.
    lengths: Vec<bool>,
    /// Factor by equation that converts a motion to a length: the scene's length for rotations, 1 otherwise.
    levers: Vec<f64>,
    /// The factors, and the equations c of their dense part, ascending.
    factors: Option<(Vec<usize>, SymmetricFactors)>,
}

impl Tangent {
    /// Sets up the tangent of a model.
    ///
    /// # Errors
    /// [`SolveError::OutOfMemory`].
    pub fn new(model: &Model, system: &System) -> Result<Self, SolveError> {
        let mut assembly = Assembly::new(model);
        let pattern = Arc::new(assembly.upper_pattern(&model.dofs)?);
        assembly.bind(&model.dofs, &pattern, true);
        let mut lengths = vec![false; model.dofs.equations];
        let mut levers = vec![1.0; model.dofs.equations];
        for (dof, equation) in model.dofs.equation.iter().enumerate() {
            if let Some(e) = equation {
                lengths[*e] = system.sizes.kind[dof] == BalancedQuantity::Length;
                levers[*e] = system.sizes.lever(dof).unwrap_or(1.0);
            }
        }
        Ok(Tangent {
            assembly,
            values: vec![0.0; pattern.entries()],
            pattern,
            pivoted: pivoted(model, &lengths),
            lengths,
            levers,
            factors: None,
        })
    }

    /// Stability of the state of the system's last linearisation, with its contacts' modes.
    pub fn stability(
        &mut self,
        system: &System,
        model: &Model,
        at: &LinearisationPoint<'_>,
    ) -> Stability {
        let found = is_symmetric(model).then(|| self.assess(system, model, at));
        found.flatten().unwrap_or(Stability::NotKnown)
    }

    /// `None` if round-off decides, or if there are too many unknowns.
    fn assess(
        &mut self,
        system: &System,
        model: &Model,
        at: &LinearisationPoint<'_>,
    ) -> Option<Stability> {
        if self.pattern.size() == 0 {
            // There are no unknowns.
            return Some(Stability::Stable);
        }
        let last = self.reached(system, model, at);
        if last.len() > MOST {
            return None;
        }
        self.assemble(&system.sizes, model, at);
        let mut dense = self.condense(system, model, at, last.clone())?;
        let mut conditions = conditions(system, model, at, &last)?;
        let levers: Vec<f64> = last.iter().map(|&e| self.levers[e]).collect();
        conditions.divide_by(&levers);
        conditions.stiffen(&mut dense.condensed);
        let basis = conditions.admissible(last.len());
        if conditions.slides {
            sliding(&dense, &conditions, &basis)
        } else {
            smooth(&dense, &basis)
        }
    }

    /// The equations that touching nodes involve, and those of bodies that require pivoting.
    fn reached(&self, system: &System, model: &Model, at: &LinearisationPoint<'_>) -> Vec<usize> {
        let mut reached = self.pivoted.clone();
        for (interface, _) in touching(system, at) {
            for link in &interface.links {
                if let Some(e) = model.dofs.equation[link.dof] {
                    reached[e] = true;
                }
            }
        }
        (0..reached.len()).filter(|&e| reached[e]).collect()
    }

    fn assemble(&mut self, sizes: &Sizes, model: &Model, at: &LinearisationPoint<'_>) {
        let dofs = model.dofs.len();
        let (mut force, mut size, step) = (vec![0.0; dofs], vec![0.0; dofs], vec![0.0; dofs]);
        let mut coupling = vec![0.0; model.dofs.equations];
        let out = ElementOutput {
            force: &mut force,
            size: &mut size,
            values: &mut self.values,
            coupling: &mut coupling,
        };
        let moved = moved(at.u, &step, at);
        self.assembly.assemble(&model.dofs, moved, out);
        let diagonal = |e: usize| self.pattern.slot(e, e);
        stiffen(model, at, sizes, diagonal, &mut self.values);
        // All motions are converted to lengths, so that round-off does not depend on the user's units.
        for (value, (row, column)) in self.values.iter_mut().zip(self.pattern.iter()) {
            *value /= self.levers[row] * self.levers[column];
        }
    }

    fn condense(
        &mut self,
        system: &System,
        model: &Model,
        at: &LinearisationPoint<'_>,
        last: Vec<usize>,
    ) -> Option<Dense> {
        if self.factors.as_ref().is_none_or(|(had, _)| *had != last) {
            let factors = SymmetricFactors::new(self.pattern.clone(), &last, &[]).ok()?;
            self.factors = Some((last, factors));
        }
        let (last, factors) = self.factors.as_mut()?;
        let (n, c) = (self.pattern.size(), last.len());
        let executor = &*system.executor;
        factors.factor(&self.values, executor).ok()?;
        // Growth in K_ii shows in the solution for almost any right-hand side.
        let (ones, mut x) = (vec![1.0; n], vec![0.0; n]);
        factors.condense(&ones, &mut x[..c], executor);
        let known = &ones[..c];
        factors.recover(&ones, known, &mut x, executor).ok()?;
        let diagonal = |e: usize| {
            self.pattern
                .slot(e, e)
                .map_or(0.0, |k| self.values[k].abs())
        };
        let mut negative = 0;
        for (e, pivot) in factors.pivots() {
            if pivot.is_nan() || pivot.abs() <= ZERO * diagonal(e) {
                return None;
            }
            negative += usize::from(pivot < 0.0);
        }
        let mut condensed = vec![0.0; c * c];
        factors.condensed(&mut condensed);
        let mut condensed = DMatrix::from_vec(c, c, condensed);
        let given = |i: usize, j: usize| {
            let (row, column) = (last[i.min(j)], last[i.max(j)]);
            self.pattern
                .slot(row, column)
                .map_or(0.0, |k| self.values[k])
        };
        let given_way = DMatrix::from_fn(c, c, given) - &condensed;
        let mut turned = DMatrix::zeros(c, c);
        turn(&mut turned, system, model, at, last);
        let lever = |k: usize| self.levers[last[k]];
        condensed += DMatrix::from_fn(c, c, |i, j| turned[(i, j)] / (lever(i) * lever(j)));
        let lengths = last.iter().filter(|&&e| self.lengths[e]).count();
        Some(Dense {
            condensed,
            given_way,
            negative,
            lengths,
        })
    }
}

fn is_symmetric(model: &Model) -> bool {
    let symmetric = |body: &Body| match &body.kind {
        BodyKind::Beam(_) | BodyKind::Solid(_) | BodyKind::Truss(_) => true,
        BodyKind::Linear(linear) => linear.is_symmetric(),
    };
    model.has_dead_loads() && model.bodies.iter().all(symmetric)
}

/// Marks the equations of bodies with length equations.
fn pivoted(model: &Model, lengths: &[bool]) -> Vec<bool> {
    let mut pivoted = lengths.to_vec();
    for body in &model.bodies {
        let saddle = match &body.kind {
            BodyKind::Beam(beam) => beam.first_shear.is_some(),
            BodyKind::Linear(linear) => linear.form != Form::Stiffness,
            BodyKind::Solid(_) | BodyKind::Truss(_) => false,
        };
        for &node in body.nodes.iter().filter(|_| saddle) {
            let own = &model.dofs.equation[model.dofs.of_node(node)];
            own.iter().flatten().for_each(|&e| pivoted[e] = true);
        }
    }
    pivoted
}

/// The touching nodes with their part of the equations.
fn touching<'a>(
    system: &'a System,
    at: &LinearisationPoint<'a>,
) -> impl Iterator<Item = (&'a Interface, usize)> + use<'a> {
    let contacts = at.contacts;
    let nodes = system.interfaces.iter().enumerate();
    nodes
        .filter(|(s, interface)| contacts[*s].mode != Mode::Free && interface.projection.is_some())
        .map(|(s, interface)| (interface, s))
}

/// Adds T.
fn turn(
    matrix: &mut DMatrix<f64>,
    system: &System,
    model: &Model,
    at: &LinearisationPoint<'_>,
    last: &[usize],
) {
    let place = |dof: usize| last.binary_search(&model.dofs.equation[dof]?).ok();
    for (interface, s) in touching(system, at) {
        let node = &at.contacts[s];
        if let Some(point) = interface.point.first() {
            let links = || interface.links.iter().enumerate();
            for (i, row) in links().filter_map(|(i, link)| Some((i, place(link.dof)?))) {
                for (j, col) in links().filter_map(|(j, link)| Some((j, place(link.dof)?))) {
                    matrix[(row, col)] -= point.stiffness[i][j];
                }
            }
            continue;
        }
        let Some((projection, curve)) = interface.projection.and_then(|f| Some((f, f.curve?)))
        else {
            continue;
        };
        let varied: Vec<(usize, Variation)> = interface
            .links
            .iter()
            .filter_map(|link| {
                let variation =
                    Variation::new(&projection, &curve, link.axis, link.weight, link.slope);
                Some((place(link.dof)?, variation))
            })
            .collect();
        let force = [node.f_n, node.f_t];
        for (i, row) in &varied {
            for (j, column) in &varied {
                matrix[(*i, *j)] -= geometric_tangent(&projection, &curve, force, row, column);
            }
        }
    }
}

/// The conditions of the touching nodes. `None` if the sliding direction of a node with friction is unknown, if its bond or
/// element has a compliance, or if several nodes press on one flexible element.
fn conditions(
    system: &System,
    model: &Model,
    at: &LinearisationPoint<'_>,
    last: &[usize],
) -> Option<Conditions> {
    let mut all = Conditions::default();
    for (interface, s) in touching(system, at) {
        let node = &at.contacts[s];
        let frame = interface.frame(node);
        let row = |component: usize| {
            let mut row = vec![0.0; last.len()];
            for (i, link) in interface.links.iter().enumerate() {
                let equation = model.dofs.equation[link.dof];
                if let Some(k) = equation.and_then(|e| last.binary_search(&e).ok()) {
                    row[k] += interface.row(i, component, &frame);
                }
            }
            row
        };
        let [normal, tangential] = [0, 1].map(row);
        let mut give = interface.bond.give();
        if let Some(point) = interface.point.first() {
            // Forces on the same element displace each other's points, which springs of single nodes cannot describe.
            if !interface.partners.is_empty() {
                return None;
            }
            // Near a border between elements the local flexibility is too small for a spring.
            if point.compliance > RIGID * model.length / system.norms.scale {
                give[0] += point.compliance;
            }
        }
        if node.mode == Mode::Fixed {
            for (row, give) in [normal, tangential].into_iter().zip(give) {
                if give > 0.0 {
                    all.springs.push((row, 1.0 / give));
                } else {
                    all.force.push(row.clone());
                    all.motion.push(row);
                }
            }
            continue;
        }
        let friction = node.friction(&at.friction[s]);
        if give[0] > 0.0 {
            // Friction would make the spring's contribution to the tangent unsymmetric.
            if !friction.is_smooth() {
                return None;
            }
            all.springs.push((normal, 1.0 / give[0]));
            continue;
        }
        let mut force = normal.clone();
        if !friction.is_smooth() {
            if node.sign == 0.0 {
                return None;
            }
            let share = node.sign * friction.coefficient();
            let both = force.iter_mut().zip(&tangential);
            both.for_each(|(f, t)| *f += share * t);
            all.slides |= share != 0.0;
        }
        all.force.push(force);
        all.motion.push(normal);
    }
    all.keep_independent();
    Some(all)
}
