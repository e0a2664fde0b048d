//! Tributary areas of slave nodes, which convert forces to pressures: p = F_n / A.
//!
//! The area of a node is the integral of its shape function over the undeformed sides of its body that belong to the slave
//! surface,
//!
//! ```text
//! A_i = ∫ N_i w |dx/dξ| dξ,
//! ```
//!
//! where w is the thickness across the plane, or 2π x in axisymmetry; w = 1 for beams, whose sides are their elements. On a
//! straight side of length L with w = 1 the areas are L/2 for each of 2 nodes, and L/6, 4L/6, L/6 for 3 nodes. A side belongs to
//! the slave surface if the pair names it (`sides`), or, if the pair names none, if all its nodes are slaves of this pair. A node
//! without such a side (for example a single slave node) gets half of each side of its body that contains it. Bodies given by
//! matrices have no sides.

use super::nodes::Names;
use crate::Spec;
use crate::format::error::{Fault, at};
use std::collections::{HashMap, HashSet};
use stickslip_core::fem::lagrange::{MAX_NODES, gauss, shape};
use stickslip_core::{Body, BodyKind, Elastic, Node, Solid, Surface};

/// Fractions of a side's area below this are round-off.
const NONE: f64 = 1e-9;

/// A side of a body with its material, which determines the width across the plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct AreaSide<'a> {
    pub nodes: &'a [usize],
    pub made_of: Option<&'a Elastic>,
}

/// The sides that the pairs name, by their nodes in ascending order; `None` for a pair that names none.
#[derive(Debug, Default)]
pub(super) struct NamedSides(Vec<Option<HashSet<Vec<usize>>>>);

impl NamedSides {
    /// The sides of all pairs of a scene.
    pub fn from_spec(spec: &Spec, names: &Names) -> Result<NamedSides, Fault> {
        let mut all = Vec::with_capacity(spec.slaves.len());
        for (k, group) in spec.slaves.iter().enumerate() {
            let mut own = HashSet::new();
            for (j, name) in group.sides.iter().enumerate() {
                let chain = names.chain(name);
                let chain = chain.map_err(|why| Fault::new(at!["slaves", k, "sides", j], why))?;
                let sides = chain.pieces().into_iter().flatten();
                own.extend(sides.map(|side| ascending(&side)));
            }
            all.push((!group.sides.is_empty()).then_some(own));
        }
        Ok(NamedSides(all))
    }

    /// Refuses names of sides that no body has, on which no node of the pair lies, or that these nodes touch.
    pub fn check(
        &self,
        spec: &Spec,
        names: &Names,
        bodies: &[Body],
        surfaces: &[Surface],
    ) -> Result<(), Fault> {
        let mut known = HashSet::new();
        if self.0.iter().any(Option::is_some) {
            let sides = bodies.iter().flat_map(sides);
            known.extend(sides.map(|side| ascending(side.nodes)));
        }
        for (k, (own, group)) in self.0.iter().zip(&spec.slaves).enumerate() {
            let nodes = group.nodes.iter().flat_map(|name| names.nodes(name));
            let nodes: HashSet<usize> = nodes.flatten().collect();
            let touched = surfaces.iter().filter(|one| group.on.contains(&one.name));
            let touched = || touched.clone().flat_map(|one| &one.elements);
            let wrong = |side: &Vec<usize>| {
                if !known.contains(side) {
                    Some(
                        "these are not sides of the elements of a solid or beam, with all their nodes",
                    )
                } else if touched().any(|nodes| ascending(nodes) == *side) {
                    Some("a side of a surface that the nodes touch cannot be a slave side as well")
                } else if !side.iter().any(|node| nodes.contains(node)) {
                    Some("no node of one of these sides is among the pair's nodes")
                } else {
                    None
                }
            };
            if let Some(why) = own.iter().flatten().find_map(wrong) {
                return Err(Fault::new(at!["slaves", k, "sides"], why));
            }
        }
        Ok(())
    }

    /// Whether a side belongs to a pair; `None` if the pair names no sides.
    pub fn has(&self, pair: usize, side: &AreaSide<'_>) -> Option<bool> {
        let own = self.0.get(pair)?.as_ref()?;
        Some(own.contains(&ascending(side.nodes)))
    }
}

fn ascending(nodes: &[usize]) -> Vec<usize> {
    let mut nodes = nodes.to_vec();
    nodes.sort_unstable();
    nodes
}

