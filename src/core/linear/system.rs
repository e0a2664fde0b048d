//! The full augmented system of a major iteration (eqn 9): bodies, interface, right-hand side.
//!
//! All data are rebuilt from a state ([`LinearisationPoint`]) and never saved. [`System::linearise`] freezes geometry, stiffness and residual at
//! the start of a major iteration; [`System::solve`] solves the system for the modes of one minor iteration. After the first pass
//! neither allocates, unless a slave node moves to another deformable master element.

use crate::contact::geometric_tangent::{Variation, geometric_tangent};
use crate::contact::projection::{Projection, projection_apart, tangent};
use crate::contact::stick_point::room;
use crate::executor::{Executor, SequentialExecutor};
use crate::fem::assembly::{Assembly, AssemblyMotion};
use crate::fem::pressure::Pressures;
use crate::interface::rows;
use crate::linalg::{Factors, Pattern, SolveError};
use crate::linear::border::Border;
use crate::linear::condensation::{Condensation, uncoupled_parts};
use crate::linear::coupling::Interface;
use crate::linear::drag::stiffen;
use crate::linear::estimate::condensable;
use crate::linear::partners::{join_partners, turn_points};
use crate::linear::point_forces::PointForces;
use crate::linear::sizes::Sizes;
use crate::model::Geometry;
use crate::plane::{larger, max_abs};
use crate::{
    CondensedSystem, ContactState, ElementOutput, Equation, Estimate, LinearisationPoint, Model,
    NodeIncrement, NodeKinematics, Norms, Settings, SolveResult, Work,
};
use std::sync::Arc;

/// An equation whose coefficients are all below this is empty; otherwise the largest is one.
const EMPTY: f64 = 1e-12;
/// Matrices with fewer entries are processed by one thread.
const LARGE: usize = 100_000;

/// Layout of the stiffness.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Layout {
    /// Bodies and interface in one matrix.
    Whole,
    /// Only the bodies, to be condensed.
    Bodies,
}

/// Where the effect of rotating interaction forces is added.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum RotationEffect {
    /// To the stiffness, and to the coupling with prescribed motions.
    Both,
    /// Only to the coupling with prescribed motions.
    Coupling,
}

/// The system linearised at a state.
pub struct System {
    /// The elements, set up on demand: strategies that only use the contacts do not need them.
    pub(super) assembly: Assembly,
    laid_out: bool,
    /// Following pressures. They require a new stiffness in every major iteration, and a full, unsymmetric matrix.
    pub(super) pressures: Pressures,
    /// Current layout of `stiffness`.
    pub(super) layout: Option<Layout>,
    pub whole: Option<Factors>,
    /// The displacements and element histories at which `stiffness` was computed, and its values without the interface, if it may
    /// be reused.
    taken: Vec<f64>,
    remembered: Vec<f64>,
    plain: Vec<f64>,
    /// Whether `bodies` have the factors of `stiffness`.
    pub(super) is_factored: bool,
    /// Work done so far.
    pub done: Work,
    /// Whether the last linearisation contains a drag.
    pub(super) dragged: bool,
    /// Whether `whole` is scaled for the current linearisation.
    pub(super) scaled: bool,
    /// Whether `values` differ from `stiffness` in the interface's rows and columns only.
    pub(super) copied: bool,
    pub(super) bodies: Option<Condensation>,
    /// Processes bodies in parallel.
    pub(super) executor: Arc<dyn Executor>,
    pub(super) estimate: Estimate,
    /// Whether [`Condensation`] can condense the scene's bodies.
    pub(super) condensable: bool,
    /// Contacts over elements with local flexibility under point forces, and whether such elements exist.
    pub(super) points: PointForces,
    pub(super) has_points: bool,
    /// The elements for which `whole` has entries.
    pub(super) pairing: Vec<Option<(usize, usize)>>,
    /// n and t of every slave node in the last condensation.
    pub(super) frames: Vec<[[f64; 2]; 2]>,
    /// Scales of the scene.
    pub sizes: Sizes,
    /// Current position of every node.
    pub positions: Vec<[f64; 2]>,
    /// Largest coordinate of `positions` (length).
    pub(super) reach: f64,
    pub(super) interfaces: Vec<Interface>,
    pub(super) condensed: CondensedSystem,
    pub(super) stiffness: Vec<f64>,
    pub(super) values: Vec<f64>,
    /// Internal force at each degree of freedom.
    pub(super) force: Vec<f64>,
    pub(super) size: Vec<f64>,
    pub(super) external: Vec<f64>,
    /// Interaction force at each degree of freedom.
    pub(super) interaction: Vec<f64>,
    pub(super) step: Vec<f64>,
    pub(super) residual: Vec<f64>,
    pub(super) coupling: Vec<f64>,
    pub(super) rhs: Vec<f64>,
    pub(super) x: Vec<f64>,
    pub(super) work: Vec<f64>,
    /// Right-hand sides of a condensation, in blocks.
    pub(super) block: Vec<f64>,
    /// Data for the load factor as an unknown.
    pub(super) border: Border,
    pub(super) norms: Norms,
    /// Round-off of forces and of lengths that should vanish, in the last linearisation.
    pub(super) floors: [f64; 2],
}

