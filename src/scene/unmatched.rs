//! Second-order slave sides over borders of second-order masters, node to surface.
//!
//! A slave node's force is equivalent to a linear combination of nodal forces of the master's element below it. If a side lies over
//! two elements of the master, no nodal forces of its three nodes give a smooth pressure on both: pressures alternate between corner
//! and middle nodes. A cylinder on a block (Hertz), 6 to 20 elements over the contact, has peaks 7 to 9 % too high with elements of
//! similar size, and 27 % with slave elements of twice the size. Sides that each lie over one element, and points of faces, are within
//! 0.4 %.

use std::collections::BTreeMap;
use stickslip_core::groups::marked;
use stickslip_core::plane::distance;
use stickslip_core::{Body, Model, Surface, SurfacePoint};

/// A border of the masters counts as inside a side if it is farther than this from its ends, in parts of the master's element.
const INSIDE: f64 = 0.05;
/// Sides whose ends are farther from the master than this are not counted, in parts of their length.
const NEAR: f64 = 0.5;
/// Least number of such sides on a surface for a warning.
const LEAST: usize = 3;

/// One sentence for each surface over whose borders most slave sides near it lie; `stands` are the projections of the slave nodes on
/// their surfaces, with the gap.
pub(crate) fn warnings(model: &Model, stands: &[Option<(SurfacePoint, f64)>]) -> Vec<String> {
    let mut slaves = vec![None; model.nodes.len()];
    for (contact, stand) in model.contacts.iter().zip(stands) {
        if contact.weights.is_empty() && !contact.bond.is_tied() {
            slaves[contact.node] = *stand;
        }
    }
    let solids = || model.bodies.iter().filter_map(Body::solid);
    let of_solids = solids().flat_map(|solid| solid.edges.iter().flatten());
    let of_solids = marked(model.nodes.len(), of_solids);
    let is_quadratic = |surface: &Surface| {
        let mut elements = surface.elements.iter();
        surface.smooth.is_empty()
            && elements.all(|nodes| nodes.len() == 3 && nodes.iter().all(|&node| of_solids[node]))
    };
    let quadratic: Vec<bool> = model.surfaces.iter().map(is_quadratic).collect();
    // Numbers of sides near a surface, and of those over one of its borders.
    let mut counts: BTreeMap<usize, [usize; 2]> = BTreeMap::new();
    for edge in solids().flat_map(|solid| &solid.edges) {
        let &[from, middle, to] = &edge[..] else {
            continue;
        };
        let (Some((a, gap_a)), Some(_), Some((b, gap_b))) =
            (slaves[from], slaves[middle], slaves[to])
        else {
            continue;
        };
        let length = distance(model.nodes[from].at, model.nodes[to].at);
        let is_far = gap_a.abs().max(gap_b.abs()) > NEAR * length;
        if a.surface != b.surface || is_far || !quadratic[a.surface] {
            continue;
        }
        let along = |element: usize, xi: f64| element as f64 + 0.5 * (1.0 + xi);
        let ends = [along(a.element, a.xi), along(b.element, b.xi)];
        let (low, high) = (ends[0].min(ends[1]) + INSIDE, ends[0].max(ends[1]) - INSIDE);
        let [near, over] = counts.entry(a.surface).or_default();
        *near += 1;
        *over += usize::from(high.floor() >= low.ceil());
    }
    let unmatched = counts
        .iter()
        .filter(|(_, [near, over])| *over >= LEAST && 2 * over > *near);
    unmatched
        .map(|(&surface, [near, over])| {
            format!(
                "{over} of {near} slave sides near surface {} lie over a border of its elements: with middle nodes on both sides, contact \
                 pressures alternate between corner and middle nodes (in Hertz contact the peak is 7 to 27 % too high); set by: \
                 surface with a law, or mesh both sides so that each slave side lies over one element, as with equal meshes",
                model.surfaces[surface].name
            )
        })
        .collect()
}
