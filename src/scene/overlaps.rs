//! Solids that overlap: a node of one lies inside the outline of another, which is straight between nodes.
//!
//! Contact acts at slave nodes that face a surface. Where none does, bodies pass through each other although every law of contact
//! holds.

use crate::number::sig4;
use std::cell::LazyCell;
use std::collections::HashSet;
use stickslip_core::contact::state::ContactState;
use stickslip_core::plane::{depth_inside, range};
use stickslip_core::{Body, IncrementStart, Model};

/// Depths below this part of the scene's length are none.
const NONE: f64 = 3e-5;
/// Depths that are reported after a run: those by which an overlap has grown, relative to the diagonal of the smaller body. Between
/// the slave nodes of a coarse mesh a master's nodes are a little inside.
const DEEP: f64 = 0.01;
/// The same for a thin body, relative to its thickness, its area per diagonal: no node is deeper inside than half of that.
const THIN: f64 = 0.25;

/// A node of a solid inside another one.
struct Overlap {
    /// Numbers of the outer body, and of the body of the node.
    bodies: [usize; 2],
    /// The deepest node.
    node: usize,
    /// The first node inside, along the sides of its body.
    first: usize,
    /// Distance of the deepest node from the outline (length).
    depth: f64,
    /// Depth up to which it is not reported after a run (length).
    most: f64,
    /// How far the curved sides of both bodies are from straight ones between nodes (length).
    bend: f64,
}

/// Describes pairs of solids that overlap before the first solve.
pub(crate) fn at_start(model: &Model) -> Vec<String> {
    let near = NONE * model.length;
    let places: Vec<[f64; 2]> = model.nodes.iter().map(|node| node.at).collect();
    let found = overlaps(model, &places, near);
    let mut pairs = HashSet::new();
    found
        .iter()
        .filter(|found| pairs.insert(unordered(found.bodies)))
        .map(|Overlap { bodies, first, .. }| {
            let [outer, inner] = bodies.map(|body| &model.bodies[body].name);
            format!(
                "bodies {outer} and {inner} overlap: {} of the second lies inside the first",
                model.nodes[*first].name
            )
        })
        .collect()
}

/// Describes pairs of solids that overlap in the last accepted state of a run: deeper than at the start, and deeper than the contact
/// laws between them allow.
pub fn at_end(model: &Model, last: &IncrementStart) -> Vec<String> {
    let start: Vec<[f64; 2]> = model.nodes.iter().map(|node| node.at).collect();
    let near = NONE * model.length;
    let before = overlaps(model, &start, near);
    let mut all = Vec::new();
    let mut pairs = HashSet::new();
    for found in overlaps(model, &model.places(&last.u), near) {
        let was = before.iter().filter(|was| was.bodies == found.bodies);
        let was = was.map(|was| was.depth).fold(0.0, f64::max);
        let grown = found.depth - was - found.bend;
        if grown <= found.most
            || grown - allowed(model, &last.nodes, found.bodies) <= found.most
            || !pairs.insert(unordered(found.bodies))
        {
            continue;
        }
        let [outer, inner] = found.bodies.map(|body| &model.bodies[body].name);
        all.push(format!(
            "bodies {outer} and {inner} overlap in the last accepted state: {} of the second lies inside the first by {}. Contact acts \
             only at slave nodes that face a surface: make the side with the finer mesh the slave, or define contact of the sides \
             that meet there",
            model.nodes[found.node].name,
            sig4(found.depth)
        ));
    }
    all
}

/// Both bodies of a pair, whichever is the outer one.
fn unordered([a, b]: [usize; 2]) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

/// The largest penetration that the springs of contacts between two bodies have (length).
fn allowed(model: &Model, nodes: &[ContactState], bodies: [usize; 2]) -> f64 {
    let nodes_of = |body: usize| model.bodies[body].nodes.iter().copied();
    let [a, b] = bodies.map(|body| nodes_of(body).collect::<HashSet<usize>>());
    let springs = model.contacts.iter().zip(nodes).filter(|(contact, _)| {
        let mut slaves = contact.carriers().map(|(node, _)| node);
        let mut masters = contact
            .surfaces
            .iter()
            .flat_map(|&surface| &model.surfaces[surface].elements);
        let mut is_on = |master: &HashSet<usize>| {
            masters.any(|side| side.iter().all(|node| master.contains(node)))
        };
        contact.bond.give()[0] > 0.0
            && slaves.next().is_some_and(|node| {
                a.contains(&node) && is_on(&b) || b.contains(&node) && is_on(&a)
            })
    });
    springs
        .map(|(contact, node)| contact.bond.give()[0] * node.f_n)
        .fold(0.0, f64::max)
}

