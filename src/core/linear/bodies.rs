//! The program's own bodies as a source: beams, continua and matrix bodies, over surfaces followed by projection.

use crate::contact::balance::{self, Forces};
use crate::contact::judge::{Judge, JudgedState};
use crate::contact::stick_point::pierced;
use crate::contact::tracking::Ground;
use crate::executor::{Executor, SequentialExecutor};
use crate::fem::assembly::history_len;
use crate::fem::deformation::deformation;
use crate::groups::marked;
use crate::linalg::SolveError;
use crate::linear::point_forces::PointForces;
use crate::linear::residual::loads;
use crate::linear::singular;
use crate::linear::sizes::Sizes;
use crate::linear::source::value;
use crate::linear::system::System;
use crate::linear::tangent::Tangent;
use crate::model::{Contact, MonitorQuantity, Surface};
use crate::plane::{larger, plus};
use crate::{
    ContactState, Deformation, Estimate, Friction, InterfaceProblem, JudgedLaw, LinearisationPoint,
    Mode, Model, NodeIncrement, NodeKinematics, Norms, Scales, Settings, Singular, SolveResult,
    Source, Stability, SurfacePoint, Verdict, Work,
};
use std::sync::Arc;

/// Minimum relative tolerance for violations of laws; it is larger if the settings' tolerance or round-off is larger.
const TOLERANCE: f64 = 1e-8;
/// Ratio of the judge's tolerance to the tolerance of the iterations.
const TIMES: f64 = 10.0;

/// The bodies of a model.
pub struct Bodies {
    model: Arc<Model>,
    system: System,
    bench: Bench,
    /// Data for stability checks, created on first use.
    tangent: Option<Tangent>,
    /// Whether the force of each contact can be computed from the stresses ([`stresses_tell`]).
    stresses_known: Vec<bool>,
    /// Whether any contact starts inside and is pushed out over the first leg.
    overlaps: bool,
    /// Fraction of these overlaps that is still open.
    unclosed: f64,
    /// Whether any bond has a compliance along n.
    gives: bool,
    /// Contacts over elements with local flexibility in the last accepted state.
    points: PointForces,
}

/// The judge and its workspace.
struct Bench {
    judge: Judge,
    /// Positions of all nodes in the last accepted state.
    before: Vec<[f64; 2]>,
    /// Remaining overlaps per contact, as displacements that would remove them: now, and in the last accepted state, where they
    /// include the deformation of the bond.
    out: [Vec<[f64; 2]>; 2],
    forces: Vec<[f64; 2]>,
    brought: Vec<f64>,
    earlier: Vec<f64>,
    anchored: Vec<f64>,
    ties: Vec<Option<SurfacePoint>>,
    /// Contact force at every node.
    contact: Vec<[f64; 2]>,
    /// Load at every degree of freedom.
    load: Vec<f64>,
}

impl Bodies {
    /// The bodies of a model, processed sequentially.
    pub fn new(model: Arc<Model>) -> Self {
        Bodies::with_executor(model, Arc::new(SequentialExecutor))
    }

    /// The bodies of a model, processed in parallel by an executor; the results are the same.
    pub fn with_executor(model: Arc<Model>, executor: Arc<dyn Executor>) -> Self {
        let (nodes, contacts) = (model.nodes.len(), model.contacts.len());
        Bodies {
            system: System::new(&model, executor),
            bench: Bench {
                judge: Judge::with_capacity(nodes, contacts),
                before: Vec::with_capacity(nodes),
                out: [Vec::new(), Vec::new()],
                forces: Vec::with_capacity(contacts),
                brought: Vec::with_capacity(contacts),
                earlier: Vec::with_capacity(contacts),
                anchored: Vec::with_capacity(contacts),
                ties: Vec::with_capacity(contacts),
                contact: vec![[0.0; 2]; nodes],
                load: vec![0.0; model.dofs.len()],
            },
            tangent: None,
            stresses_known: stresses_tell(&model),
            overlaps: model.contacts.iter().any(|contact| contact.overlap > 0.0),
            gives: model
                .contacts
                .iter()
                .any(|contact| contact.bond.give()[0] > 0.0),
            points: PointForces::default(),
            unclosed: 0.0,
            model,
        }
    }

