//! Ends of surfaces that coincide. A rigid chain whose ends coincide is closed. Where two rigid surfaces that a node may touch end in
//! one point, in a concave corner, each continues past it into the body of the other, so that they cross
//! ([`stickslip_core::contact::crossing`]). A node that starts where two surfaces meet that can move apart presses on both ends and has
//! a contact with each. Ends at which slave nodes start, or that are on a line of symmetry, continue a little.

use super::super::corners::{CORNER, turn};
use super::super::nodes::Names;
use super::layout::Layout;
use stickslip_core::contact::crossing::{end_slope, ends_in_corner};
use stickslip_core::plane::{self, distance, dot, minus};
use stickslip_core::{Component, Contact, Node, Surface};

/// Distance of ends that coincide, relative to the scene's length.
const SAME: f64 = 1e-9;
/// How far a surface continues past a corner, in units of ξ of its end element.
const PAST: f64 = 1.0;
/// The same at an end with which a slave surface ends: a tenth of the element, as Abaqus extends master surfaces by default.
const FLUSH: f64 = 0.2;
/// The same past a line of symmetry. The normal at the end of a curved element is not exactly
/// along the line, so that the closest point of a node on the line may lie past the end.
const MIRRORED: f64 = 0.5;

/// The nodes where a chain begins and where it ends.
pub(super) fn end_nodes(elements: &[Vec<usize>]) -> [Option<usize>; 2] {
    let first = elements.first().and_then(|nodes| nodes.first());
    let last = elements.last().and_then(|nodes| nodes.last());
    [first.copied(), last.copied()]
}

/// Whether two nodes are at the same place.
pub(super) fn coincide(nodes: &[Node], [a, b]: [usize; 2], length: f64) -> bool {
    distance(nodes[a].at, nodes[b].at) <= SAME * length
}

/// Ends a chain of nodes without bodies at the node where it begins, if its last node is at the same place and stays there.
pub(super) fn close(
    elements: &mut [Vec<usize>],
    nodes: &[Node],
    on_body: &[bool],
    stays: impl Fn([usize; 2]) -> bool,
    length: f64,
) {
    let is_rigid = elements.iter().flatten().all(|&node| !on_body[node]);
    let [Some(first), Some(last)] = end_nodes(elements) else {
        return;
    };
    let same = coincide(nodes, [first, last], length) && stays([first, last]);
    if let [_, .., end] = elements
        && let Some(end) = end.last_mut()
        && is_rigid
        && same
    {
        *end = first;
    }
}

/// Extends rigid surfaces that end in a concave corner, so that they cross there; `listed` is the entry of the scene's list of each.
/// Surfaces with prescribed nodes, which may move apart, are left as they are.
pub(super) fn cross(
    surfaces: &mut [Surface],
    listed: &[usize],
    slaves: &[Contact],
    nodes: &[Node],
    is_prescribed: impl Fn(usize) -> bool,
    length: f64,
) {
    let at: Vec<[f64; 2]> = nodes.iter().map(|node| node.at).collect();
    let mut pairs: Vec<[usize; 2]> = slaves
        .iter()
        .filter(|slave| slave.bond.is_hard())
        .flat_map(|slave| {
            let all = slave.surfaces.iter().enumerate();
            all.flat_map(|(k, &one)| {
                slave.surfaces[k + 1..]
                    .iter()
                    .map(move |&other| [one, other])
            })
        })
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    for pair in pairs {
        let both = pair.map(|k| &surfaces[k]);
        let stays = both
            .iter()
            .all(|s| s.rigid && !s.endless && !s.nodes().any(|&node| is_prescribed(node)));
        if !stays || listed[pair[0]] == listed[pair[1]] {
            continue;
        }
        let own = both.map(|surface| end_nodes(&surface.elements));
        for ends in [[0, 0], [0, 1], [1, 0], [1, 1]] {
            let both = pair.map(|k| &surfaces[k]);
            let meet = [0, 1].map(|k| own[k][ends[k]]);
            if let [Some(a), Some(b)] = meet
                && coincide(nodes, [a, b], length)
                && ends_in_corner(both, ends, &at)
            {
                for (k, end) in pair.into_iter().zip(ends) {
                    let past = &mut surfaces[k].past_ends[end];
                    *past = past.max(PAST);
                }
            }
        }
    }
}

