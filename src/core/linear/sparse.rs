//! Contacts on a rigid floor whose bodies are given by a sparse compliance, as a source: the interface problems of other programs.
//!
//! With W and the free motions q along n and t of each contact, the load factor λ, the loads p and the contact forces F:
//!
//! ```text
//! w = q(λ) + W (p(λ) + F),      gap = gap_0 + w_n,      slip = −w_t
//! ```
//!
//! Nothing larger than the entries of W and the factors of a sparse system is stored. A minor iteration solves for the forces of
//! the touching contacts; sweeps use the blocks of W ([`crate::interface::sweep`]).

use crate::contact::projection::projection_at;
use crate::contact::stick_point::pierced;
use crate::contact::tracking::Ground;
use crate::interface::blocks::Blocks;
use crate::interface::rows;
use crate::linalg::{DenseFactors, Factors, Pattern, SolveError, largest};
use crate::linear::source::value;
use crate::linear::sparse_contacts::sparse_contacts;
use crate::linear::violation::violation;
use crate::model::{Bond, Linear, MonitorQuantity};
use crate::plane::max_abs;
use crate::strategy::SETTLED;
use crate::{
    ContactState, Equation, Friction, InterfaceProblem, InterfaceResponse, LinearisationPoint,
    Model, NodeIncrement, NodeKinematics, Norms, NotFound, ProblemNode, RelativeMotion, Settings,
    SolveResult, Source, SurfacePoint, Sweep, Work,
};
use std::sync::Arc;

/// Maximum number of contacts for the dense form of the problem.
const MOST_DENSE: usize = 400;

/// A sparse compliance with the workspace of a major iteration.
pub struct SparseInterface {
    model: Arc<Model>,
    compliance: Arc<Blocks>,
    parts: Vec<Vec<usize>>,
    /// Degree of freedom of the first force on the body, and height of the floor.
    first_force: usize,
    floor: f64,
    /// Contact of each node.
    contact_of: Vec<Option<usize>>,
    /// Largest own compliance of a contact (length per force).
    softest: f64,
    /// Stiffness that relates lengths to forces (force per length).
    spring: f64,
    /// Current position of every node.
    positions: Vec<[f64; 2]>,
    /// In the last linearisation: q and p along n and t, w without contact forces minus the current one, and the gaps.
    free: Vec<f64>,
    load: Vec<f64>,
    start: Vec<f64>,
    gaps: Vec<f64>,
    /// Total contact forces at that time, those of the last minor iteration, and its motion Δw.
    before: Vec<f64>,
    forces: Vec<f64>,
    moved: Vec<f64>,
    norms: Norms,
    /// Uncertainty of lengths relative to the scene's.
    lengths: f64,
    work: Work,
}

/// An unknown of a minor iteration: the force of a contact along a direction, and the motion that it determines.
struct ContactUnknown {
    contact: usize,
    /// ΔF_n, ΔF_t per unit.
    direction: [f64; 2],
    /// Component of the motion: 0 normal, 1 tangential.
    component: usize,
    row: Equation,
}

impl SparseInterface {
    /// The source of a model; `None` if it has anything but contacts on a floor and a compliance ([`sparse_contacts`]).
    pub fn new(model: &Arc<Model>) -> Option<Self> {
        let given = sparse_contacts(model)?;
        let contacts = model.contacts.len();
        let compliance = blocks(contacts, given.linear);
        let count = 2 * contacts;
        let own = (0..contacts).map(|k| compliance.own(k));
        let own = own.map(|own| [own[0][0].abs(), own[1][1].abs()]);
        let mean = own.clone().map(|[n, t]| n + t).sum::<f64>() / count as f64;
        let softest = own.flatten().fold(0.0, f64::max);
        Some(SparseInterface {
            first_force: given.first_force,
            floor: given.floor,
            contact_of: contacts_of_nodes(model),
            parts: compliance.parts(),
            compliance: Arc::new(compliance),
            softest,
            spring: if mean > 0.0 { 1.0 / mean } else { 1.0 },
            positions: model.nodes.iter().map(|node| node.at).collect(),
            free: vec![0.0; count],
            load: vec![0.0; count],
            start: vec![0.0; count],
            gaps: vec![0.0; contacts],
            before: vec![0.0; count],
            forces: vec![0.0; count],
            moved: vec![0.0; count],
            norms: Norms::default(),
            lengths: 0.0,
            work: Work::default(),
            model: model.clone(),
        })
    }

