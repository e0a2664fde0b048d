//! The frozen interface problem: all that the minor iterations of one major iteration know of the bodies.
//!
//! While geometry and stiffness are frozen, forces and relative motions at the slave nodes depend linearly on each other
//! ([`InterfaceResponse`]). Coulomb's law, applied to the whole increment, says what each node may do: a free node has g >= 0
//! and no force; a touching one has F_n >= 0, and either sticks where it was at the start of the increment, with
//! |F_t| <= tan φ F_n + c, or slips with |F_t| = tan φ F_n + c against the slip. This module solves for one assumption of
//! what every node does, and says how far the answer is from obeying; [`crate::interface::census`] tries all of them.

use crate::contact::state::ContactState;
use crate::contact::table1::{Equation, FrictionBound, Known};
use crate::contact::table2::Ties;
use crate::interface::kinematics::{NodeIncrement, NodeKinematics};
use crate::interface::response::InterfaceResponse;
use crate::interface::rows::{self, moves, supported};
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
            limit: FrictionBound::Consistent {
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
