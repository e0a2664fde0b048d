//! Major iterations in which sliding is held back ([`super::proximal`]), and which of them are taken back.

use super::proximal::Brake;
use crate::linear::norms::Norms;
use crate::model::Mode;
use crate::step::event::{Failure, Outcome};
use crate::step::state::{Progress, State};
use crate::step::stepper::Stepper;

/// Slip in one major iteration beyond which it is taken back, relative to the scene's length.
const FAR: f64 = 0.02;
/// Part of its work before that a step may have turned round after it.
const TURNED: f64 = 0.5;
/// Error of the interface conditions (relative) below which nothing is carried any more.
const EXACT: f64 = 1e-9;
/// Times the settings' major iterations that an increment may take which is held back.
pub(in crate::step) const PATIENCE: u32 = 5;

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
