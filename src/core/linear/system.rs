//! The augmented system of a major iteration (eqn 9), uncondensed: bodies, interface, right-hand side.
//!
//! Everything here is rebuilt from a [`State`]; nothing of it is saved. [`System::linearise`] freezes geometry,
//! stiffness and residual at the start of a major iteration; [`System::solve`] solves it for the modes of one minor
//! iteration. After a first pass neither allocates, unless a slave node finds another deformable master element.

use crate::contact::geometric_tangent::{Variation, turning};
use crate::contact::projection::{Projection, footing, tangent};
use crate::contact::state::ContactState;
use crate::contact::table1::{Equation, Motion};
use crate::fem::assembly::{Assembled, Assembly, Moved};
use crate::interface::kinematics::{NodeIncrement, NodeKinematics};
use crate::interface::minor;
use crate::interface::problem::{InterfaceProblem, ProblemNode};
use crate::linalg::{Factors, Pattern, SolveError};
use crate::linear::bodies::Bodies;
use crate::linear::condensed::Condensed;
use crate::linear::coupling::{Interface, Link};
use crate::linear::estimate::{Estimate, condensable};
use crate::linear::norms::Norms;
use crate::linear::sizes::{ROUND_OFF, Sizes};
use crate::model::{Beam, BodyKind, Model};
use crate::model::{Component, Geometry, Sticking};
use crate::model::{Mode, Settings};
use crate::step::state::State;
use std::sync::Arc;

/// Estimated norm of the scaled inverse from which on a system is suspected to be singular: the whole one, and that of
/// the interface, where the springs that hold a loose body cost digits before they drop out.
const SUSPICIOUS_WHOLE: f64 = 1e12;
const SUSPICIOUS_INTERFACE: f64 = 1e9;
/// An equation whose coefficients are all smaller than this (the largest is one) is empty.
const EMPTY: f64 = 1e-12;

/// How one solve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solved {
    /// The solution satisfies the equations.
    Well,
    /// It does, but the matrix is singular to working precision.
    NearlySingular,
    /// There is no solution, or none that can be computed.
    Not,
}

/// What the stiffness is laid out for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Layout {
    /// Bodies and interface in one matrix.
    Whole,
    /// The bodies alone, to be condensed.
    Bodies,
}

/// The linearised system about a state.
pub struct System {
    assembly: Assembly,
    /// What `stiffness` is laid out for.
    layout: Option<Layout>,
    whole: Option<Factors>,
    /// Whether `whole` is scaled for the present linearisation.
    scaled: bool,
    bodies: Option<Bodies>,
    estimate: Estimate,
    /// Whether the scene's bodies may be condensed by [`Bodies`].
    condensable: bool,
    /// The elements that `whole` has places for.
    pairing: Vec<Option<(usize, usize)>>,
    /// n and t of every slave node in the last condensation.
    frames: Vec<[[f64; 2]; 2]>,
    /// Sizes that the scene gives.
    pub sizes: Sizes,
    /// Current position of every node.
    pub positions: Vec<[f64; 2]>,
    interfaces: Vec<Interface>,
    condensed: Condensed,
    stiffness: Vec<f64>,
    values: Vec<f64>,
    /// Internal force at each degree of freedom.
    force: Vec<f64>,
    size: Vec<f64>,
    external: Vec<f64>,
    /// Interaction force at each degree of freedom.
    interaction: Vec<f64>,
    step: Vec<f64>,
    residual: Vec<f64>,
    coupling: Vec<f64>,
    rhs: Vec<f64>,
    x: Vec<f64>,
    work: Vec<f64>,
    /// Right-hand sides of a condensation, some at a time.
    block: Vec<f64>,
    norms: Norms,
}

