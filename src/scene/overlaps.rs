//! Solids that overlap: a node of one lies inside the outline of another, which is straight between nodes, or their sides cross.
//!
//! Contact acts at slave nodes that face a surface. Where none does, bodies pass through each other although every law of contact
//! holds.

use crate::number::sig4;
use std::cell::LazyCell;
use std::collections::HashSet;
use stickslip_core::contact::state::ContactState;
use stickslip_core::plane::{cross, depth_inside, minus, range};
use stickslip_core::{Body, IncrementStart, Model};

/// Depths below this part of the scene's length are none.
const NONE: f64 = 3e-5;
/// Depths that are reported after a run: those by which an overlap has grown, relative to the diagonal of the smaller body. Between
/// the slave nodes of a coarse mesh a master's nodes are a little inside.
const DEEP: f64 = 0.01;
/// The same for a thin body, relative to its thickness, its area per diagonal: no node is deeper inside than half of that.
const THIN: f64 = 0.25;

/// A node of a solid, or a side between two nodes, inside another one.
struct Overlap {
    /// Numbers of the outer body, and of the body of the node or side.
    bodies: [usize; 2],
    /// The deepest one.
    deepest: InnerPart,
    /// The first one inside, along the sides of its body.
    first: InnerPart,
    /// Distance of the deepest one from the outline (length).
    depth: f64,
    /// Depth up to which it is not reported after a run (length).
    most: f64,
    /// How far the curved sides of both bodies are from straight ones between nodes (length).
    bend: f64,
}

/// What lies inside another solid.
#[derive(Clone, Copy)]
enum InnerPart {
    Node(usize),
    /// The middle of a side between two nodes that are outside.
    Side([usize; 2]),
}

impl InnerPart {
    fn words(self, model: &Model) -> String {
        let name = |node: usize| &model.nodes[node].name;
        match self {
            InnerPart::Node(node) => format!("{} of the second lies inside the first", name(node)),
            InnerPart::Side([from, to]) => format!(
                "the side of the second from {} to {} lies partly inside the first",
                name(from),
                name(to)
            ),
        }
    }
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
            let inside = first.words(model);
            format!("bodies {outer} and {inner} overlap: {inside}")
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
        let same = |was: &&Overlap| match found.deepest {
            InnerPart::Node(_) => was.bodies == found.bodies,
            InnerPart::Side(_) => unordered(was.bodies) == unordered(found.bodies),
        };
        let was = before.iter().filter(same);
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
            "bodies {outer} and {inner} overlap in the last accepted state: {} by {}. Contact acts \
             only at slave nodes that face a surface: make the side with the finer mesh the slave, or define contact of the sides \
             that meet there",
            found.deepest.words(model),
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

/// Pairs of solids where a node of one lies deeper than `near` inside the outline of the other, each with its deepest node; then
/// other pairs whose sides cross as deep, with the deepest side.
fn overlaps(model: &Model, places: &[[f64; 2]], near: f64) -> Vec<Overlap> {
    let solids: Vec<(usize, &Body, Outline)> = (model.bodies.iter().enumerate())
        .filter_map(|(k, body)| Some((k, body, Outline::new(places, &body.solid()?.edges))))
        .collect();
    let mut all = Vec::new();
    let mut crossing = Vec::new();
    for (a, body, outline) in &solids {
        let own = LazyCell::new(|| body.nodes.iter().copied().collect::<HashSet<usize>>());
        for (b, other, others) in &solids {
            if a == b || !outline.meets(others) {
                continue;
            }
            let overlap = |first, (deepest, depth)| Overlap {
                bodies: [*a, *b],
                deepest,
                first,
                depth,
                most: outline.tolerance().min(others.tolerance()),
                bend: outline.bend + others.bend,
            };
            let lines = other.kind.lines();
            let nodes = lines.iter().flatten().map(|&node| {
                let depth = outline.depth(places[node], near);
                (InnerPart::Node(node), depth)
            });
            let is_own = |part: InnerPart| match part {
                InnerPart::Node(node) => own.contains(&node),
                InnerPart::Side(ends) => ends.iter().any(|node| own.contains(node)),
            };
            if let Some((first, deepest)) = first_and_deepest(nodes, near, is_own) {
                all.push(overlap(first, deepest));
            } else if a < b {
                let pairs = lines.iter().flat_map(|line| line.windows(2));
                let sides = pairs.map(|pair| {
                    let depth = outline.depth_along([places[pair[0]], places[pair[1]]], near);
                    (InnerPart::Side([pair[0], pair[1]]), depth)
                });
                let found = first_and_deepest(sides, near, is_own);
                crossing.extend(found.map(|(first, deepest)| overlap(first, deepest)));
            }
        }
    }
    let met: HashSet<[usize; 2]> = all.iter().map(|found| unordered(found.bodies)).collect();
    crossing.retain(|found| !met.contains(&found.bodies));
    all.extend(crossing);
    all
}

/// The first and the deepest part deeper than `near`, without those that both bodies own.
fn first_and_deepest(
    parts: impl Iterator<Item = (InnerPart, f64)>,
    near: f64,
    is_own: impl Fn(InnerPart) -> bool,
) -> Option<(InnerPart, (InnerPart, f64))> {
    let mut found: Option<(InnerPart, (InnerPart, f64))> = None;
    for (part, depth) in parts {
        if depth > found.map_or(near, |(_, (_, depth))| depth) && !is_own(part) {
            found = Some((found.map_or(part, |(first, _)| first), (part, depth)));
        }
    }
    found
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

    /// The largest depth of a straight side whose ends are not inside: at the middle of each part between two of the outline's sides.
    fn depth_along(&self, [from, to]: [[f64; 2]; 2], near: f64) -> f64 {
        let along = minus(to, from);
        let is_beyond = (0..2).any(|k| {
            let [low, high] = range([from[k], to[k]]);
            high <= self.low[k] || low >= self.high[k]
        });
        if is_beyond {
            return 0.0;
        }
        let meets = |&[a, b]: &[[f64; 2]; 2]| {
            let (side, before) = (minus(b, a), minus(a, from));
            let turn = cross(along, side);
            let [part, other] = [cross(before, side) / turn, cross(before, along) / turn];
            let both = [part, other].iter().all(|x| (0.0..=1.0).contains(x));
            both.then_some(part)
        };
        let mut parts: Vec<f64> = self.sides.iter().filter_map(meets).collect();
        parts.sort_by(f64::total_cmp);
        let middles = parts.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        let depths =
            middles.map(|part| self.depth([0, 1].map(|k| from[k] + part * along[k]), near));
        depths.fold(0.0, f64::max)
    }
}
