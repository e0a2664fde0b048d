//! A smooth curve through all nodes of a master chain, so that its normal does not jump between two elements.
//!
//! Between the nodes b and c the curve is the cubic with their places and slopes at its ends (Hermite). The slope at a node
//! is that of the parabola through it and its two neighbours (Catmull & Rom 1974 for even distances; Overhauser 1968). With
//! knots s, the way along the straight chords from node to node before anything deforms, and h = s_c − s_b,
//!
//! ```text
//! x(t) = h00(t) x_b + h10(t) h x'_b + h01(t) x_c + h11(t) h x'_c            t = (s − s_b)/h = (1 + ξ)/2
//! x'_b = h/(k+h) (x_b − x_a)/k + k/(k+h) (x_c − x_b)/h                       k = s_b − s_a
//! h00 = 2t³ − 3t² + 1    h10 = t³ − 2t² + t    h01 = 3t² − 2t³    h11 = t³ − t²
//! ```
//!
//! Around a closed chain that goes on for ever. At an end of an open one the slope is that of the parabola through the last
//! three nodes, which the last piece then is; a chain of two nodes is straight.
//!
//! The knots never change, so a place on the curve is a fixed weighted mean of the places of up to four nodes, Σ N_i x_i with
//! Σ N_i = 1: the curve turns and moves with its nodes, all that holds for an element with shape functions holds for a
//! piece, and a force at its foot is spread over the four so that force and moment are kept. x' is continuous and x'' jumps
//! at the nodes. Of a smooth curve through the nodes the distance is O(h³), and of a circle with evenly spaced
//! nodes 3h⁴/128 radii, with h the angle between two.
//!
//! The curve knows no corners: it is rounded where the chain turns sharply. A real corner wants two surfaces.

use crate::fem::lagrange::{MAX_NODES, Shape};
use crate::model::{Node, Piece, STENCIL, Surface};

/// Makes the chain of a surface smooth: its elements are then the pieces from node to node. The chain's elements must follow
/// each other, with distinct nodes, three or more of them if it is closed.
pub fn smooth(surface: &mut Surface, nodes: &[Node]) {
    let chain = walk(&surface.elements);
    let closed = chain.len() > 2 && chain.first() == chain.last();
    let count = chain.len().saturating_sub(1);
    let (elements, pieces) = (0..count).map(|k| piece(&chain, closed, k, nodes)).unzip();
    (surface.elements, surface.smooth) = (elements, pieces);
}

/// The nodes of a chain in walking order; the first of a closed one comes again at the end.
fn walk(elements: &[Vec<usize>]) -> Vec<usize> {
    let mut chain: Vec<usize> = elements.iter().flatten().copied().collect();
    chain.dedup();
    chain
}

/// Piece k of a chain, with the nodes that it depends on.
fn piece(chain: &[usize], closed: bool, k: usize, nodes: &[Node]) -> (Vec<usize>, Piece) {
    let count = chain.len() - 1;
    let before = match k {
        0 if closed => Some(chain[count - 1]),
        0 => None,
        _ => Some(chain[k - 1]),
    };
    let behind = match chain.get(k + 2) {
        None if closed => Some(chain[1]),
        behind => behind.copied(),
    };
    let (b, c) = (chain[k], chain[k + 1]);
    let chord = |one: usize, other: usize| {
        let ([x, y], [u, v]) = (nodes[one].at, nodes[other].at);
        (u - x).hypot(v - y)
    };
    let h = chord(b, c);
    let first = usize::from(before.is_some());
    // Slopes times h, as shares of (the node before, b, c) and of (b, c, the node behind).
    let early = before.map(|a| {
        let k = chord(a, b);
        let (share, own) = (h / (k + h) * (h / k), k / (k + h));
        [-share, share - own, own]
    });
    let late = behind.map(|d| {
        let l = chord(c, d);
        let (own, share) = (l / (l + h), h / (l + h) * (h / l));
        [-own, own - share, share]
    });
    let mut slopes = [[0.0; STENCIL]; 2];
    let mut add = |end: usize, from: usize, shares: [f64; 3]| {
        for (slope, share) in slopes[end][from..].iter_mut().zip(shares) {
            *slope += share;
        }
    };
    // Where a parabola is missing, the slope at that end is that of the other one there: twice the chord less its slope at
    // the end between them.
    let other = |[x, y, z]: [f64; 3], chord: [f64; 3]| {
        [2.0 * chord[0] - x, 2.0 * chord[1] - y, 2.0 * chord[2] - z]
    };
    match (early, late) {
        (Some(early), Some(late)) => {
            add(0, 0, early);
            add(1, 1, late);
        }
        (Some(early), None) => {
            add(0, 0, early);
            add(1, 0, other(early, [0.0, -1.0, 1.0]));
        }
        (None, Some(late)) => {
            add(0, 0, other(late, [-1.0, 1.0, 0.0]));
            add(1, 0, late);
        }
        (None, None) => (0..2).for_each(|end| add(end, 0, [-1.0, 1.0, 0.0])),
    }
    let mut stencil: Vec<usize> = [before, Some(b), Some(c), behind]
        .into_iter()
        .flatten()
        .collect();
    // Around a triangle, the node before is the one behind.
    if before.is_some() && before == behind {
        stencil.pop();
        for slope in &mut slopes {
            slope[0] += std::mem::take(&mut slope[STENCIL - 1]);
        }
    }
    (stencil, Piece { first, slopes })
}

