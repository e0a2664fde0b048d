//! What screens need of a model in each frame, and take from all of its nodes and elements: found once per session.

use super::conditions::{Support, supports};
use super::round_off::reach;
use super::unforced::FreeBodies;
use std::collections::HashMap;
use stickslip_core::Model;
use stickslip_core::model::{Body, SolidElement};
use stickslip_core::plane::minus;

/// Facts about a model.
#[derive(Debug, Clone, Default)]
pub struct ModelFacts {
    /// The largest length ([`reach`]).
    pub reach: f64,
    /// The supported nodes.
    pub supports: Vec<Support>,
    /// The largest undeformed diagonal of an element of a solid (length); 0 without solids.
    pub largest_element: f64,
    /// The faces between different materials of a solid.
    pub seams: Vec<Vec<usize>>,
    /// The bodies that only contacts hold.
    pub free: FreeBodies,
}

impl ModelFacts {
    /// The facts about a model.
    pub fn new(model: &Model) -> ModelFacts {
        let mut facts = ModelFacts {
            reach: reach(model),
            supports: supports(model),
            free: FreeBodies::new(model),
            ..ModelFacts::default()
        };
        for body in &model.bodies {
            let sizes = solid_elements(body).iter().map(|element| {
                let [from, to] = diagonal(element).map(|node| model.nodes[node].at);
                let [x, y] = minus(to, from);
                x.hypot(y)
            });
            facts.largest_element = sizes.fold(facts.largest_element, f64::max);
            facts.seams.extend(seams(solid_elements(body)));
        }
        facts
    }
}

/// The elements of a body if it is a solid.
pub fn solid_elements(body: &Body) -> &[SolidElement] {
    body.solid().map_or(&[], |solid| &solid.elements)
}

/// Two opposite corners of an element, or a corner of a triangle and the next but one.
pub fn diagonal(element: &SolidElement) -> [usize; 2] {
    let across = element.kind.faces().len() / 2;
    [element.nodes[0], element.nodes[across]]
}

/// The faces between elements of different materials.
fn seams(elements: &[SolidElement]) -> Vec<Vec<usize>> {
    let mut across = HashMap::new();
    let mut seams = Vec::new();
    for element in elements {
        for face in element.kind.faces_of(&element.nodes) {
            // Neighbours walk the face that they share in opposite directions.
            let mut ends = [face.first().copied(), face.last().copied()];
            ends.sort_unstable();
            match across.insert(ends, element.material) {
                Some(other) if other != element.material => seams.push(face),
                _ => {}
            }
        }
    }
    seams
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip_core::elements::kinds::ElementKind;

    #[test]
    fn seams_lie_between_materials_only() {
        // 1--3--5--7  three quadrilaterals, the last of another material
        // 0--2--4--6
        let element = |nodes: [usize; 4], material| SolidElement {
            kind: ElementKind::Quad4,
            nodes: nodes.to_vec(),
            material,
        };
        let elements = [
            element([0, 2, 3, 1], 0),
            element([2, 4, 5, 3], 0),
            element([4, 6, 7, 5], 1),
        ];
        assert_eq!(seams(&elements), [[5, 4]]);
    }
}
