//! Bodies that nothing connects with the others: no contact, no tie, no common node.

use super::motion::{GroupMotion, pairs_of, words};
use super::shape::{DeckShape, Vector};
use super::supports::groups;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use stickslip_core::RunFinding;
use stickslip_exchange::mesh::CellKind;

/// Nodes closer than this are at the same place, relative to the extent of the mesh.
const SAME: f64 = 1e-6;
/// Number of nodes at the same place from which two bodies look like one.
const SHARED: usize = 3;
/// Number of outer faces that each hexahedron of a single row has at least.
const ROW: usize = 4;

/// A body that no support, tie or contact holds.
pub fn unconnected(shape: &DeckShape) -> Vec<RunFinding> {
    if shape.deck.is_incomplete {
        return Vec::new();
    }
    let far = shape
        .ties
        .iter()
        .filter(|tie| !tie.nodes.iter().any(|n| tie.is_closed(n)));
    let far: BTreeSet<usize> = far.flat_map(|tie| tie.groups).collect();
    let alone = groups(shape).into_iter().filter(|group| {
        let free = GroupMotion::new(shape, *group, 0).free(shape.modes(*group));
        !free.is_empty() && pairs_of(shape, *group).next().is_none() && !far.contains(group)
    });
    alone
        .map(|group| {
            let name = shape.group_name(group);
            let free = GroupMotion::new(shape, group, 0).free(shape.modes(group));
            let nodes = (0..shape.deck.nodes.len()).filter(|n| shape.group(*n) == Some(group));
            let first = nodes.map(|node| shape.deck.nodes[node].label).min();
            RunFinding {
                rule: "unconnected body",
                cause: format!(
                    "{name} is in no contact pair and no tie, and its supports leave it free {}",
                    words(&free)
                ),
                cure: format!("support {name}, or put it into a *CONTACT PAIR or *TIE"),
                lines: format!("*BOUNDARY\n{}, 1, 3", first.unwrap_or_default()),
            }
        })
        .collect()
}

/// Bodies with nodes at the same places that no contact or tie connects: meshes that were not merged.
pub fn unmerged(shape: &DeckShape) -> Vec<RunFinding> {
    // A surface may have faces of several bodies: then its slave nodes tell.
    let connected = |groups: [usize; 2], nodes: &[[usize; 2]]| {
        let nodes: BTreeSet<usize> = nodes.iter().flatten().copied().collect();
        let mut pairs = shape.pairs.iter().chain(&shape.ties);
        pairs.any(|own| {
            let of_groups = own.groups == groups || own.groups == [groups[1], groups[0]];
            of_groups || own.nodes.iter().any(|slave| nodes.contains(&slave.node))
        })
    };
    let places = coincident(shape).into_iter();
    let places = places.filter(|_| !shape.deck.is_incomplete);
    let places =
        places.filter(|(groups, nodes)| nodes.len() >= SHARED && !connected(*groups, nodes));
    let finding = |(pair, nodes): ([usize; 2], Vec<[usize; 2]>)| {
        let [one, other] = pair.map(|group| shape.group_name(group));
        let [first, second] = nodes[0].map(|node| shape.deck.nodes[node].label);
        let surface = |which: usize| {
            let own: BTreeSet<usize> = nodes.iter().map(|pair| pair[which]).collect();
            let faces = faces_of(shape, &own);
            format!("*SURFACE, NAME=JOIN{}\n{}", which + 1, faces.join("\n"))
        };
        RunFinding {
            rule: "unmerged nodes",
            cause: format!(
                "{one} and {other} have nodes at {} common places, such as {first} and {second}, but no common node, no tie and \
                 no contact: they move independently",
                nodes.len()
            ),
            cure: "merge these nodes in the mesh, or tie the surfaces (before *STEP)".into(),
            lines: format!(
                "{}\n{}\n*TIE, NAME=JOIN\nJOIN2, JOIN1",
                surface(0),
                surface(1)
            ),
        }
    };
    places.map(finding).collect()
}

