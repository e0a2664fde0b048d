//! Checks before a run whether double precision is sufficient for a scene.

use stickslip_core::linear::sizes::expected_noise;
use stickslip_core::{BodyKind, Model, Norms};

/// Ratio of the expected round-off to the round-off found in runs.
const GENEROUS: f64 = 10.0;

/// Reports a body that is so much stiffer than another that round-off reduces the accuracy of the forces; `None` if the
/// accuracy is sufficient.
pub fn warning(model: &Model) -> Option<String> {
    let (number, noise) = expected_noise(model)?;
    let noise = noise / GENEROUS;
    let body = model.bodies.get(number)?;
    let (word, value) = match &body.kind {
        BodyKind::Beam(beam) => ("EA", beam.ea),
        BodyKind::Truss(truss) => ("EA", truss.ea),
        BodyKind::Solid(solid) => {
            let all = solid.materials.iter().map(|material| material.young);
            ("E", all.fold(0.0, f64::max))
        }
        BodyKind::Linear(_) => return None,
    };
    (noise > Norms::AUDIBLE).then(|| {
        let enough = value * Norms::AUDIBLE / noise;
        let end = if noise > Norms::LOUDEST { format!("at most {:.0e} is accepted", Norms::LOUDEST) } else { "the contact forces have few digits left".to_owned() };
        format!(
            "body {}, {word} = {value:.0e}, is so stiff that the round-off of its forces is about {noise:.0e} of the loads; {end}. {word} = {enough:.0e} is practically rigid",
            body.name
        )
    })
}
