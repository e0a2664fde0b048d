//! Cuts masters at their convex corners, and finds the directions that their slave nodes face
//! ([`stickslip_core::contact::facing`]).

use std::collections::HashMap;
use stickslip_core::model::{Body, Contact, Facing, Node};
use stickslip_core::plane::{cross, dot, minus};

/// Angle between two elements above which their border is a real corner rather than part of a curve (30 degrees).
pub(super) const CORNER: f64 = std::f64::consts::FRAC_PI_6;

/// Angle of the left turn from the end of one element to the start of the next (radians). The outside is on the right, so
/// the border is convex if the angle is positive.
pub(super) fn turn(one: &[usize], other: &[usize], at: impl Fn(usize) -> [f64; 2]) -> f64 {
    let ([.., before, last], [first, behind, ..]) = (one, other) else {
        return 0.0;
    };
    let way = |from: usize, to: usize| {
        let (from, to) = (at(from), at(to));
        minus(to, from)
    };
    let (a, b) = (way(*before, *last), way(*first, *behind));
    cross(a, b).atan2(dot(a, b))
}

/// A chain of elements in walking order, cut at its convex corners. A closed chain starts at a corner, if it has one.
pub(super) fn cut(mut chain: Vec<Vec<usize>>, nodes: &[Node]) -> Vec<Vec<Vec<usize>>> {
    let is_corner = |one: &[usize], other: &[usize]| turn(one, other, |n| nodes[n].at) > CORNER;
    let (last, first) = (chain.last(), chain.first());
    if last.and_then(|last| last.last()) == first.and_then(|first| first.first()) {
        let start = (0..chain.len()).find(|&k| {
            let before = (k + chain.len() - 1) % chain.len();
            is_corner(&chain[before], &chain[k])
        });
        chain.rotate_left(start.unwrap_or(0));
    }
    let pieces = chain.chunk_by(|one, other| !is_corner(one, other));
    pieces.map(<[_]>::to_vec).collect()
}

/// Finds the directions that the slave nodes of cut masters face; `pieces` are the numbers of the surfaces that are pieces,
/// and `pairs` has the pair of each slave node.
pub(super) fn face(pieces: &[usize], bodies: &[Body], pairs: &[usize], slaves: &mut [Contact]) {
    if pieces.is_empty() {
        return;
    }
    let edges: Vec<&Vec<usize>> = bodies
        .iter()
        .filter_map(Body::solid)
        .flat_map(|solid| &solid.edges)
        .collect();
    let pair_of: HashMap<usize, usize> = slaves
        .iter()
        .map(|slave| slave.node)
        .zip(pairs.iter().copied())
        .collect();
    for slave in slaves {
        let mut own: Vec<usize> = slave
            .surfaces
            .iter()
            .copied()
            .filter(|surface| pieces.contains(surface))
            .collect();
        own.sort_unstable();
        let pair = pair_of.get(&slave.node);
        // The sides of the slave surface, or all sides of the node if it is on none of them.
        let on_side = outline(
            slave.node,
            edges
                .iter()
                .filter(|edge| edge.iter().all(|node| pair_of.get(node) == pair))
                .copied(),
        );
        let outline = match slave.weights.as_slice() {
            [(first, _), .., (last, _)] => Some([*first, *last]),
            _ => on_side.or_else(|| outline(slave.node, edges.iter().copied())),
        };
        slave.facing = outline.filter(|_| own.len() > 1).map(|outline| Facing {
            outline,
            pieces: own,
        });
    }
}

/// The nodes before and after a node along these edges, or the node itself at an end; `None` if it is on no edge.
fn outline<'a>(node: usize, edges: impl Iterator<Item = &'a Vec<usize>>) -> Option<[usize; 2]> {
    let mut ends = [node; 2];
    for edge in edges {
        let Some(place) = edge.iter().position(|&other| other == node) else {
            continue;
        };
        if place > 0 {
            ends[0] = edge[place - 1];
        }
        if let Some(&behind) = edge.get(place + 1) {
            ends[1] = behind;
        }
    }
    (ends[0] != ends[1]).then_some(ends)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nodes(places: &[[f64; 2]]) -> Vec<Node> {
        let node = |at: &[f64; 2]| Node {
            name: String::new(),
            at: *at,
        };
        places.iter().map(node).collect()
    }

    #[test]
    fn a_chain_is_cut_where_it_is_convex_and_not_where_it_is_concave_or_bends_slightly() {
        // Up a wall, left over a step (convex), down into a notch (convex), left again (concave), then a turn of 17 degrees.
        let nodes = nodes(&[
            [0.0, 0.0],
            [0.0, 1.0],
            [-1.0, 1.0],
            [-1.0, 0.5],
            [-2.0, 0.5],
            [-3.0, 0.2],
        ]);
        let chain = (0..5).map(|k| vec![k, k + 1]).collect();
        let pieces = cut(chain, &nodes);
        let starts: Vec<usize> = pieces.iter().map(|piece| piece[0][0]).collect();
        assert_eq!(starts, [0, 1, 2]);
        assert_eq!(pieces[2].len(), 3);
    }

    #[test]
    fn a_closed_chain_begins_at_a_corner() {
        let square = nodes(&[[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        let chain = (0..5).map(|k| vec![(k + 1) % 5, (k + 2) % 5]).collect();
        let pieces = cut(chain, &square);
        let starts: Vec<usize> = pieces.iter().map(|piece| piece[0][0]).collect();
        assert_eq!(starts, [2, 3, 4, 0]);
        assert_eq!(pieces[3], [vec![0, 1], vec![1, 2]]);
    }
}
