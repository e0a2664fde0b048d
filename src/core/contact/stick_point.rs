//! Stick points, and the distance of nodes from them along the surface.
//!
//! The paper's fixed mode prevents tangential motion within a major iteration, but has no memory of the stick point. A node that
//! closes a gap g without tangential motion lands on its S*, so closing causes no drift. But a slip in one major iteration that
//! is undone in the next is a sum of steps along tangents that have rotated and stretched since. The anchor is the material point
//! of the master (surface, element, ξ) where the node stuck:
//!
//! - it is set where the node touches: where its path, straight within the major iteration, meets the surface, at S* − g ρ t (eqn
//!   14);
//! - it moves along when an increment is accepted in which the node slides (or with every major iteration, if slip is accumulated
//!   over these), and is removed when the node is free, unless the judge requires the net slip ([`crate::contact::judge`]): then
//!   the anchor of the increment's start is kept;
//! - the drift is the distance along the surface from S* to the anchor, positive if the anchor is ahead of S* along t.
//!
//! Drift has the sign of slip, u_tS* − u_tS, and is what sticking must undo (Table 1).

use crate::contact::element::closed;
use crate::contact::projection::{Projection, has_kink, project, tangent};
use crate::model::Surface;
use crate::plane::length as span;
use crate::{ElementPositions, SurfaceElement, SurfacePoint};

/// Gauss-Legendre points and weights for the length of an element; constants, because every major iteration needs them.
const POINTS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];

/// Newton steps to the point at a given distance; quadratic, from a point on the same element.
const NEWTON_STEPS: usize = 8;

/// Where a node that was free at the start of a major iteration touched: the point S* − g ρ t (eqn 14) where its straight path
/// meets the surface. `None` beyond the ends of its surface.
///
/// `positions` are the positions at the start of that major iteration, to which `projection` belongs; `ratio` is ρ.
pub fn pierced(
    surfaces: &[Surface],
    spot: SurfacePoint,
    projection: &Projection,
    ratio: f64,
    positions: &[[f64; 2]],
) -> Option<SurfacePoint> {
    if ratio == 0.0 {
        return Some(spot);
    }
    let t = tangent(projection.normal);
    let point = [0, 1].map(|k| projection.foot[k] - projection.gap * ratio * t[k]);
    project(point, surfaces, &[spot.surface], positions, Some(spot))
}

/// Distances from a surface point along −t and +t to the ends of its element, where other elements meet it at an angle (length).
/// `None` if the chain continues straight or ends there.
pub fn room(surface: &Surface, spot: SurfacePoint, positions: &[[f64; 2]]) -> [Option<f64>; 2] {
    [-1.0, 1.0].map(|xi| {
        let end = SurfacePoint { xi, ..spot };
        has_kink(surface, end, positions).then(|| distance(surface, spot, end, positions).abs())
    })
}

/// Signed distance between two points along a surface, positive along the walk; on a closed surface the shorter way round.
///
/// Both points must lie on `surface`.
pub fn distance(
    surface: &Surface,
    from: SurfacePoint,
    to: SurfacePoint,
    positions: &[[f64; 2]],
) -> f64 {
    let open = if from.element <= to.element {
        walk(surface, from, to, positions)
    } else {
        -walk(surface, to, from, positions)
    };
    if from.element == to.element || !closed(surface) {
        return open;
    }
    let whole: f64 = SurfaceElement::all(surface)
        .map(|element| length(element, -1.0, 1.0, positions))
        .sum();
    let other = open - whole.copysign(open);
    if other.abs() < open.abs() {
        other
    } else {
        open
    }
}

/// The point at a signed distance along the surface from another one; beyond an end, on the end's element continued.
pub fn ahead(
    surface: &Surface,
    from: SurfacePoint,
    by: f64,
    positions: &[[f64; 2]],
) -> SurfacePoint {
    let part = |at: SurfacePoint, xi: f64| {
        let element = SurfaceElement::from_surface(surface, at.element);
        length(element, at.xi, xi, positions)
    };
    let (mut at, mut left, count) = (from, by, surface.elements.len());
    let end = by.signum();
    // On a closed surface no distance is longer than the way round.
    for _ in 0..count {
        let rest = part(at, end);
        let next = match (at.element, end > 0.0) {
            (last, true) if last + 1 == count => closed(surface).then_some(0),
            (element, true) => Some(element + 1),
            (0, false) => closed(surface).then_some(count - 1),
            (element, false) => Some(element - 1),
        };
        match next.filter(|_| rest.abs() < left.abs() && (end - at.xi) * end >= 0.0) {
            Some(element) => {
                left -= rest;
                at = SurfacePoint {
                    element,
                    xi: -end,
                    ..at
                };
            }
            None => break,
        }
    }
    let start = at;
    for _ in 0..NEWTON_STEPS {
        let element = SurfaceElement::from_surface(surface, at.element);
        let places = ElementPositions::from_nodes(element.nodes, positions);
        let [slopes] = element.slopes_at([at.xi]);
        let speed = span(places.sum(&slopes));
        let step = (left - part(start, at.xi)) / speed;
        if !step.is_finite() {
            break;
        }
        at.xi += step;
        if step.abs() <= f64::EPSILON {
            break;
        }
    }
    at
}