impl System {
    /// Lays out the system of a scene.
    pub fn new(model: &Model) -> Self {
        let (dofs, equations) = (model.dofs.len(), model.dofs.equations);
        let interfaces: Vec<Interface> = model
            .contacts
            .iter()
            .map(|_| Interface::default())
            .collect();
        System {
            assembly: Assembly::new(model),
            layout: None,
            whole: None,
            scaled: false,
            bodies: None,
            estimate: Estimate::of(model),
            condensable: condensable(model),
            pairing: Vec::new(),
            frames: Vec::new(),
            sizes: Sizes::new(model),
            positions: vec![[0.0; 2]; model.nodes.len()],
            condensed: Condensed::new(interfaces.len()),
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
            norms: Norms::default(),
        }
    }

    /// Whether the minor iterations are solved on the condensed interface with these settings.
    pub fn condenses(&self, settings: &Settings) -> bool {
        self.estimate.is_condensed(settings.solver)
    }

    /// Current positions of all nodes at displacements u.
    pub fn place(&mut self, model: &Model, u: &[f64]) {
        for (n, position) in self.positions.iter_mut().enumerate() {
            let first = model.dofs.first[n];
            *position = [
                model.nodes[n].at[0] + u[first],
                model.nodes[n].at[1] + u[first + 1],
            ];
        }
    }

    /// Freezes geometry, stiffness and residual at a state's u, forces and load factor; [`System::turn`] completes it.
    ///
    /// # Errors
    /// [`SolveError`] if the pattern cannot be analysed.
    pub fn linearise(&mut self, model: &Model, state: &State) -> Result<(), SolveError> {
        if self.condenses(&state.controls.settings) && self.condensable {
            self.linearise_in(Layout::Bodies, model, state)
        } else {
            self.linearise_in(Layout::Whole, model, state)
        }
    }

    fn linearise_in(
        &mut self,
        layout: Layout,
        model: &Model,
        state: &State,
    ) -> Result<(), SolveError> {
        self.condensed.fresh = false;
        self.scaled = false;
        self.place(model, &state.u);
        for (interface, (node, slave)) in self
            .interfaces
            .iter_mut()
            .zip(state.nodes.iter().zip(&model.contacts))
        {
            interface.footing = node.spot.map(|spot| {
                footing(
                    &model.surfaces,
                    spot,
                    &self.positions,
                    self.positions[slave.node],
                )
            });
        }
        match layout {
            Layout::Whole => self.bind_whole(model, state)?,
            Layout::Bodies => self.bind_bodies(model, state)?,
        }
        self.load(model, state);
        self.step.fill(0.0);
        for p in &model.prescribed {
            self.step[p.dof] = p.value * p.scale.at(state.target) - state.u[p.dof];
        }
        let out = Assembled {
            force: &mut self.force,
            size: &mut self.size,
            values: &mut self.stiffness,
            coupling: &mut self.coupling,
        };
        let moved = Moved {
            u: &state.u,
            step: &self.step,
            before: &state.start.u,
            history: &state.start.history,
        };
        self.assembly.assemble(&model.dofs, moved, out);
        if let (Layout::Bodies, Some(bodies)) = (layout, &mut self.bodies) {
            bodies.turning.fill(0.0);
        }
        self.measure_interfaces(model);
        self.balance(model, state);
        Ok(())
    }

    /// Renews the pattern where a slave node has found another element with unknowns; rigid ones have no entries.
    fn bind_whole(&mut self, model: &Model, state: &State) -> Result<(), SolveError> {
        let changed = self.whole.is_none()
            || state
                .nodes
                .iter()
                .zip(&self.pairing)
                .any(|(node, pair)| pairing(model, node) != *pair);
        self.link(model, state);
        if changed {
            self.pairing.clear();
            self.pairing
                .extend(state.nodes.iter().map(|node| pairing(model, node)));
            self.analyse(model)?;
        }
        let Some(factors) = &self.whole else {
            return Ok(());
        };
        if changed || self.layout != Some(Layout::Whole) {
            let size = factors.pattern().size();
            self.assembly.bind(&model.dofs, factors.pattern(), false);
            self.stiffness.resize(factors.pattern().entries(), 0.0);
            self.values.resize(factors.pattern().entries(), 0.0);
            for buffer in [&mut self.rhs, &mut self.x, &mut self.work] {
                buffer.resize(size, 0.0);
            }
            self.layout = Some(Layout::Whole);
            self.interfaces.iter_mut().for_each(|i| i.placed = false);
        }
        for (s, interface) in self.interfaces.iter_mut().enumerate() {
            interface.find_slots(model, factors.pattern(), model.dofs.equations + 2 * s);
        }
        Ok(())
    }

