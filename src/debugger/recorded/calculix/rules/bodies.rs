//! Bodies that nothing connects with the others: no contact, no tie, no common node.

use super::motion::{GroupMotion, words};
use super::shape::DeckShape;
use super::sorted_points::extent;
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
    let far: BTreeSet<usize> = shape
        .ties
        .iter()
        .filter(|tie| tie.closed().next().is_none())
        .flat_map(|tie| tie.groups)
        .collect();
    let alone = shape
        .groups()
        .into_iter()
        .filter(|g| shape.pairs_of(*g).next().is_none() && !far.contains(g));
    let finding = |group: usize| {
        let name = shape.group_name(group);
        let free = GroupMotion::new(shape, group, 0).free(shape);
        let labels = shape
            .group_nodes(group)
            .map(|node| shape.deck.nodes[node].label);
        (!free.is_empty()).then(|| RunFinding {
            rule: "unconnected body",
            cause: format!(
                "{name} is in no contact pair and no tie, and its supports leave it free {}",
                words(&free)
            ),
            cure: format!("support {name}, or put it into a *CONTACT PAIR or *TIE"),
            lines: format!("*BOUNDARY\n{}, 1, 3", labels.min().unwrap_or_default()),
        })
    };
    alone.filter_map(finding).collect()
}

/// Bodies with nodes at the same places that no contact or tie connects: meshes that were not merged.
pub fn unmerged(shape: &DeckShape) -> Vec<RunFinding> {
    // If a surface has faces of several bodies, its slave nodes decide.
    let connected = |groups: [usize; 2], nodes: &[[usize; 2]]| {
        let nodes: BTreeSet<usize> = nodes.iter().flatten().copied().collect();
        shape.pairs.iter().chain(&shape.ties).any(|own| {
            let of_groups = own.groups == groups || own.groups == [groups[1], groups[0]];
            of_groups || own.nodes.iter().any(|slave| nodes.contains(&slave.node))
        })
    };
    let places = coincident(shape).into_iter();
    let apart = places.filter(|(groups, nodes)| {
        nodes.len() >= SHARED && !connected(*groups, nodes) && !shape.deck.is_incomplete
    });
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
            lines: [
                surface(0),
                surface(1),
                "*TIE, NAME=JOIN\nJOIN2, JOIN1".into(),
            ]
            .join("\n"),
        }
    };
    apart.map(finding).collect()
}

/// Bodies in contact that are a single row of hexahedra with reduced integration, in a run that failed.
pub fn reduced_row(shape: &DeckShape) -> Vec<RunFinding> {
    let deck = shape.deck;
    let bodies = (0..shape.bodies.len()).filter(|_| shape.failed.is_some());
    let finding = |body: usize| {
        let mut pairs = shape.pairs_of(shape.group_of[body]);
        let first = &deck.elements[shape.elements(body).next()?];
        let (reduced, full) = match first.kind.cell {
            CellKind::Hexa8 => ("C3D8R", "C3D8"),
            CellKind::Hexa20 => ("C3D20R", "C3D20"),
            _ => return None,
        };
        let outer = |element: usize| shape.outer_faces(element).count();
        (pairs.next().is_some() && shape.elements(body).all(|k| deck.elements[k].kind.reduced && outer(k) >= ROW)).then(|| RunFinding {
            rule: "reduced integration",
            cause: format!(
                "{} is a single row of {reduced} elements, which have motions without stiffness (hourglass modes) that contact \
                 forces excite",
                shape.bodies[body]
            ),
            cure: format!(
                "full integration (*ELEMENT before line {}), or more elements over the cross-section",
                first.place.line
            ),
            lines: format!("*ELEMENT, TYPE={full}, ELSET={}", shape.bodies[body]),
        })
    };
    bodies.filter_map(finding).collect()
}

/// Pairs of groups with their nodes at the same places.
fn coincident(shape: &DeckShape) -> BTreeMap<[usize; 2], Vec<[usize; 2]>> {
    let nodes = (0..shape.deck.nodes.len()).filter_map(|node| Some((node, shape.group(node)?)));
    // Not relative to the coordinates: the origin may be far away.
    let along = |axis: usize| extent(nodes.clone().map(|(node, _)| shape.at(node)[axis]));
    let cell = SAME * (0..3).map(along).fold(f64::MIN_POSITIVE, f64::max);
    let mut known: HashMap<[i64; 3], Vec<(usize, usize)>> = HashMap::new();
    let mut pairs: BTreeMap<[usize; 2], Vec<[usize; 2]>> = BTreeMap::new();
    for (node, group) in nodes {
        let place = shape.at(node).map(|x| (x / cell).round() as i64).into();
        let here = known.entry(place).or_default();
        for &(earlier, other) in here.iter().filter(|(_, other)| *other != group) {
            let mut both = [(other, earlier), (group, node)];
            both.sort_unstable();
            let nodes = pairs.entry(both.map(|(group, _)| group)).or_default();
            nodes.push(both.map(|(_, node)| node));
        }
        here.push((node, group));
    }
    pairs
}

/// The outer faces with all their nodes in a set, as lines of *SURFACE.
fn faces_of(shape: &DeckShape, nodes: &BTreeSet<usize>) -> Vec<String> {
    let deck = shape.deck;
    let within = deck
        .elements
        .iter()
        .enumerate()
        .flat_map(|(k, element)| (0..element.kind.cell.sides().len()).map(move |side| (k, side)))
        .filter(|&(element, side)| {
            let (corners, middles) = deck.face(element, side);
            corners
                .iter()
                .chain(&middles)
                .all(|node| nodes.contains(node))
        });
    within
        .map(|(element, side)| shape.surface_line(element, side))
        .collect()
}