/// The functions N_i of a piece at ξ, with two derivatives by ξ.
pub fn shape(piece: &Piece, xi: f64) -> Shape {
    let t = 0.5 * (1.0 + xi);
    let (n, d, dd) = (
        hermite(
            [
                t * t * (2.0 * t - 3.0) + 1.0,
                t * ((t - 2.0) * t + 1.0),
                t * t * (3.0 - 2.0 * t),
                t * t * (t - 1.0),
            ],
            piece,
        ),
        hermite(
            [
                6.0 * t * (t - 1.0),
                (3.0 * t - 4.0) * t + 1.0,
                6.0 * t * (1.0 - t),
                t * (3.0 * t - 2.0),
            ],
            piece,
        ),
        hermite(
            [12.0 * t - 6.0, 6.0 * t - 4.0, 6.0 - 12.0 * t, 6.0 * t - 2.0],
            piece,
        ),
    );
    // dt/dξ = 1/2.
    Shape {
        n,
        d: d.map(|d| 0.5 * d),
        dd: dd.map(|dd| 0.25 * dd),
    }
}

/// The share of each node in a sum of place and slope at the beginning, and place and slope at the end.
fn hermite([b, slope_b, c, slope_c]: [f64; 4], piece: &Piece) -> [f64; MAX_NODES] {
    let mut shares = [0.0; MAX_NODES];
    for (k, share) in shares.iter_mut().enumerate().take(STENCIL) {
        *share = slope_b * piece.slopes[0][k] + slope_c * piece.slopes[1][k];
    }
    shares[piece.first] += b;
    shares[piece.first + 1] += c;
    shares
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::element::{Element, closed};
    use crate::contact::projection::{project, projection_at, tangent};

    /// A smooth chain of elements of two nodes through these places.
    fn chain(places: &[[f64; 2]], round: bool) -> Surface {
        let nodes: Vec<Node> = places
            .iter()
            .map(|&at| Node {
                name: String::new(),
                at,
            })
            .collect();
        let count = places.len();
        let mut elements: Vec<Vec<usize>> = (1..count).map(|k| vec![k - 1, k]).collect();
        if round {
            elements.push(vec![count - 1, 0]);
        }
        let mut surface = Surface {
            name: "s".into(),
            elements,
            rigid: false,
            endless: false,
            smooth: Vec::new(),
        };
        smooth(&mut surface, &nodes);
        surface
    }

    fn sum(element: Element<'_>, shares: &[f64], places: &[[f64; 2]]) -> [f64; 2] {
        [0, 1].map(|axis| {
            let parts = element.nodes.iter().zip(shares);
            parts.map(|(&n, share)| share * places[n][axis]).sum()
        })
    }

    fn uneven() -> Vec<[f64; 2]> {
        vec![
            [2.0, 0.1],
            [1.4, 0.5],
            [1.2, 0.45],
            [0.3, 0.9],
            [-0.1, 0.6],
            [-0.7, 0.8],
        ]
    }

    /// `count` nodes around the unit circle, or along this part of it, anticlockwise.
    fn circle(count: usize, part: f64) -> Vec<[f64; 2]> {
        let whole = part * std::f64::consts::TAU / count as f64;
        (0..count)
            .map(|k| (k as f64 * whole).sin_cos())
            .map(|(s, c)| [c, s])
            .collect()
    }

    #[test]
    fn a_piece_is_the_blend_of_the_parabolas_through_its_ends_and_the_node_before_and_behind() {
        let x = uneven();
        let surface = chain(&x, false);
        let mut knots = vec![0.0];
        for pair in x.windows(2) {
            let ([a, b], [c, d]) = (pair[0], pair[1]);
            knots.push(knots[knots.len() - 1] + (c - a).hypot(d - b));
        }
        // Lagrange's parabola through the nodes k, k + 1 and k + 2, moved inside the chain at its ends.
        let parabola = |k: isize, s: f64| {
            let k = k.clamp(0, x.len() as isize - 3) as usize;
            [0, 1].map(|axis| {
                let part = |i: usize| {
                    let others = (k..k + 3).filter(|&j| j != i);
                    let product: f64 = others
                        .map(|j| (s - knots[j]) / (knots[i] - knots[j]))
                        .product();
                    product * x[i][axis]
                };
                (k..k + 3).map(part).sum::<f64>()
            })
        };
        for (k, element) in Element::all(&surface).enumerate() {
            for t in [0.0, 0.21, 0.5, 0.9, 1.0] {
                let s = knots[k] + t * (knots[k + 1] - knots[k]);
                let (before, behind) = (parabola(k as isize - 1, s), parabola(k as isize, s));
                let found = sum(element, &element.shape(2.0 * t - 1.0).n, &x);
                for axis in 0..2 {
                    let exact = (1.0 - t) * before[axis] + t * behind[axis];
                    assert!((found[axis] - exact).abs() < 1e-14, "{k} {t}");
                }
            }
        }
    }

    #[test]
    fn the_shares_of_the_nodes_add_up_to_one_and_have_the_derivatives_that_they_say() {
        for (places, round) in [(uneven(), false), (uneven(), true), (circle(3, 1.0), true)] {
            let surface = chain(&places, round);
            assert_eq!(closed(&surface), round);
            for element in Element::all(&surface) {
                for xi in [-1.0, -0.3, 0.2, 1.0] {
                    let (s, h) = (element.shape(xi), 1e-5);
                    assert!((s.n.iter().sum::<f64>() - 1.0).abs() < 1e-15);
                    assert!(s.d.iter().sum::<f64>().abs() < 1e-14);
                    let (plus, minus) = (element.shape(xi + h), element.shape(xi - h));
                    for i in 0..MAX_NODES {
                        let d = (plus.n[i] - minus.n[i]) / (2.0 * h);
                        let dd = (plus.d[i] - minus.d[i]) / (2.0 * h);
                        assert!((d - s.d[i]).abs() < 1e-9 && (dd - s.dd[i]).abs() < 1e-9);
                    }
                }
            }
        }
    }

    #[test]
    fn the_normal_does_not_jump_at_a_node_however_the_chain_is_bent_since() {
        for round in [false, true] {
            let surface = chain(&uneven(), round);
            // Not the places that the knots are from.
            let bent: Vec<[f64; 2]> = uneven()
                .iter()
                .map(|[x, y]| [1.3 * x - 0.2 * y * y, y + 0.1 * x * x])
                .collect();
            let count = surface.elements.len();
            for k in 0..count - usize::from(!round) {
                let (one, next) = (
                    Element::of(&surface, k),
                    Element::of(&surface, (k + 1) % count),
                );
                assert_eq!(one.last(), next.first());
                let before = sum(one, &one.shape(1.0).d, &bent);
                let behind = sum(next, &next.shape(-1.0).d, &bent);
                let turn = before[0] * behind[1] - before[1] * behind[0];
                let size = before[0].hypot(before[1]) * behind[0].hypot(behind[1]);
                assert!(turn.abs() < 1e-14 * size, "{k}: {turn}");
            }
        }
    }

    #[test]
    fn the_gap_to_a_circle_is_wrong_by_the_fourth_power_of_the_distance_of_nodes_and_the_normal_by_the_third()
     {
        let error = |count: usize| {
            let x = circle(count, 1.0);
            let s = [chain(&x, true)];
            let (mut gap, mut turn) = (0.0_f64, 0.0_f64);
            for k in 0..200 {
                let (sin, cos) = (0.031 * f64::from(k)).sin_cos();
                let slave = [1.1 * cos, 1.1 * sin];
                let spot = project(slave, &s, &[0], &x, None).unwrap();
                let over = projection_at(&s, spot, &x, slave);
                gap = gap.max((over.gap - 0.1).abs());
                turn = turn.max((over.normal[0] * sin - over.normal[1] * cos).abs());
            }
            (gap, turn)
        };
        let errors = [16, 32, 64].map(error);
        for pair in errors.windows(2) {
            let (gap, turn) = (pair[0].0 / pair[1].0, pair[0].1 / pair[1].1);
            assert!((gap.log2() - 4.0).abs() < 0.1, "{errors:?}");
            assert!((turn.log2() - 3.0).abs() < 0.1, "{errors:?}");
        }
        // In the middle of a piece of the angle h the radius is cos(h/2) + sin h sin(h/2)/4 = 1 − 3 h⁴/128 + …
        let h = std::f64::consts::TAU / 64.0;
        let exact = 1.0 - (0.5 * h).cos() - 0.25 * h.sin() * (0.5 * h).sin();
        assert!(
            (errors[2].0 / exact - 1.0).abs() < 0.01,
            "{errors:?} {exact}"
        );
        assert!((exact / (3.0 * h.powi(4) / 128.0) - 1.0).abs() < 0.01);
    }

    #[test]
    fn a_force_at_the_foot_is_spread_over_the_nodes_with_its_moment() {
        let x = uneven();
        let s = [chain(&x, false)];
        let force = [0.7, -1.9];
        for slave in [[1.8, 0.6], [1.25, 0.7], [0.7, 0.9], [-0.3, 0.9]] {
            let spot = project(slave, &s, &[0], &x, None).unwrap();
            let over = projection_at(&s, spot, &x, slave);
            let (mut total, mut moment) = ([0.0; 2], 0.0);
            for (&n, share) in s[0].elements[spot.element].iter().zip(over.shape) {
                let arm = [x[n][0] - over.foot[0], x[n][1] - over.foot[1]];
                total = [0, 1].map(|k| total[k] + share * force[k]);
                moment += share * (arm[0] * force[1] - arm[1] * force[0]);
            }
            assert!((total[0] - force[0]).abs() < 1e-14 && (total[1] - force[1]).abs() < 1e-14);
            assert!(moment.abs() < 1e-14, "{moment}");
        }
    }

    #[test]
    fn the_curve_turns_with_its_nodes() {
        let x = uneven();
        let s = [chain(&x, false)];
        let (sin, cos) = 0.83_f64.sin_cos();
        let turn = |[x, y]: [f64; 2]| [cos * x - sin * y + 3.0, sin * x + cos * y - 1.0];
        let turned: Vec<[f64; 2]> = x.iter().map(|&x| turn(x)).collect();
        for slave in [[1.8, 0.6], [1.2, 0.5], [0.7, 0.9], [-0.3, 0.9]] {
            let at = |slave: [f64; 2], x: &[[f64; 2]]| {
                let spot = project(slave, &s, &[0], x, None).unwrap();
                (spot, projection_at(&s, spot, x, slave))
            };
            let ((spot, here), (there_spot, there)) = (at(slave, &x), at(turn(slave), &turned));
            assert_eq!(spot.element, there_spot.element);
            assert!((spot.xi - there_spot.xi).abs() < 1e-13);
            assert!((here.gap - there.gap).abs() < 1e-14);
            let [n, m] = [here.normal, there.normal];
            assert!((cos * n[0] - sin * n[1] - m[0]).abs() < 1e-13);
            let (t, u) = (tangent(n), tangent(m));
            assert!((sin * t[0] + cos * t[1] - u[1]).abs() < 1e-13);
        }
    }
}
