//! Tests of smooth chains: positions, slopes and normals, the distance from a circle, and the distribution of a force.

use crate::SurfaceElement;
use crate::contact::element::closed;
use crate::contact::projection::{project, projection_at, tangent};
use crate::contact::smooth::smooth;
use crate::fem::lagrange::MAX_NODES;
use crate::model::{Node, Surface};

/// A smooth chain of 2-node elements through these points.
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
    let mut surface = Surface::new("s", elements, false);
    smooth(&mut surface, &nodes);
    surface
}

fn sum(element: SurfaceElement<'_>, shares: &[f64], places: &[[f64; 2]]) -> [f64; 2] {
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

/// `count` nodes around the unit circle, or on this fraction of it, anticlockwise.
fn circle(count: usize, part: f64) -> Vec<[f64; 2]> {
    let whole = part * std::f64::consts::TAU / count as f64;
    (0..count)
        .map(|k| (k as f64 * whole).sin_cos())
        .map(|(s, c)| [c, s])
        .collect()
}

#[test]
fn a_piece_blends_the_parabolas_through_its_ends_and_one_neighbour() {
    let x = uneven();
    let surface = chain(&x, false);
    let mut knots = vec![0.0];
    for pair in x.windows(2) {
        let ([a, b], [c, d]) = (pair[0], pair[1]);
        knots.push(knots[knots.len() - 1] + (c - a).hypot(d - b));
    }
    // Lagrange's parabola through the nodes k, k + 1 and k + 2; at the ends of the chain, shifted inside.
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
    for (k, element) in SurfaceElement::all(&surface).enumerate() {
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
fn node_weights_sum_to_one_and_their_derivatives_are_correct() {
    for (places, round) in [(uneven(), false), (uneven(), true), (circle(3, 1.0), true)] {
        let surface = chain(&places, round);
        assert_eq!(closed(&surface), round);
        for element in SurfaceElement::all(&surface) {
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
fn the_normal_is_continuous_at_nodes_of_a_deformed_chain() {
    for round in [false, true] {
        let surface = chain(&uneven(), round);
        // Not the positions that define the knots.
        let bent: Vec<[f64; 2]> = uneven()
            .iter()
            .map(|[x, y]| [1.3 * x - 0.2 * y * y, y + 0.1 * x * x])
            .collect();
        let count = surface.elements.len();
        for k in 0..count - usize::from(!round) {
            let (one, next) = (
                SurfaceElement::from_surface(&surface, k),
                SurfaceElement::from_surface(&surface, (k + 1) % count),
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
fn on_a_circle_the_gap_error_is_fourth_order_and_the_normal_error_third_order() {
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
    // In the middle of a piece with the angle h the radius is cos(h/2) + sin h sin(h/2)/4 = 1 − 3 h⁴/128 + …
    let h = std::f64::consts::TAU / 64.0;
    let exact = 1.0 - (0.5 * h).cos() - 0.25 * h.sin() * (0.5 * h).sin();
    assert!(
        (errors[2].0 / exact - 1.0).abs() < 0.01,
        "{errors:?} {exact}"
    );
    assert!((exact / (3.0 * h.powi(4) / 128.0) - 1.0).abs() < 0.01);
}

#[test]
fn a_contact_force_is_distributed_over_the_nodes_with_its_moment() {
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
fn the_curve_rotates_with_its_nodes() {
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