    /// Current positions of the contacts' surfaces and nodes.
    fn ground(&self) -> Ground<'_> {
        let norms = &self.system.norms;
        Ground {
            surfaces: &self.model.surfaces,
            positions: &self.system.positions,
            // Small enough that the judge does not detect the difference.
            same_force: 0.5 * (TIMES * norms.limit).max(TOLERANCE) * norms.scale,
            unclosed: self.unclosed,
        }
    }

    /// Rotates the normals of contacts over elements with local flexibility according to the current forces.
    fn turn_normals(&mut self, contacts: &mut [ContactState]) {
        if self.system.has_points {
            let (points, positions) = (&mut self.system.points, &self.system.positions);
            points.find(&self.model, positions, contacts);
            for press in points.all() {
                contacts[press.contact].normal = press.normal;
            }
        }
    }

    fn scales(&self, tolerance: f64, after: &Norms) -> Scales {
        Scales {
            length: self.model.length,
            force: after.scale.max(f64::MIN_POSITIVE),
            lengths: (TIMES * tolerance).max(TOLERANCE),
            forces: (TIMES * tolerance.max(after.limit)).max(TOLERANCE),
        }
    }
}

/// Whether the force of each contact can be computed from the stresses. It cannot if a support or a second contact contributes to
/// its node's force, or if the node belongs to a master surface.
fn stresses_tell(model: &Model) -> Vec<bool> {
    let masters = model.surfaces.iter().filter(|surface| !surface.rigid);
    let master = marked(model.nodes.len(), masters.flat_map(Surface::nodes));
    let mut contacts = vec![0; model.nodes.len()];
    let carriers = model.contacts.iter().flat_map(Contact::carriers);
    carriers.for_each(|(node, _)| contacts[node] += 1);
    let tell = |node: usize| {
        let first = model.dofs.first[node];
        let held = (0..2).any(|k| model.dofs.equation[first + k].is_none());
        !held && !master[node] && contacts[node] == 1
    };
    model.contacts.iter().map(|c| tell(c.node)).collect()
}

/// Whether two models differ only in friction, loads, history and settings, which do not affect the layout.
fn is_laid_out_alike(one: &Model, other: &Model) -> bool {
    let memory = |model: &Model| (model.settings.memory, model.budget, model.length);
    let mut contacts = one.contacts.iter().zip(&other.contacts);
    let stands_alike = |(a, b): (&Contact, &Contact)| {
        (
            a.node,
            &a.weights,
            &a.surfaces,
            &a.facing,
            a.overlap,
            a.bond,
        ) == (
            b.node,
            &b.weights,
            &b.surfaces,
            &b.facing,
            b.overlap,
            b.bond,
        )
    };
    one.contacts.len() == other.contacts.len()
        && contacts.all(stands_alike)
        && memory(one) == memory(other)
        && one.dofs == other.dofs
        && one.nodes == other.nodes
        && one.surfaces == other.surfaces
        && one.bodies == other.bodies
}

impl Source for Bodies {
    fn start(&self) -> Vec<f64> {
        vec![0.0; self.model.dofs.len()]
    }

    fn history(&self) -> Vec<f64> {
        vec![0.0; history_len(&self.model)]
    }

    fn follow(
        &mut self,
        u: &[f64],
        contacts: &mut [ContactState],
        friction: &[Friction],
        anew: bool,
        unclosed: f64,
    ) {
        self.unclosed = unclosed;
        self.system.place(&self.model, u);
        let slaves = &self.model.contacts;
        self.ground().follow(contacts, slaves, friction, anew);
        self.turn_normals(contacts);
    }