    fn place(&mut self, u: &[f64]) {
        for (node, position) in self.positions.iter_mut().enumerate() {
            *position = self.model.place(u, node);
        }
    }

    fn ground(&self) -> Ground<'_> {
        Ground {
            surfaces: &self.model.surfaces,
            positions: &self.positions,
            same_force: SETTLED * self.norms.scale,
            unclosed: 0.0,
        }
    }

    /// First degree of freedom of a contact's node.
    fn first(&self, contact: usize) -> usize {
        self.model.dofs.first[self.model.contacts[contact].node]
    }

    /// Current w_n, w_t of a contact.
    fn displacement(&self, contact: usize, u: &[f64]) -> [f64; 2] {
        let first = self.first(contact);
        [u[first + 1], -u[first]]
    }

    /// Loads and free motions at a load factor, along n and t.
    fn take_loads(&mut self, target: f64) {
        self.free.fill(0.0);
        self.load.fill(0.0);
        let model = self.model.clone();
        for load in &model.loads {
            let value = load.value * load.scale.at(target);
            if let Some(component) = load.dof.checked_sub(self.first_force) {
                let (place, sign) = turned(component);
                self.free[place] += sign * value;
                continue;
            }
            if let Some((node, axis)) = model.dofs.node_of(load.dof)
                && let Some(contact) = self.contact_of[node]
            {
                let (place, sign) = turned(2 * contact + axis);
                self.load[place] += sign * value;
            }
        }
    }

    /// Takes `forces` as the result of a minor iteration: computes the motion.
    fn finish(&mut self) {
        self.moved.copy_from_slice(&self.start);
        self.compliance.multiply(&self.forces, &mut self.moved);
    }

    /// The unknowns of a minor iteration; sets all forces that its modes prescribe. `None` if the equations have another form.
    fn unknowns(&mut self, at: &LinearisationPoint<'_>) -> Option<Vec<ContactUnknown>> {
        let mut unknowns = Vec::new();
        for (contact, state) in at.contacts.iter().enumerate() {
            let friction = state.friction(&at.friction[contact]);
            let over = self.kinematics(contact);
            let [normal, tangential] =
                rows::rows(state, over.as_ref(), &friction, &at.settings, 0.0);
            let (n, t) = (2 * contact, 2 * contact + 1);
            self.forces[n] = state.f_n;
            self.forces[t] = state.f_t;
            let mut unknown = |direction, component, row| {
                unknowns.push(ContactUnknown {
                    contact,
                    direction,
                    component,
                    row,
                });
            };
            match (normal.motion, tangential.motion) {
                (RelativeMotion::None, RelativeMotion::None) => {
                    self.forces[n] += normal.value;
                    self.forces[t] += tangential.value;
                }
                (RelativeMotion::Normal, RelativeMotion::None) => {
                    // d_n ΔF_n + d_t ΔF_t = value.
                    self.forces[t] += tangential.value / tangential.d_t;
                    unknown([1.0, -tangential.d_n / tangential.d_t], 0, normal);
                }
                (RelativeMotion::Normal, RelativeMotion::Tangential) => {
                    unknown([1.0, 0.0], 0, normal);
                    unknown([0.0, 1.0], 1, tangential);
                }
                _ => return None,
            }
        }
        Some(unknowns)
    }

    /// Solves for the unknowns; `moved` are the motions without them.
    fn solve_for(&mut self, unknowns: &[ContactUnknown]) -> Result<(Vec<f64>, f64), SolveError> {
        let size = unknowns.len();
        let mut first = vec![usize::MAX; self.gaps.len()];
        for (k, unknown) in unknowns.iter().enumerate().rev() {
            first[unknown.contact] = k;
        }
        let of = |contact: usize| {
            let from = first[contact].min(size);
            let own = unknowns[from..].iter().enumerate();
            let own = own.take_while(move |(_, unknown)| unknown.contact == contact);
            own.map(move |(k, unknown)| (from + k, unknown))
        };
        let mut entries = Vec::new();
        for (column, unknown) in unknowns.iter().enumerate() {
            for (i, _) in self.compliance.column(unknown.contact) {
                for (row, _) in of(i) {
                    entries.extend([(row, column), (column, row)]);
                }
            }
        }
        let pattern = Arc::new(Pattern::new(size, entries.iter().copied())?);
        let mut values = vec![0.0; pattern.entries()];
        for (column, unknown) in unknowns.iter().enumerate() {
            let [n, t] = unknown.direction;
            for (i, block) in self.compliance.column(unknown.contact) {
                for (row, into) in of(i) {
                    let k = into.component;
                    if let Some(slot) = pattern.slot(row, column) {
                        values[slot] += block[0][k] * n + block[1][k] * t;
                    }
                }
            }
        }
        let groups: Vec<usize> = unknowns.iter().map(|unknown| unknown.contact).collect();
        let mut factors = Factors::in_groups(pattern, &numbered(groups), size)?;
        factors.scale(&values, size, &vec![1.0; size]);
        factors.factor(&values)?;
        self.work.factorizations += 1;
        // The motion of S* against S is −Δw.
        let wanted = |u: &ContactUnknown| -u.row.value - self.moved[2 * u.contact + u.component];
        let right: Vec<f64> = unknowns.iter().map(wanted).collect();
        let mut x = vec![0.0; size];
        factors.solve(&right, &mut x)?;
        Ok((x, factors.inverse_norm()))
    }

    /// The contacts for searches.
    fn nodes(&self, at: &LinearisationPoint<'_>) -> Vec<ProblemNode> {
        at.nodes(|contact| (self.kinematics(contact), [0.0; 2]))
    }
}

