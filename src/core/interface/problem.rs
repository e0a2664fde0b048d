//! The frozen interface problem: all that the minor iterations of one major iteration know of the bodies.
//!
//! While geometry and stiffness are frozen, forces and relative motions at the slave nodes depend linearly on each other
//! ([`InterfaceResponse`]). Coulomb's law, applied to the whole increment, says what each node may do: a free node has g >= 0
//! and no force; a touching one has F_n >= 0, and either sticks where it was at the start of the increment, with
//! |F_t| <= tan φ F_n + c, or slips with |F_t| = tan φ F_n + c against the slip. This module solves for one assumption of
//! what every node does, and says how far the answer is from obeying; [`crate::interface::census`] tries all of them.

use crate::contact::record::ContactRecord;
use crate::contact::state::ContactState;
use crate::contact::table1::{Equation, Known, Limit};
use crate::contact::table2::Ties;
use crate::interface::kinematics::{NodeIncrement, NodeKinematics};
use crate::interface::method::Method;
use crate::interface::minor::{self, Check, moves, supported};
use crate::interface::response::InterfaceResponse;
use crate::linalg::DenseFactors;
use crate::model::{self, Friction, Mode, Settings};
use serde::{Deserialize, Serialize};

/// Estimated norm of the inverse of the scaled matrix above which an assumption counts as singular.
pub const SINGULAR: f64 = 1e11;

/// The frozen interface problem of a major iteration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InterfaceProblem {
    /// How forces answer motions (eqn 6).
    pub relation: InterfaceResponse,
    /// One entry a slave node, in the relation's order.
    pub nodes: Vec<ProblemNode>,
    /// Size of the forces, the unit of relative margins of forces.
    pub force: f64,
    /// Size of the lengths, the unit of relative margins of lengths.
    pub length: f64,
    /// Stiffness that compares lengths with forces (force by length), finite even if `relation` has no springs.
    pub spring: f64,
    /// Settings in force.
    pub settings: Settings,
}

/// What a slave node brings into the frozen problem.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ProblemNode {
    /// Contact number in the scene.
    pub slave: usize,
    /// How it stands over its surface; `None` past the ends of all surfaces.
    #[serde(rename = "site")]
    pub kinematics: Option<NodeKinematics>,
    /// Prescribed part of the motion of S* relative to S, along n and t (length).
    pub prescribed: [f64; 2],
    /// Friction in force at the node.
    pub friction: Friction,
    /// What the node brings into the next minor iteration.
    pub state: ContactState,
}

/// What a node is assumed to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Assumed {
    /// No force.
    Free,
    /// Touching, and sticking.
    Fixed,
    /// Sliding with F_t > 0.
    Plus,
    /// Sliding with F_t < 0.
    Minus,
}

impl Assumed {
    /// One letter, as in the reference solutions: F, X, +, −.
    pub fn letter(self) -> char {
        match self {
            Assumed::Free => 'F',
            Assumed::Fixed => 'X',
            Assumed::Plus => '+',
            Assumed::Minus => '-',
        }
    }

    /// The mode that it is.
    pub fn mode(self) -> Mode {
        match self {
            Assumed::Free => Mode::Free,
            Assumed::Fixed => Mode::Fixed,
            Assumed::Plus | Assumed::Minus => Mode::Sliding,
        }
    }

    /// The assumption of this mode, and of this sign of the tangential force.
    pub fn of(mode: Mode, sign: f64) -> Self {
        match mode {
            Mode::Free => Assumed::Free,
            Mode::Fixed => Assumed::Fixed,
            Mode::Sliding if sign < 0.0 => Assumed::Minus,
            Mode::Sliding => Assumed::Plus,
        }
    }

    /// Sign of F_t when sliding; 1 for the other assumptions.
    pub fn sign(self) -> f64 {
        if self == Assumed::Minus { -1.0 } else { 1.0 }
    }
}

impl ProblemNode {
    /// Whether any unknown takes part in its normal and in its tangential motion.
    pub fn moves(&self) -> [bool; 2] {
        moves(self.kinematics.as_ref())
    }

    /// What the node can be assumed to do. Without friction, a node cannot stick, and sliding has no direction.
    pub fn choices(&self) -> &'static [Assumed] {
        if self.kinematics.is_none() {
            &[Assumed::Free]
        } else if self.friction.is_smooth() {
            &[Assumed::Free, Assumed::Plus]
        } else {
            &[Assumed::Free, Assumed::Fixed, Assumed::Plus, Assumed::Minus]
        }
    }

    /// Table 1's equations of an assumption, normal and tangential; T_max follows F_n in them.
    pub fn equations(&self, assumed: Assumed, settings: &Settings) -> [Equation; 2] {
        let known = Known {
            gap: self.kinematics.map_or(0.0, |k| k.gap),
            ratio: 0.0,
            slip: self.state.slipped(settings),
            f_n: self.state.f_n,
            f_t: self.state.f_t,
            limit: Limit::Consistent {
                sign: assumed.sign(),
                coefficient: self.friction.coefficient(),
                cohesion: self.friction.cohesion,
            },
        };
        supported(assumed.mode(), &known, self.moves())
    }
}