    fn held_in_corner(
        &self,
        contact: usize,
        state: &ContactState,
        motion: Option<f64>,
    ) -> Option<ContactState> {
        self.ground()
            .held_in_corner(state, &self.model.contacts[contact], motion)
    }

    fn brakes(&self) -> bool {
        true
    }

    fn place_stick_points(&mut self, contacts: &mut [ContactState]) {
        self.ground().place_anchors(contacts, &self.model.contacts);
    }

    fn renew(&mut self, model: &Arc<Model>) -> bool {
        let same = is_laid_out_alike(&self.model, model);
        if same {
            self.system.sizes = Sizes::new(model);
            self.system.estimate = Estimate::from_model(model);
            self.system.done = Work::default();
            self.tangent = None;
            self.model = model.clone();
        }
        same
    }

    fn linearise(&mut self, at: &LinearisationPoint<'_>) -> Result<(), SolveError> {
        self.system.linearise(&self.model, at)
    }

    fn turn(&mut self, at: &LinearisationPoint<'_>) {
        self.system.turn(&self.model, at);
    }

    fn aim(&mut self, at: &LinearisationPoint<'_>) -> bool {
        // A following pressure has a stiffness that depends on the load.
        let dead = self.model.has_dead_loads();
        let holds =
            dead && at.accepted.history.is_empty() && !(self.system.dragged || at.drag.is_some());
        if holds {
            self.system.aim(&self.model, at);
        }
        holds
    }

    fn norms(&mut self, at: &LinearisationPoint<'_>) -> Norms {
        self.system.norms_of(&self.model, at)
    }

    fn required_force(&self) -> f64 {
        self.system.required_force(&self.model)
    }

    fn largest_residual(&self) -> Option<(usize, f64)> {
        self.system.largest(&self.model)
    }

    fn kinematics(&self, contact: usize) -> Option<NodeKinematics> {
        self.system.kinematics(contact)
    }

    fn solve(&mut self, at: &LinearisationPoint<'_>) -> SolveResult {
        self.system.solve(&self.model, at)
    }

    fn load_step(&self) -> f64 {
        self.system.border.load_step
    }

    fn follows_paths(&self) -> bool {
        true
    }

    fn increment(&self, contact: usize) -> NodeIncrement {
        self.system.solution_at(contact)
    }

    fn problem(&mut self, at: &LinearisationPoint<'_>) -> Result<InterfaceProblem, SolveError> {
        self.system.problem(&self.model, at)
    }

    fn spring(&self) -> f64 {
        self.system.spring(&self.model)
    }

    fn condenses(&self, settings: &Settings) -> bool {
        self.system.condenses(settings)
    }

    fn recover(&mut self) -> SolveResult {
        self.system.recover(&self.model)
    }

    fn advance(&mut self, u: &mut [f64]) -> f64 {
        let mut largest = 0.0_f64;
        for &first in &self.model.dofs.first {
            for d in first..first + 2 {
                largest = larger(largest, self.system.increment(&self.model, d).abs());
            }
        }
        for (d, u) in u.iter_mut().enumerate() {
            *u += self.system.increment(&self.model, d);
        }
        for contact in self.model.contacts.iter().filter(|c| !c.weights.is_empty()) {
            let first = &self.model.dofs.first;
            for axis in 0..2 {
                let parts = contact
                    .carriers()
                    .map(|(n, weight)| weight * u[first[n] + axis]);
                let sum = parts.sum();
                u[first[contact.node] + axis] = sum;
            }
        }
        largest
    }

    fn stick_point(&self, contact: usize, state: &ContactState) -> Option<SurfacePoint> {
        let (point, over) = state.spot.zip(self.system.projection(contact))?;
        let positions = &self.system.positions;
        pierced(&self.model.surfaces, point, over, state.ratio, positions)
    }

