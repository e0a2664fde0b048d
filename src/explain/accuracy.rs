//! What round-off leaves of a scene's accuracy, in words.

use crate::linear::norms::Norms;

/// What accuracy round-off leaves; `None` if it leaves enough.
pub fn left(norms: &Norms) -> Option<String> {
    (norms.noise > Norms::AUDIBLE).then(|| {
        format!(
            "forces are known to about {:.0e} of the loads: that is the round-off of the stiffest ones",
            norms.noise
        )
    })
}

/// That increments were accepted at more than the tolerance, since round-off leaves as much; `reached` is the largest relative
/// error of them. `None` if none was.
pub fn raised(tolerance: f64, reached: f64) -> Option<String> {
    (reached > tolerance).then(|| {
        format!(
            "settings.tolerance {tolerance:.0e} is below what round-off leaves in this scene: increments were accepted at up to {reached:.1e}"
        )
    })
}
