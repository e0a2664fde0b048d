//! The frozen interface problem: all data of the bodies that the minor iterations of one major iteration use.
//!
//! With frozen geometry and stiffness, forces and relative motions at the slave nodes depend linearly on each other
//! ([`InterfaceResponse`]). Coulomb's law, applied to the whole increment, restricts each node: a free node has g >= 0 and no
//! force; a touching one has F_n >= 0, and either sticks where it was at the start of the increment, with
//! |F_t| <= tan φ F_n + c, or slips with |F_t| = tan φ F_n + c against the slip. This module solves for one combination of
//! modes and measures how far the solution is from obeying this law; [`crate::interface::census`] tries all combinations.

use crate::contact::table1::{FrictionBound, SlipDirection};
use crate::interface::rows::{self, moves, supported};
use crate::linalg::DenseFactors;
use crate::model;
use crate::{
    ContactState, Equation, Friction, InterfaceResponse, Mode, NodeIncrement, NodeKinematics,
    Settings, Ties,
};
use serde::{Deserialize, Serialize};

/// Estimated norm of the inverse of the scaled matrix above which a combination counts as singular.
pub const SINGULAR: f64 = 1e11;

/// The frozen interface problem of a major iteration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InterfaceProblem {
    /// Dependence of the forces on the motions (eqn 6).
    pub relation: InterfaceResponse,
    /// One entry per slave node, in the relation's order.
    pub nodes: Vec<ProblemNode>,
    /// Force scale, the unit of relative force margins.
    pub force: f64,
    /// Length scale, the unit of relative length margins.
    pub length: f64,
    /// Stiffness that relates lengths to forces (force per length), finite even if `relation` has no springs.
    pub spring: f64,
    /// Effective settings.
    pub settings: Settings,
}

/// Data of a slave node in the frozen problem.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ProblemNode {
    /// Contact number in the scene.
    pub slave: usize,
    /// Position relative to its surface; `None` beyond the ends of all surfaces.
    #[serde(rename = "site")]
    pub kinematics: Option<NodeKinematics>,
    /// Prescribed part of the motion of S* relative to S, along n and t (length).
    pub prescribed: [f64; 2],
    /// Current friction of the node.
    pub friction: Friction,
    /// State of the node before the next minor iteration.
    pub state: ContactState,
}

/// Assumed mode of a node, with the direction of sliding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum AssumedMode {
    /// No force.
    Free,
    /// Touching and sticking.
    Fixed,
    /// Sliding with F_t > 0.
    Plus,
    /// Sliding with F_t < 0.
    Minus,
}

impl AssumedMode {
    /// One letter, as in the reference solutions: F, X, +, −.
    pub fn letter(self) -> char {
        match self {
            AssumedMode::Free => 'F',
            AssumedMode::Fixed => 'X',
            AssumedMode::Plus => '+',
            AssumedMode::Minus => '-',
        }
    }

    /// The mode without the direction.
    pub fn mode(self) -> Mode {
        match self {
            AssumedMode::Free => Mode::Free,
            AssumedMode::Fixed => Mode::Fixed,
            AssumedMode::Plus | AssumedMode::Minus => Mode::Sliding,
        }
    }

    /// The assumption for this mode and sign of the tangential force.
    pub fn from_mode(mode: Mode, sign: f64) -> Self {
        match mode {
            Mode::Free => AssumedMode::Free,
            Mode::Fixed => AssumedMode::Fixed,
            Mode::Sliding if sign < 0.0 => AssumedMode::Minus,
            Mode::Sliding => AssumedMode::Plus,
        }
    }

    /// Sign of F_t when sliding; 1 for the other assumptions.
    pub fn sign(self) -> f64 {
        if self == AssumedMode::Minus {
            -1.0
        } else {
            1.0
        }
    }
}

impl ProblemNode {
    /// Whether its normal and its tangential motion contain an unknown.
    pub fn moves(&self) -> [bool; 2] {
        moves(self.kinematics.as_ref())
    }