    fn take_forces_from_stresses(&mut self, contacts: &mut [ContactState]) -> bool {
        let mut changed = false;
        for (k, state) in contacts.iter_mut().enumerate() {
            if state.mode == Mode::Free || !self.stresses_known[k] {
                continue;
            }
            let first = self.model.dofs.first[self.model.contacts[k].node];
            let force = [
                self.system.nodal_force(first),
                self.system.nodal_force(first + 1),
            ];
            let ([c, s], before) = (state.normal, state.f_t);
            state.f_n = c * force[0] + s * force[1];
            state.f_t = -s * force[0] + c * force[1];
            let give = self.model.contacts[k].bond.give()[1];
            if give > 0.0 {
                state.drift += give * (before - state.f_t);
            }
            changed = true;
        }
        // A restored state computes its normals from the same forces.
        self.turn_normals(contacts);
        changed
    }

    fn rebalance(&mut self, at: &LinearisationPoint<'_>) {
        self.system.balance(&self.model, at);
    }

    fn accept(&mut self, u: &[f64], before: &[f64], history: &mut [f64]) {
        self.system.advance(u, before, history);
    }

    fn explain(&self, contacts: &[ContactState]) -> Singular {
        let at = (&self.system.positions[..], &self.system.external[..]);
        let projection = |contact: usize| self.system.projection(contact);
        singular::diagnose(&self.model, at, contacts, projection)
    }

    fn position(&self, contact: usize) -> [f64; 2] {
        self.system.positions[self.model.contacts[contact].node]
    }

    fn largest_motion(&self, u: &[f64]) -> f64 {
        self.system.sizes.largest_motion(u)
    }

    fn moved(&self, u: &[f64], before: &[f64]) -> f64 {
        let moved = |d: usize| (u[d] - before[d]).abs();
        let nodes = self.model.dofs.first.iter();
        nodes.fold(0.0, |most: f64, &first| {
            larger(most, larger(moved(first), moved(first + 1)))
        })
    }

    fn judge(&mut self, at: &LinearisationPoint<'_>, after: &Norms) -> Verdict {
        let scales = self.scales(at.chosen.tolerance, after);
        let (model, bench) = (&self.model, &mut self.bench);
        bench.before.clear();
        let nodes = 0..model.nodes.len();
        let at_start = nodes.map(|node| model.place(at.accepted.u, node));
        bench.before.extend(at_start);
        bench.forces.clear();
        let forces = at.contacts.iter().map(|state| state.force());
        bench.forces.extend(forces);
        bench.brought.clear();
        let accepted = || at.accepted.contacts.iter();
        bench.brought.extend(accepted().map(|state| state.slip));
        bench.earlier.clear();
        bench.earlier.extend(accepted().map(|state| state.f_t));
        bench.anchored.clear();
        bench
            .anchored
            .extend(accepted().map(|state| state.stretched));
        bench.ties.clear();
        bench
            .ties
            .extend(at.contacts.iter().map(|state| state.anchor));
        let now = &self.system.positions;
        let overlaps = model
            .contacts
            .iter()
            .zip(at.contacts.iter().zip(at.accepted.contacts));
        let left = [
            model.unclosed(at.leg, at.last_target),
            model.unclosed(at.leg, at.start_load),
        ];
        bench.out.iter_mut().for_each(Vec::clear);
        if self.overlaps || self.gives || self.system.has_points {
            for (contact, (state, was)) in overlaps {
                for ((out, part), normal) in bench
                    .out
                    .iter_mut()
                    .zip(left)
                    .zip([state.normal, was.normal])
                {
                    out.push(normal.map(|n| n * part * contact.overlap));
                }
                // The judge computes the current deformation of the bond.
                if let Some(out) = bench.out[1].last_mut() {
                    let given = contact.bond.give()[0] * was.f_n;
                    *out = [0, 1].map(|k| out[k] + was.normal[k] * given);
                }
            }
        }
        if self.system.has_points {
            self.points.find(model, &bench.before, at.accepted.contacts);
            for press in self.points.all() {
                let (out, way) = (&mut bench.out[1][press.contact], press.way_out());
                let was = at.accepted.contacts[press.contact];
                let deep = model.contacts[press.contact].bond.give()[0] * was.f_n;
                // The bond also deforms along n of the element's line, not along the rotated n.
                let along = |k: usize| deep * (press.line[k] - was.normal[k]);
                *out = [0, 1].map(|k| out[k] + way[k] + along(k));
            }
        }
        let [out, was_out] = &bench.out;
        let seen = JudgedState {
            surfaces: &model.surfaces,
            contacts: &model.contacts,
            friction: at.friction,
            before: &bench.before,
            now,
            out: [out, was_out],
            forces: &bench.forces,
            brought: &bench.brought,
            earlier: &bench.earlier,
            anchored: &bench.anchored,
            ties: &bench.ties,
            scales,
        };
        let mut verdict = bench.judge.interface(&seen, &mut bench.contact);
        let known = (&self.system.pressures, &self.system.sizes);
        loads(model, at, at.last_target, known, &mut bench.load);
        let forces = Forces {
            internal: self.system.internal(),
            load: &bench.load,
            contact: &bench.contact,
        };
        balance::check(model, &forces, now, &scales, &mut verdict);
        if self.overlaps && left[0] > 0.0 {
            // With a remaining overlap, the force and its reaction act at different points.
            verdict.worst[JudgedLaw::Moments as usize] = None;
        }
        verdict
    }