    /// The bodies' own pattern never changes.
    fn bind_bodies(&mut self, model: &Model, state: &State) -> Result<(), SolveError> {
        self.link(model, state);
        if self.bodies.is_none() {
            self.bodies = Some(Bodies::new(model, self.assembly.entries(&model.dofs))?);
        }
        let Some(bodies) = &self.bodies else {
            return Ok(());
        };
        if self.layout != Some(Layout::Bodies) {
            self.assembly.bind(&model.dofs, bodies.pattern(), true);
            self.stiffness.resize(bodies.pattern().entries(), 0.0);
            for buffer in [&mut self.rhs, &mut self.x, &mut self.work] {
                buffer.resize(model.dofs.equations, 0.0);
            }
            self.layout = Some(Layout::Bodies);
            self.interfaces.iter_mut().for_each(|i| i.placed = false);
        }
        for interface in &mut self.interfaces {
            interface.find_unknowns(model, bodies);
        }
        Ok(())
    }

    fn link(&mut self, model: &Model, state: &State) {
        let slaves = state.nodes.iter().zip(&model.contacts);
        for (interface, (node, slave)) in self.interfaces.iter_mut().zip(slaves) {
            interface.link(model, node, slave.node);
        }
    }

    /// The pattern that `stiffness` has its values in.
    fn pattern(&self) -> Option<&Arc<Pattern>> {
        match self.layout? {
            Layout::Whole => self.whole.as_ref().map(Factors::pattern),
            Layout::Bodies => self.bodies.as_ref().map(Bodies::pattern),
        }
    }

    fn analyse(&mut self, model: &Model) -> Result<(), SolveError> {
        let equations = model.dofs.equations;
        let mut entries = self.assembly.entries(&model.dofs);
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
        let size = equations + 2 * self.interfaces.len();
        let pattern = Arc::new(Pattern::new(size, entries));
        self.whole = Some(Factors::in_groups(pattern, &self.groups(model))?);
        Ok(())
    }

    /// Groups of unknowns, for the elimination: a node's displacements, with the forces of its interface equations; each
    /// of the bodies' own unknowns. Where a slave node has no displacement, its forces go with a master node's. An
    /// element of a shear-rigid beam has one shear force more than nodes inside, which all may be held by their contacts:
    /// the last of these forces goes with a node at its end.
    fn groups(&self, model: &Model) -> Vec<usize> {
        let dofs = &model.dofs;
        let mut groups = vec![0; dofs.equations + 2 * self.interfaces.len()];
        let mut node_of = vec![None; dofs.len()];
        for (node, (&first, &count)) in dofs.first.iter().zip(&dofs.count).enumerate() {
            node_of[first..first + count as usize].fill(Some(node));
        }
        for body in &model.bodies {
            if let BodyKind::Beam(beam) = &body.kind {
                give_shears(model, beam, &mut node_of);
            }
        }
        let mut more = dofs.first.len()..;
        for (dof, equation) in dofs.equation.iter().enumerate() {
            if let Some(equation) = equation {
                groups[*equation] = node_of[dof].or_else(|| more.next()).unwrap_or(0);
            }
        }
        for (s, interface) in self.interfaces.iter().enumerate() {
            let free = |link: &&Link| dofs.equation[link.dof].is_some();
            let home = interface
                .links
                .iter()
                .find(free)
                .and_then(|l| node_of[l.dof]);
            let home = home.or_else(|| more.next()).unwrap_or(0);
            let row = dofs.equations + 2 * s;
            groups[row..row + 2].fill(home);
        }
        groups
    }