/// Areas of the slave nodes, where `pair_of` is the pair of each; `None` for other nodes and for nodes on no side. In a pair with
/// a compliance (`gives`), a node on the axis has no area.
pub(super) fn tributary(
    nodes: &[Node],
    bodies: &[Body],
    pair_of: &[Option<usize>],
    named: &NamedSides,
    gives: impl Fn(usize) -> bool,
) -> Vec<Option<f64>> {
    let sides: Vec<AreaSide<'_>> = bodies.iter().flat_map(sides).collect();
    let mut areas = vec![None; nodes.len()];
    let mut add = |node: usize, area: f64| *areas[node].get_or_insert(0.0) += area;
    for side in &sides {
        let first = pair_of[side.nodes[0]];
        let is_whole = side.nodes.iter().all(|&node| pair_of[node] == first);
        // Nodes of a named side may be slaves of another pair, or of none.
        let pair =
            |node: usize| pair_of[node].filter(|&pair| named.has(pair, side).unwrap_or(is_whole));
        let Some(any) = side.nodes.iter().find_map(|&node| pair(node)) else {
            continue;
        };
        let mut shares = shares(side, nodes);
        if gives(any) {
            off_axis(side, nodes, &mut shares);
        }
        for (&node, share) in side.nodes.iter().zip(shares) {
            if pair(node).is_some() {
                add(node, share);
            }
        }
    }
    let mut alone: Vec<Option<f64>> = vec![None; nodes.len()];
    for side in &sides {
        for &node in side
            .nodes
            .iter()
            .filter(|node| pair_of[**node].is_some() && areas[**node].is_none())
        {
            *alone[node].get_or_insert(0.0) += 0.5 * shares(side, nodes).iter().sum::<f64>();
        }
    }
    areas
        .into_iter()
        .zip(alone)
        .map(|(area, alone)| area.or(alone))
        .collect()
}

/// Moves the area of a node on the axis to the next node of its side. Its ring has no length, so no pressure acts on it;
/// and if the surface is dented at that end, its normal deviates from the axis by the symmetry error of the elements.
fn off_axis(side: &AreaSide<'_>, nodes: &[Node], shares: &mut [f64]) {
    let Some(made_of) = side.made_of else {
        return;
    };
    let widths: Vec<f64> = side
        .nodes
        .iter()
        .map(|&node| made_of.width(nodes[node].at[0]))
        .collect();
    let widest = widths.iter().copied().fold(0.0, f64::max);
    for (k, width) in widths.iter().enumerate() {
        if *width <= NONE * widest {
            let share = std::mem::take(&mut shares[k]);
            shares[if k == 0 { 1 } else { k - 1 }] += share;
        }
    }
}

/// The sides of a body.
pub(super) fn sides(body: &Body) -> Vec<AreaSide<'_>> {
    let materials = match &body.kind {
        BodyKind::Beam(beam) => vec![None; beam.elements.len()],
        BodyKind::Solid(solid) => materials(solid),
        BodyKind::Linear(_) | BodyKind::Truss(_) => return Vec::new(),
    };
    body.kind
        .lines()
        .iter()
        .zip(materials)
        .map(|(nodes, made_of)| AreaSide { nodes, made_of })
        .collect()
}

/// The material of a solid at each of its edges.
fn materials(solid: &Solid) -> Vec<Option<&Elastic>> {
    if let [only] = solid.materials.as_slice() {
        return vec![Some(only); solid.edges.len()];
    }
    // The element behind an edge is the one that contains all its nodes.
    let mut around: HashMap<usize, Vec<usize>> = HashMap::new();
    for (k, element) in solid.elements.iter().enumerate() {
        element
            .nodes
            .iter()
            .for_each(|&node| around.entry(node).or_default().push(k));
    }
    let behind = |edge: &Vec<usize>| {
        around
            .get(&edge[0])?
            .iter()
            .find(|k| {
                edge.iter()
                    .all(|node| solid.elements[**k].nodes.contains(node))
            })
            .copied()
    };
    solid
        .edges
        .iter()
        .map(|edge| {
            solid
                .materials
                .get(solid.elements.get(behind(edge)?)?.material)
        })
        .collect()
}

/// The area of each node of a side. Lagrange polynomials of high order have negative integrals; in that case each node gets the
/// part of the side closest to it.
fn shares(side: &AreaSide<'_>, nodes: &[Node]) -> Vec<f64> {
    let count = side.nodes.len();
    let by_shape = integrals(side, nodes, -1.0, 1.0);
    let whole: f64 = by_shape.iter().sum();
    if by_shape.iter().all(|share| *share >= -NONE * whole) {
        return by_shape
            .into_iter()
            .map(|share| if share <= NONE * whole { 0.0 } else { share })
            .collect();
    }
    let half = 1.0 / (count as f64 - 1.0);
    let place = |k: usize| -1.0 + 2.0 * half * k as f64;
    (0..count)
        .map(|k| {
            let (from, to) = ((place(k) - half).max(-1.0), (place(k) + half).min(1.0));
            integrals(side, nodes, from, to).iter().sum()
        })
        .collect()
}