impl System {
    /// Sets up the system of a scene.
    pub fn new(model: &Model, executor: Arc<dyn Executor>) -> Self {
        let (dofs, equations) = (model.dofs.len(), model.dofs.equations);
        let interfaces: Vec<Interface> = model
            .contacts
            .iter()
            .map(|_| Interface::default())
            .collect();
        System {
            assembly: Assembly::empty(executor.clone()),
            laid_out: false,
            pressures: Pressures::new(model),
            layout: None,
            whole: None,
            taken: Vec::new(),
            remembered: Vec::new(),
            plain: Vec::new(),
            is_factored: false,
            done: Work::default(),
            dragged: false,
            scaled: false,
            copied: false,
            bodies: None,
            executor,
            estimate: Estimate::from_model(model),
            condensable: condensable(model),
            points: PointForces::default(),
            has_points: model.surfaces.iter().any(|s| !s.gives.is_empty()),
            pairing: Vec::new(),
            frames: Vec::new(),
            sizes: Sizes::new(model),
            positions: vec![[0.0; 2]; model.nodes.len()],
            reach: 0.0,
            condensed: CondensedSystem::new(interfaces.len()),
            interfaces,
            stiffness: Vec::new(),
            values: Vec::new(),
            force: vec![0.0; dofs],
            size: vec![0.0; dofs],
            external: vec![0.0; dofs],
            interaction: vec![0.0; dofs],
            step: vec![0.0; dofs],
            residual: vec![0.0; equations],
            coupling: vec![0.0; equations],
            rhs: Vec::new(),
            x: Vec::new(),
            work: Vec::new(),
            block: Vec::new(),
            border: Border::default(),
            norms: Norms::default(),
            floors: [0.0; 2],
        }
    }

    /// Whether minor iterations are solved on the condensed interface with these settings.
    pub fn condenses(&self, settings: &Settings) -> bool {
        self.estimate.is_condensed(settings.solver)
    }

    /// Current positions of all nodes at displacements u.
    pub fn place(&mut self, model: &Model, u: &[f64]) {
        self.reach = 0.0;
        for (n, position) in self.positions.iter_mut().enumerate() {
            *position = model.place(u, n);
            self.reach = larger(self.reach, max_abs(*position));
        }
    }

    /// Freezes geometry, stiffness and residual at a state's u, forces and load factor; [`System::turn`] completes it.
    ///
    /// # Errors
    /// [`SolveError`] if the pattern cannot be analysed.
    pub fn linearise(
        &mut self,
        model: &Model,
        at: &LinearisationPoint<'_>,
    ) -> Result<(), SolveError> {
        if self.condenses(at.chosen) && self.condensable && at.along.is_none() {
            self.linearise_in(Layout::Bodies, model, at)
        } else {
            self.linearise_in(Layout::Whole, model, at)
        }
    }

