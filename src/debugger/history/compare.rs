//! Compares two branches: modes, forces, residuals and cost, at their tips and at a common point.
//!
//! The common point is the last load at which both accepted an increment after the fork (on the same leg, if
//! the load path reverses). If there is none, it is the last minor iteration at the same position. Two states
//! are the same if displacements and gaps differ by less than [`SAME_STATE`] of the scene's length, and forces
//! by less than [`SAME_STATE`] of the larger branch's largest force; within a major iteration, in which
//! displacements do not change yet, gaps and forces are those of the minor iteration. Modes of equal states can
//! differ only in ties and are listed separately.

use crate::explain::names;
use crate::history::branches::{self, Cost};
use crate::history::breakpoints::RunPlace;
use crate::{Frame, Strip, Tree};
use stickslip_core::{ContactRecord, ContactState, Mode, Model};
use stickslip_scene::{first_of, shortest, sig2};

/// Relative difference below which two states are the same.
pub const SAME_STATE: f64 = 1e-7;

/// A slave node in one of the branches. Compression is positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeSide {
    /// Mode of the iteration.
    pub mode: Mode,
    /// Mode of the next iteration.
    pub next: Mode,
    /// Total forces (normal, tangential) after the iteration; `None` if the frame is thinned or nothing was
    /// solved.
    pub forces: Option<[f64; 2]>,
}

/// One branch at one point.
#[derive(Debug, Clone, PartialEq)]
pub struct Side {
    /// Number in [`Tree::branches`].
    pub branch: usize,
    /// Load factor λ.
    pub load_factor: f64,
    /// One entry per slave node.
    pub nodes: Vec<NodeSide>,
    /// Relative residual: after the major iteration if it ended here, otherwise before it.
    pub residual: f64,
    /// Cost from the root to here.
    pub cost: Cost,
}

/// Two branches side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Both at their tips.
    pub tips: [Side; 2],
    /// Both at their common point, if there is one.
    pub common: Option<[Side; 2]>,
    /// Whether the states at the common point are the same; `None` if there is no such point, or a frame is
    /// thinned.
    pub is_same: Option<bool>,
}

/// Compares two branches; `None` if one does not exist.
pub fn compare(tree: &Tree, a: usize, b: usize) -> Option<Comparison> {
    let tip = |branch: usize| side(tree, branch, tree.len(branch).checked_sub(1)?);
    let places = common(tree, a, b);
    let common = match places {
        Some([at_a, at_b]) => Some([side(tree, a, at_a)?, side(tree, b, at_b)?]),
        None => None,
    };
    Some(Comparison {
        tips: [tip(a)?, tip(b)?],
        common,
        is_same: places.and_then(|[at_a, at_b]| same(tree, (a, at_a), (b, at_b))),
    })
}

/// Whether two branches have the same state at the last load that both accepted, and that load.
pub(super) fn sameness(tree: &Tree, a: usize, b: usize) -> Option<(bool, f64)> {
    let [at_a, at_b] = common_load(tree, a, b)?;
    let (_, strip) = tree.point(a, at_a)?;
    Some((same(tree, (a, at_a), (b, at_b))?, strip.load_factor))
}

fn side(tree: &Tree, branch: usize, at: usize) -> Option<Side> {
    let (frame, strip) = tree.point(branch, at)?;
    let node = |s: usize| {
        let found = frame.event.as_ref().and_then(|event| event.nodes.get(s));
        NodeSide {
            mode: strip.before(s),
            next: strip.next(s),
            forces: found.map(|found| [found.f_n, found.f_t]),
        }
    };
    let after = strip.after.as_deref();
    Some(Side {
        branch,
        load_factor: strip.load_factor,
        nodes: (0..strip.slaves()).map(node).collect(),
        residual: after.map_or(strip.residual, |after| after.relative),
        cost: branches::cost(tree, branch, 0..at + 1),
    })
}

/// Number of points that two lines share.
fn parting(tree: &Tree, a: usize, b: usize) -> usize {
    let owner = |branch: usize, at: usize| {
        let mut owner = branch;
        while let Some(found) = tree.branches().get(owner)
            && found.from > at
            && let Some(parent) = found.parent
        {
            owner = parent;
        }
        owner
    };
    let both = tree.len(a).min(tree.len(b));
    (0..both)
        .find(|&at| owner(a, at) != owner(b, at))
        .unwrap_or(both)
}

