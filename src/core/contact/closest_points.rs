//! Finds all points of a chain that are locally closest to a given point, by a complete search.
//!
//! [`super::projection`] tracks one S* between iterations, starting from the previous one. Checking a state must not depend on
//! history, so here every element is searched. With the curve x(ξ) and the point p, the derivative of half the squared distance,
//! (x − p) · x', changes sign from minus to plus at a closest point inside an element.

use crate::contact::projection::{Bounds, blend};
use crate::fem::lagrange::{MAX_NODES, Shape, node, shape};
use crate::model::Surface;
use crate::plane::{dot, length, minus, unit};
use crate::{ElementPositions, SurfaceElement, SurfacePoint};
use std::sync::LazyLock;

/// Number of search intervals per degree of a curved element.
const INTERVALS: usize = 2;
/// Maximum number of steps to a root; bisection alone reaches adjacent floating-point numbers in this many steps.
const STEPS: u32 = 60;

/// ξ, shape functions and their derivatives at the ends of the search intervals of an element with m nodes; indexed by m.
static GRID: LazyLock<Vec<Vec<(f64, Shape)>>> = LazyLock::new(|| {
    let of = |m: usize| {
        let at = |k: usize| node(intervals(m - 1) + 1, k);
        (0..=intervals(m - 1))
            .map(|k| (at(k), shape(m, at(k))))
            .collect()
    };
    (0..=MAX_NODES)
        .map(|m| if m < 2 { Vec::new() } else { of(m) })
        .collect()
});

/// Number of search intervals for an element whose curve has this degree.
fn intervals(degree: usize) -> usize {
    if degree == 1 { 1 } else { INTERVALS * degree }
}

/// Initialises the table for the searches, so that the first search does not allocate.
pub fn prepare() {
    LazyLock::force(&GRID);
}

/// A point of a surface that is closer than its neighbours on the same element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosestPoint {
    /// Surface point.
    pub spot: SurfacePoint,
    /// Its position.
    pub at: [f64; 2],
    /// Its distance (length, not negative).
    pub distance: f64,
}

/// Fills `feet` with all closest points of the surfaces `candidates` whose distance from `point` exceeds the smallest by at
/// most `slack` (length), the closest first. A border between two elements is listed for each of them.
pub fn find(
    point: [f64; 2],
    surfaces: &[Surface],
    candidates: &[usize],
    positions: &[[f64; 2]],
    slack: f64,
    feet: &mut Vec<ClosestPoint>,
) {
    feet.clear();
    // Nodes lie on the curves, so none is closer than the closest point, and few elements reach that far.
    let reach = candidates
        .iter()
        .map(|&surface| &surfaces[surface])
        .filter(|chain| !chain.endless)
        .flat_map(|chain| chain.nodes())
        .map(|&n| squared(minus(point, positions[n])))
        .fold(f64::INFINITY, f64::min)
        .sqrt()
        + slack;
    let mut least = f64::INFINITY;
    for &surface in candidates {
        let chain = &surfaces[surface];
        for (element, curve) in SurfaceElement::all(chain).enumerate() {
            let reach = reach.min(least + slack);
            let bounds = Bounds::new(curve.nodes, positions);
            if !chain.endless && bounds.lies_beyond(curve, point, reach) {
                continue;
            }
            let mut found = |xi: f64| {
                let at = place(curve, positions, xi);
                let distance = length(minus(point, at));
                if distance <= least + slack {
                    least = least.min(distance);
                    let spot = SurfacePoint {
                        surface,
                        element,
                        xi,
                    };
                    feet.push(ClosestPoint { spot, at, distance });
                }
            };
            if chain.endless {
                found(on_line(curve, positions, point));
            } else {
                minima(curve, positions, point, &mut found);
            }
        }
    }
    feet.retain(|foot| foot.distance <= least + slack);
    feet.sort_by(|a, b| a.distance.total_cmp(&b.distance));
}

/// Calls a function for every local minimum of the distance on an element.
fn minima(
    element: SurfaceElement<'_>,
    positions: &[[f64; 2]],
    point: [f64; 2],
    found: &mut impl FnMut(f64),
) {
    let (places, count) = (
        ElementPositions::from_nodes(element.nodes, positions),
        intervals(element.degree()),
    );
    let at = |k: usize| {
        if !element.is_plain() {
            let xi = node(count + 1, k);
            return (xi, slope(&places, point, &element.shape(xi)));
        }
        let (xi, s) = &GRID[element.nodes.len()][k];
        (*xi, slope(&places, point, s))
    };
    let mut left = at(0);
    if left.1 >= 0.0 {
        found(-1.0);
    }
    for k in 1..=count {
        let right = at(k);
        let at_end = k == count && right.1 == 0.0;
        if left.1 < 0.0 && right.1 >= 0.0 && !at_end {
            found(root(element, &places, point, [left, right]));
        }
        left = right;
    }
    if left.1 <= 0.0 {
        found(1.0);
    }
}

/// The root of (x − p) · x' between two ξ, given with their values, where the sign changes from minus to plus: Newton's method,
/// with bisection if a step leaves the interval.
fn root(
    element: SurfaceElement<'_>,
    places: &ElementPositions,
    point: [f64; 2],
    [(mut low, below), (mut high, above)]: [(f64, f64); 2],
) -> f64 {
    // The values are known, so the secant gives a good start.
    let mut xi = low - below * (high - low) / (above - below);
    for _ in 0..STEPS {
        let s = element.shape(xi);
        let value = slope(places, point, &s);
        let newton = xi - value / rise(places, point, &s);
        if (newton - xi).abs() <= f64::EPSILON {
            return newton.clamp(low, high);
        }
        if value < 0.0 {
            low = xi;
        } else {
            high = xi;
        }
        xi = if newton > low && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
    }
    xi
}

