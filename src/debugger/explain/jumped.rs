//! Describes jumps to another branch of equilibrium, and loss of stability.

use stickslip_core::{Event, Model, Stability, StabilityLoss};
use stickslip_scene::{shortest, sig2, sig4};

/// The motions that lead away from an unstable state.
pub fn leads_away(stability: Stability) -> String {
    match stability {
        Stability::Unstable { modes: 1 } => "1 motion leads away from equilibrium".into(),
        Stability::Unstable { modes } => {
            format!("{modes} independent motions lead away from equilibrium")
        }
        _ => "with friction, a motion grows (divergence)".into(),
    }
}

/// Why an increment that jumped fails, and the stability of the state after the jump.
pub fn jump(motion: f64, predicted: f64, unstable: Option<Stability>) -> String {
    match unstable {
        Some(stability) => format!(
            "the increment would end in an unstable state: {}",
            leads_away(stability)
        ),
        None => format!(
            "a jump to another branch: the motion is {}, while the tangent and the previous increments predict {}",
            sig4(motion),
            sig2(predicted)
        ),
    }
}

/// Objections against an accepted increment; empty if it stays on the branch of stable equilibrium.
pub fn reservation(jumped: bool, unstable: Option<&StabilityLoss>) -> String {
    match unstable {
        Some(loss) => {
            let since = loss
                .stable_at
                .map(|load| format!("; last known to be stable at load {}", shortest(load)))
                .unwrap_or_default();
            format!(", unstable: {}{since}", leads_away(loss.stability))
        }
        None if jumped => ", after a jump to another branch".into(),
        None => String::new(),
    }
}

/// How the history ends with an increment.
pub fn end(model: &Model, event: &Event) -> &'static str {
    if event.is_cut_short(model) {
        "; the path stops here, at its maximum length"
    } else {
        "; the history is complete"
    }
}
