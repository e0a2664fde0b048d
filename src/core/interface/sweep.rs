//! Projected Gauss-Seidel on the frozen interface problem: solves Coulomb's law exactly at one node after the other, with the
//! forces of all others frozen (as in non-smooth contact dynamics; Jean, Comput. Methods Appl. Mech. Engrg. 177, 1999).
//!
//! With the compliance W and the free motions q, e = W F + q contains the gap and the negative slip of every node. At one node
//! this is a problem with two equations and four assumptions: free, fixed, and sliding in either direction. The forces converge
//! slowly, but the modes usually soon, and a solve with these modes gives the exact forces. Only 2 by 2 blocks are inverted, so W
//! may be singular. Every second sweep runs backwards: with strong friction, sweeps in the same direction may cycle.
//!
//! The compliance is stored by its blocks, and contacts that it does not couple are independent: a part whose forces obey the law
//! is not swept again. How far forces are from obeying it is the natural map, with ρ the inverse of a node's own compliance:
//!
//! ```text
//! F_n − max(F_n − ρ e_n, 0),     F_t − [F_t − ρ e_t]  limited to  ±(tan φ F_n + c)
//! ```

use crate::interface::blocks::Blocks;
use crate::interface::cone_law::local;
use crate::{AssumedMode, Friction, InterfaceProblem, ProblemNode};
use std::ops::Range;
use std::sync::Arc;

/// Estimated norm of the scaled inverse above which the response has no compliance.
const SINGULAR: f64 = 1e11;

/// State of the sweeps: with D = 2 in the plane, with D = 3 and two tangential components in space.
#[derive(Debug, Clone)]
pub struct Sweep<const D: usize = 2> {
    /// W.
    compliance: Arc<Blocks<D>>,
    /// Relative accuracy of W if it was given by its entries; `None` if it was inverted.
    given: Option<f64>,
    nodes: Vec<SingleNode>,
    /// The nodes, part by part, and the parts.
    order: Vec<usize>,
    parts: Vec<Part>,
    /// The forces of each node in turn, the normal one first.
    forces: Vec<f64>,
    /// Gap and negative slip (motion of the node) of each node in turn: without forces, and with the current ones.
    free: Vec<f64>,
    motions: Vec<f64>,
    /// Whether the next sweep runs backwards.
    back: bool,
    /// Whether a node of the last sweep had no force that obeys the law: its own compliance is not positive.
    unanswered: bool,
}

/// Contacts that W couples with each other and with no others.
#[derive(Debug, Clone)]
struct Part {
    /// Its nodes, as a range of the order.
    nodes: Range<usize>,
    /// Whether its forces obey the law within the tolerance.
    settled: bool,
}

/// A single node.
#[derive(Debug, Clone, Copy)]
struct SingleNode {
    does: AssumedMode,
    coefficient: f64,
    cohesion: f64,
    /// Whether it can have a normal force, and whether it has friction.
    presses: bool,
    rough: bool,
}

impl SingleNode {
    fn new(node: &ProblemNode) -> Self {
        let [normal, tangential] = node.moves();
        SingleNode {
            presses: normal,
            rough: normal && tangential && !node.friction.is_smooth(),
            ..SingleNode::with_friction(&node.friction)
        }
    }

    /// A node that can move in every direction.
    fn with_friction(friction: &Friction) -> Self {
        SingleNode {
            does: AssumedMode::Free,
            coefficient: friction.coefficient(),
            cohesion: friction.cohesion,
            presses: true,
            rough: !friction.is_smooth(),
        }
    }

    /// The friction bound under a normal force.
    fn limit(&self, f_n: f64) -> f64 {
        self.coefficient * f_n + self.cohesion
    }
}

/// Coulomb's law at one node with all others frozen.
pub trait LocalLaw<const D: usize> {
    /// The force on a node that obeys the law; also sets its mode.
    fn alone(&mut self, place: usize) -> [f64; D];

    /// The square of the natural map at a node (force²).
    fn natural(&self, place: usize) -> f64;
}