    pub(super) fn linearise_in(
        &mut self,
        layout: Layout,
        model: &Model,
        at: &LinearisationPoint<'_>,
    ) -> Result<(), SolveError> {
        if !std::mem::replace(&mut self.laid_out, true) {
            self.assembly = Assembly::with_executor(model, self.executor.clone());
        }
        self.condensed.fresh = false;
        self.scaled = false;
        self.copied = false;
        self.place(model, at.u);
        let unclosed = model.unclosed(at.leg, at.target);
        for (interface, (node, slave)) in self
            .interfaces
            .iter_mut()
            .zip(at.contacts.iter().zip(&model.contacts))
        {
            let point = self.positions[slave.node];
            let apart = slave.is_apart(unclosed);
            let over =
                |spot| projection_apart(apart, &model.surfaces, spot, &self.positions, point);
            interface.projection = node.spot.map(over).map(|here| match node.second {
                Some(_) => here.along(node.normal, point),
                // The force may rotate the sides of a border between elements.
                None if self.has_points && here.curve.is_none() => here.along(node.normal, point),
                // A tied node does not move over its surface.
                None if slave.bond.is_tied() => here.along(node.normal, point),
                None => here,
            });
        }
        self.allow(model, at);
        match layout {
            Layout::Whole => self.bind_whole(model, at)?,
            Layout::Bodies => self.bind_bodies(model, at)?,
        }
        self.load(model, at);
        self.prescribe(model, at);
        self.take_stiffness(layout, model, at);
        self.measure_interfaces(model, at);
        self.balance(model, at);
        Ok(())
    }

    /// Computes the internal forces and the stiffness; the stiffness may be one from earlier displacements.
    fn take_stiffness(&mut self, layout: Layout, model: &Model, at: &LinearisationPoint<'_>) {
        let about = at.factored.unwrap_or(at.u);
        let stands =
            at.factored.is_some() && self.taken == about && self.remembered == at.accepted.history;
        if !stands {
            self.is_factored = false;
            self.assemble(model, &LinearisationPoint { u: about, ..*at });
            self.taken.clear();
            if model.keeps_factors(at.chosen.factor, self.condenses(at.chosen)) {
                self.taken.extend_from_slice(about);
                self.remembered.clear();
                self.remembered.extend_from_slice(at.accepted.history);
                if layout == Layout::Whole {
                    self.plain.clone_from(&self.stiffness);
                }
            }
        } else if layout == Layout::Whole {
            self.stiffness.copy_from_slice(&self.plain);
        }
        self.resist(model, at);
        if stands {
            let moved = moved(about, &self.step, at);
            self.assembly.couple(&model.dofs, moved, &mut self.coupling);
        }
    }

    /// Computes the remaining overlaps at the target load.
    pub(super) fn allow(&mut self, model: &Model, at: &LinearisationPoint<'_>) {
        let unclosed = model.unclosed(at.leg, at.target);
        for (interface, slave) in self.interfaces.iter_mut().zip(&model.contacts) {
            interface.allowed = slave.overlap * unclosed;
        }
    }

    /// Computes the remaining increments of prescribed displacements.
    pub(super) fn prescribe(&mut self, model: &Model, at: &LinearisationPoint<'_>) {
        self.step.fill(0.0);
        for p in &model.prescribed {
            self.step[p.dof] = p.value * p.scale.at(at.target) - at.u[p.dof];
        }
    }

    /// Recomputes their effect through the stiffness of the last linearisation.
    pub(super) fn couple(&mut self, model: &Model, at: &LinearisationPoint<'_>) {
        let moved = moved(at.factored.unwrap_or(at.u), &self.step, at);
        self.assembly.couple(&model.dofs, moved, &mut self.coupling);
        self.turn_into(model, at, RotationEffect::Coupling);
    }

    /// Internal forces and stiffness of the bodies, and the effect of prescribed displacements through it.
    pub(super) fn assemble(&mut self, model: &Model, at: &LinearisationPoint<'_>) {
        let out = ElementOutput {
            force: &mut self.force,
            size: &mut self.size,
            values: &mut self.stiffness,
            coupling: &mut self.coupling,
        };
        let moved = moved(at.u, &self.step, at);
        self.assembly.assemble(&model.dofs, moved, out);
        let place = (at.u, at.target);
        let (values, coupling) = (&mut self.stiffness, &mut self.coupling);
        self.pressures
            .stiffen(model, place, &self.step, values, coupling);
        self.done.assemblies += 1;
        self.drag(model, at);
    }