/// (x − p) · x' for these shape functions.
fn slope(places: &ElementPositions, point: [f64; 2], s: &Shape) -> f64 {
    let to = places.sum_from([-point[0], -point[1]], &s.n);
    let d = places.sum(&s.d);
    dot(to, d)
}

/// Its derivative with respect to ξ.
fn rise(places: &ElementPositions, point: [f64; 2], s: &Shape) -> f64 {
    let (x, d, dd) = (places.sum(&s.n), places.sum(&s.d), places.sum(&s.dd));
    squared(d) + (x[0] - point[0]) * dd[0] + (x[1] - point[1]) * dd[1]
}

/// ξ of the projection on the infinite straight line through an element's ends.
fn on_line(element: SurfaceElement<'_>, positions: &[[f64; 2]], point: [f64; 2]) -> f64 {
    let [start, end] = [-1.0, 1.0].map(|xi| place(element, positions, xi));
    let along = minus(end, start);
    let to = minus(point, start);
    2.0 * dot(to, along) / squared(along).max(f64::MIN_POSITIVE) - 1.0
}

/// Position of a point of an element.
pub fn place(element: SurfaceElement<'_>, positions: &[[f64; 2]], xi: f64) -> [f64; 2] {
    blend(element.nodes, positions, &element.shape(xi).n)
}

/// Unit tangent along the walk at a point of an element. `None` where dx/dξ = 0.
pub fn direction(element: SurfaceElement<'_>, positions: &[[f64; 2]], xi: f64) -> Option<[f64; 2]> {
    unit(blend(element.nodes, positions, &element.slopes(xi)))
}

fn squared(v: [f64; 2]) -> f64 {
    dot(v, v)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chain(elements: Vec<Vec<usize>>, endless: bool) -> Vec<Surface> {
        vec![Surface {
            name: "s".into(),
            elements,
            rigid: true,
            endless,
            past_ends: [0.0; 2],
            smooth: Vec::new(),
            gives: Vec::new(),
        }]
    }

    fn all(
        point: [f64; 2],
        surfaces: &[Surface],
        positions: &[[f64; 2]],
        slack: f64,
    ) -> Vec<ClosestPoint> {
        let mut feet = Vec::new();
        find(point, surfaces, &[0], positions, slack, &mut feet);
        feet
    }

    #[test]
    fn a_point_in_a_valley_has_a_closest_point_on_each_side() {
        let valley = chain(vec![vec![0, 1], vec![1, 2]], false);
        let x = [[1.0, 1.0], [0.0, 0.0], [-1.0, 1.0]];
        let feet = all([0.1, 0.5], &valley, &x, 1.0);
        assert_eq!(feet.len(), 2);
        assert_eq!((feet[0].spot.element, feet[1].spot.element), (0, 1));
        assert!((feet[0].distance - 0.4 / 2f64.sqrt()).abs() < 1e-15);
        assert!((feet[1].distance - 0.6 / 2f64.sqrt()).abs() < 1e-15);
        let nearest = all([0.1, 0.5], &valley, &x, 0.0);
        assert_eq!(nearest, feet[..1]);
    }

    #[test]
    fn a_point_over_a_ridge_has_its_closest_point_on_the_border() {
        let ridge = chain(vec![vec![0, 1], vec![1, 2]], false);
        let x = [[1.0, -1.0], [0.0, 0.0], [-1.0, -1.0]];
        let feet = all([0.0, 0.5], &ridge, &x, 0.0);
        let spots: Vec<_> = feet.iter().map(|f| (f.spot.element, f.spot.xi)).collect();
        assert_eq!(spots, [(0, 1.0), (1, -1.0)]);
        assert_eq!(feet[0].at, [0.0, 0.0]);
    }

    #[test]
    fn all_closest_points_of_a_curved_element_are_found() {
        let m = 5;
        let x: Vec<[f64; 2]> = (0..m)
            .map(|k| f64::from(k) * std::f64::consts::FRAC_PI_4)
            .map(|a| [a.cos(), a.sin()])
            .collect();
        let half_circle = chain(vec![(0..5).collect()], false);
        // Below the middle both ends are closest, and the top is the furthest.
        let feet = all([0.0, -0.5], &half_circle, &x, 2.0);
        let xis: Vec<f64> = feet.iter().map(|f| f.spot.xi).collect();
        assert!(
            xis.contains(&-1.0) && xis.contains(&1.0) && xis.len() == 2,
            "{xis:?}"
        );
        let above = all([0.3, 1.2], &half_circle, &x, 0.0);
        let exact = place(
            SurfaceElement::from_surface(&half_circle[0], 0),
            &x,
            above[0].spot.xi,
        );
        assert!((above[0].distance - (1.2_f64.hypot(0.3) - 1.0)).abs() < 2e-3);
        assert_eq!(above[0].at, exact);
    }

    #[test]
    fn an_endless_line_has_one_closest_point_beyond_its_ends_too() {
        let line = chain(vec![vec![0, 1]], true);
        let feet = all([40.0, 3.0], &line, &[[1.0, 0.0], [0.0, 0.0]], 0.0);
        assert_eq!(
            (feet.len(), feet[0].at, feet[0].distance),
            (1, [40.0, 0.0], 3.0)
        );
    }
}
