//! Progress of a history along the equilibrium path, as plain data; `arc` advances it.

use crate::contact::table1::t_max;
use crate::linear::source::LoadEquation;
use crate::model::{ArcLength, ArcMeasure};
use crate::{ContactState, Friction, Mode, Model};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Progress along the path, and the constraint of the current increment.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ArcState {
    /// Arc length from the start of the history to the current increment (in the measured quantity).
    pub length: f64,
    /// Size of the current increment; 0 before the first tangent.
    pub step: f64,
    /// Size of the first increment.
    pub first: f64,
    /// The quantity that measures increments.
    pub measured: ArcMeasure,
    /// Direction of the load factor towards the leg's corner: −1 or 1.
    pub ahead: f64,
    /// Constraint of the current increment.
    pub aim: ArcConstraint,
    /// Distance that the next major iteration has to cover.
    pub left: f64,
    /// Whether the tangent of the current increment is known.
    pub known: bool,
    /// Direction in which the measured quantity changes: −1 or 1.
    pub sign: f64,
    /// Weights of the plane normal to the tangent, by degree of freedom: their sum over a motion is its size.
    pub row: Arc<Vec<f64>>,
    /// Displacements of the previous increment, as weights; empty at the start of a leg.
    pub last: Arc<Vec<f64>>,
    /// Change of the load factor in the previous increment.
    pub last_load: f64,
    /// The contacts whose modes end first along the tangent (`step::recovery::path_corner`).
    #[serde(default)]
    pub next: Arc<Vec<Change>>,
    /// Arc length from the start of the increment to the ends of their modes.
    #[serde(default)]
    pub next_at: f64,
    /// The contacts that changed first in the current attempt.
    #[serde(default)]
    pub seen: Arc<Vec<Change>>,
    /// Slips of the sliding contacts in the previous increment, 0 for the others (length).
    #[serde(default)]
    pub slips: Arc<Vec<f64>>,
    /// Whether the current increment starts with the modes of `next`.
    #[serde(default)]
    pub turned: bool,
}

/// Change of a contact's mode at a corner of the path.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// Contact number.
    pub contact: usize,
    /// Mode before the corner.
    pub from: Mode,
    /// Mode after the corner.
    pub to: Mode,
    /// Direction of its tangential force (−1, 0 or 1).
    pub sign: f64,
    /// Whether it is held in the concave corner into which it slides.
    pub held: bool,
    /// Whether it slides out of the concave corner at which it sticks, since no increment ends in that corner.
    #[serde(default)]
    pub through: bool,
}

/// Constraint of an increment.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub enum ArcConstraint {
    /// None yet: the tangent has to be found.
    #[default]
    Tangent,
    /// The plane normal to the tangent.
    Plane,
    /// A degree of freedom reaches a value.
    Dof {
        /// Its number.
        dof: usize,
        /// The value.
        to: f64,
    },
    /// The slip of a contact.
    Slip(usize),
    /// The load factor reaches a value.
    Load(f64),
}

/// Relative accuracy of increment sizes.
pub(super) const ROUNDING: f64 = 1e-9;

/// Maximum arc length of a history along the path.
pub(super) fn farthest(model: &Model) -> f64 {
    let most = ArcLength::FARTHEST * model.length;
    model.arc.length.unwrap_or(most)
}

impl ArcState {
    /// State before the first increment.
    pub fn new(model: &Model) -> Self {
        ArcState {
            measured: model.arc.along,
            ahead: (model.path[1] - model.path[0]).signum(),
            sign: 1.0,
            ..Self::default()
        }
    }

    /// Constraint equation of the next solve.
    pub(super) fn along(&self) -> LoadEquation<'_> {
        let step = self.left;
        match self.aim {
            ArcConstraint::Tangent if self.last.is_empty() => LoadEquation::Load { step },
            ArcConstraint::Tangent => LoadEquation::Displacements {
                row: &self.last,
                step,
            },
            ArcConstraint::Plane => LoadEquation::Displacements {
                row: &self.row,
                step,
            },
            ArcConstraint::Dof { dof, .. } => LoadEquation::Dof { dof, step },
            ArcConstraint::Slip(contact) => LoadEquation::Slip { contact, step },
            ArcConstraint::Load(_) => LoadEquation::Load { step },
        }
    }

    /// Starts an increment, or another attempt at it, from displacements `start`; `increment` is the increment of the load
    /// factor.
    pub(super) fn begin(&mut self, start: &[f64], increment: f64) {
        if !self.seen.is_empty() {
            self.seen = Arc::default();
        }
        if !self.known {
            self.aim = ArcConstraint::Tangent;
            self.left = if self.last.is_empty() {
                self.ahead * increment
            } else {
                1.0
            };
            return;
        }
        self.left = self.sign * self.step;
        self.aim = match self.measured {
            ArcMeasure::Displacements => ArcConstraint::Plane,
            ArcMeasure::Dof(dof) => ArcConstraint::Dof {
                dof,
                to: start[dof] + self.left,
            },
            ArcMeasure::Slip(contact) => ArcConstraint::Slip(contact),
        };
    }

    /// Remaining distance of the current constraint at displacements `u`.
    pub(super) fn remaining(&self, u: &[f64], start: &[f64]) -> f64 {
        match self.aim {
            ArcConstraint::Plane => self.step - self.gone(u, start),
            ArcConstraint::Dof { dof, to } => to - u[dof],
            ArcConstraint::Tangent | ArcConstraint::Slip(_) | ArcConstraint::Load(_) => 0.0,
        }
    }

    /// Lets contacts that the corner of the path holds in a concave corner slide out of it. Returns whether there are any.
    pub(super) fn pass_through(&mut self) -> bool {
        let sticks = |change: &Change| change.from == Mode::Fixed && change.held;
        if !self.next.iter().any(sticks) {
            return false;
        }
        for change in Arc::make_mut(&mut self.next) {
            if sticks(change) {
                (change.to, change.held, change.through) = (Mode::Sliding, false, true);
            }
        }
        true
    }

    /// Distance from the start along the tangent.
    pub(super) fn gone(&self, u: &[f64], start: &[f64]) -> f64 {
        let moved = u.iter().zip(start).map(|(u, start)| u - start);
        self.row.iter().zip(moved).map(|(c, moved)| c * moved).sum()
    }

    /// Gives contacts the modes behind the corner, if the current increment starts there.
    pub(super) fn change(&self, nodes: &mut [ContactState], friction: &[Friction]) {
        for change in self.next.iter().filter(|_| self.turned) {
            let node = &mut nodes[change.contact];
            node.mode = change.to;
            if change.to == Mode::Sliding {
                let friction = node.friction(&friction[change.contact]);
                node.sign = change.sign;
                node.t_max = t_max(&friction, node.f_n, change.sign);
            }
        }
    }

    /// Records where the next corner lies, along a motion with this `size` in the measured quantity.
    pub(super) fn expect(&mut self, (at, changes): (f64, Vec<Change>), size: f64) {
        self.next_at = at * size;
        self.next = Arc::new(changes);
    }
}