    /// Adds the drag of a damped motion to the stiffness.
    fn drag(&mut self, model: &Model, at: &LinearisationPoint<'_>) {
        self.dragged = at.drag.is_some();
        if let Some(pattern) = self.pattern().filter(|_| self.dragged).cloned() {
            let diagonal = |e: usize| pattern.slot(e, e);
            stiffen(model, at, &self.sizes, diagonal, &mut self.stiffness);
        }
    }

    /// Updates the pattern if a slave node has moved to another element with unknowns; rigid elements have no entries.
    fn bind_whole(&mut self, model: &Model, at: &LinearisationPoint<'_>) -> Result<(), SolveError> {
        let changed = self.whole.is_none()
            || at
                .contacts
                .iter()
                .zip(&self.pairing)
                .any(|(node, pair)| pairing(model, node) != *pair);
        self.link(model, at);
        if changed {
            self.pairing.clear();
            self.pairing
                .extend(at.contacts.iter().map(|node| pairing(model, node)));
            self.analyse(model)?;
        }
        let Some(factors) = &self.whole else {
            return Ok(());
        };
        if changed || self.layout != Some(Layout::Whole) {
            let size = factors.pattern().size();
            self.taken.clear();
            self.assembly.bind(&model.dofs, factors.pattern(), false);
            self.pressures.bind(&model.dofs, factors.pattern());
            self.stiffness.resize(factors.pattern().entries(), 0.0);
            self.values.resize(factors.pattern().entries(), 0.0);
            for buffer in [&mut self.rhs, &mut self.x, &mut self.work] {
                buffer.resize(size, 0.0);
            }
            self.layout = Some(Layout::Whole);
            self.interfaces.iter_mut().for_each(|i| {
                i.placed = false;
                i.partners.clear();
            });
        }
        for (s, interface) in self.interfaces.iter_mut().enumerate() {
            interface.find_slots(model, factors.pattern(), model.dofs.equations + 2 * s);
        }
        Ok(())
    }

    /// Prepares the layout for the bodies alone, whose pattern never changes.
    fn bind_bodies(
        &mut self,
        model: &Model,
        at: &LinearisationPoint<'_>,
    ) -> Result<(), SolveError> {
        self.link(model, at);
        let is_new = self.layout != Some(Layout::Bodies);
        if is_new {
            self.lay_out_bodies(model)?;
        }
        let Some(bodies) = &mut self.bodies else {
            return Ok(());
        };
        if bodies.choose(model, &self.interfaces) || is_new {
            self.interfaces.iter_mut().for_each(|i| i.placed = false);
        }
        for interface in &mut self.interfaces {
            let place = |row, column| bodies.place(row, column);
            interface.find_unknowns(model, |e| bodies.number(e), place);
        }
        Ok(())
    }

    /// Analyses the bodies, unless that is done, while the elements are bound to their pattern.
    fn lay_out_bodies(&mut self, model: &Model) -> Result<(), SolveError> {
        self.taken.clear();
        // The elements are bound even if the analysis fails.
        self.layout = None;
        let pattern = match &self.bodies {
            Some(bodies) => bodies.pattern().clone(),
            None => Arc::new(self.assembly.upper_pattern(&model.dofs)?),
        };
        let parts = uncoupled_parts(&pattern);
        let (executor, bodies) = (&self.executor, &mut self.bodies);
        let (assembly, mut done) = (&mut self.assembly, Ok(()));
        executor_for(pattern.entries(), &**executor).join(
            &mut || {
                if bodies.is_none() {
                    let new = Condensation::new(model, pattern.clone(), &parts, executor.clone());
                    done = new.map(|new| *bodies = Some(new));
                }
            },
            &mut || assembly.bind(&model.dofs, &pattern, true),
        );
        done?;
        // Several threads write to this memory first.
        self.stiffness = vec![0.0; pattern.entries()];
        for buffer in [&mut self.rhs, &mut self.x, &mut self.work] {
            buffer.resize(model.dofs.equations, 0.0);
        }
        self.layout = Some(Layout::Bodies);
        Ok(())
    }

