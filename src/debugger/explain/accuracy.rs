//! Describes how far round-off limits the accuracy of a scene.

use stickslip_core::strategy::SETTLED;
use stickslip_core::{Event, Norms, Rule, Test, TestedQuantity};
use stickslip_scene::{sig2, sig4};

/// Describes the accuracy that round-off permits; `None` if it is sufficient.
pub fn left(norms: &Norms) -> Option<String> {
    (norms.noise > Norms::AUDIBLE).then(|| {
        format!(
            "forces are accurate to about {:.0e} of the loads, due to round-off of the stiffest ones",
            norms.noise
        )
    })
}

/// Reports increments accepted above the tolerance because of round-off; `reached` is their largest relative error. `None`
/// if there were no such increments.
pub fn raised(tolerance: f64, reached: f64) -> Option<String> {
    (reached > tolerance).then(|| {
        format!(
            "settings.tolerance {tolerance:.0e} is below the round-off of this scene: increments were accepted at errors up to {}",
            sig2(reached)
        )
    })
}

/// What remains after Gauss-Seidel sweeps: the natural map, or the change of the forces in the last one.
pub fn sweeps(event: &Event) -> String {
    match first_test(event) {
        None => "sweeps".to_owned(),
        Some(test) if test.tested == TestedQuantity::Error => {
            format!(
                "sweeps; the natural map of the forces is {}",
                sig2(test.value)
            )
        }
        Some(test) => format!(
            "sweeps; the last one changed forces by {}",
            sig4(test.value)
        ),
    }
}

/// The natural map of forces that were accepted without a solve for their modes, relative to the forces. In space, where all forces
/// are those of sweeps, only if it is larger than usual.
pub fn natural_map(event: &Event) -> Option<f64> {
    let first = event.nodes.first()?;
    let error = first_test(event).map(|test| test.value)?;
    let noted = first.directions.is_none() || error > SETTLED;
    (noted && first.decision.rule == Rule::Settled).then_some(error)
}

/// The note [`not_unique`] for an event whose forces are not unique.
pub fn settled(event: &Event) -> Option<String> {
    natural_map(event).map(not_unique)
}

/// Describes forces that were accepted with this natural map.
pub fn not_unique(error: f64) -> String {
    let why = match error > SETTLED {
        true => "settings.matrix_accuracy allows the contact forces of the sweeps; they",
        false => "the modes do not determine the contact forces; those of the sweeps",
    };
    format!(
        "{why} satisfy the contact laws to {} (natural map)",
        sig2(error)
    )
}

fn first_test(event: &Event) -> Option<Test> {
    event.nodes.iter().find_map(|node| node.decision.tests[0])
}