    /// The possible assumptions for the node. Without friction, a node cannot stick, and sliding has no direction.
    pub fn choices(&self) -> &'static [AssumedMode] {
        if self.kinematics.is_none() {
            &[AssumedMode::Free]
        } else if self.friction.is_smooth() {
            &[AssumedMode::Free, AssumedMode::Plus]
        } else {
            &[
                AssumedMode::Free,
                AssumedMode::Fixed,
                AssumedMode::Plus,
                AssumedMode::Minus,
            ]
        }
    }

    /// Table 1's equations of an assumption, normal and tangential; T_max follows F_n in them.
    pub fn equations(&self, assumed: AssumedMode, settings: &Settings) -> [Equation; 2] {
        let known = SlipDirection {
            gap: self.kinematics.map_or(0.0, |k| k.gap),
            ratio: 0.0,
            slip: self.state.slipped(settings),
            f_n: self.state.f_n,
            f_t: self.state.f_t,
            limit: FrictionBound::Consistent {
                sign: assumed.sign(),
                coefficient: self.friction.coefficient(),
                cohesion: self.friction.cohesion,
            },
        };
        supported(assumed.mode(), &known, self.moves())
    }
}

/// Solution for an assumption at one node.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NodeAnswer {
    /// The assumption.
    pub assumed: AssumedMode,
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
    /// The condition closest to violation, or violated most.
    pub worst: Margin,
}

/// A condition of an assumption.
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

/// Distance of a condition from violation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Margin {
    /// The condition.
    pub condition: Condition,
    /// Force or length; negative if the condition is violated.
    pub value: f64,
    /// `value` divided by [`InterfaceProblem::force`] or [`InterfaceProblem::length`].
    pub relative: f64,
}

/// The solution for a combination of assumptions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    /// One entry per node of the problem, in its order.
    pub nodes: Vec<NodeAnswer>,
}

impl Answer {
    /// The combination, one letter per node.
    pub fn letters(&self) -> String {
        self.nodes.iter().map(|n| n.assumed.letter()).collect()
    }

    /// The node whose condition is closest to violation, or violated most, with that condition. `None` without nodes.
    pub fn worst(&self) -> Option<(usize, Margin)> {
        self.nodes
            .iter()
            .map(|n| n.worst)
            .enumerate()
            .min_by(|a, b| a.1.relative.total_cmp(&b.1.relative))
    }

    /// Whether every node satisfies its conditions, up to a relative tolerance.
    pub fn obeys(&self, tolerance: f64) -> bool {
        self.nodes.iter().all(|n| n.worst.relative >= -tolerance)
    }
}

impl InterfaceProblem {
    /// State of each node before the next minor iteration.
    pub fn states(&self) -> Vec<ContactState> {
        self.nodes.iter().map(|node| node.state).collect()
    }

    /// Tolerances of Table 2 if the largest force is `force`.
    pub fn ties(&self, force: f64) -> Ties {
        Ties {
            force: self.settings.tolerance * force,
            length: self.settings.tolerance * self.length,
            keep: self.settings.ties == model::TieRule::Keep,
        }
    }

    /// The problem of some of the nodes (`keep`, by index, ascending); the others keep their modes and are eliminated by their
    /// equations. `None` if these equations are singular.
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
            let rows = rows::rows(
                &node.state,
                node.kinematics.as_ref(),
                &node.friction,
                &self.settings,
                0.0,
            );
            for (k, row) in rows.iter().enumerate() {
                rhs[2 * s + k] = relation.place_row(s, k, row, node.prescribed, &mut matrix);
            }
        }
        // z of the eliminated nodes for z = 0 of the kept ones, and its derivative with respect to each of these.
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
            gone.iter()
                .zip(z)
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

/// Forces, gap and slip of a node after these increments, and the condition of its assumption that is closest to violation.
pub fn node_answer(
    problem: &InterfaceProblem,
    node: &ProblemNode,
    assumed: AssumedMode,
    NodeIncrement { force, motion }: NodeIncrement,
) -> NodeAnswer {
    let (f_n, f_t) = (node.state.f_n + force[0], node.state.f_t + force[1]);
    let limit = node.friction.limit(f_n.abs());
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
        AssumedMode::Free => of_length(Condition::NoPenetration, gap),
        AssumedMode::Fixed => smaller(pressed, of_force(Condition::WithinLimit, limit - f_t.abs())),
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