/// Bodies in contact that are a single row of hexahedra with reduced integration, in a run that failed.
pub fn reduced_row(shape: &DeckShape) -> Vec<RunFinding> {
    let deck = shape.deck;
    let bodies = (0..shape.bodies.len()).filter(|_| shape.failed.is_some());
    let finding = |body: usize| {
        let in_contact = pairs_of(shape, shape.group_of[body]).next().is_some();
        let own = 0..deck.elements.len();
        let own = own.filter(|k| shape.body_of[deck.elements[*k].nodes[0]] == Some(body));
        let own: Vec<usize> = own.collect();
        let outer = |element: usize| {
            let sides = 0..deck.elements[element].kind.cell.sides().len();
            let faces = sides.filter_map(|side| shape.face(element, side));
            faces.filter(|face| !shape.is_inner(face)).count()
        };
        let (reduced, full) = match deck.elements[*own.first()?].kind.cell {
            CellKind::Hexa8 => ("C3D8R", "C3D8"),
            CellKind::Hexa20 => ("C3D20R", "C3D20"),
            _ => return None,
        };
        let is_row = |k: &usize| deck.elements[*k].kind.reduced && outer(*k) >= ROW;
        (in_contact && own.iter().all(is_row)).then(|| RunFinding {
            rule: "reduced integration",
            cause: format!(
                "{} is a single row of {reduced} elements, which have motions without stiffness (hourglass modes) that contact \
                 forces excite",
                shape.bodies[body]
            ),
            cure: format!(
                "full integration (*ELEMENT before line {}), or more elements over the cross-section",
                deck.elements[own[0]].place.line
            ),
            lines: format!("*ELEMENT, TYPE={full}, ELSET={}", shape.bodies[body]),
        })
    };
    bodies.filter_map(finding).collect()
}

/// Pairs of groups with their nodes at the same places.
fn coincident(shape: &DeckShape) -> BTreeMap<[usize; 2], Vec<[usize; 2]>> {
    let nodes = || (0..shape.deck.nodes.len()).filter_map(|node| Some((node, shape.group(node)?)));
    // Not relative to the coordinates: the origin may be far away.
    let extents = [Vector::x(), Vector::y(), Vector::z()].map(|axis| shape.height(None, axis));
    let cell = SAME * extents.into_iter().fold(f64::MIN_POSITIVE, f64::max);
    let mut known: HashMap<[i64; 3], Vec<(usize, usize)>> = HashMap::new();
    let mut pairs: BTreeMap<[usize; 2], Vec<[usize; 2]>> = BTreeMap::new();
    for (node, group) in nodes() {
        let place = shape.at(node).map(|x| (x / cell).round() as i64).into();
        let here = known.entry(place).or_default();
        for &(earlier, other) in here.iter().filter(|(_, other)| *other != group) {
            let (groups, nodes) = match other < group {
                true => ([other, group], [earlier, node]),
                false => ([group, other], [node, earlier]),
            };
            pairs.entry(groups).or_default().push(nodes);
        }
        here.push((node, group));
    }
    pairs
}

/// The outer faces with all their nodes in a set, as lines of *SURFACE.
fn faces_of(shape: &DeckShape, nodes: &BTreeSet<usize>) -> Vec<String> {
    let deck = shape.deck;
    let sides = (0..deck.elements.len()).flat_map(|element| {
        let sides = 0..deck.elements[element].kind.cell.sides().len();
        sides.map(move |side| (element, side))
    });
    let within = sides.filter(|&(element, side)| {
        let (corners, middles) = deck.face(element, side);
        corners
            .iter()
            .chain(&middles)
            .all(|node| nodes.contains(node))
    });
    within
        .map(|(element, side)| format!("{}, S{}", deck.elements[element].label, side + 1))
        .collect()
}