impl Sweep {
    /// Starts without forces. `None` if the bodies are unsupported without contact, or memory is insufficient.
    pub fn new(problem: &InterfaceProblem) -> Option<Self> {
        let bodies = problem.relation.compliance()?;
        if bodies.inverse_norm > SINGULAR {
            return None;
        }
        let mut free = bodies.still;
        for (place, node) in problem.nodes.iter().enumerate() {
            let (n, t) = (2 * place, 2 * place + 1);
            free[n] += node.kinematics.map_or(0.0, |over| over.gap) - node.prescribed[0];
            free[t] -= node.state.slipped(&problem.settings) + node.prescribed[1];
        }
        let compliance = Blocks::<2>::from_dense(problem.nodes.len(), &bodies.w);
        // The initial motions are those without forces.
        for (place, node) in problem.nodes.iter().enumerate() {
            compliance.add_column(place, [-node.state.f_n, -node.state.f_t], &mut free);
        }
        let parts = vec![(0..problem.nodes.len()).collect()];
        let mut sweep = Sweep::start(Arc::new(compliance), parts, free, &problem.nodes);
        sweep.given = None;
        Some(sweep)
    }

    /// Starts without forces, for a compliance given by its blocks with its independent parts; `free` are gap and negative slip
    /// of each node without contact forces.
    pub fn start(
        compliance: Arc<Blocks>,
        parts: Vec<Vec<usize>>,
        free: Vec<f64>,
        nodes: &[ProblemNode],
    ) -> Self {
        let nodes = nodes.iter().map(SingleNode::new).collect();
        Sweep::without_forces(compliance, parts, free, nodes)
    }

    /// Continues from the forces of the nodes' states.
    pub fn with_forces(mut self, nodes: &[ProblemNode]) -> Self {
        for (force, node) in self.forces.chunks_exact_mut(2).zip(nodes) {
            force.copy_from_slice(&[node.state.f_n, node.state.f_t]);
        }
        self.renew_motions();
        self
    }

    /// With this relative accuracy of a compliance given by its entries.
    pub fn with_accuracy(self, accuracy: f64) -> Self {
        Sweep {
            given: self.given.map(|_| accuracy),
            ..self
        }
    }

    /// F_n, F_t, gap and slip of a node after the last sweep.
    pub fn numbers(&self, place: usize) -> [f64; 4] {
        let (n, t) = (2 * place, 2 * place + 1);
        let gap = match self.nodes[place].does {
            AssumedMode::Free if self.nodes[place].presses => self.motions[n],
            AssumedMode::Free => f64::INFINITY,
            _ => 0.0,
        };
        [self.forces[n], self.forces[t], gap, -self.motions[t]]
    }
}

impl Sweep<3> {
    /// Starts without forces in space; `free` are gap and motion of each node without contact forces.
    pub fn in_space(compliance: Arc<Blocks<3>>, free: Vec<f64>, friction: &[Friction]) -> Self {
        let parts = compliance.parts();
        let nodes = friction.iter().map(SingleNode::with_friction).collect();
        Sweep::without_forces(compliance, parts, free, nodes)
    }

    /// The forces (f_n, f_1, f_2) of each node in turn.
    pub fn forces(&self) -> &[f64] {
        &self.forces
    }

    /// Gap and motion (gap, u_1, u_2) of each node in turn.
    pub fn motions(&self) -> &[f64] {
        &self.motions
    }

    /// Continues from other forces and friction, after this number of sweeps; tolerance and result are those of [`Sweep::settle`].
    pub fn continue_from(
        &mut self,
        forces: &[f64],
        friction: &[Friction],
        sweeps: usize,
        tolerance: f64,
    ) -> f64 {
        self.forces.copy_from_slice(forces);
        self.nodes = friction.iter().map(SingleNode::with_friction).collect();
        self.back = sweeps % 2 == 1;
        let error = self.settle(tolerance);
        // Parts that obey the law are not swept, which would find the modes.
        for place in 0..self.nodes.len() {
            self.nodes[place].does = self.mode_of_force(place);
        }
        error
    }

    /// The mode of a node whose force obeys the law.
    fn mode_of_force(&self, place: usize) -> AssumedMode {
        let f_n = self.forces[3 * place];
        let [t_1, t_2] = self.trial(place);
        match t_1.hypot(t_2) > self.nodes[place].limit(f_n) {
            _ if f_n <= 0.0 => AssumedMode::Free,
            true => AssumedMode::Plus,
            false => AssumedMode::Fixed,
        }
    }

    /// The tangential force that the natural map limits to the friction cone.
    fn trial(&self, place: usize) -> [f64; 2] {
        let own = self.compliance.own(place);
        let (force, motion) = (&self.forces[3 * place..], &self.motions[3 * place..]);
        let tt = 0.5 * (own[1][1] + own[2][2]);
        [1, 2].map(|k| force[k] - stopping_force(motion[k], tt))
    }
}