/// The same as [`distance`] for `from.element <= to.element`.
fn walk(surface: &Surface, from: SurfacePoint, to: SurfacePoint, positions: &[[f64; 2]]) -> f64 {
    let part = |element: usize, from: f64, to: f64| {
        length(
            SurfaceElement::from_surface(surface, element),
            from,
            to,
            positions,
        )
    };
    if from.element == to.element {
        return part(from.element, from.xi, to.xi);
    }
    let between = from.element + 1..to.element;
    part(from.element, from.xi, 1.0)
        + between.map(|element| part(element, -1.0, 1.0)).sum::<f64>()
        + part(to.element, -1.0, to.xi)
}

/// Length of an element's curve from one ξ to another; negative if ξ decreases.
fn length(element: SurfaceElement<'_>, from: f64, to: f64, positions: &[[f64; 2]]) -> f64 {
    if from == to {
        return 0.0;
    }
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let places = ElementPositions::from_nodes(element.nodes, positions);
    let slopes = element.slopes_at(POINTS.map(|(x, _)| middle + half * x));
    let sum: f64 = slopes
        .iter()
        .map(|slopes| span(places.sum(slopes)))
        .zip(POINTS)
        .map(|(speed, (_, w))| w * speed)
        .sum();
    half * sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::projection::projection_at;

    fn surface(elements: Vec<Vec<usize>>) -> Surface {
        Surface::new("s", elements, true)
    }

    fn spot(element: usize, xi: f64) -> SurfacePoint {
        SurfacePoint {
            surface: 0,
            element,
            xi,
        }
    }

    /// Two 5-node elements on a quarter of the unit circle each, walked anticlockwise.
    fn arc() -> (Surface, Vec<[f64; 2]>) {
        let positions = (0..9)
            .map(|k| f64::from(k) * std::f64::consts::PI / 12.0)
            .map(|a| [a.cos(), a.sin()])
            .collect();
        (surface(vec![(0..5).collect(), (4..9).collect()]), positions)
    }

    #[test]
    fn the_points_are_those_of_the_gauss_rule() {
        for ((x, w), (exact_x, exact_w)) in POINTS.iter().zip(crate::fem::lagrange::gauss(5)) {
            assert!((x - exact_x).abs() < 1e-15 && (w - exact_w).abs() < 1e-15);
        }
    }

    #[test]
    fn distances_are_lengths_of_the_curve_also_across_element_borders() {
        let (s, x) = arc();
        for (from, to, angle) in [
            (spot(0, -1.0), spot(0, 1.0), 60.0),
            (spot(0, 0.0), spot(1, 0.5), 75.0),
            (spot(1, 0.5), spot(0, 0.0), -75.0),
            (spot(0, 1.0), spot(1, -1.0), 0.0),
        ] {
            let exact = f64::to_radians(angle);
            let found = distance(&s, from, to, &x);
            // The 5-node element approximates the circle to 1e-4.
            assert!((found - exact).abs() < 1e-4, "{found} {exact}");
        }
        assert_eq!(distance(&s, spot(1, 0.3), spot(1, 0.3), &x), 0.0);
    }

    #[test]
    fn round_a_closed_surface_the_shorter_way_counts() {
        // A square of side 1, walked anticlockwise.
        let x = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let s = surface(vec![vec![0, 1], vec![1, 2], vec![2, 3], vec![3, 0]]);
        let there = distance(&s, spot(0, 0.0), spot(3, 0.0), &x);
        assert!((there + 1.0).abs() < 1e-15, "{there}");
        let back = distance(&s, spot(3, 0.0), spot(0, 0.0), &x);
        assert!((back - 1.0).abs() < 1e-15, "{back}");
    }

    #[test]
    fn the_point_at_a_distance_lies_at_that_distance() {
        let (s, x) = arc();
        let cases = [
            (spot(0, -0.4), 0.3),
            (spot(0, 0.2), 0.9),
            (spot(1, 0.1), -0.8),
            (spot(1, -1.0), 0.0),
        ];
        for (from, by) in cases {
            let there = ahead(&s, from, by, &x);
            assert!(there.xi.abs() <= 1.0, "{there:?}");
            let found = distance(&s, from, there, &x);
            assert!((found - by).abs() < 1e-12, "{found} {by}");
        }
        let whole = distance(&s, spot(0, -1.0), spot(1, 1.0), &x);
        let beyond = ahead(&s, spot(0, -1.0), whole + 0.01, &x);
        assert!(beyond.element == 1 && beyond.xi > 1.0, "{beyond:?}");

        let x = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let s = surface(vec![vec![0, 1], vec![1, 2], vec![2, 3], vec![3, 0]]);
        assert_eq!(ahead(&s, spot(3, 0.5), 0.5, &x), spot(0, -0.5));
        assert_eq!(ahead(&s, spot(0, -0.5), -0.5, &x), spot(3, 0.5));
    }

    #[test]
    fn a_node_touches_where_its_straight_path_meets_the_surface() {
        let x = [[3.0, 0.0], [-1.0, 0.0]];
        let s = [surface(vec![vec![0, 1]])];
        // From (0, 0.5), one to the right for every one down: meets the floor at (0.5, 0).
        let slave = [0.0, 0.5];
        let start = project(slave, &s, &[0], &x, None).unwrap();
        let at = projection_at(&s, start, &x, slave);
        // Travel of S* relative to S along t (towards −x) and n (up): (−1, −1) · step has both reversed.
        let (normal, tangential) = (1.0, 1.0);
        let touched = pierced(&s, start, &at, tangential / normal, &x).unwrap();
        let d = distance(&s[0], touched, start, &x);
        assert!((d - 0.5).abs() < 1e-14, "{d}");
    }
}