fn common(tree: &Tree, a: usize, b: usize) -> Option<[usize; 2]> {
    common_load(tree, a, b).or_else(|| {
        let start = parting(tree, a, b);
        let places = |branch: usize| {
            branches::strips(tree, branch, start).filter(|(_, strip)| strip.kind.is_solved())
        };
        let place = |strip: &Strip| RunPlace::from(strip.position);
        places(a).find_map(|(at_a, x)| {
            let (at_b, _) = places(b).find(|(_, y)| place(x) == place(y))?;
            Some([at_a, at_b])
        })
    })
}

/// The last load that both accepted after the fork.
fn common_load(tree: &Tree, a: usize, b: usize) -> Option<[usize; 2]> {
    let start = parting(tree, a, b);
    branches::accepted(tree, a)
        .take_while(|(at, _)| *at >= start)
        .find_map(|(at_a, strip)| {
            let at_b = branches::accepted_like(tree, b, strip)?;
            (at_b >= start).then_some([at_a, at_b])
        })
}

/// The records of a minor iteration that ends no increment: forces and gaps along directions that are frozen in it.
fn solved(frame: &Frame) -> &[ContactRecord] {
    let event = frame.event.as_deref();
    let within = event.filter(|event| !event.outcome.is_accepted());
    within.map_or(&[], |event| &event.nodes)
}

fn same(tree: &Tree, a: (usize, usize), b: (usize, usize)) -> Option<bool> {
    let (x, _) = tree.point(a.0, a.1)?;
    let (y, _) = tree.point(b.0, b.1)?;
    if !(x.is_whole() && y.is_whole()) {
        return None;
    }
    let apart = |x: &[f64], y: &[f64], size: f64| {
        x.len() != y.len()
            || x.iter()
                .zip(y)
                .any(|(x, y)| (x - y).abs() > SAME_STATE * size)
    };
    let (solved_x, solved_y) = (solved(x), solved(y));
    let forces = |frame: &Frame, solved: &[ContactRecord]| -> Vec<f64> {
        let held = frame.state.nodes.iter().flat_map(ContactState::force);
        held.chain(solved.iter().flat_map(|node| [node.f_n, node.f_t]))
            .collect()
    };
    let gaps =
        |solved: &[ContactRecord]| -> Vec<f64> { solved.iter().map(|node| node.gap).collect() };
    let (f, g) = (forces(x, solved_x), forces(y, solved_y));
    let scale = |frame: &Frame| frame.event.as_ref().map_or(0.0, |event| event.before.scale);
    let largest = f
        .iter()
        .chain(&g)
        .fold(scale(x).max(scale(y)), |m, f| m.max(f.abs()));
    let length = tree.model().length;
    let moved =
        apart(&x.state.u, &y.state.u, length) || apart(&gaps(solved_x), &gaps(solved_y), length);
    Some(!moved && !apart(&f, &g, largest))
}

/// The comparison in one line.
pub fn describe(tree: &Tree, comparison: &Comparison) -> String {
    let cost = |side: &Side| {
        let Cost {
            minors,
            majors,
            seconds,
            ..
        } = side.cost;
        format!(
            "{} at load {}, residual {}, {minors} minor, {majors} major, {seconds:.3} s",
            branches::name(tree, side.branch),
            shortest(side.load_factor),
            sig2(side.residual)
        )
    };
    let [a, b] = comparison.tips.each_ref().map(cost);
    format!("{a}; {b}; {}", verdict(tree, comparison))
}

/// Whether the states at the common point are the same, in words.
pub fn verdict(tree: &Tree, comparison: &Comparison) -> String {
    let Some([a, b]) = &comparison.common else {
        return "the branches share no iteration after the fork".into();
    };
    let load = shortest(a.load_factor);
    match comparison.is_same {
        Some(true) => format!("same state at load {load}"),
        Some(false) => {
            let nodes = differing(tree.model(), a, b);
            format!("different states at load {load}{nodes}")
        }
        None => format!("at load {load} one state was thinned; go there first to recompute it"),
    }
}

/// The first nodes whose modes differ.
fn differing(model: &Model, a: &Side, b: &Side) -> String {
    const SHOWN: usize = 3;
    let nodes: Vec<usize> = (0..a.nodes.len().min(b.nodes.len()))
        .filter(|&s| a.nodes[s].next != b.nodes[s].next)
        .collect();
    let describe = |&s: &usize| {
        let [a, b] = [a.nodes[s].next, b.nodes[s].next].map(Mode::word);
        format!("{} {a}, {b}", names::slave(model, s))
    };
    if nodes.is_empty() {
        ", with the same modes".into()
    } else {
        format!(": {}", first_of(nodes.iter().map(describe), SHOWN, "; "))
    }
}