impl<const D: usize> Sweep<D>
where
    Sweep<D>: LocalLaw<D>,
{
    fn without_forces(
        compliance: Arc<Blocks<D>>,
        parts: Vec<Vec<usize>>,
        free: Vec<f64>,
        nodes: Vec<SingleNode>,
    ) -> Self {
        let mut first = 0;
        let ranges = parts.iter().map(|part| {
            first += part.len();
            Part {
                nodes: first - part.len()..first,
                settled: false,
            }
        });
        Sweep {
            compliance,
            given: Some(0.0),
            nodes,
            parts: ranges.collect(),
            order: parts.concat(),
            forces: vec![0.0; free.len()],
            motions: free.clone(),
            free,
            back: false,
            unanswered: false,
        }
    }

    /// Whether the compliance was given by its entries: it may be singular, and the forces that obey the law need not be unique.
    pub fn is_given(&self) -> bool {
        self.given.is_some()
    }

    /// Relative accuracy of the compliance: 0 if it is exact.
    pub fn accuracy(&self) -> f64 {
        self.given.unwrap_or(0.0)
    }

    /// Recomputes the motions, in which round-off accumulates.
    fn renew_motions(&mut self) {
        self.motions.copy_from_slice(&self.free);
        self.compliance.multiply(&self.forces, &mut self.motions);
    }

    /// One sweep over all nodes of the parts that have not settled; returns the largest change of a force relative to the largest
    /// force. With a symmetric compliance given by its entries, [`Sweep::settle`] must follow before the motions are read.
    pub fn sweep(&mut self) -> f64 {
        let (mut most, mut largest) = (0.0_f64, 0.0_f64);
        self.unanswered = false;
        for part in 0..self.parts.len() {
            let Part { nodes, settled } = self.parts[part].clone();
            if settled {
                continue;
            }
            for k in nodes.clone() {
                let k = if self.back {
                    nodes.end - 1 - (k - nodes.start)
                } else {
                    k
                };
                let place = self.order[k];
                // Rows are read faster than columns are written, but the motions of the other nodes are then old.
                let by_rows = self.compliance.is_symmetric();
                if by_rows {
                    let moved = self.compliance.row(place, &self.forces);
                    for (k, moved) in (D * place..).zip(moved) {
                        self.motions[k] = self.free[k] + moved;
                    }
                }
                let force = self.alone(place);
                let change: [f64; D] =
                    std::array::from_fn(|k| force[k] - self.forces[D * place + k]);
                if !by_rows {
                    self.compliance.add_column(place, change, &mut self.motions);
                }
                self.forces[D * place..D * place + D].copy_from_slice(&force);
                for k in 0..D {
                    most = most.max(change[k].abs());
                    largest = largest.max(force[k].abs());
                }
            }
        }
        self.back = !self.back;
        if most == 0.0 {
            0.0
        } else {
            most / largest.max(most)
        }
    }

    /// The norm of the natural map relative to that of the forces: how far the forces are from obeying Coulomb's law. Parts
    /// within the tolerance are not swept again.
    pub fn settle(&mut self, tolerance: f64) -> f64 {
        self.renew_motions();
        let force: f64 = self.forces.iter().map(|f| f * f).sum();
        let allowed = tolerance * tolerance * force / self.parts.len() as f64;
        let mut error = 0.0;
        for part in 0..self.parts.len() {
            let nodes = &self.order[self.parts[part].nodes.clone()];
            let of_part: f64 = nodes.iter().map(|&place| self.natural(place)).sum();
            self.parts[part].settled = of_part <= allowed;
            error += of_part;
        }
        match error {
            0.0 => 0.0,
            error if error < force => (error / force).sqrt(),
            // No forces yet, or a node that no force can move.
            _ => 1.0,
        }
    }

    /// Whether the last sweep found forces that obey the law at every node, with all others frozen.
    pub fn is_answered(&self) -> bool {
        !self.unanswered
    }

    /// Mode of a node after the last sweep.
    pub fn assumed(&self, place: usize) -> AssumedMode {
        self.nodes[place].does
    }
}

/// The force that stops a motion of a node with this compliance; none stops a motion without compliance.
fn stopping_force(motion: f64, own: f64) -> f64 {
    if own > 0.0 { motion / own } else { 0.0 }
}

