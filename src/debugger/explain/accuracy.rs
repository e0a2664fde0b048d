//! Describes how far round-off limits the accuracy of a scene.

use stickslip_core::linear::norms::Norms;

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
            "settings.tolerance {tolerance:.0e} is below the round-off of this scene: increments were accepted at errors up to {reached:.1e}"
        )
    })
}