/// The compliance along n and t of each contact, from that along x and y: n is y, and t is −x.
fn blocks(contacts: usize, linear: &Linear) -> Blocks {
    let entries = linear.entries.iter().map(|&(i, j, value)| {
        let ((row, a), (column, b)) = (turned(i), turned(j));
        (row, column, a * b * value)
    });
    Blocks::from_entries(contacts, entries)
}

/// The component along n or t of one along x or y (both in pairs), and its sign.
fn turned(component: usize) -> (usize, f64) {
    match component % 2 {
        0 => (component + 1, -1.0),
        _ => (component - 1, 1.0),
    }
}

fn contacts_of_nodes(model: &Model) -> Vec<Option<usize>> {
    let mut contact_of = vec![None; model.nodes.len()];
    for (contact, slave) in model.contacts.iter().enumerate() {
        contact_of[slave.node] = Some(contact);
    }
    contact_of
}

/// Consecutive numbers for ascending ones.
fn numbered(mut groups: Vec<usize>) -> Vec<usize> {
    let (mut last, mut number) = (None, 0);
    for group in &mut groups {
        number += usize::from(last.is_some_and(|last| last != *group));
        last = Some(*group);
        *group = number;
    }
    groups
}

impl Source for SparseInterface {
    fn start(&self) -> Vec<f64> {
        vec![0.0; self.model.dofs.len()]
    }

    fn follow(
        &mut self,
        u: &[f64],
        contacts: &mut [ContactState],
        friction: &[Friction],
        anew: bool,
        _unclosed: f64,
    ) {
        self.place(u);
        let slaves = &self.model.contacts;
        self.ground().follow(contacts, slaves, friction, anew);
    }

    fn place_stick_points(&mut self, contacts: &mut [ContactState]) {
        self.ground().place_anchors(contacts, &self.model.contacts);
    }

