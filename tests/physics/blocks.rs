//! What the tests of solids share: a block alone, and a run that must get to its end.

use crate::common::{Run, run};
use stickslip::scene::Scene;

/// A block alone: corners, elements, material, and whatever else.
pub fn block(corners: &str, elements: &str, material: &str, rest: &str) -> Scene {
    let text = format!(
        "(title: \"t\", nodes: [Block(id: \"k\", corners: [{corners}], elements: {elements})],
          materials: [Elastic(id: \"m\", {material})], bodies: [Solid(id: \"k\", mesh: \"k\", material: \"m\")],
          {rest})"
    );
    Scene::from_text("test.ron", &text, &[]).unwrap_or_else(|e| panic!("{e}"))
}

pub fn finished(scene: &Scene) -> Run {
    let run = run(scene);
    assert!(run.failure.is_none(), "{:?}", run.failure);
    run
}

pub fn last(run: &Run, monitor: &str) -> f64 {
    run.accepted.last().unwrap().monitors[monitor]
}
