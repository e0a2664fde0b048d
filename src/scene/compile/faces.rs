//! Points of slave faces (`by: surface`): Gauss points of the parts into which the borders of the masters' elements divide each side.
//!
//! The displacement of a point is Σ N_i u_i over the nodes of its side, and its force acts on node i with the weight N_i. On each
//! part the functions of both sides are polynomials, so constant pressure is integrated exactly on meshes that do not match.

use super::super::areas::{AreaSide, NamedSides, density, sides};
use super::super::nodes::Names;
use crate::Spec;
use crate::format::error::{Fault, at, bail};
use stickslip_core::contact::projection::{closest_point, projection_at};
use stickslip_core::fem::lagrange::gauss;
use stickslip_core::plane::distance;
use stickslip_core::{Body, Contact, Node, Surface, SurfaceElement};

/// Minimum number of points of a side. Only where a contact zone ends within a side do they matter (page `decks`): the extreme case
/// is a ring with one element per side, whose forces scatter by 19 % with 3 to 12 points.
const POINTS: usize = 10;
/// Borders of parts closer than this, in coordinates ξ of the side, are one border.
const SAME: f64 = 1e-6;

/// Replaces the nodes of pairs with `by: surface` by points of their sides, which become further nodes without unknowns.
pub(super) fn spread(
    spec: &Spec,
    names: &mut Names,
    bodies: &[Body],
    surfaces: &[Surface],
    named: &NamedSides,
    slaves: &mut Vec<Contact>,
    pairs: &mut Vec<usize>,
) -> Result<(), Fault> {
    let by_surface = |pair: usize| !spec.slaves[pair].by.is_node();
    let mut pairs_of = vec![Vec::new(); names.nodes.len()];
    for (slave, &pair) in slaves.iter().zip(&*pairs) {
        pairs_of[slave.node].push(pair);
    }
    let places: Vec<[f64; 2]> = names.nodes.iter().map(|node| node.at).collect();
    let sides: Vec<AreaSide<'_>> = bodies
        .iter()
        .filter(|body| body.solid().is_some())
        .flat_map(sides)
        .collect();
    let all: Vec<(Contact, usize)> = slaves.drain(..).zip(pairs.drain(..)).collect();
    let (mut done, mut points) = (vec![false; spec.slaves.len()], 0);
    for (slave, pair) in all {
        if by_surface(pair) && std::mem::replace(&mut done[pair], true) {
            continue;
        }
        if !by_surface(pair) {
            slaves.push(slave);
            pairs.push(pair);
            continue;
        }
        let of_pair = sides.iter().filter(|side| {
            let mut nodes = side.nodes.iter();
            let whole = || nodes.all(|&node| pairs_of[node].contains(&pair));
            named.has(pair, side).unwrap_or_else(whole)
        });
        for side in of_pair {
            let borders = borders(side, surfaces, &slave.surfaces, &places);
            let ends = [side.nodes[0], side.nodes[side.nodes.len() - 1]];
            let [from, to] = ends.map(|node| names.nodes[node].name.clone());
            for (number, (xi, weight)) in (1..).zip(rule(&borders, side.nodes.len())) {
                let (n, size) = density(side, &names.nodes[..places.len()], xi);
                let weights: Vec<(usize, f64)> = side.nodes.iter().copied().zip(n).collect();
                let at = [0, 1].map(|k| weights.iter().map(|&(node, n)| n * places[node][k]).sum());
                slaves.push(Contact {
                    node: names.nodes.len(),
                    weights,
                    area: Some(weight * size),
                    ..slave.clone()
                });
                pairs.push(pair);
                names.nodes.push(Node {
                    name: format!("{from}~{to}.{number}"),
                    at,
                });
            }
        }
        if points == slaves.len() {
            bail!(
                at!["slaves", pair, "by"],
                "no side of a solid has all its nodes in this list; points of faces need whole sides"
            );
        }
        points = slaves.len();
    }
    Ok(())
}

/// Coordinates ξ of the borders of the parts of a side, ascending, with its ends: the closest points of the ends of the masters'
/// elements within the side's length.
fn borders(
    side: &AreaSide<'_>,
    surfaces: &[Surface],
    masters: &[usize],
    places: &[[f64; 2]],
) -> Vec<f64> {
    let line = [Surface::new("", vec![side.nodes.to_vec()], false)];
    let corner = |node: Option<&usize>| node.map_or([f64::NAN; 2], |&node| places[node]);
    let [from, to] = [corner(side.nodes.first()), corner(side.nodes.last())];
    let length = distance(to, from);
    let over = masters
        .iter()
        .map(|&surface| &surfaces[surface])
        .filter(|surface| !surface.endless)
        .flat_map(SurfaceElement::all)
        .flat_map(|element| [element.first(), element.last()])
        .flatten()
        .filter_map(|&node| {
            let at = places[node];
            let is_near = distance(at, from) <= 2.0 * length;
            let spot = is_near.then(|| closest_point(at, &line, &[0], places, None))??;
            let gap = projection_at(&line, spot, places, at).gap;
            (gap.abs() <= length).then_some(spot.xi)
        });
    let mut found: Vec<f64> = over
        .filter(|xi| xi.abs() < 1.0 - SAME)
        .chain([-1.0, 1.0])
        .collect();
    found.sort_by(f64::total_cmp);
    found.dedup_by(|next, before| *next - *before < SAME);
    found
}

/// Points ξ and weights of the Gauss rules on the parts of a side with `nodes` nodes.
fn rule(borders: &[f64], nodes: usize) -> Vec<(f64, f64)> {
    let count = nodes.max(POINTS.div_ceil(borders.len().max(2) - 1));
    let parts = borders
        .windows(2)
        .map(|part| (0.5 * (part[0] + part[1]), 0.5 * (part[1] - part[0])));
    parts
        .flat_map(|(middle, half)| {
            gauss(count)
                .into_iter()
                .map(move |(x, weight)| (middle + half * x, half * weight))
        })
        .collect()
}
