//! Elements of a given mesh: puts them in anticlockwise order, and rejects folded, duplicate and mismatching ones.

use super::super::geometry::Folds;
use crate::format::error::{Fault, Path, bail, fault};
use crate::joined;
use stickslip_core::plane::minus;
use stickslip_core::{ElementKind, Node, counted};

/// An element: its kind and its node numbers, anticlockwise.
pub(crate) type Element = (ElementKind, Vec<usize>);

/// Number of corners, which come first.
fn corners(kind: ElementKind) -> usize {
    kind.faces().len()
}

/// The element of these nodes, reversed if it is clockwise: meshers number the elements of a surface that way if it faces away
/// from the viewer. `path` is its location, and `folds` the check for folded elements of its kind.
///
/// # Errors
/// If it has the wrong number of nodes, a repeated node, or is folded.
pub(super) fn sound(
    path: impl Fn() -> Path,
    nodes: &[Node],
    folds: &Folds,
    kind: ElementKind,
    mut own: Vec<usize>,
) -> Result<Element, Fault> {
    if own.len() != kind.nodes() {
        bail!(
            path(),
            "the element has {}; a {} has {}",
            counted(own.len(), "node"),
            kind.word(),
            kind.nodes()
        );
    }
    if let Some(k) = (1..own.len()).find(|&k| own[..k].contains(&own[k])) {
        bail!(
            path().then(k),
            "node {} occurs twice in the element",
            nodes[own[k]].name
        );
    }
    let count = corners(kind);
    if area(nodes, &own[..count]) < 0.0 {
        // Reversed from its first corner, so that the midside node of its last side comes first.
        own[1..count].reverse();
        own[count..count * (kind.per_face() - 1)].reverse();
    }
    if folds.is_folded(own.iter().map(|&n| nodes[n].at)) {
        let [x, y] = nodes[own[0]].at;
        bail!(
            path(),
            "the element with the corners {} at ({x:?}, {y:?}) is folded or flat: its Jacobian is not positive everywhere",
            named(nodes, &own[..count])
        );
    }
    Ok((kind, own))
}

/// Names of some nodes, joined.
pub(super) fn named(nodes: &[Node], some: &[usize]) -> String {
    joined(some.iter().map(|&n| &nodes[n].name), ", ")
}

/// Twice the area of a polygon; positive if anticlockwise.
fn area(nodes: &[Node], around: &[usize]) -> f64 {
    let origin = around.first().map_or([0.0; 2], |&n| nodes[n].at);
    let from = |n: usize| minus(nodes[n].at, origin);
    around
        .iter()
        .zip(around.iter().cycle().skip(1))
        .map(|(&a, &b)| {
            let ([x, y], [v, w]) = (from(a), from(b));
            x * w - v * y
        })
        .sum()
}

/// Rejects two elements with the same corners.
pub(super) fn check_doubled(
    here: &Path,
    nodes: &[Node],
    elements: &[Element],
) -> Result<(), Fault> {
    let mut keys: Vec<[usize; 4]> = elements
        .iter()
        .map(|(kind, nodes)| {
            let mut key = [usize::MAX; 4];
            key[..corners(*kind)].copy_from_slice(&nodes[..corners(*kind)]);
            key.sort_unstable();
            key
        })
        .collect();
    keys.sort_unstable();
    let Some(pair) = keys.windows(2).find(|pair| pair[0] == pair[1]) else {
        return Ok(());
    };
    let shared = pair[0].iter().copied().filter(|&n| n != usize::MAX);
    Err(fault!(
        here,
        "two elements have the same corners, {}",
        named(nodes, &shared.collect::<Vec<_>>())
    ))
}

/// Rejects a side shared by an element with a midside node and one without: they would gape or overlap between the ends. `path`
/// locates an element.
pub(super) fn check_orders(
    path: impl Fn(usize) -> Path,
    nodes: &[Node],
    elements: &[Element],
) -> Result<(), Fault> {
    let per_face = |(kind, _): &Element| kind.per_face();
    let first = elements.first().map(per_face);
    if elements
        .iter()
        .all(|element| first == Some(per_face(element)))
    {
        return Ok(());
    }
    let mut sides: Vec<([usize; 2], usize, usize)> = Vec::new();
    for (k, (kind, own)) in elements.iter().enumerate() {
        for face in kind.faces() {
            let (a, b) = (own[face[0]], own[face[face.len() - 1]]);
            sides.push(([a.min(b), a.max(b)], face.len(), k));
        }
    }
    sides.sort_unstable();
    let mixed =
        |pair: &&[([usize; 2], usize, usize)]| pair[0].0 == pair[1].0 && pair[0].1 != pair[1].1;
    let Some(pair) = sides.windows(2).find(mixed) else {
        return Ok(());
    };
    let (linear, quadratic) = (pair[0].2, pair[1].2);
    Err(fault!(
        path(linear.max(quadratic)),
        "the side between {} is shared by a {} and a {}, but only one of them has a midside node there; mesh both with elements of the same order",
        named(nodes, &pair[0].0),
        elements[quadratic].0.word(),
        elements[linear].0.word()
    ))
}
