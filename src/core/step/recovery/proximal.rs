//! Sliding that is held back: how an increment ends whose nodes cannot come to rest near where they were.
//!
//! Where a surface bends under a node, or is made of elements that meet at an angle, the force that drives a sliding node
//! along it may fall and rise again over a short way. The branch of equilibrium that the loads follow then ends, the next
//! one begins further on, and Newton's method hops to and fro between tangents that point away from each other. Where
//! nothing else has helped, the smallest increment is tried once more with
//!
//! ```text
//! ΔF_t − κ (Δu_tS* − Δu_tS) = T_max − F_t
//! ```
//!
//! at every sliding node in place of Table 1's ΔF_t = T_max − F_t: the tangential force is taken off a step at a time,
//! and the node goes where that force drives it. Once major iterations come to rest the motion is zero, and the
//! equation is Table 1's; what is accepted does not hang on κ. This is a proximal (Levenberg-Marquardt) step, or one of
//! pseudo-transient continuation with a viscosity on the slip (Kelley & Keyes, SIAM J. Numer. Anal. 35, 1998).
//!
//! The work of those forces on the slip decides about κ. With the slips δ of a major iteration, and the driving forces d =
//! F_t − T_max before and after it, the step is good if Σ δ d was positive, and has not turned below minus half of that: what
//! the nodes lose in energy then goes down from one major iteration to the next, so that none comes back to where it was. κ
//! starts at the interface's own stiffness, and falls after a good step. A step that is not good, or goes far, is taken
//! back, and tried with a greater κ, as is one whose minor iterations find no consistent modes. Friction opposes the slip of
//! the present major iteration, as it would in time; the judge looks at the net slip in the end.

use crate::linear::norms::Norms;
use crate::model::Mode;
use crate::step::event::{Failure, Outcome};
use crate::step::state::{Progress, State};
use crate::step::stepper::Stepper;
use serde::{Deserialize, Serialize};

/// Factors by which κ grows and falls.
const GROWS: f64 = 8.0;
const FALLS: f64 = 0.25;
/// κ over the interface's stiffness below which it holds nothing back, and above which it does not help.
const LEAST: f64 = 1e-7;
const MOST: f64 = 1e6;

/// Slip in one major iteration beyond which it is taken back, relative to the scene's length.
const FAR: f64 = 0.02;
/// Part of its work before that a step may have turned round after it.
const TURNED: f64 = 0.5;
/// Error of the interface conditions (relative) below which nothing is carried any more.
const EXACT: f64 = 1e-9;
/// Times the settings' major iterations that an increment may take which is held back.
pub(in crate::step) const PATIENCE: u32 = 5;

/// How sliding is held back.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Brake {
    /// The interface's own stiffness as the attempt began (force by length).
    pub spring: f64,
    /// κ of the present major iteration (force by length).
    pub stiffness: f64,
}

impl Brake {
    /// As an attempt begins, with the interface's own stiffness (force by length).
    pub(in crate::step) fn new(spring: f64) -> Self {
        Brake {
            spring,
            stiffness: spring,
        }
    }

    /// Holds back more; false where that does not help any more.
    pub(super) fn tighten(&mut self) -> bool {
        self.stiffness = GROWS * self.stiffness.max(LEAST * self.spring);
        self.stiffness <= MOST * self.spring
    }

    /// Holds back less.
    pub(super) fn loosen(&mut self) {
        let less = FALLS * self.stiffness;
        let holds = less > LEAST * self.spring;
        self.stiffness = if holds { less } else { 0.0 };
    }
}

/// A major iteration that may have to be taken back.
pub(in crate::step) struct Held {
    /// Where it began.
    state: Box<State>,
    /// What held it back.
    brake: Brake,
    /// Slips of the sliding contacts, 0 of the others (length).
    slips: Vec<f64>,
    /// Σ δ d before it (force by length).
    work: f64,
}

impl Stepper {
    /// The modes of a major iteration do not settle: it begins again with a greater κ, with which they do in the end. `None`
    /// where sliding is not held back, or κ does not help any more.
    pub(in crate::step) fn hold_harder(&mut self, why: &Failure) -> Option<Outcome> {
        let brake = self.state.brake.as_mut()?;
        if !brake.tighten() {
            return None;
        }
        let stiffness = brake.stiffness;
        self.state.search = Progress::default();
        self.state.next.minor += 1;
        Some(Outcome::HeldBack {
            why: Some(why.clone()),
            stiffness,
        })
    }

    /// Whether what holds sliding back still carries a part of the friction that the judge would miss.
    pub(in crate::step) fn is_carried(&self, after: &Norms) -> bool {
        let holds = |brake: Brake| brake.stiffness > 0.0;
        self.state.brake.is_some_and(holds) && after.interface > EXACT
    }

    /// What a major iteration is about to do, where sliding is held back.
    pub(in crate::step) fn hold(&self) -> Option<Held> {
        self.state.brake.map(|brake| {
            let (mut work, mut slips) = (0.0, Vec::new());
            for (contact, node) in self.state.nodes.iter().enumerate() {
                let record = self.record(contact);
                let slides = record.decision.before == Mode::Sliding;
                let slip = if slides {
                    self.source.increment(contact).motion[1]
                } else {
                    0.0
                };
                work += slip * (node.f_t - record.t_max_used);
                slips.push(slip);
            }
            Held {
                state: Box::new(self.state.clone()),
                brake,
                slips,
                work,
            }
        })
    }

    /// Takes a major iteration back that went too far or the wrong way. Else κ falls for the next one.
    pub(in crate::step) fn hold_back(&mut self, held: Held) -> Option<Outcome> {
        let Held {
            state,
            mut brake,
            slips,
            work: before,
        } = held;
        let far = FAR * self.model.length;
        let after: f64 = (slips.iter().zip(&self.state.nodes))
            .map(|(slip, node)| slip * (node.f_t - node.t_max))
            .sum();
        // The first major iteration brings the load in, which drives nodes by itself.
        let loads = state.next.major == 1;
        let way: f64 = slips.iter().map(|slip| slip.abs()).sum();
        let tiny = self.state.controls.settings.tolerance * self.force_scale() * way;
        let turned = before < -tiny || after < -TURNED * before - tiny;
        let wrong = slips.iter().any(|slip| slip.abs() > far) || turned && !loads;
        if !wrong || !brake.tighten() {
            brake.loosen();
            self.state.brake = Some(brake);
            return None;
        }
        self.state = *state;
        self.state.brake = Some(brake);
        self.linearised = false;
        self.begin_again();
        self.state.next.minor += 1;
        Some(Outcome::HeldBack {
            why: None,
            stiffness: brake.stiffness,
        })
    }
}
