//! Sides of a given mesh: sorts them into walking order with the body on the left, piece by piece.

use super::elements::{Element, named};
use crate::format::error::{Fault, Path, bail};
use crate::shown::first_of;
use std::collections::{HashMap, HashSet};
use stickslip_core::fem::lagrange::MAX_NODES;
use stickslip_core::groups::marked;
use stickslip_core::{Node, counted};

/// Sides in walking order.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct SideLine {
    /// Connected pieces, each as its sides from start to end.
    pub pieces: Vec<Vec<Vec<usize>>>,
    /// Whether a side lies between two elements, so that there is no outward side.
    pub inside: bool,
}

impl SideLine {
    /// The nodes in walking order, each once.
    pub fn nodes(&self) -> Vec<usize> {
        let mut seen = HashSet::new();
        self.pieces
            .iter()
            .flatten()
            .flatten()
            .copied()
            .filter(|n| seen.insert(*n))
            .collect()
    }

    /// Number of nodes per side, if this is one open piece with equal sides, that is, a chain.
    pub fn per_element(&self) -> Option<usize> {
        let [piece] = &self.pieces[..] else {
            return None;
        };
        let (first, last) = (piece.first()?, piece.last()?);
        let even = piece.iter().all(|side| side.len() == first.len());
        (even && first.first() != last.last()).then_some(first.len())
    }

    /// Description of the pieces, for a message.
    pub fn words(&self, nodes: &[Node]) -> String {
        const MOST: usize = 4;
        let piece = |piece: &Vec<Vec<usize>>| {
            let name = |n: Option<&usize>| n.map_or("", |&n| nodes[n].name.as_str());
            let (first, last) = (piece.first(), piece.last());
            let (start, end) = (first.and_then(|s| s.first()), last.and_then(|s| s.last()));
            if start == end {
                format!("a closed one at {}", name(start))
            } else {
                format!("{} to {}", name(start), name(end))
            }
        };
        let shown = first_of(self.pieces.iter().map(piece), MOST, ", ");
        let count = counted(self.pieces.len(), "piece");
        format!("{count} ({shown})")
    }

    /// Mutable access to all node numbers.
    pub fn numbers_mut(&mut self) -> impl Iterator<Item = &mut usize> {
        self.pieces.iter_mut().flatten().flatten()
    }
}

/// The faces of elements at these sides, by start and end node.
pub(super) struct Faces {
    /// The nodes between the ends, from start to end.
    middles: HashMap<(usize, usize), Vec<usize>>,
    /// Nodes of sides that belong to elements.
    on_elements: HashSet<usize>,
}

impl Faces {
    pub fn among<'a>(named: impl Iterator<Item = &'a usize>, elements: &[Element]) -> Faces {
        let named: HashSet<usize> = named.copied().collect();
        let last = named.iter().max().map_or(0, |n| n + 1);
        let is_named = marked(last, &named);
        let has = |n: usize| is_named.get(n) == Some(&true);
        let mut faces = Faces {
            middles: HashMap::new(),
            on_elements: HashSet::new(),
        };
        for (kind, nodes) in elements {
            for face in kind.faces() {
                let &[start, ref middle @ .., end] = *face else {
                    continue;
                };
                let (start, end) = (nodes[start], nodes[end]);
                match (has(start), has(end)) {
                    (true, true) => {
                        let middle = middle.iter().map(|&n| nodes[n]).collect();
                        faces.middles.insert((start, end), middle);
                        faces.on_elements.extend([start, end]);
                    }
                    (true, false) => drop(faces.on_elements.insert(start)),
                    _ => {}
                }
            }
        }
        faces
    }
}