    fn linearise(&mut self, at: &LinearisationPoint<'_>) -> Result<(), SolveError> {
        self.place(at.u);
        self.take_loads(at.target);
        let model = self.model.clone();
        for (k, contact) in model.contacts.iter().enumerate() {
            self.gaps[k] = self.positions[contact.node][1] - self.floor;
            let state = &at.contacts[k];
            (self.before[2 * k], self.before[2 * k + 1]) = (state.f_n, state.f_t);
            for (component, w) in self.displacement(k, at.u).into_iter().enumerate() {
                self.start[2 * k + component] = self.free[2 * k + component] - w;
            }
        }
        self.compliance.multiply(&self.load, &mut self.start);
        self.forces.copy_from_slice(&self.before);
        self.finish();
        let largest = |values: &[f64]| max_abs(values);
        let loads = largest(&self.load).max(self.spring * largest(&self.free));
        let scale = loads.max(largest(&self.before)).max(f64::MIN_POSITIVE);
        let force = self.spring * largest(&self.moved);
        self.norms = at.norms(force, scale);
        // Forces, and gaps and drifts, that the natural map of accepted forces allows.
        let mut allowed = [SETTLED; 2];
        if at.settings.matrix_accuracy > SETTLED {
            let size = self.before.iter().map(|f| f * f).sum::<f64>().sqrt();
            let times = [size / scale, size * self.softest / model.length];
            allowed = times.map(|times| at.settings.matrix_accuracy * times.max(1.0));
        }
        let [forces, lengths] = allowed.map(|allowed| self.norms.limit.max(allowed));
        (self.norms.limit, self.lengths) = (forces.max(lengths), lengths);
        Ok(())
    }

    fn limit_of_lengths(&self) -> Option<f64> {
        Some(self.lengths)
    }

    fn norms(&mut self, at: &LinearisationPoint<'_>) -> Norms {
        let over = |contact: usize| self.kinematics(contact);
        self.norms.interface = violation(at, self.model.length, self.norms.scale, over);
        self.norms
    }

    fn kinematics(&self, contact: usize) -> Option<NodeKinematics> {
        let [x, y] = self.positions[self.model.contacts[contact].node];
        Some(NodeKinematics {
            gap: self.gaps[contact],
            normal: [0.0, 1.0],
            foot: [x, y - self.gaps[contact]],
            room: [None; 2],
            moves: [true; 2],
            bond: Bond::Hard,
        })
    }

    fn solve(&mut self, at: &LinearisationPoint<'_>) -> SolveResult {
        let Some(unknowns) = self.unknowns(at) else {
            return SolveResult::Not;
        };
        self.finish();
        let mut norm = 1.0;
        if !unknowns.is_empty() {
            let Ok((x, inverse)) = self.solve_for(&unknowns) else {
                return SolveResult::Not;
            };
            for (unknown, x) in unknowns.iter().zip(x) {
                self.forces[2 * unknown.contact] += unknown.direction[0] * x;
                self.forces[2 * unknown.contact + 1] += unknown.direction[1] * x;
            }
            self.finish();
            norm = inverse;
        }
        SolveResult::from_norm(norm)
    }

    fn increment(&self, contact: usize) -> NodeIncrement {
        let here = [2 * contact, 2 * contact + 1];
        NodeIncrement {
            force: here.map(|k| self.forces[k] - self.before[k]),
            motion: here.map(|k| -self.moved[k]),
        }
    }

    fn sweep(&mut self, at: &LinearisationPoint<'_>) -> Result<Sweep, NotFound> {
        let mut free = self.start.clone();
        for (k, state) in at.contacts.iter().enumerate() {
            free[2 * k] += self.gaps[k];
            free[2 * k + 1] -= state.slipped(&at.settings);
        }
        let nodes = self.nodes(at);
        let sweep = Sweep::start(self.compliance.clone(), self.parts.clone(), free, &nodes);
        Ok(sweep
            .with_accuracy(at.settings.matrix_accuracy)
            .with_forces(&nodes))
    }

