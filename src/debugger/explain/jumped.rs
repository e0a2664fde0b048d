//! Describes jumps to another branch of equilibrium and states that lost their stability.

use stickslip_core::linear::stability::Stability;
use stickslip_core::model::Model;
use stickslip_core::step::event::Event;
use stickslip_core::step::watch::StabilityLoss;

/// The motion that leads away from an unstable state.
pub fn leads_away(stability: Stability) -> String {
    match stability {
        Stability::Unstable { modes: 1 } => "1 motion leads away from equilibrium".into(),
        Stability::Unstable { modes } => {
            format!("{modes} independent motions lead away from equilibrium")
        }
        _ => "with its friction, a motion grows (divergence)".into(),
    }
}

/// Why an increment that jumped fails, and the state it would end in.
pub fn jump(motion: f64, predicted: f64, unstable: Option<Stability>) -> String {
    match unstable {
        Some(stability) => format!(
            "it would end in an unstable state: {}",
            leads_away(stability)
        ),
        None => format!(
            "a jump to another branch: it moves by {motion:.3e}, where its tangent and the increments before predict {predicted:.1e}"
        ),
    }
}

/// Objections against an accepted increment; empty if it stays on the branch of stable equilibrium.
pub fn reservation(jumped: bool, unstable: Option<&StabilityLoss>) -> String {
    match unstable {
        Some(loss) => {
            let since = loss.stable_at.map_or(String::new(), |load| {
                format!("; last known to be stable at load {load}")
            });
            format!(", unstable: {}{since}", leads_away(loss.stability))
        }
        None if jumped => ", jumped: another branch from here".into(),
        None => String::new(),
    }
}

/// How the history ends with an increment.
pub fn end(model: &Model, event: &Event) -> &'static str {
    match event.is_cut_short(model) {
        true => "; the path is not completed: it came to the bound on its length",
        false => "; the history is done",
    }
}
