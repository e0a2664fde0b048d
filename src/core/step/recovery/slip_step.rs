//! Major iterations in which sliding is held back ([`super::proximal`]), and which of them are undone.

use super::proximal::SlipStiffness;
use crate::step::iterate::Iterate;
use crate::step::state::Progress;
use crate::{ContactRecord, Failure, Mode, Norms, Outcome, State};

/// Slip in one major iteration beyond which it is undone, relative to the scene's length.
const FAR: f64 = 0.02;
/// Maximum reversed work after a step, as a fraction of the work before it.
const TURNED: f64 = 0.5;
/// Error of the interface conditions (relative) below which the held-back sliding carries no force.
const EXACT: f64 = 1e-9;
/// Factor on the settings' limit of major iterations for an increment in which sliding is held back.
pub(in crate::step) const PATIENCE: u32 = 5;

/// A major iteration that may have to be undone.
pub(in crate::step) struct UndoableMajor {
    /// State at its start.
    state: Box<State>,
    /// Brake in force during it.
    brake: SlipStiffness,
    /// Slips of the sliding contacts, 0 for the others (length).
    slips: Vec<f64>,
    /// Σ δ d before it (force times length).
    work: f64,
}

impl Iterate {
    /// Records a major iteration before it is done, if sliding is held back.
    pub(in crate::step) fn hold(&self, records: &[ContactRecord]) -> Option<UndoableMajor> {
        self.state.recovery.brake.map(|brake| {
            let (mut work, mut slips) = (0.0, Vec::new());
            for (contact, node) in self.state.nodes.iter().enumerate() {
                let record = &records[contact];
                let slides = record.decision.before == Mode::Sliding;
                let slip = if slides {
                    self.source.increment(contact).motion[1]
                } else {
                    0.0
                };
                work += slip * (node.f_t - record.t_max_used);
                slips.push(slip);
            }
            UndoableMajor {
                state: Box::new(self.state.clone()),
                brake,
                slips,
                work,
            }
        })
    }

    /// Undoes a major iteration that moved too far or in the wrong direction. Otherwise decreases κ for the next one.
    pub(in crate::step) fn hold_back(&mut self, held: UndoableMajor) -> Option<Outcome> {
        let UndoableMajor {
            state,
            mut brake,
            slips,
            work: before,
        } = held;
        let far = FAR * self.model.length;
        let after: f64 = (slips.iter().zip(&self.state.nodes))
            .map(|(slip, node)| slip * (node.f_t - node.t_max))
            .sum();
        // The first major iteration applies the load, which drives nodes by itself.
        let loads = state.next.major == 1;
        let way: f64 = slips.iter().map(|slip| slip.abs()).sum();
        let tiny = self.state.controls.settings.tolerance * self.force_scale() * way;
        let turned = before < -tiny || after < -TURNED * before - tiny;
        let wrong = slips.iter().any(|slip| slip.abs() > far) || turned && !loads;
        if !wrong || !brake.tighten() {
            brake.loosen();
            self.state.recovery.brake = Some(brake);
            return None;
        }
        self.state = *state;
        self.state.recovery.brake = Some(brake);
        self.linearised = false;
        self.state.begin_again();
        self.state.next.minor += 1;
        Some(Outcome::HeldBack {
            why: None,
            stiffness: brake.stiffness,
        })
    }
}

impl State {
    /// The modes of a major iteration do not converge: restarts it with a larger κ, with which they converge eventually. `None`
    /// if sliding is not held back, or if a larger κ no longer helps.
    pub(in crate::step) fn hold_harder(&mut self, why: &Failure) -> Option<Outcome> {
        let brake = self.recovery.brake.as_mut()?;
        if !brake.tighten() {
            return None;
        }
        let stiffness = brake.stiffness;
        self.attempt.search = Progress::default();
        self.next.minor += 1;
        Some(Outcome::HeldBack {
            why: Some(why.clone()),
            stiffness,
        })
    }

    /// Whether the brake still carries a part of the friction, which the judge would report as missing.
    pub(in crate::step) fn is_carried(&self, after: &Norms) -> bool {
        self.recovery
            .brake
            .is_some_and(|brake| brake.stiffness > 0.0)
            && after.interface > EXACT
    }
}