/// Pairs of solids where a node of one lies deeper than `near` inside the outline of the other, each with its deepest node.
fn overlaps(model: &Model, places: &[[f64; 2]], near: f64) -> Vec<Overlap> {
    let solids: Vec<(usize, &Body, Outline)> = (model.bodies.iter().enumerate())
        .filter_map(|(k, body)| Some((k, body, Outline::new(places, &body.solid()?.edges))))
        .collect();
    let mut all = Vec::new();
    for (a, body, outline) in &solids {
        let own = LazyCell::new(|| body.nodes.iter().copied().collect::<HashSet<usize>>());
        for (b, other, others) in &solids {
            if a == b || !outline.meets(others) {
                continue;
            }
            let mut deepest: Option<(usize, f64)> = None;
            let mut first = None;
            for &node in other.kind.lines().iter().flatten() {
                let depth = outline.depth(places[node], near);
                if depth > deepest.map_or(near, |(_, depth)| depth) && !own.contains(&node) {
                    deepest = Some((node, depth));
                    first = first.or(deepest);
                }
            }
            let found = first.zip(deepest);
            all.extend(found.map(|((first, _), (node, depth))| Overlap {
                bodies: [*a, *b],
                node,
                first,
                depth,
                most: outline.tolerance().min(others.tolerance()),
                bend: outline.bend + others.bend,
            }));
        }
    }
    all
}

/// A closed outline, straight between nodes.
struct Outline {
    sides: Vec<[[f64; 2]; 2]>,
    /// Smallest and largest coordinates.
    low: [f64; 2],
    high: [f64; 2],
    /// How far a curved side is at most from the straight ones between its nodes (length).
    bend: f64,
}

impl Outline {
    fn new(places: &[[f64; 2]], edges: &[Vec<usize>]) -> Self {
        let sides = edges
            .iter()
            .flat_map(|edge| edge.windows(2))
            .map(|pair| [places[pair[0]], places[pair[1]]]);
        let sides: Vec<[[f64; 2]; 2]> = sides.collect();
        let [x, y] = [0, 1].map(|axis| range(sides.iter().flatten().map(|end| end[axis])));
        // Half of a parabola is a quarter of the distance of its middle node from its own chord.
        let bend = |nodes: &[usize]| {
            let [a, b, c] = [0, 1, 2].map(|k| places[nodes[k]]);
            let [x, y] = [0, 1].map(|k| b[k] - 0.5 * (a[k] + c[k]));
            0.25 * x.hypot(y)
        };
        let bends = edges.iter().flat_map(|edge| edge.windows(3)).map(bend);
        Outline {
            low: [x[0], y[0]],
            high: [x[1], y[1]],
            bend: bends.fold(0.0, f64::max),
            sides,
        }
    }

    /// The depth up to which an overlap with this solid is not reported after a run.
    fn tolerance(&self) -> f64 {
        let diagonal = (self.high[0] - self.low[0]).hypot(self.high[1] - self.low[1]);
        let twice_areas = self.sides.iter().map(|[a, b]| a[0] * b[1] - b[0] * a[1]);
        let thickness = 0.5 * twice_areas.sum::<f64>().abs() / diagonal;
        (DEEP * diagonal).min(THIN * thickness)
    }

    /// Whether the bounding boxes have a point in common.
    fn meets(&self, other: &Outline) -> bool {
        (0..2).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }

    /// The distance of a point inside from the sides; 0 outside, and for points within `near` of the bounding box.
    fn depth(&self, at: [f64; 2], near: f64) -> f64 {
        let inside_box = (0..2).all(|k| at[k] - self.low[k] > near && self.high[k] - at[k] > near);
        if inside_box {
            depth_inside(&self.sides, at)
        } else {
            0.0
        }
    }
}