    fn count_net_slip(
        &mut self,
        tolerance: f64,
        accepted: &[ContactState],
        contacts: &mut [ContactState],
    ) {
        let near = (TIMES * tolerance).max(TOLERANCE) * self.model.length;
        let ground = self.ground();
        let before = &self.bench.before;
        let states = contacts.iter_mut().zip(accepted);
        let out = |k: usize| self.bench.out[1].get(k).copied().unwrap_or_default();
        for (k, ((state, was), contact)) in states.zip(&self.model.contacts).enumerate() {
            let (at, out) = (before[contact.node], out(k));
            let at = plus(at, out);
            let touched = Judge::touched(&self.model.surfaces, contact, at, before, near);
            let Some(touched) = touched.filter(|_| !contact.bond.is_tied()) else {
                continue;
            };
            let anchor = was.anchor.filter(|a| a.surface == touched.surface);
            state.stretched = match anchor {
                Some(_) => was.stretched,
                None => contact.bond.give()[1] * was.f_t,
            };
            (state.anchor, state.kept) = (anchor.or(Some(touched)), true);
            (state.ratio, state.travel) = (0.0, 0.0);
            ground.find_anchor(state, contact);
            state.slip = state.drift;
        }
    }

    fn deformation(&self, u: &[f64]) -> Option<Deformation> {
        deformation(&self.model, u)
    }

    fn damps(&self) -> bool {
        true
    }

    fn stability(&mut self, at: &LinearisationPoint<'_>) -> Stability {
        let (system, model) = (&self.system, &self.model);
        if self.tangent.is_none() {
            self.tangent = Tangent::new(model, system).ok();
        }
        let tangent = self.tangent.as_mut();
        tangent.map_or(Stability::NotKnown, |t| t.stability(system, model, at))
    }

    fn stability_cost(&self) -> f64 {
        self.system.estimate.stability
    }

    fn work(&self) -> Work {
        self.system.done
    }

    fn monitor(&self, watched: &MonitorQuantity, at: &LinearisationPoint<'_>) -> f64 {
        match watched {
            // Use the load of the current displacements, not of the next target.
            MonitorQuantity::Reaction { dof } => {
                let loads = self.model.loads.iter().filter(|load| load.dof == *dof);
                let mut load: f64 = loads.map(|l| l.value * l.scale.at(at.last_target)).sum();
                let size = |k: usize| self.model.pressure(k, at.last_target);
                self.system.pressures.each(at.u, size, |own, part| {
                    load += if own == *dof { part } else { 0.0 };
                });
                self.system.internal()[*dof] - load - self.system.interaction(*dof)
            }
            _ => value(watched, &self.model.contacts, at),
        }
    }
}