    fn link(&mut self, model: &Model, at: &LinearisationPoint<'_>) {
        let slaves = at.contacts.iter().zip(&model.contacts);
        for (interface, (node, slave)) in self.interfaces.iter_mut().zip(slaves) {
            interface.link(model, node, slave);
        }
    }

    /// The pattern of `stiffness`.
    pub(super) fn pattern(&self) -> Option<&Arc<Pattern>> {
        match self.layout? {
            Layout::Whole => self.whole.as_ref().map(Factors::pattern),
            Layout::Bodies => self.bodies.as_ref().map(Condensation::pattern),
        }
    }

    fn analyse(&mut self, model: &Model) -> Result<(), SolveError> {
        let equations = model.dofs.equations;
        let mut entries = Vec::new();
        for (s, interface) in self.interfaces.iter().enumerate() {
            let row = equations + 2 * s;
            let linked = || {
                interface
                    .links
                    .iter()
                    .filter_map(|l| model.dofs.equation[l.dof])
            };
            entries.extend(linked().flat_map(|i| linked().map(move |j| (i, j))));
            for k in 0..2 {
                entries.extend([(row + k, row), (row + k, row + 1)]);
                for equation in linked() {
                    entries.extend([(row + k, equation), (equation, row + k)]);
                }
            }
        }
        if self.has_points {
            join_partners(&self.interfaces, &self.pairing, model, &mut entries);
        }
        let size = equations + 2 * self.interfaces.len();
        let bodies = self.assembly.entries(&model.dofs);
        let bodies = bodies.chain(self.pressures.entries(&model.dofs));
        let entries = bodies.chain(entries.iter().copied());
        let pattern = Arc::new(Pattern::new(size, entries)?);
        self.whole = Some(Factors::in_groups(pattern, &self.groups(model), equations)?);
        Ok(())
    }

    pub(super) fn measure_interfaces(&mut self, model: &Model, at: &LinearisationPoint<'_>) {
        for (interface, node) in self.interfaces.iter_mut().zip(at.contacts) {
            interface.room = node.spot.map_or([None; 2], |spot| {
                room(&model.surfaces[spot.surface], spot, &self.positions)
            });
            interface.prescribed = [0.0; 2];
            interface.moves = [false; 2];
            let Some(frame) = interface.projection.map(|f| [f.normal, tangent(f.normal)]) else {
                continue;
            };
            for link in &interface.links {
                if model.dofs.equation[link.dof].is_none() {
                    interface.prescribed[link.axis] += link.weight * self.step[link.dof];
                    continue;
                }
                for (moves, direction) in interface.moves.iter_mut().zip(frame) {
                    *moves |= (link.weight * direction[link.axis]).abs() > EMPTY;
                }
            }
        }
    }

    /// Adds the effect of rotating and moving interaction forces to the stiffness, if the settings request it; once per
    /// linearisation, when the state has its final forces.
    pub fn turn(&mut self, model: &Model, at: &LinearisationPoint<'_>) {
        self.copied = false;
        self.turn_into(model, at, RotationEffect::Both);
    }

    fn turn_into(&mut self, model: &Model, at: &LinearisationPoint<'_>, turned: RotationEffect) {
        if at.settings.geometry == Geometry::Frozen {
            return;
        }
        turn_points(
            &self.interfaces,
            (&mut self.stiffness, turned == RotationEffect::Both),
            (&mut self.coupling, &self.step),
            model,
        );
        let bodies = self.bodies.as_mut();
        let mut bodies = bodies.filter(|_| self.layout == Some(Layout::Bodies));
        for (interface, node) in self.interfaces.iter_mut().zip(at.contacts) {
            if !interface.point.is_empty() {
                continue;
            }
            let Some((projection, curve)) = interface.projection.and_then(|f| Some((f, f.curve?)))
            else {
                continue;
            };
            if node.f_n == 0.0 && node.f_t == 0.0 {
                continue;
            }
            for link in &mut interface.links {
                link.variation =
                    Variation::new(&projection, &curve, link.axis, link.weight, link.slope);
            }
            let force = [node.f_n, node.f_t];
            let count = interface.links.len();
            for (i, row) in interface.links.iter().enumerate() {
                let Some(equation) = model.dofs.equation[row.dof] else {
                    continue;
                };
                for (j, col) in interface.links.iter().enumerate() {
                    let value = geometric_tangent(
                        &projection,
                        &curve,
                        force,
                        &row.variation,
                        &col.variation,
                    );
                    match interface.pairs[i * count + j] {
                        Some(slot) if turned == RotationEffect::Both => match &mut bodies {
                            Some(bodies) => bodies.turn(slot, -value),
                            None => self.stiffness[slot] -= value,
                        },
                        Some(_) => {}
                        None => self.coupling[equation] -= value * self.step[col.dof],
                    }
                }
            }
        }
    }

