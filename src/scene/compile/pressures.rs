//! Faces of solids under pressure, and the equivalent dead load for small displacements.

use super::super::nodes::Names;
use super::tractions;
use crate::areas::sides;
use crate::format::error::{AtPath, Fault, Path, bail};
use std::collections::{BTreeMap, HashMap, HashSet};
use stickslip_core::model::{Body, Elastic, Plane, PressedFace, Update};
use stickslip_core::plane::plus;

/// Faces under pressure of bodies with large displacements, and of those with small ones.
#[derive(Default)]
pub(super) struct Pressed {
    pub following: Vec<PressedFace>,
    pub small: Vec<PressedFace>,
}

/// The faces of solids along a chain.
pub(super) fn faces(
    here: &Path,
    names: &Names,
    bodies: &[Body],
    along: &str,
) -> Result<Pressed, Fault> {
    let chain = names.chain(along).at(here)?;
    let outer = outer_faces(bodies);
    let mut pressed = Pressed::default();
    for element in chain.elements() {
        // The chain may run in either direction; the body determines the side.
        let found =
            ends(&element).and_then(|(a, b)| outer.get(&(a, b)).or_else(|| outer.get(&(b, a))));
        let inner = |face: &[usize]| {
            let own: HashSet<usize> = element.iter().copied().collect();
            face.len() == element.len() && face.iter().all(|node| own.contains(node))
        };
        let Some(&(nodes, elastic)) = found.filter(|(nodes, _)| inner(nodes)) else {
            let name = |node: Option<&usize>| node.map_or("", |&n| names.nodes[n].name.as_str());
            bail!(
                here,
                "the element {} to {} of {along:?} is not an outer face of a solid; pressures act only on these",
                name(element.first()),
                name(element.last())
            );
        };
        let face = PressedFace {
            nodes: nodes.to_vec(),
            thickness: (elastic.plane != Plane::Axisymmetric).then_some(elastic.thickness),
        };
        match elastic.update {
            Update::Small => pressed.small.push(face),
            Update::Total | Update::Updated => pressed.following.push(face),
        }
    }
    Ok(pressed)
}

fn ends(face: &[usize]) -> Option<(usize, usize)> {
    Some((*face.first()?, *face.last()?))
}

/// The outer faces of all solids by their end nodes, with their materials.
fn outer_faces(bodies: &[Body]) -> HashMap<(usize, usize), (&[usize], &Elastic)> {
    let solids = bodies.iter().filter(|body| body.solid().is_some());
    solids
        .flat_map(sides)
        .filter_map(|side| Some((ends(side.nodes)?, (side.nodes, side.made_of?))))
        .collect()
}

/// Nodal forces of a pressure on undeformed faces.
pub(super) fn dead(names: &Names, faces: &[PressedFace], value: f64) -> Vec<(usize, [f64; 2])> {
    let mut sums = BTreeMap::new();
    for face in faces {
        let load = tractions::Load {
            along: "",
            normal: -value * face.thickness.unwrap_or(1.0),
            vector: [0.0; 2],
            round: face.thickness.is_none(),
        };
        for (node, force) in tractions::on_nodes(names, &face.nodes, &load) {
            let sum = sums.entry(node).or_insert([0.0; 2]);
            *sum = plus(*sum, force);
        }
    }
    sums.into_iter().collect()
}