/// Continues surfaces past the ends for which the scene leaves this to the program: where a slave surface ends with it, and farther
/// where a slave node and the end are guided along the same line of symmetry, which the surface meets at a right angle up to half of
/// [`CORNER`].
pub(super) fn extend(
    surfaces: &mut [Surface],
    automatic: &[[bool; 2]],
    slaves: &[Contact],
    nodes: &[Node],
    layout: &Layout,
    guided: impl Fn(usize, Component) -> bool,
    length: f64,
) {
    let at: Vec<[f64; 2]> = nodes.iter().map(|node| node.at).collect();
    let axes = [(0, Component::X), (1, Component::Y)];
    for (on, (surface, automatic)) in (surfaces.iter_mut().zip(automatic)).enumerate() {
        for (k, end) in end_nodes(&surface.elements).into_iter().enumerate() {
            let Some(end) = end.filter(|_| automatic[k]) else {
                continue;
            };
            let slope = end_slope(surface, k, &at);
            let size = plane::length(slope);
            let outward = if k == 0 { -1.0 / size } else { 1.0 / size };
            let [mut inside, mut flush, mut beyond, mut mirrored] = [false; 4];
            let own = slaves.iter().filter(|slave| slave.surfaces.contains(&on));
            for (node, _) in own.flat_map(Contact::carriers) {
                let to = minus(at[node], at[end]);
                let past = outward * dot(to, slope);
                let moves = axes.iter().any(|(_, axis)| !layout.is_held(node, *axis));
                inside |= past < -SAME * size;
                flush |= moves && past.abs() <= SAME * size;
                beyond |= past > SAME * size;
                mirrored |= axes.into_iter().any(|(k, axis)| {
                    to[k].abs() <= SAME * length
                        && slope[k].abs() >= (0.5 * CORNER).cos() * size
                        && guided(node, axis)
                        && guided(end, axis)
                });
            }
            surface.past_ends[k] = match (mirrored, inside && flush && !beyond) {
                (true, _) => MIRRORED,
                (_, true) => FLUSH,
                _ => 0.0,
            };
        }
    }
}

/// Divides each contact that starts at the common end of surfaces into one contact with each of them. The ends must be able to move
/// apart, so that the equations are independent, and must not form a convex corner, where the node would press on one side only. The
/// further contacts are points carried by the node, behind its own, with its pair.
pub(super) fn divide(
    names: &mut Names,
    surfaces: &[Surface],
    slaves: &mut Vec<Contact>,
    pairs: &mut Vec<usize>,
    layout: &Layout,
    length: f64,
) {
    if slaves.iter().all(|slave| slave.surfaces.len() < 2) {
        return;
    }
    let places: Vec<Node> = names.nodes.clone();
    let end_at = |node: usize, surface: usize| {
        let ends = end_nodes(&surfaces[surface].elements);
        let at =
            |end: &Option<usize>| end.is_some_and(|end| coincide(&places, [end, node], length));
        Some((ends.iter().position(at)?, surface))
    };
    let all: Vec<(Contact, usize)> = slaves.drain(..).zip(pairs.drain(..)).collect();
    for (mut slave, pair) in all {
        let may = !slave.bond.is_tied() && slave.weights.is_empty() && slave.surfaces.len() > 1;
        let met = slave.surfaces.iter().filter(|_| may);
        let met: Vec<_> = met.filter_map(|&on| end_at(slave.node, on)).collect();
        let joined = match met[..] {
            [(1, one), (0, other)] | [(0, other), (1, one)] => {
                let both = [&surfaces[one].elements, &surfaces[other].elements];
                parts(both, &places, layout).then(|| met[1].1)
            }
            _ => None,
        };
        let Some(other) = joined else {
            slaves.push(slave);
            pairs.push(pair);
            continue;
        };
        let own = &places[slave.node];
        let point = Contact {
            node: names.nodes.len(),
            weights: vec![(slave.node, 1.0)],
            surfaces: vec![other],
            ..slave.clone()
        };
        names.nodes.push(Node {
            name: format!("{}~{}", own.name, surfaces[other].name),
            at: own.at,
        });
        slave.surfaces.retain(|&on| on != other);
        slaves.extend([slave, point]);
        pairs.extend([pair, pair]);
    }
}

/// Whether the end of one chain and the start of the next one, at the same place, can move apart along both axes, and do not form a
/// convex corner.
fn parts([one, next]: [&Vec<Vec<usize>>; 2], nodes: &[Node], layout: &Layout) -> bool {
    let ([.., before], [behind, ..]) = (&one[..], &next[..]) else {
        return false;
    };
    let (Some(&end), Some(&start)) = (before.last(), behind.first()) else {
        return false;
    };
    let is_held = |axis| layout.is_held(end, axis) && layout.is_held(start, axis);
    end != start
        && ![Component::X, Component::Y].into_iter().any(is_held)
        && turn(before, behind, |node| nodes[node].at) <= CORNER
}