/// What an assumption leads to, at one node.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NodeAnswer {
    /// What the node was assumed to do.
    pub assumed: Assumed,
    /// Total normal force; compression positive.
    pub f_n: f64,
    /// Total tangential force along t.
    pub f_t: f64,
    /// Friction bound tan φ |F_n| + c (force).
    pub limit: f64,
    /// Gap after the motion (length); infinite without a surface.
    pub gap: f64,
    /// Slip since the start of the increment (length).
    pub slip: f64,
    /// The condition that is closest to being broken, or most broken.
    pub worst: Margin,
}

/// A condition that an assumption must meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Condition {
    /// A free node must not penetrate: g ≥ 0 (length).
    NoPenetration,
    /// A touching node must be pressed: F_n ≥ 0 (force).
    NoTension,
    /// A stuck node must keep to the friction limit: T_max − |F_t| ≥ 0 (force).
    WithinLimit,
    /// Friction must oppose the slip: sgn(F_t) · slip ≥ 0 (length).
    Dissipation,
}

/// How far a condition is from being broken.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Margin {
    /// The condition.
    pub condition: Condition,
    /// Force or length; negative where the condition is broken.
    pub value: f64,
    /// `value` over [`InterfaceProblem::force`] or [`InterfaceProblem::length`].
    pub relative: f64,
}

/// An assumption for every node, solved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    /// One entry a node of the problem, in its order.
    pub nodes: Vec<NodeAnswer>,
}

impl Answer {
    /// The assumption, a letter a node.
    pub fn letters(&self) -> String {
        self.nodes.iter().map(|n| n.assumed.letter()).collect()
    }

    /// The node whose condition is closest to being broken, or most broken, and that condition. `None` if there are no nodes.
    pub fn worst(&self) -> Option<(usize, Margin)> {
        let margins = self.nodes.iter().map(|n| n.worst).enumerate();
        margins.min_by(|a, b| a.1.relative.total_cmp(&b.1.relative))
    }

    /// Whether every node obeys, up to a relative tolerance.
    pub fn obeys(&self, tolerance: f64) -> bool {
        self.nodes.iter().all(|n| n.worst.relative >= -tolerance)
    }
}

/// Solves one set of equations after the other, with room made once.
pub struct Trials<'a> {
    problem: &'a InterfaceProblem,
    matrix: Vec<f64>,
    z: Vec<f64>,
    dense: DenseFactors,
}

impl<'a> Trials<'a> {
    /// Room for trials of a problem. `None` if there is no memory.
    pub fn new(problem: &'a InterfaceProblem) -> Option<Self> {
        let count = problem.relation.count();
        Some(Trials {
            problem,
            matrix: vec![0.0; count * count],
            z: vec![0.0; count],
            dense: DenseFactors::new(count, 1).ok()?,
        })
    }

    /// The answer to an assumption, one entry a node. `None` if its equations are singular.
    pub fn answer(&mut self, assumed: &[Assumed]) -> Option<Answer> {
        let problem = self.problem;
        let given = self.solve(|s, node| node.equations(assumed[s], &problem.settings))?;
        let nodes = problem.nodes.iter().zip(assumed).zip(given);
        Some(Answer {
            nodes: nodes
                .map(|((node, &assumed), given)| node_answer(problem, node, assumed, given))
                .collect(),
        })
    }

    /// One minor iteration: solves for what the nodes bring, and leaves in them what they bring into the next. Returns what
    /// it did at each node, and whether all modes and T_max have settled. `None` if the equations are singular.
    pub fn minor(
        &mut self,
        nodes: &mut [ContactState],
        method: &'static dyn Method,
    ) -> Option<(Vec<ContactRecord>, bool)> {
        let problem = self.problem;
        let given = self.given(nodes)?;
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
        let all = nodes.iter_mut().zip(&problem.nodes).zip(given);
        let mut records: Vec<ContactRecord> = all
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

    /// Solves Table 1's equations for what the nodes bring, without a check of the modes. `None` if they are singular.
    pub fn given(&mut self, nodes: &[ContactState]) -> Option<Vec<NodeIncrement>> {
        let settings = self.problem.settings;
        self.solve(|s, node| {
            minor::rows(
                &nodes[s],
                node.kinematics.as_ref(),
                &node.friction,
                &settings,
            )
        })
    }

    /// Derivative of the last solution by the right-hand side of equation k (0 normal, 1 tangential) of a node: one entry a
    /// node. `None` if it is not finite.
    pub fn answers_to(&mut self, slave: usize, k: usize) -> Option<Vec<NodeIncrement>> {
        self.z.fill(0.0);
        self.z[2 * slave + k] = 1.0;
        self.dense.solve(&mut self.z).ok()?;
        let relation = &self.problem.relation;
        let change = |s: usize| {
            let [force, motion] = relation.change(&self.z, s);
            NodeIncrement { force, motion }
        };
        Some((0..self.problem.nodes.len()).map(change).collect())
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
        let given = |(s, node): (usize, &ProblemNode)| {
            let [force, motion] = relation.answer(&self.z, s, node.prescribed);
            NodeIncrement { force, motion }
        };
        Some(nodes.map(given).collect())
    }
}

impl InterfaceProblem {
    /// What each node brings into the next minor iteration.
    pub fn states(&self) -> Vec<ContactState> {
        self.nodes.iter().map(|node| node.state).collect()
    }

