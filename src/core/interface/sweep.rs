//! Projected Gauss-Seidel on the frozen interface problem: solves Coulomb's law exactly at one node after the other, with the
//! forces of all others frozen (as in non-smooth contact dynamics; Jean, Comput. Methods Appl. Mech. Engrg. 177, 1999).
//!
//! With the compliance W and the free motions q, e = W F + q contains the gap and the negative slip of every node. At one node
//! this is a problem with two equations and four assumptions: free, fixed, and sliding in either direction. The forces converge
//! slowly, but the modes usually soon, and a solve with these modes gives the exact forces. Only 2 by 2 blocks are inverted, so W
//! may be singular. Every second sweep runs backwards: with strong friction, sweeps in the same direction may cycle.

use crate::interface::problem::{Assumed, InterfaceProblem};
use crate::linalg::DenseFactors;

/// Estimated norm of the scaled inverse above which the response has no compliance.
const SINGULAR: f64 = 1e11;

/// State of the sweeps.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// W, column-major.
    compliance: Vec<f64>,
    nodes: Vec<Alone>,
    /// F_n, F_t of each node in turn.
    forces: Vec<f64>,
    /// Gap and negative slip of each node in turn.
    motions: Vec<f64>,
    /// Whether the next sweep runs backwards.
    back: bool,
}

/// A single node.
#[derive(Debug, Clone, Copy)]
struct Alone {
    does: Assumed,
    coefficient: f64,
    cohesion: f64,
    /// Whether it can have a normal force, and whether it has friction.
    presses: bool,
    rough: bool,
}

impl Sweep {
    /// Starts without forces. `None` if the bodies are unsupported without contact, or memory is insufficient.
    pub fn new(problem: &InterfaceProblem) -> Option<Self> {
        let (relation, count) = (&problem.relation, problem.relation.count());
        // motion = R⁻¹ (ΔF − start) + ΔF / k.
        let mut solved = vec![0.0; count * (count + 1)];
        for j in 0..count {
            solved[j * count + j] = 1.0;
        }
        let last = count * count;
        for (to, start) in solved[last..].iter_mut().zip(&relation.start) {
            *to = -start;
        }
        let mut dense = DenseFactors::new(count, count + 1).ok()?;
        dense.factor(&relation.response);
        if dense.inverse_norm() > SINGULAR {
            return None;
        }
        dense.solve(&mut solved).ok()?;
        let mut motions = solved.split_off(last);
        motions.iter_mut().for_each(|x| *x = -*x);
        let mut compliance = solved;
        compliance.iter_mut().for_each(|x| *x = -*x);
        for j in 0..count {
            compliance[j * count + j] -= 1.0 / relation.stiffness;
        }
        let mut nodes = Vec::with_capacity(problem.nodes.len());
        for (place, node) in problem.nodes.iter().enumerate() {
            let [normal, tangential] = node.moves();
            let (n, t) = (2 * place, 2 * place + 1);
            motions[n] += node.kinematics.map_or(0.0, |over| over.gap) - node.prescribed[0];
            motions[t] -= node.state.slipped(&problem.settings) + node.prescribed[1];
            nodes.push(Alone {
                does: Assumed::Free,
                coefficient: node.friction.coefficient(),
                cohesion: node.friction.cohesion,
                presses: normal,
                rough: normal && tangential && !node.friction.is_smooth(),
            });
        }
        let mut sweep = Sweep {
            compliance,
            nodes,
            forces: vec![0.0; count],
            motions,
            back: false,
        };
        // The initial motions are those without forces.
        for (place, node) in problem.nodes.iter().enumerate() {
            sweep.push(place, [-node.state.f_n, -node.state.f_t]);
        }
        Some(sweep)
    }

    /// Adds to the forces of a node and updates the motions.
    fn push(&mut self, place: usize, change: [f64; 2]) {
        let count = self.motions.len();
        for (j, change) in [2 * place, 2 * place + 1].into_iter().zip(change) {
            if change != 0.0 {
                let column = &self.compliance[j * count..(j + 1) * count];
                for (e, w) in self.motions.iter_mut().zip(column) {
                    *e += w * change;
                }
            }
        }
    }

    /// One sweep over all nodes; returns the largest change of a force relative to the largest force.
    pub fn sweep(&mut self) -> f64 {
        let (mut most, mut largest) = (0.0_f64, 0.0_f64);
        let count = self.nodes.len();
        for k in 0..count {
            let place = if self.back { count - 1 - k } else { k };
            let force = self.alone(place);
            let change: [f64; 2] = std::array::from_fn(|k| force[k] - self.forces[2 * place + k]);
            self.push(place, change);
            self.forces[2 * place..2 * place + 2].copy_from_slice(&force);
            for k in 0..2 {
                most = most.max(change[k].abs());
                largest = largest.max(force[k].abs());
            }
        }
        self.back = !self.back;
        if most == 0.0 {
            0.0
        } else {
            most / largest.max(most)
        }
    }

    /// The force on a node that obeys Coulomb's law with all others frozen; also sets its mode.
    fn alone(&mut self, place: usize) -> [f64; 2] {
        let (count, n, t) = (self.motions.len(), 2 * place, 2 * place + 1);
        let w = |i: usize, j: usize| self.compliance[j * count + i];
        let (nn, nt, tn, tt) = (w(n, n), w(n, t), w(t, n), w(t, t));
        let (f_n, f_t) = (self.forces[n], self.forces[t]);
        // Motions without this node's own force.
        let q = [
            self.motions[n] - nn * f_n - nt * f_t,
            self.motions[t] - tn * f_n - tt * f_t,
        ];
        let node = &mut self.nodes[place];
        if !node.presses || q[0] >= 0.0 {
            node.does = Assumed::Free;
            return [0.0; 2];
        }
        if !node.rough {
            if nn <= 0.0 {
                return [f_n, 0.0];
            }
            node.does = Assumed::Plus;
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
                node.does = Assumed::Fixed;
                return fixed;
            }
        }
        for does in [Assumed::Plus, Assumed::Minus] {
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
        [f_n, f_t]
    }

    /// Mode of a node after the last sweep.
    pub fn assumed(&self, place: usize) -> Assumed {
        self.nodes[place].does
    }

    /// F_n, F_t, gap and slip of a node after the last sweep.
    pub fn numbers(&self, place: usize) -> [f64; 4] {
        let (n, t) = (2 * place, 2 * place + 1);
        let gap = match self.nodes[place].does {
            Assumed::Free if self.nodes[place].presses => self.motions[n],
            Assumed::Free => f64::INFINITY,
            _ => 0.0,
        };
        [self.forces[n], self.forces[t], gap, -self.motions[t]]
    }
}
