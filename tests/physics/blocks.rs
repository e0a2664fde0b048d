//! What the tests of solids share: a block alone.

use crate::common::read;
use stickslip::scene::Scene;

/// A block alone: corners, elements, material, and whatever else.
pub fn block(corners: &str, elements: &str, material: &str, rest: &str) -> Scene {
    let text = format!(
        "(title: \"t\", nodes: [Block(id: \"k\", corners: [{corners}], elements: {elements})],
          materials: [Elastic(id: \"m\", {material})], bodies: [Solid(id: \"k\", mesh: \"k\", material: \"m\")],
          {rest})"
    );
    read(&text)
}