    /// Updates the elements' history variables when displacements `u` are accepted; `before` are the previous ones.
    pub fn advance(&mut self, u: &[f64], before: &[f64], history: &mut [f64]) {
        self.assembly.advance(u, before, history);
    }

    /// Geometry of a slave node in the last linearisation.
    pub fn projection(&self, slave: usize) -> Option<&Projection> {
        self.interfaces[slave].projection.as_ref()
    }

    /// Solves the linearised system for a state's modes. The interface's result is available at once, that of the bodies after
    /// [`System::recover`].
    pub fn solve(&mut self, model: &Model, at: &LinearisationPoint<'_>) -> SolveResult {
        if self.condenses(at.chosen) || at.along.is_some() {
            self.solve_condensed(model, at)
        } else {
            self.solve_augmented(model, at)
        }
    }

    /// Table 1's rows of a node.
    pub(super) fn rows(&self, s: usize, at: &LinearisationPoint<'_>) -> [Equation; 2] {
        let (node, kinematics) = (&at.contacts[s], self.kinematics(s));
        let friction = node.friction(&at.friction[s]);
        rows::rows(node, kinematics.as_ref(), &friction, &at.settings, at.brake)
    }

    /// Position of a contact relative to its surface in the last linearisation; `None` without a surface.
    pub fn kinematics(&self, contact: usize) -> Option<NodeKinematics> {
        let interface = &self.interfaces[contact];
        let projection = interface.projection.as_ref()?;
        // Preserves a gap of -0.
        let gap = match interface.allowed {
            0.0 => projection.gap,
            allowed => projection.gap + allowed,
        };
        let gap = match interface.given {
            0.0 => gap,
            given => gap + given,
        };
        let give = interface.give();
        let point = interface.point.first();
        Some(NodeKinematics {
            gap,
            normal: point.map_or(projection.normal, |point| point.normal),
            foot: projection.foot,
            room: interface.room,
            // A force on a spring causes motion even if everything else is held.
            moves: [0, 1].map(|k| interface.moves[k] || give[k] > 0.0),
            bond: interface.bond,
        })
    }

    /// Result of the last solve at a slave node.
    pub fn solution_at(&self, slave: usize) -> NodeIncrement {
        NodeIncrement {
            force: self.condensed.forces[slave],
            motion: self.condensed.motions[slave],
        }
    }

    /// Increment of a degree of freedom in the last solve.
    pub fn increment(&self, model: &Model, dof: usize) -> f64 {
        model.dofs.equation[dof].map_or(self.step[dof], |e| self.x[e])
    }
}

/// The executor of tasks that depend on the number of entries of a pattern: starting a second thread must pay off.
pub(super) fn executor_for(entries: usize, executor: &dyn Executor) -> &dyn Executor {
    match entries < LARGE {
        true => &SequentialExecutor,
        false => executor,
    }
}

/// Displacements `u` within the current increment, with the prescribed ones.
pub(super) fn moved<'a>(
    u: &'a [f64],
    step: &'a [f64],
    at: &LinearisationPoint<'a>,
) -> AssemblyMotion<'a> {
    AssemblyMotion {
        u,
        step,
        before: at.accepted.u,
        history: at.accepted.history,
    }
}

/// The element that a node's equations involve, if it has unknowns.
fn pairing(model: &Model, node: &ContactState) -> Option<(usize, usize)> {
    node.spot
        .filter(|s| !model.surfaces[s.surface].rigid)
        .map(|s| (s.surface, s.element))
}