impl LocalLaw<2> for Sweep<2> {
    fn natural(&self, place: usize) -> f64 {
        let node = &self.nodes[place];
        let (f_n, f_t) = (self.forces[2 * place], self.forces[2 * place + 1]);
        let [e_n, e_t] = [self.motions[2 * place], self.motions[2 * place + 1]];
        let &[[nn, _], [_, tt]] = self.compliance.own(place);
        let normal = match node.presses {
            true if nn <= 0.0 && e_n < 0.0 => f64::INFINITY,
            true => f_n - (f_n - stopping_force(e_n, nn)).max(0.0),
            false => f_n,
        };
        let limit = match node.does {
            AssumedMode::Free => 0.0,
            _ => node.limit(f_n).max(0.0),
        };
        let tangential = f_t - (f_t - stopping_force(e_t, tt)).clamp(-limit, limit);
        normal * normal + tangential * tangential
    }

    fn alone(&mut self, place: usize) -> [f64; 2] {
        let (n, t) = (2 * place, 2 * place + 1);
        let &[[nn, tn], [nt, tt]] = self.compliance.own(place);
        let (f_n, f_t) = (self.forces[n], self.forces[t]);
        // Motions without this node's own force.
        let q = [
            self.motions[n] - nn * f_n - nt * f_t,
            self.motions[t] - tn * f_n - tt * f_t,
        ];
        let node = &mut self.nodes[place];
        if !node.presses || q[0] >= 0.0 {
            node.does = AssumedMode::Free;
            return [0.0; 2];
        }
        if !node.rough {
            if nn <= 0.0 {
                self.unanswered = true;
                return [f_n, 0.0];
            }
            node.does = AssumedMode::Plus;
            return [-q[0] / nn, 0.0];
        }
        let (mu, cohesion) = (node.coefficient, node.cohesion);
        let determinant = nn * tt - nt * tn;
        if determinant > 0.0 {
            let fixed = [
                (nt * q[1] - tt * q[0]) / determinant,
                (tn * q[0] - nn * q[1]) / determinant,
            ];
            if fixed[0] >= 0.0 && fixed[1].abs() <= mu * fixed[0] + cohesion {
                node.does = AssumedMode::Fixed;
                return fixed;
            }
        }
        for does in [AssumedMode::Plus, AssumedMode::Minus] {
            let sign = does.sign();
            let gives = nn + sign * mu * nt;
            let f_n = -(q[0] + nt * sign * cohesion) / gives;
            let f_t = sign * (mu * f_n + cohesion);
            let slip = -(q[1] + tn * f_n + tt * f_t);
            if gives > 0.0 && f_n >= 0.0 && sign * slip >= 0.0 {
                node.does = does;
                return [f_n, f_t];
            }
        }
        self.unanswered = true;
        [f_n, f_t]
    }
}

impl LocalLaw<3> for Sweep<3> {
    fn alone(&mut self, place: usize) -> [f64; 3] {
        let own = self.compliance.own(place);
        let (forces, motions) = (&self.forces[3 * place..], &self.motions[3 * place..]);
        // Motions without this node's own force.
        let without = [0, 1, 2].map(|i| {
            let by_own = (0..3).fold(0.0, |sum, k| sum + own[k][i] * forces[k]);
            motions[i] - by_own
        });
        let node = &mut self.nodes[place];
        let (does, force) = local(own, without, node.coefficient, node.cohesion);
        node.does = does;
        force
    }

    fn natural(&self, place: usize) -> f64 {
        let node = &self.nodes[place];
        let (force, motion) = (&self.forces[3 * place..], &self.motions[3 * place..]);
        let own = self.compliance.own(place);
        let nn = own[0][0];
        let normal = if nn <= 0.0 && motion[0] < 0.0 {
            f64::INFINITY
        } else {
            force[0] - (force[0] - stopping_force(motion[0], nn)).max(0.0)
        };
        let limit = if force[0] > 0.0 {
            node.limit(force[0])
        } else {
            0.0
        };
        let trial = self.trial(place);
        let size = trial[0].hypot(trial[1]);
        let part = if size > limit { limit / size } else { 1.0 };
        let off = [0, 1].map(|k| force[k + 1] - part * trial[k]);
        normal * normal + off[0] * off[0] + off[1] * off[1]
    }
}