    fn takes_forces(&self) -> bool {
        true
    }

    fn press(&mut self, forces: &mut dyn Iterator<Item = [f64; 2]>) {
        for (into, force) in self.forces.chunks_exact_mut(2).zip(forces) {
            into.copy_from_slice(&force);
        }
        self.finish();
    }

    /// With springs of stiffness k, for which a singular W has a response: ΔF = −(W + 1/k)⁻¹ (z + Δw without ΔF).
    fn problem(&mut self, at: &LinearisationPoint<'_>) -> Result<InterfaceProblem, SolveError> {
        if self.gaps.len() > MOST_DENSE {
            return Err(SolveError::OutOfMemory);
        }
        let count = self.start.len();
        let mut matrix = vec![0.0; count * count];
        let mut response = vec![0.0; count * (count + 1)];
        let mut unit = vec![0.0; count];
        for (j, column) in matrix.chunks_exact_mut(count).enumerate() {
            unit[j] = 1.0;
            self.compliance.multiply(&unit, column);
            unit[j] = 0.0;
            column[j] += 1.0 / self.spring;
            response[j * count + j] = -1.0;
        }
        let last = count * count;
        self.forces.copy_from_slice(&self.before);
        self.finish();
        for (to, moved) in response[last..].iter_mut().zip(&self.moved) {
            *to = -moved;
        }
        let mut dense = DenseFactors::new(count, count + 1)?;
        dense.factor(&matrix);
        dense.solve(&mut response)?;
        let start = response.split_off(last);
        Ok(InterfaceProblem {
            nodes: self.nodes(at),
            relation: InterfaceResponse {
                stiffness: self.spring,
                start,
                response,
            },
            force: self.norms.scale,
            length: self.model.length,
            spring: self.spring,
            settings: at.settings,
        })
    }

    fn length(&self) -> f64 {
        self.model.length
    }

    fn spring(&self) -> f64 {
        self.spring
    }

    fn condenses(&self, _settings: &Settings) -> bool {
        false
    }

    fn advance(&mut self, u: &mut [f64]) -> f64 {
        let forces = self.first_force;
        let mut largest = 0.0_f64;
        for contact in 0..self.gaps.len() {
            let (n, t) = (2 * contact, 2 * contact + 1);
            let first = self.first(contact);
            u[first] -= self.moved[t];
            u[first + 1] += self.moved[n];
            largest = largest.max(self.moved[n].abs()).max(self.moved[t].abs());
            u[forces + n] = -self.load[t] - self.forces[t];
            u[forces + t] = self.load[n] + self.forces[n];
        }
        largest
    }

    fn stick_point(&self, contact: usize, state: &ContactState) -> Option<SurfacePoint> {
        let (surfaces, positions) = (&self.model.surfaces, &self.positions);
        let spot = state.spot?;
        let slave = positions[self.model.contacts[contact].node];
        let over = projection_at(surfaces, spot, positions, slave);
        pierced(surfaces, spot, &over, state.ratio, positions)
    }

    fn position(&self, contact: usize) -> [f64; 2] {
        self.positions[self.model.contacts[contact].node]
    }

    fn largest_motion(&self, u: &[f64]) -> f64 {
        largest(&u[..self.first_force])
    }

    fn moved(&self, u: &[f64], before: &[f64]) -> f64 {
        let nodes = u.iter().zip(before).take(self.first_force);
        max_abs(nodes.map(|(u, before)| u - before))
    }

    fn slid(&self, contact: usize, at: &LinearisationPoint<'_>) -> Option<f64> {
        let first = self.first(contact);
        Some(at.u[first] - at.accepted.u[first])
    }

    fn work(&self) -> Work {
        self.work
    }

    fn monitor(&self, watched: &MonitorQuantity, at: &LinearisationPoint<'_>) -> f64 {
        value(watched, &self.model.contacts, at)
    }
}