/// ∫ N_i w |dx/dξ| dξ over a part of a side.
fn integrals(side: &AreaSide<'_>, nodes: &[Node], from: f64, to: f64) -> Vec<f64> {
    let count = side.nodes.len();
    let mut sums = vec![0.0; count];
    for (x, weight) in gauss(count + 2) {
        let (here, density) = density(side, nodes, 0.5 * (from + to) + 0.5 * (to - from) * x);
        let size = 0.5 * (to - from) * weight * density;
        sums.iter_mut()
            .zip(here)
            .for_each(|(sum, n)| *sum += size * n);
    }
    sums
}

/// The functions N_i of a side at ξ, and w |dx/dξ| there.
pub(super) fn density(side: &AreaSide<'_>, nodes: &[Node], xi: f64) -> ([f64; MAX_NODES], f64) {
    let here = shape(side.nodes.len(), xi);
    let slope = [0, 1].map(|axis| -> f64 {
        let at = side.nodes.iter().map(|&node| nodes[node].at[axis]);
        at.zip(here.d).map(|(at, d)| at * d).sum()
    });
    let radius = side
        .nodes
        .iter()
        .zip(here.n)
        .map(|(&node, n)| nodes[node].at[0] * n)
        .sum();
    let width = side.made_of.map_or(1.0, |made_of| made_of.width(radius));
    (here.n, width * slope[0].hypot(slope[1]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip_core::model::Beam;

    fn beam(elements: Vec<Vec<usize>>) -> Body {
        let (ea, ei) = (1.0, 1.0);
        Body {
            name: "beam".into(),
            nodes: Vec::new(),
            kind: BodyKind::Beam(Beam {
                elements,
                ea,
                ei,
                ga: None,
                first_shear: None,
            }),
        }
    }

    fn row(count: usize, length: f64) -> Vec<Node> {
        let at = |k: usize| [length * k as f64 / (count as f64 - 1.0), 0.0];
        (0..count)
            .map(|k| Node {
                name: String::new(),
                at: at(k),
            })
            .collect()
    }

    fn close(found: &[Option<f64>], exact: &[f64]) {
        for (found, exact) in found.iter().zip(exact) {
            assert!((found.unwrap() - exact).abs() < 1e-14, "{found:?} {exact}");
        }
    }

    #[test]
    fn areas_on_a_straight_side_are_the_integrals_of_the_shape_functions() {
        let linear = tributary(
            &row(3, 2.0),
            &[beam(vec![vec![0, 1], vec![1, 2]])],
            &[Some(0); 3],
            &NamedSides::default(),
            |_| false,
        );
        close(&linear, &[0.5, 1.0, 0.5]);
        let quadratic = tributary(
            &row(3, 3.0),
            &[beam(vec![vec![0, 1, 2]])],
            &[Some(0); 3],
            &NamedSides::default(),
            |_| false,
        );
        close(&quadratic, &[0.5, 2.0, 0.5]);
    }

    #[test]
    fn a_single_slave_node_has_half_of_its_sides() {
        let bodies = [beam(vec![vec![0, 1], vec![1, 2]])];
        let found = tributary(
            &row(3, 2.0),
            &bodies,
            &[None, Some(0), None],
            &NamedSides::default(),
            |_| false,
        );
        assert_eq!(found, [None, Some(1.0), None]);
        let apart = tributary(
            &row(3, 2.0),
            &bodies,
            &[Some(1), Some(0), Some(1)],
            &NamedSides::default(),
            |_| false,
        );
        assert_eq!(apart, [Some(0.5), Some(1.0), Some(0.5)]);
    }

    #[test]
    fn the_areas_of_an_arc_add_up_to_its_length() {
        let place = |k: usize| {
            let angle = 0.25 * std::f64::consts::PI * k as f64 / 2.0;
            Node {
                name: String::new(),
                at: [angle.cos(), angle.sin()],
            }
        };
        let nodes: Vec<Node> = (0..5).map(place).collect();
        let found = tributary(
            &nodes,
            &[beam(vec![(0..5).collect()])],
            &[Some(0); 5],
            &NamedSides::default(),
            |_| false,
        );
        let sum: f64 = found.iter().flatten().sum();
        assert!((sum - 0.5 * std::f64::consts::PI).abs() < 1e-4, "{sum}");
    }

    #[test]
    fn no_area_is_negative_however_many_nodes_a_side_has() {
        for m in 2..=9 {
            let found = tributary(
                &row(m, 1.0),
                &[beam(vec![(0..m).collect()])],
                &[Some(0); 9][..m],
                &NamedSides::default(),
                |_| false,
            );
            assert!(
                found.iter().all(|area| area.unwrap() > 0.0),
                "{m}: {found:?}"
            );
            assert!((found.iter().flatten().sum::<f64>() - 1.0).abs() < 1e-13);
        }
    }
}
