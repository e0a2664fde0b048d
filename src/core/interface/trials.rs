//! Solves combinations of modes and minor iterations on a separate interface problem.

use crate::interface::minor::{self, Check};
use crate::interface::problem::{Answer, SINGULAR, node_answer};
use crate::interface::rows;
use crate::linalg::DenseFactors;
use crate::{
    AssumedMode, ContactRecord, ContactState, Equation, InterfaceProblem, Method, NodeIncrement,
    ProblemNode,
};

/// Solves one set of equations after the other with preallocated workspace.
pub struct Trials<'a> {
    problem: &'a InterfaceProblem,
    matrix: Vec<f64>,
    z: Vec<f64>,
    dense: DenseFactors,
}

impl<'a> Trials<'a> {
    /// Workspace for a problem. `None` if memory is insufficient.
    pub fn new(problem: &'a InterfaceProblem) -> Option<Self> {
        let count = problem.relation.count();
        Some(Trials {
            problem,
            matrix: vec![0.0; count * count],
            z: vec![0.0; count],
            dense: DenseFactors::new(count, 1).ok()?,
        })
    }

    /// The problem.
    pub fn problem(&self) -> &'a InterfaceProblem {
        self.problem
    }

    /// The solution for a combination, one entry per node. `None` if its equations are singular.
    pub fn answer(&mut self, assumed: &[AssumedMode]) -> Option<Answer> {
        let problem = self.problem;
        let given = self.solve(|s, node| node.equations(assumed[s], &problem.settings))?;
        let nodes = problem.nodes.iter().zip(assumed).zip(given);
        Some(Answer {
            nodes: nodes
                .map(|((node, &assumed), given)| node_answer(problem, node, assumed, given))
                .collect(),
        })
    }

    /// One minor iteration: solves for the states of the nodes and updates them. Returns the record of each node, and whether all
    /// modes and T_max have converged. `None` if the equations are singular.
    pub fn minor(
        &mut self,
        nodes: &mut [ContactState],
        method: &dyn Method,
    ) -> Option<(Vec<ContactRecord>, bool)> {
        let problem = self.problem;
        let given = self.solve_states(nodes)?;
        let forces = nodes.iter().zip(&given).flat_map(|(node, given)| {
            [node.f_n + given.force[0], node.f_t + given.force[1]].map(f64::abs)
        });
        let ties = problem.ties(forces.fold(problem.force, f64::max));
        let check = Check {
            settings: problem.settings,
            method,
            ties,
            stiffness: problem.spring,
        };
        let mut settled = true;
        let before = nodes.to_vec();
        let mut records: Vec<ContactRecord> = nodes
            .iter_mut()
            .zip(&problem.nodes)
            .zip(given)
            .map(|((state, node), given)| {
                let (record, still) = minor::check(
                    state,
                    node.kinematics.as_ref(),
                    given,
                    &node.friction,
                    &check,
                );
                settled &= still;
                record
            })
            .collect();
        if method.is_single(false) {
            minor::one_at_a_time(nodes, &before, &mut records);
        }
        Some((records, settled))
    }

    /// Solves Table 1's equations for the states of the nodes, without checking the modes. `None` if they are singular.
    pub fn solve_states(&mut self, nodes: &[ContactState]) -> Option<Vec<NodeIncrement>> {
        let settings = self.problem.settings;
        self.solve(|s, node| {
            rows::rows(
                &nodes[s],
                node.kinematics.as_ref(),
                &node.friction,
                &settings,
                0.0,
            )
        })
    }

    /// Derivatives of a node's F_n, F_t, normal and tangential motion in the last solution with respect to the right-hand sides of
    /// all equations: two entries per node, normal and tangential. `None` if they are not finite.
    pub fn answers_of(&mut self, slave: usize) -> Option<[Vec<f64>; 4]> {
        let mut answers = self.problem.relation.rows(slave);
        for row in &mut answers {
            self.dense.solve_transposed(row).ok()?;
        }
        Some(answers)
    }

    fn solve(
        &mut self,
        equations: impl Fn(usize, &ProblemNode) -> [Equation; 2],
    ) -> Option<Vec<NodeIncrement>> {
        let relation = &self.problem.relation;
        for (s, node) in self.problem.nodes.iter().enumerate() {
            for (k, row) in equations(s, node).iter().enumerate() {
                self.z[2 * s + k] =
                    relation.place_row(s, k, row, node.prescribed, &mut self.matrix);
            }
        }
        self.dense.factor(&self.matrix);
        if self.dense.inverse_norm() > SINGULAR || self.dense.solve(&mut self.z).is_err() {
            return None;
        }
        let nodes = self.problem.nodes.iter().enumerate();
        Some(
            nodes
                .map(|(s, node)| {
                    let [force, motion] = relation.answer(&self.z, s, node.prescribed);
                    NodeIncrement { force, motion }
                })
                .collect(),
        )
    }
}