    fn measure_interfaces(&mut self, model: &Model) {
        for interface in &mut self.interfaces {
            interface.prescribed = [0.0; 2];
            interface.moves = [false; 2];
            let Some(frame) = interface.footing.map(|f| [f.normal, tangent(f.normal)]) else {
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

    /// Adds what turning and travelling interaction forces do to the stiffness, where the settings want it; once
    /// after each linearisation, when the state has its final forces.
    pub fn turn(&mut self, model: &Model, state: &State) {
        if state.controls.settings.geometry == Geometry::Frozen {
            return;
        }
        let matrix = match (self.layout, &mut self.bodies) {
            (Some(Layout::Bodies), Some(bodies)) => &mut bodies.turning,
            _ => &mut self.stiffness,
        };
        for (interface, node) in self.interfaces.iter_mut().zip(&state.nodes) {
            let Some((footing, curve)) = interface.footing.and_then(|f| Some((f, f.curve?))) else {
                continue;
            };
            if node.f_n == 0.0 && node.f_t == 0.0 {
                continue;
            }
            for link in &mut interface.links {
                link.variation =
                    Variation::new(&footing, &curve, link.axis, link.weight, link.slope);
            }
            let force = [node.f_n, node.f_t];
            let count = interface.links.len();
            for (i, row) in interface.links.iter().enumerate() {
                let Some(equation) = model.dofs.equation[row.dof] else {
                    continue;
                };
                for (j, col) in interface.links.iter().enumerate() {
                    let value = turning(&footing, &curve, force, &row.variation, &col.variation);
                    match interface.pairs[i * count + j] {
                        Some(slot) => matrix[slot] -= value,
                        None => self.coupling[equation] -= value * self.step[col.dof],
                    }
                }
            }
        }
    }

    /// Out-of-balance force R − F of eqn (22) and its norms.
    fn balance(&mut self, model: &Model, state: &State) {
        self.interaction.fill(0.0);
        for (interface, node) in self.interfaces.iter().zip(&state.nodes) {
            let force = node.force();
            for link in &interface.links {
                self.interaction[link.dof] -= link.weight * force[link.axis];
            }
        }
        let tolerance = state.controls.settings.tolerance;
        let mut scale = self.sizes.reference.max(self.sizes.least_scale(tolerance));
        let (mut force, mut length) = (0.0_f64, 0.0_f64);
        for (d, equation) in model.dofs.equation.iter().enumerate() {
            let balance = self.external[d] + self.interaction[d] - self.force[d];
            match self.sizes.lever(d) {
                None => length = length.max(balance.abs() / model.length),
                Some(lever) => {
                    scale = scale
                        .max(self.size[d] / lever)
                        .max(self.external[d].abs() / lever);
                    if equation.is_some() {
                        force = force.max(balance.abs() / lever);
                    }
                }
            }
            if let Some(equation) = equation {
                self.residual[*equation] = balance;
            }
        }
        let [floor, length_floor] = self.round_off(model, &state.u);
        let relative = |force: f64| if force > 0.0 { force / scale } else { 0.0 };
        let wanted = self.sizes.wanted(model, state, |dof| self.nodal_force(dof));
        let noise = if floor > 0.0 { floor / wanted } else { 0.0 };
        self.norms = Norms {
            force,
            relative: relative(force).max(length),
            interface: 0.0,
            correction: state.correction,
            scale,
            limit: tolerance
                .max(relative(floor))
                .max(length_floor / model.length),
            noise: noise.max(length_floor / model.length),
        };
        self.norms.interface = self.violation(model, state);
    }

    /// Aims the last linearisation at another load, at the same displacements; nothing else of it changes where no motion is
    /// prescribed and no element remembers what was accepted.
    pub fn aim(&mut self, model: &Model, state: &State) {
        self.load(model, state);
        self.balance(model, state);
    }

    fn load(&mut self, model: &Model, state: &State) {
        self.external.fill(0.0);
        for load in &model.loads {
            self.external[load.dof] += load.value * load.scale.at(state.target);
        }
    }

    /// Renews the residual after the forces of the interface were changed, geometry and stiffness staying.
    pub fn rebalance(&mut self, model: &Model, state: &State) {
        self.balance(model, state);
    }

    /// MajorCycle-off of the internal forces, and of the lengths that are to vanish: the machine precision times |K| |u|.
    fn round_off(&mut self, model: &Model, u: &[f64]) -> [f64; 2] {
        let Some(pattern) = self.pattern().cloned() else {
            return [0.0; 2];
        };
        self.x.fill(0.0);
        for (d, equation) in model.dofs.equation.iter().enumerate() {
            if let Some(e) = equation {
                self.x[*e] = u[d];
            }
        }
        let half = self.layout == Some(Layout::Bodies);
        pattern.multiply_abs(&self.stiffness, &self.x, &mut self.work, half);
        let mut worst = [0.0_f64; 2];
        for (d, equation) in model.dofs.equation.iter().enumerate() {
            let Some(e) = *equation else { continue };
            match self.sizes.lever(d) {
                Some(lever) => worst[0] = worst[0].max(self.work[e] / lever),
                None => worst[1] = worst[1].max(self.work[e]),
            }
        }
        worst.map(|worst| ROUND_OFF * f64::EPSILON * worst)
    }

    /// Largest relative violation of the interface conditions by a state's forces and gaps.
    fn violation(&self, model: &Model, state: &State) -> f64 {
        let mut worst = 0.0_f64;
        // Also in the middle of a major iteration this is about what it began with.
        let first = state.minor_history.first(state.nodes.len());
        for (s, node) in state.nodes.iter().enumerate() {
            let (mode, t_max) = match first.get(s) {
                Some(input) => (input.mode, input.t_max),
                None => (node.mode, node.t_max),
            };
            let Some(gap) = self.interfaces[s].footing.map(|f| f.gap) else {
                continue;
            };
            let length = match mode {
                Mode::Free => (-gap).max(0.0),
                _ => gap.abs(),
            };
            let force = match mode {
                Mode::Sliding => (node.f_t - t_max).abs(),
                _ => 0.0,
            };
            let anchored =
                state.controls.settings.sticking == Sticking::Anchored || node.corner.is_some();
            let drift = match mode {
                Mode::Fixed if anchored && self.interfaces[s].moves[1] => node.drift.abs(),
                _ => 0.0,
            };
            worst = worst.max(length.max(drift) / model.length);
            if force > 0.0 {
                worst = worst.max(force / self.norms.scale);
            }
        }
        worst
    }

    /// Renews what the elements remember, once displacements `u` are accepted; `before` are those accepted last.
    pub fn advance(&mut self, u: &[f64], before: &[f64], history: &mut [f64]) {
        self.assembly.advance(u, before, history);
    }

    /// Norms of the last linearisation, with the interface conditions of this state: what is told of it must not hang on
    /// whether the workspace was made anew since.
    pub fn norms_of(&mut self, model: &Model, state: &State) -> Norms {
        self.norms.interface = self.violation(model, state);
        self.norms
    }

    /// Norms of the last linearisation.
    pub fn norms(&self) -> Norms {
        self.norms
    }

    /// Geometry of a slave node in the last linearisation.
    pub fn footing(&self, slave: usize) -> Option<&Projection> {
        self.interfaces[slave].footing.as_ref()
    }

    /// Whether any unknown takes part in a slave node's normal and tangential motion.
    pub fn moves(&self, slave: usize) -> [bool; 2] {
        self.interfaces[slave].moves
    }

    /// Internal force at each degree of freedom in the last linearisation.
    pub fn internal(&self) -> &[f64] {
        &self.force
    }

    /// Internal force less applied load at a degree of freedom: what support or surface must give there.
    pub fn nodal_force(&self, dof: usize) -> f64 {
        self.force[dof] - self.external[dof]
    }

    /// Interaction force at a degree of freedom in the last linearisation.
    pub fn interaction(&self, dof: usize) -> f64 {
        self.interaction[dof]
    }

    /// Solves the linearised system for a state's modes; the interface's answer is there at once, that of the
    /// bodies after [`System::recover`].
    pub fn solve(&mut self, model: &Model, state: &State) -> Solved {
        if self.condenses(&state.controls.settings) {
            self.solve_condensed(model, state)
        } else {
            self.solve_augmented(model, state)
        }
    }

    fn solve_augmented(&mut self, model: &Model, state: &State) -> Solved {
        self.condensed.fresh = false;
        self.scale(model, state);
        self.start_values();
        let unknowns = model.dofs.equations;
        for s in 0..self.interfaces.len() {
            let rows = self.rows(s, state);
            let frame = self.interfaces[s].frame(&state.nodes[s]);
            for (k, row) in rows.iter().enumerate() {
                self.rhs[unknowns + 2 * s + k] = self.place_row(s, k, row, frame);
            }
        }
        let solved = self.factor_and_solve();
        for (s, node) in state.nodes.iter().enumerate() {
            let row = unknowns + 2 * s;
            self.condensed.forces[s] = [self.x[row], self.x[row + 1]];
            self.condensed.motions[s] = self.motion_of_solution(model, s, node);
        }
        solved
    }

    /// Finds the scale of all systems of this linearisation: that of the one in which every node is held.
    fn scale(&mut self, model: &Model, state: &State) {
        if std::mem::replace(&mut self.scaled, true) {
            return;
        }
        self.start_values();
        for s in 0..self.interfaces.len() {
            let frame = self.interfaces[s].frame(&state.nodes[s]);
            for (k, row) in springs(0.0).iter().enumerate() {
                self.place_row(s, k, row, frame);
            }
        }
        self.sizes.units(model, self.spring(model), &mut self.work);
        if let Some(factors) = &mut self.whole {
            factors.scale(&self.values, model.dofs.equations, &self.work);
        }
    }

    /// Stiffness and out-of-balance forces, without any interface.
    fn start_values(&mut self) {
        self.values.copy_from_slice(&self.stiffness);
        self.start_rhs();
    }

    fn start_rhs(&mut self) {
        let balance = self.residual.iter().zip(&self.coupling);
        for (rhs, (residual, coupling)) in self.rhs.iter_mut().zip(balance) {
            *rhs = residual - coupling;
        }
    }

    /// Enters an equation of a slave node, and the column of its force; returns the equation's right-hand side.
    fn place_row(&mut self, s: usize, k: usize, row: &Equation, frame: [[f64; 2]; 2]) -> f64 {
        let interface = &self.interfaces[s];
        self.values[interface.block[2 * k]] = row.d_n;
        self.values[interface.block[2 * k + 1]] = row.d_t;
        let direction = match row.motion {
            Motion::None => [0.0; 2],
            Motion::Normal => frame[0],
            Motion::Tangential => frame[1],
        };
        for link in &interface.links {
            let Some(slots) = link.slots else { continue };
            self.values[slots[2 * k]] += link.weight * direction[link.axis];
            self.values[slots[2 * k + 1]] += link.weight * frame[k][link.axis];
        }
        row.value - dot(direction, interface.prescribed)
    }

    fn factor_and_solve(&mut self) -> Solved {
        let Some(factors) = &mut self.whole else {
            return Solved::Not;
        };
        if factors.factor(&self.values).is_err() || factors.solve(&self.rhs, &mut self.x).is_err() {
            return Solved::Not;
        }
        suspicion(factors.inverse_norm())
    }

    /// Solves for the interface alone, about a compliance of it that is made once a major iteration.
    fn solve_condensed(&mut self, model: &Model, state: &State) -> Solved {
        if !self.condensed.fresh {
            self.condensed.norm = match self.condense(model, state) {
                Ok(norm) => norm,
                Err(_) => return Solved::Not,
            };
            self.condensed.fresh = true;
        }
        self.condensed.clear();
        for s in 0..self.interfaces.len() {
            let rows = self.rows(s, state);
            let frame = self.frames[s];
            let prescribed = frame.map(|direction| dot(direction, self.interfaces[s].prescribed));
            for (k, row) in rows.iter().enumerate() {
                self.condensed.place_row(s, k, row, prescribed);
            }
        }
        let Ok(norm) = self.condensed.solve() else {
            return Solved::Not;
        };
        for (s, frame) in self.frames.iter().enumerate() {
            let prescribed = frame.map(|direction| dot(direction, self.interfaces[s].prescribed));
            self.condensed.read(s, prescribed);
        }
        if norm > SUSPICIOUS_INTERFACE {
            return Solved::NearlySingular;
        }
        suspicion(self.condensed.norm)
    }

    /// The interface problem of the last linearisation, to be looked at by itself; costs a condensation, unless the
    /// minor iterations have made it already.
    ///
    /// # Errors
    /// [`SolveError`] where the bodies cannot be condensed.
    pub fn frozen(&mut self, model: &Model, state: &State) -> Result<InterfaceProblem, SolveError> {
        if !self.condensed.fresh {
            if self.estimate.condensed.bytes > self.estimate.budget {
                return Err(SolveError::OutOfMemory);
            }
            self.condensed.norm = self.condense(model, state)?;
            self.condensed.fresh = true;
        }
        let relation = self.condensed.relation.clone();
        let nodes = state
            .nodes
            .iter()
            .enumerate()
            .map(|(slave, node)| ProblemNode {
                slave,
                site: self.site(slave, node),
                prescribed: self.frames[slave].map(|d| dot(d, self.interfaces[slave].prescribed)),
                friction: node.friction(&state.controls.friction[slave]),
                state: *node,
            });
        let largest = relation.start.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        Ok(InterfaceProblem {
            nodes: nodes.collect(),
            force: if self.norms.scale > 0.0 {
                self.norms.scale
            } else {
                largest
            },
            length: model.length,
            spring: self.spring(model),
            settings: state.settings(),
            relation,
        })
    }

    /// Condenses the bodies to the interface; returns an estimate of the norm of the inverse of what was factored.
    ///
    /// Bodies that [`Bodies`] cannot factor in this state are factored with the interface, and with pivoting.
    fn condense(&mut self, model: &Model, state: &State) -> Result<f64, SolveError> {
        self.condensed.resize(self.interfaces.len())?;
        self.frames.clear();
        let nodes = self.interfaces.iter().zip(&state.nodes);
        self.frames.extend(nodes.map(|(i, node)| i.frame(node)));
        if self.layout == Some(Layout::Bodies) {
            self.condensed.relation.stiffness = self.spring(model);
            self.start_rhs();
            if let Some(bodies) = &mut self.bodies
                && let Ok(norm) = bodies.condense(
                    &self.stiffness,
                    &self.rhs,
                    &self.interfaces,
                    &self.frames,
                    &mut self.condensed.relation,
                )
            {
                return Ok(norm);
            }
            self.linearise_in(Layout::Whole, model, state)?;
            self.turn(model, state);
        }
        self.condensed.relation.stiffness = self.spring(model);
        self.condense_whole(model, state)
    }

    /// Condenses with every interface equation replaced by `motion − ΔF / stiffness = z`: the forces are then a linear
    /// function of z, found column by column.
    fn condense_whole(&mut self, model: &Model, state: &State) -> Result<f64, SolveError> {
        self.scale(model, state);
        self.start_values();
        let unknowns = model.dofs.equations;
        let give = -1.0 / self.condensed.relation.stiffness;
        for s in 0..self.interfaces.len() {
            for (k, row) in springs(give).iter().enumerate() {
                self.place_row(s, k, row, self.frames[s]);
                self.rhs[unknowns + 2 * s + k] = 0.0;
            }
        }
        let Some(factors) = &mut self.whole else {
            return Err(SolveError::Singular);
        };
        factors.factor(&self.values)?;
        factors.solve(&self.rhs, &mut self.x)?;
        let norm = factors.inverse_norm();
        self.condensed
            .relation
            .start
            .copy_from_slice(&self.x[unknowns..]);
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
            }
        }
        Ok(norm)
    }

    /// Stiffness of the springs. What lies k times above or below it loses as many digits when the springs drop out, so
    /// it is midway between the stiffest degree of freedom of the interface and the softest body as a whole.
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

    /// Completes a solve: finds what it does to the bodies. Costs one back substitution where the bodies were
    /// condensed, else nothing.
    pub fn recover(&mut self, model: &Model) -> Solved {
        if !self.condensed.fresh {
            return Solved::Well;
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
            Ok(()) => Solved::Well,
            Err(_) => Solved::Not,
        }
    }

    /// Table 1's rows of a node.
    fn rows(&self, s: usize, state: &State) -> [Equation; 2] {
        let (node, site) = (&state.nodes[s], self.site(s, &state.nodes[s]));
        let friction = node.friction(&state.controls.friction[s]);
        minor::rows(node, &site, &friction, &state.settings())
    }

    /// A slave node's surroundings in the last linearisation.
    pub fn site(&self, slave: usize, node: &ContactState) -> NodeKinematics {
        let interface = &self.interfaces[slave];
        let footing = interface.footing.as_ref();
        NodeKinematics {
            gap: footing.map_or(f64::INFINITY, |f| f.gap),
            normal: footing.map_or(node.normal, |f| f.normal),
            foot: footing.map_or([f64::NAN; 2], |f| f.foot),
            moves: interface.moves,
        }
    }

    /// What the last solve gave at a slave node.
    pub fn given(&self, slave: usize) -> NodeIncrement {
        NodeIncrement {
            force: self.condensed.forces[slave],
            motion: self.condensed.motions[slave],
        }
    }

    /// Increments ΔF_n, ΔF_t of a slave node in the last solve.
    pub fn force_increment(&self, slave: usize) -> [f64; 2] {
        self.condensed.forces[slave]
    }

    /// Normal and tangential part of Δu_S* − Δu_S of a slave node in the last solve.
    pub fn relative_motion(&self, slave: usize) -> [f64; 2] {
        self.condensed.motions[slave]
    }

    fn motion_of_solution(&self, model: &Model, slave: usize, node: &ContactState) -> [f64; 2] {
        let interface = &self.interfaces[slave];
        let mut motion = [0.0; 2];
        for link in &interface.links {
            motion[link.axis] += link.weight * self.increment(model, link.dof);
        }
        let frame = interface.frame(node);
        [dot(frame[0], motion), dot(frame[1], motion)]
    }

    /// Increment of a degree of freedom in the last solve.
    pub fn increment(&self, model: &Model, dof: usize) -> f64 {
        model.dofs.equation[dof].map_or(self.step[dof], |e| self.x[e])
    }
}

/// Says of every element's last shear force that it goes with the node at the element's end, or, where the beam's own end
/// does not turn freely, at its start.
fn give_shears(model: &Model, beam: &Beam, node_of: &mut [Option<usize>]) {
    let turns = |node: &usize| {
        let dof = model.dofs.dof(*node, Component::Rotation);
        dof.is_some_and(|dof| model.dofs.equation[dof].is_some())
    };
    let last = beam.elements.last().and_then(|nodes| nodes.last());
    let at_end = last.is_some_and(turns);
    for (e, nodes) in beam.elements.iter().enumerate() {
        let end = if at_end { nodes.last() } else { nodes.first() };
        if let (Some(first), Some(node)) = (beam.first_shear, end.filter(|n| turns(n))) {
            node_of[first + (e + 1) * (nodes.len() - 1) - 1] = Some(*node);
        }
    }
}

/// `motion − ΔF / stiffness = 0` in both directions, for `give` = −1 / stiffness.
fn springs(give: f64) -> [Equation; 2] {
    [
        Equation {
            motion: Motion::Normal,
            d_n: give,
            d_t: 0.0,
            value: 0.0,
        },
        Equation {
            motion: Motion::Tangential,
            d_n: 0.0,
            d_t: give,
            value: 0.0,
        },
    ]
}

fn suspicion(inverse_norm: f64) -> Solved {
    if inverse_norm > SUSPICIOUS_WHOLE {
        Solved::NearlySingular
    } else {
        Solved::Well
    }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The element that a node's equations reach into, if that has unknowns.
fn pairing(model: &Model, node: &ContactState) -> Option<(usize, usize)> {
    node.spot
        .filter(|s| !model.surfaces[s.surface].rigid)
        .map(|s| (s.surface, s.element))
}
