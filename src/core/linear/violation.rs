//! Violation of the conditions of a state's modes.

use super::source::LinearisationPoint;
use crate::model::Sticking;
use crate::{Mode, NodeKinematics};

/// Largest violation of the interface conditions by a state's forces and gaps, relative to a length and a force: gaps of touching
/// contacts, penetration of free ones, drift of anchored ones, and |F_t − T_max| of sliding ones.
pub fn violation(
    at: &LinearisationPoint<'_>,
    length: f64,
    force: f64,
    kinematics: impl Fn(usize) -> Option<NodeKinematics>,
) -> f64 {
    let mut worst = 0.0_f64;
    for (contact, state) in at.contacts.iter().enumerate() {
        // Even within a major iteration, the violation refers to its initial modes.
        let (mode, t_max) = match at.entered.get(contact) {
            Some(input) => (input.mode, input.t_max),
            None => (state.mode, state.t_max),
        };
        let Some(over) = kinematics(contact) else {
            continue;
        };
        let gap = match mode {
            Mode::Free => (-over.gap).max(0.0),
            _ => over.gap.abs(),
        };
        let beyond = match mode {
            Mode::Sliding => (state.f_t - t_max).abs(),
            _ => 0.0,
        };
        let held = state.corner.is_some() || over.bond.is_tied();
        let anchored = at.chosen.sticking == Sticking::Anchored || held;
        let drift = match mode {
            Mode::Fixed if anchored && over.moves[1] => state.drift.abs(),
            _ => 0.0,
        };
        worst = worst.max(gap.max(drift) / length);
        if beyond > 0.0 {
            worst = worst.max(beyond / force);
        }
    }
    worst
}