/// Sorts sides into walking order, with the element on the left. Sides without an element follow the direction of the first one
/// of a piece.
pub(super) fn line(
    here: &Path,
    nodes: &[Node],
    faces: &Faces,
    sides: &[Vec<usize>],
) -> Result<SideLine, Fault> {
    if sides.is_empty() {
        bail!(here, "there are no sides");
    }
    let mut inside = false;
    let mut free = Vec::new();
    let mut made: Vec<Vec<usize>> = Vec::with_capacity(sides.len());
    for (k, side) in sides.iter().enumerate() {
        let fault = |message: String| Fault::new(here.then(k), message);
        let (start, end) = match side[..] {
            [start, .., end] if side.len() <= MAX_NODES => (start, end),
            _ => {
                return Err(fault(format!(
                    "the side has {}; it must have 2 to {MAX_NODES}",
                    counted(side.len(), "node")
                )));
            }
        };
        if (1..side.len()).any(|j| side[..j].contains(&side[j])) {
            return Err(fault("a node occurs twice in the side".to_owned()));
        }
        let found = |from, to| faces.middles.get(&(from, to));
        let mut walked = side.clone();
        let middle = match (found(start, end), found(end, start)) {
            (None, None) if [start, end].iter().all(|n| faces.on_elements.contains(n)) => {
                let message = format!(
                    "the side {} does not belong to an element",
                    named(nodes, &[start, end])
                );
                return Err(fault(message));
            }
            (None, None) => {
                free.push(k);
                made.push(walked);
                continue;
            }
            (Some(middle), other) => {
                inside |= other.is_some();
                middle
            }
            (None, Some(middle)) => {
                walked.reverse();
                middle
            }
        };
        let own = &walked[1..walked.len() - 1];
        if middle != own {
            let listed = |some: &[usize], none: &str| match some {
                [] => none.to_owned(),
                some => named(nodes, some),
            };
            return Err(fault(format!(
                "the side {} has {} in the middle, but the element has {}",
                named(nodes, &[start, end]),
                listed(own, "no node"),
                listed(middle, "none"),
            )));
        }
        made.push(walked);
    }
    align(&mut made, &free);
    let mut walked = HashSet::new();
    if let Some(k) = made.iter().position(|side| !walked.insert(ends(side))) {
        bail!(
            here.then(k),
            "the side {} is listed twice",
            named(nodes, &made[k])
        );
    }
    Ok(SideLine {
        pieces: pieces(&made),
        inside,
    })
}

fn ends(side: &[usize]) -> (usize, usize) {
    (side[0], side[side.len() - 1])
}

/// Reverses sides without an element so that connected ones run in the direction of the first one.
fn align(sides: &mut [Vec<usize>], free: &[usize]) {
    let mut at: HashMap<usize, Vec<usize>> = HashMap::new();
    for &k in free {
        let (start, end) = ends(&sides[k]);
        at.entry(start).or_default().push(k);
        at.entry(end).or_default().push(k);
    }
    let mut done = HashSet::new();
    for &k in free {
        let mut open = vec![k];
        done.insert(k);
        while let Some(k) = open.pop() {
            let (start, end) = ends(&sides[k]);
            for (node, is_end) in [(start, false), (end, true)] {
                // Walks stop where more than two sides meet.
                let [a, b] = at[&node][..] else { continue };
                let other = if a == k { b } else { a };
                if !done.insert(other) {
                    continue;
                }
                let starts_there = ends(&sides[other]).0 == node;
                if starts_there != is_end {
                    sides[other].reverse();
                }
                open.push(other);
            }
        }
    }
}

/// Sorts sides into pieces: a piece starts where no single side precedes, and a closed one at the first remaining side.
fn pieces(sides: &[Vec<usize>]) -> Vec<Vec<Vec<usize>>> {
    let mut starting: HashMap<usize, Vec<usize>> = HashMap::new();
    let mut ending: HashMap<usize, Vec<usize>> = HashMap::new();
    for (k, side) in sides.iter().enumerate() {
        let (start, end) = ends(side);
        starting.entry(start).or_default().push(k);
        ending.entry(end).or_default().push(k);
    }
    let one =
        |map: &HashMap<usize, Vec<usize>>, node: usize| match map.get(&node).map(Vec::as_slice) {
            Some(&[k]) => Some(k),
            _ => None,
        };
    // A walk continues only where exactly one side ends and one starts.
    let goes_on = |node: usize| one(&ending, node).and_then(|_| one(&starting, node));
    let mut taken = vec![false; sides.len()];
    let mut pieces = Vec::new();
    for first in (0..sides.len())
        .filter(|k| goes_on(ends(&sides[*k]).0).is_none())
        .chain(0..sides.len())
    {
        let mut piece = Vec::new();
        let mut next = Some(first);
        while let Some(k) = next.filter(|&k| !taken[k]) {
            taken[k] = true;
            piece.push(sides[k].clone());
            next = goes_on(ends(&sides[k]).1);
        }
        if !piece.is_empty() {
            pieces.push(piece);
        }
    }
    pieces
}