    /// Tolerances of Table 2, if the largest force is `force`.
    pub fn ties(&self, force: f64) -> Ties {
        Ties {
            force: self.settings.tolerance * force,
            length: self.settings.tolerance * self.length,
            keep: self.settings.ties == model::Ties::Keep,
        }
    }

    /// The problem of some of the nodes (`keep`, by place, ascending), the others eliminated by the equations of what they
    /// bring: they keep their modes. `None` if these equations are singular.
    pub fn reduced(&self, keep: &[usize]) -> Option<InterfaceProblem> {
        let (relation, count) = (&self.relation, self.relation.count());
        let rest: Vec<usize> = (0..self.nodes.len())
            .filter(|s| !keep.contains(s))
            .collect();
        let unknowns = |nodes: &[usize]| -> Vec<usize> {
            nodes.iter().flat_map(|&s| [2 * s, 2 * s + 1]).collect()
        };
        let (kept, gone) = (unknowns(keep), unknowns(&rest));
        let (mut matrix, mut rhs) = (vec![0.0; count * count], vec![0.0; count]);
        for &s in &rest {
            let node = &self.nodes[s];
            let rows = minor::rows(
                &node.state,
                node.kinematics.as_ref(),
                &node.friction,
                &self.settings,
            );
            for (k, row) in rows.iter().enumerate() {
                rhs[2 * s + k] = relation.place_row(s, k, row, node.prescribed, &mut matrix);
            }
        }
        // z of the rest for z = 0 of the kept ones, and its change by each of these.
        let own: Vec<f64> = gone
            .iter()
            .flat_map(|&j| gone.iter().map(move |&i| (i, j)))
            .map(|(i, j)| matrix[j * count + i])
            .collect();
        let mut answers: Vec<f64> = gone.iter().map(|&i| rhs[i]).collect();
        for &j in &kept {
            answers.extend(gone.iter().map(|&i| -matrix[j * count + i]));
        }
        let mut dense = DenseFactors::new(gone.len(), 1 + kept.len()).ok()?;
        dense.factor(&own);
        if dense.inverse_norm() > SINGULAR {
            return None;
        }
        dense.solve(&mut answers).ok()?;
        let through = |i: usize, column: usize| -> f64 {
            let z = answers.iter().skip(column * gone.len());
            let shares = gone.iter().zip(z);
            shares
                .map(|(&j, z)| relation.response[j * count + i] * z)
                .sum()
        };
        let start = kept.iter().map(|&i| relation.start[i] + through(i, 0));
        let columns = kept
            .iter()
            .enumerate()
            .flat_map(|(column, &j)| kept.iter().map(move |&i| (i, j, column + 1)));
        let response =
            columns.map(|(i, j, column)| relation.response[j * count + i] + through(i, column));
        Some(InterfaceProblem {
            relation: InterfaceResponse {
                stiffness: relation.stiffness,
                start: start.collect(),
                response: response.collect(),
            },
            nodes: keep.iter().map(|&s| self.nodes[s]).collect(),
            ..self.clone()
        })
    }
}

/// Forces, gap and slip that a node has after these increments, and the condition of its assumption that is closest to
/// being broken.
pub fn node_answer(
    problem: &InterfaceProblem,
    node: &ProblemNode,
    assumed: Assumed,
    NodeIncrement { force, motion }: NodeIncrement,
) -> NodeAnswer {
    let (f_n, f_t) = (node.state.f_n + force[0], node.state.f_t + force[1]);
    let limit = f_n.abs() * node.friction.coefficient() + node.friction.cohesion;
    let gap = node.kinematics.map_or(f64::INFINITY, |k| k.gap) - motion[0];
    let slip = node.state.slipped(&problem.settings) + motion[1];
    let of_force = |condition, value: f64| Margin {
        condition,
        value,
        relative: value / problem.force,
    };
    let of_length = |condition, value: f64| Margin {
        condition,
        value,
        relative: value / problem.length,
    };
    let pressed = of_force(Condition::NoTension, f_n);
    let worst = match assumed {
        Assumed::Free => of_length(Condition::NoPenetration, gap),
        Assumed::Fixed => smaller(pressed, of_force(Condition::WithinLimit, limit - f_t.abs())),
        _ if node.friction.is_smooth() => pressed,
        _ => smaller(
            pressed,
            of_length(Condition::Dissipation, assumed.sign() * slip),
        ),
    };
    NodeAnswer {
        assumed,
        f_n,
        f_t,
        limit,
        gap,
        slip,
        worst,
    }
}

fn smaller(a: Margin, b: Margin) -> Margin {
    if b.relative < a.relative { b } else { a }
}
