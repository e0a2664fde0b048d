//! Projection of a slave node on the chains of interface elements that it may touch (Fig. 2).
//!
//! S* is the closest point of all candidate elements. At the common node of two elements that meet at an angle, the normal is the
//! mean of both; the pieces of a smooth chain ([`super::smooth`]) do not meet at an angle. Beyond an end of a chain there is no
//! contact. Frame: the outward normal n is on the right of the walk along the chain, and t is n turned 90 degrees anticlockwise,
//! so t points along the walk. The gap is (x_S − x_S*) · n; negative is penetration.

use crate::fem::lagrange::MAX_NODES;
use crate::model::Surface;
use crate::plane::{cross, dot, length, minus, plus, unit};
use crate::{ElementPositions, SurfaceElement};

/// Distance beyond an end of a chain at which a node still counts as over it, relative to the last element's length.
const END_TOLERANCE: f64 = 1e-9;
/// Minimum difference in distance for a node to change its element, relative to the element's length.
const STAY_TOLERANCE: f64 = 1e-12;
/// Relative difference below which two distances are equal up to round-off.
const NEARLY: f64 = 1e-9;
/// Depth below a vertex, relative to the element's length, from which the direction to the node is known.
const DEEP: f64 = 1e-9;
/// Radius of a vertex, relative to the distance of the node that turns around it.
const VERTEX: f64 = 1e-9;
/// Coordinates ξ closer than this belong to the same closest point: their distances differ only by round-off.
const NEXT_TO: f64 = 1e-6;

/// A point of a chain of interface elements.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SurfacePoint {
    /// Number of the surface in the scene.
    pub surface: usize,
    /// Number of the element in the surface.
    pub element: usize,
    /// Coordinate ξ in the element, −1 to 1; unbounded on an endless line.
    pub xi: f64,
}

/// Geometry at a projection, frozen during a major iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projection {
    /// Position of S*.
    pub foot: [f64; 2],
    /// Outward normal n (unit).
    pub normal: [f64; 2],
    /// Gap g = (x_S − x_S*) · n (length); negative is penetration.
    pub gap: f64,
    /// Shape functions N_i of the master element at S*; entries beyond its nodes are zero.
    pub shape: [f64; MAX_NODES],
    /// dN_i/dξ there.
    pub shape_slope: [f64; MAX_NODES],
    /// Derivatives of the element's curve. `None` if S* is at an end of the element, unless a smooth chain continues there.
    pub curve: Option<Curve>,
}

impl Projection {
    /// The same point with another normal (unit): that of a corner in which a slave node at `slave` is held.
    pub fn along(self, normal: [f64; 2], slave: [f64; 2]) -> Self {
        let to = minus(slave, self.foot);
        Projection {
            normal,
            gap: dot(to, normal),
            curve: None,
            ..self
        }
    }
}

impl Projection {
    /// The same point, a vertex of the chain, for a slave node at `slave` that turns around it: the vertex acts like an arc with a
    /// negligible radius.
    fn around(self, slave: [f64; 2]) -> Projection {
        let to = minus(slave, self.foot);
        let away = length(to) * self.gap.signum();
        let radius = VERTEX * length(to);
        let normal = to.map(|part| part / away);
        Projection {
            normal,
            gap: away,
            shape_slope: [0.0; MAX_NODES],
            curve: Some(Curve {
                slope: tangent(normal).map(|t| radius * t),
                bend: normal.map(|n| -radius * n * away.signum()),
            }),
            ..self
        }
    }

    /// √m / (m − g k) (1 / length), with m and k of [`crate::contact::geometric_tangent`]. `None` at an end of the element.
    pub fn lever(&self) -> Option<f64> {
        let Curve { slope, bend } = self.curve?;
        let m = dot(slope, slope);
        let k = dot(bend, self.normal);
        Some(m.sqrt() / (m - self.gap * k))
    }
}

/// Derivatives of the master element's curve at S*.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curve {
    /// dx/dξ.
    pub slope: [f64; 2],
    /// d²x/dξ².
    pub bend: [f64; 2],
}

/// n turned 90 degrees anticlockwise.
pub fn tangent(normal: [f64; 2]) -> [f64; 2] {
    [-normal[1], normal[0]]
}

/// Finds S* for a slave node at `slave` among the surfaces `candidates`.
///
/// `positions` are the current positions of the scene's nodes. `previous` is the last surface point of the node; the node stays
/// on its element unless another one is closer by more than round-off. `None` beyond the ends of all surfaces.
pub fn project(
    slave: [f64; 2],
    surfaces: &[Surface],
    candidates: &[usize],
    positions: &[[f64; 2]],
    previous: Option<SurfacePoint>,
) -> Option<SurfacePoint> {
    let spot = closest_point(slave, surfaces, candidates, positions, previous)?;
    (!past_end(&surfaces[spot.surface], spot, positions, slave)).then_some(spot)
}

/// Like [`project`], but accepts the end of a chain as S* if the node lies beyond it.
pub fn closest_point(
    slave: [f64; 2],
    surfaces: &[Surface],
    candidates: &[usize],
    positions: &[[f64; 2]],
    previous: Option<SurfacePoint>,
) -> Option<SurfacePoint> {
    let mut best: Option<ClosestCandidate> = None;
    if let Some(spot) = previous {
        consider(slave, surfaces, positions, spot, true, &mut best);
    }
    let reach = match previous {
        Some(_) => f64::INFINITY,
        None => nearest_node(slave, surfaces, candidates, positions) * (1.0 + NEARLY),
    };
    for &surface in candidates {
        for (element, curve) in SurfaceElement::all(&surfaces[surface]).enumerate() {
            // Before the first element is found, every element up to the slave node would be closer than the previous one.
            if best.is_none()
                && !surfaces[surface].endless
                && Bounds::new(curve.nodes, positions).lies_beyond(curve, slave, reach)
            {
                continue;
            }
            let spot = SurfacePoint {
                surface,
                element,
                xi: 0.0,
            };
            if previous.is_none_or(|p| (p.surface, p.element) != (surface, element)) {
                consider(slave, surfaces, positions, spot, false, &mut best);
            }
        }
    }
    best.map(|best| best.spot)
}

/// Refines S* with Newton's method, starting from a nearby surface point.
///
/// [`project`] compares distances. At the distance g it cannot separate two points of a surface that are closer than about √(g ·
/// round-off). This error vanishes for a node on its surface, but for a node that transmits a force across a distance it changes
/// the forces by more than any tolerance.
pub fn sharpen(
    slave: [f64; 2],
    surfaces: &[Surface],
    spot: SurfacePoint,
    positions: &[[f64; 2]],
) -> SurfacePoint {
    let surface = &surfaces[spot.surface];
    if surface.endless || spot.xi.abs() == 1.0 {
        return spot;
    }
    let element = SurfaceElement::from_surface(surface, spot.element);
    let places = ElementPositions::from_nodes(element.nodes, positions);
    let xi = descend(element, &places, slave, spot.xi);
    if (xi - spot.xi).abs() <= NEXT_TO {
        SurfacePoint { xi, ..spot }
    } else {
        spot
    }
}

/// Distance to the closest node of surfaces whose curves interpolate their nodes.
fn nearest_node(
    slave: [f64; 2],
    surfaces: &[Surface],
    candidates: &[usize],
    positions: &[[f64; 2]],
) -> f64 {
    let squared = candidates
        .iter()
        .map(|&surface| &surfaces[surface])
        .filter(|surface| surface.smooth.is_empty())
        .flat_map(|surface| surface.nodes())
        .map(|&node| {
            let [x, y] = minus(slave, positions[node]);
            x * x + y * y
        });
    squared.fold(f64::INFINITY, f64::min).sqrt()
}

/// The closest point so far.
struct ClosestCandidate {
    spot: SurfacePoint,
    distance: f64,
}

/// Takes the closest point of the element of `spot` if it is closer than the best so far by more than round-off; with `warm`, the
/// ξ of `spot` is a good initial guess.
fn consider(
    slave: [f64; 2],
    surfaces: &[Surface],
    positions: &[[f64; 2]],
    spot: SurfacePoint,
    warm: bool,
    best: &mut Option<ClosestCandidate>,
) {
    let surface = &surfaces[spot.surface];
    let element = SurfaceElement::from_surface(surface, spot.element);
    let own = Bounds::new(element.nodes, positions);
    if let Some(best) = best
        && !surface.endless
        && own.lies_beyond(element, slave, best.distance)
    {
        return;
    }
    let (distance, xi) = if surface.endless {
        closest_of_line(element, positions, slave)
    } else {
        closest(element, positions, slave, warm.then_some(spot.xi))
    };
    let slack = STAY_TOLERANCE * own.size();
    if best
        .as_ref()
        .is_none_or(|best| distance < best.distance - slack)
    {
        *best = Some(ClosestCandidate {
            spot: SurfacePoint { xi, ..spot },
            distance,
        });
    }
}

/// The border of the elements `from` and `to` of a surface, as an end of `from`. `None` if they are not neighbours.
pub fn border(
    surface: &Surface,
    surface_number: usize,
    from: usize,
    to: usize,
) -> Option<SurfacePoint> {
    [1.0, -1.0].into_iter().find_map(|xi| {
        let end = SurfacePoint {
            surface: surface_number,
            element: from,
            xi,
        };
        let (across, _) = neighbour(surface, end)?;
        (across == to).then_some(end)
    })
}

/// Two sides meet without a kink if the angle between their normals is less than twice this (radians).
pub const STRAIGHT: f64 = 1e-9;

/// The diagonal of the bounding box of an element's nodes (length).
pub fn element_size(surface: &Surface, spot: SurfacePoint, positions: &[[f64; 2]]) -> f64 {
    Bounds::new(&surface.elements[spot.element], positions).size()
}

/// dx/dξ of the two elements that meet at a border, in walking order. `turned` corrects each for the local rotation of its
/// element there. `None` if no two elements meet, and on smooth chains, which have no corners.
pub fn slopes_at_border(
    surface: &Surface,
    border: SurfacePoint,
    positions: &[[f64; 2]],
    turned: impl Fn(SurfacePoint, [f64; 2]) -> [f64; 2],
) -> Option<[[f64; 2]; 2]> {
    if !surface.smooth.is_empty() {
        return None;
    }
    let (other, xi) = neighbour(surface, border)?;
    let slope = |element: usize, xi: f64| {
        let end = SurfacePoint {
            element,
            xi,
            ..border
        };
        turned(end, slope_at(surface, element, xi, positions))
    };
    let (own, across) = (slope(border.element, border.xi), slope(other, xi));
    Some(if border.xi > 0.0 {
        [own, across]
    } else {
        [across, own]
    })
}

/// Whether two elements meet at a border at an angle ([`STRAIGHT`]).
pub fn has_kink(surface: &Surface, border: SurfacePoint, positions: &[[f64; 2]]) -> bool {
    if !surface.smooth.is_empty() {
        return false;
    }
    let Some((other, xi)) = neighbour(surface, border) else {
        return false;
    };
    let own = slope_at(surface, border.element, border.xi, positions);
    let across = slope_at(surface, other, xi, positions);
    let turn = cross(own, across);
    let cosine = dot(own, across);
    // For small angles, the arc tangent equals its argument.
    turn.abs() > 2.0 * STRAIGHT * cosine
}

/// Geometry at a surface point, for a slave node at `slave`.
pub fn projection_at(
    surfaces: &[Surface],
    spot: SurfacePoint,
    positions: &[[f64; 2]],
    slave: [f64; 2],
) -> Projection {
    let surface = &surfaces[spot.surface];
    let element = SurfaceElement::from_surface(surface, spot.element);
    let (places, s) = (
        ElementPositions::from_nodes(element.nodes, positions),
        element.shape(spot.xi),
    );
    let (foot, slope) = (places.sum(&s.n), places.sum(&s.d));
    let normal = normal_at(surface, spot, positions, slope);
    let gap = (slave[0] - foot[0]) * normal[0] + (slave[1] - foot[1]) * normal[1];
    let passes = !surface.smooth.is_empty() && neighbour(surface, spot).is_some();
    let inside = spot.xi.abs() != 1.0 || surface.endless || passes;
    Projection {
        foot,
        normal,
        gap,
        shape: s.n,
        shape_slope: s.d,
        curve: inside.then(|| Curve {
            slope,
            bend: places.sum(&s.dd),
        }),
    }
}

/// [`projection_at`] for a contact that transmits forces across a distance if `apart` ([`crate::model::Contact::is_apart`]): a node
/// that has penetrated both sides of a vertex, which is then its closest point, turns around it.
pub fn projection_apart(
    apart: bool,
    surfaces: &[Surface],
    spot: SurfacePoint,
    positions: &[[f64; 2]],
    slave: [f64; 2],
) -> Projection {
    let here = projection_at(surfaces, spot, positions, slave);
    let surface = &surfaces[spot.surface];
    let is_vertex = || here.curve.is_none() && neighbour(surface, spot).is_some();
    if apart && is_vertex() && here.gap < -DEEP * element_size(surface, spot, positions) {
        here.around(slave)
    } else {
        here
    }
}

/// Outward normal of a surface point's own element.
pub fn normal(surface: &Surface, spot: SurfacePoint, positions: &[[f64; 2]]) -> [f64; 2] {
    right_of(slope_at(surface, spot.element, spot.xi, positions))
}

/// Outward normal at a surface point with this dx/dξ: at a border, the mean of both sides.
fn normal_at(
    surface: &Surface,
    spot: SurfacePoint,
    positions: &[[f64; 2]],
    slope: [f64; 2],
) -> [f64; 2] {
    let own = right_of(slope);
    let Some((other, xi)) = neighbour(surface, spot) else {
        return own;
    };
    let across = slope_at(surface, other, xi, positions);
    mean_normal(slope, across)
}

/// Mean of the outward normals (unit) of two sides with these dx/dξ.
pub fn mean_normal(one: [f64; 2], other: [f64; 2]) -> [f64; 2] {
    let [own, across] = [one, other].map(right_of);
    unit(plus(own, across)).unwrap_or(own)
}

/// The last point that has the side's own normal, on the side ahead of a border (along the walk) or on the one behind it.
pub fn point_on_side(surface: &Surface, border: SurfacePoint, ahead: bool) -> SurfacePoint {
    let own = (border.xi < 0.0) == ahead;
    let across = || neighbour(surface, border).filter(|_| !own);
    let (element, xi) = across().unwrap_or((border.element, border.xi));
    SurfacePoint {
        element,
        xi: xi * (1.0 - f64::EPSILON),
        ..border
    }
}

/// dx/dξ at ξ of an element.
fn slope_at(surface: &Surface, element: usize, xi: f64, positions: &[[f64; 2]]) -> [f64; 2] {
    let element = SurfaceElement::from_surface(surface, element);
    blend(element.nodes, positions, &element.slopes(xi))
}

/// The element that meets that of the surface point there, and ξ on it. `None` inside an element, and at an end of the chain.
pub(super) fn neighbour(surface: &Surface, spot: SurfacePoint) -> Option<(usize, f64)> {
    let count = surface.elements.len();
    let own = SurfaceElement::from_surface(surface, spot.element);
    let at = |other: usize| SurfaceElement::from_surface(surface, other);
    let (other, xi, node, met) = if spot.xi == 1.0 {
        let other = (spot.element + 1) % count;
        (other, -1.0, own.last(), at(other).first())
    } else if spot.xi == -1.0 {
        let other = (spot.element + count - 1) % count;
        (other, 1.0, own.first(), at(other).last())
    } else {
        return None;
    };
    (other != spot.element && node == met).then_some((other, xi))
}

fn past_end(
    surface: &Surface,
    spot: SurfacePoint,
    positions: &[[f64; 2]],
    slave: [f64; 2],
) -> bool {
    if surface.endless || spot.xi.abs() < 1.0 || neighbour(surface, spot).is_some() {
        return false;
    }
    let element = SurfaceElement::from_surface(surface, spot.element);
    let (nodes, s) = (element.nodes, element.shape(spot.xi));
    let (foot, slope) = (blend(nodes, positions, &s.n), blend(nodes, positions, &s.d));
    let beyond = spot.xi * ((slave[0] - foot[0]) * slope[0] + (slave[1] - foot[1]) * slope[1]);
    beyond > END_TOLERANCE * Bounds::new(nodes, positions).size() * length(slope)
}

/// Distance to the closest point of the infinite straight line through a 2-node element, and its unbounded coordinate.
fn closest_of_line(
    element: SurfaceElement<'_>,
    positions: &[[f64; 2]],
    slave: [f64; 2],
) -> (f64, f64) {
    let at = |xi: f64| blend(element.nodes, positions, &element.shape(xi).n);
    let (start, end) = (at(-1.0), at(1.0));
    let (along, to) = (minus(end, start), minus(slave, start));
    let part = dot(to, along) / dot(along, along).max(f64::MIN_POSITIVE);
    let xi = 2.0 * part - 1.0;
    (length(minus(slave, at(xi))), xi)
}

/// Distance to the closest point of an element, and its coordinate; `guess` is a coordinate that may be close.
fn closest(
    element: SurfaceElement<'_>,
    positions: &[[f64; 2]],
    slave: [f64; 2],
    guess: Option<f64>,
) -> (f64, f64) {
    let places = ElementPositions::from_nodes(element.nodes, positions);
    let squared = |n: &[f64; MAX_NODES]| {
        let to = minus(slave, places.sum(n));
        dot(to, to)
    };
    let mut start = (f64::INFINITY, 0.0);
    let mut look = |xi: f64, n: &[f64; MAX_NODES]| {
        let squared = squared(n);
        if squared < start.0 {
            start = (squared, xi);
        }
    };
    element.samples(&mut look);
    if let Some(xi) = guess.map(|xi| xi.clamp(-1.0, 1.0)) {
        look(xi, &element.shape(xi).n);
    }
    let refined = descend(element, &places, slave, start.1);
    let (squared, xi) = if refined == start.1 {
        start
    } else {
        let ended = squared(&element.shape(refined).n);
        if ended <= start.0 {
            (ended, refined)
        } else {
            start
        }
    };
    (squared.sqrt(), xi)
}

/// Newton's method for (x_S − x) · x' = 0 within |ξ| ≤ 1; Gauss-Newton if the second derivative of the squared distance is small
/// or negative, x'·x' − (x_S − x)·x'' <= 0.1 x'·x'. `places` are the positions of the curve's nodes.
fn descend(
    element: SurfaceElement<'_>,
    places: &ElementPositions,
    slave: [f64; 2],
    start: f64,
) -> f64 {
    let mut xi = start;
    for _ in 0..50 {
        let s = element.shape(xi);
        let (x, d, dd) = (places.sum(&s.n), places.sum(&s.d), places.sum(&s.dd));
        let to = minus(slave, x);
        let slope = dot(d, d);
        let curvature = slope - dot(to, dd);
        let denominator = if curvature > 0.1 * slope {
            curvature
        } else {
            slope
        };
        if denominator == 0.0 {
            break;
        }
        let next = (xi + dot(to, d) / denominator).clamp(-1.0, 1.0);
        let step = (next - xi).abs();
        xi = next;
        if step <= 2.0 * f64::EPSILON {
            break;
        }
    }
    xi
}

/// The unit vector to the right of a direction.
pub(super) fn right_of(d: [f64; 2]) -> [f64; 2] {
    unit([d[1], -d[0]]).unwrap_or([0.0, 1.0])
}

pub(super) fn blend(
    nodes: &[usize],
    positions: &[[f64; 2]],
    weights: &[f64; MAX_NODES],
) -> [f64; 2] {
    nodes.iter().zip(weights).fold([0.0, 0.0], |sum, (&n, w)| {
        [sum[0] + w * positions[n][0], sum[1] + w * positions[n][1]]
    })
}

/// The bounding box of an element's nodes.
pub(super) struct Bounds {
    low: [f64; 2],
    high: [f64; 2],
}

impl Bounds {
    pub fn new(nodes: &[usize], positions: &[[f64; 2]]) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        // Plain comparisons compile to single instructions; `min` and `max` would handle NaN.
        for &n in nodes {
            let at = positions[n];
            for k in 0..2 {
                low[k] = if at[k] < low[k] { at[k] } else { low[k] };
                high[k] = if at[k] > high[k] { at[k] } else { high[k] };
            }
        }
        Bounds { low, high }
    }

    fn sides(&self) -> [f64; 2] {
        minus(self.high, self.low)
    }

    /// Length of the diagonal.
    fn size(&self) -> f64 {
        length(self.sides())
    }

    /// Whether the whole element with these node bounds is further from a point than `distance`.
    pub fn lies_beyond(&self, element: SurfaceElement<'_>, point: [f64; 2], distance: f64) -> bool {
        let bulge = element.bulge(self.sides());
        let outside = |k: usize| {
            let out = (self.low[k] - point[k]).max(point[k] - self.high[k]) - bulge[k];
            out.max(0.0)
        };
        let (x, y) = (outside(0), outside(1));
        x * x + y * y > distance * distance
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::lagrange::shape;

    fn surface(elements: Vec<Vec<usize>>) -> Vec<Surface> {
        vec![Surface::new("s", elements, true)]
    }

    /// A flat floor of two 3-node elements, walked towards −x, so that +y is outward.
    fn floor() -> (Vec<Surface>, Vec<[f64; 2]>) {
        let positions = (0..5).map(|k| [2.0 - k as f64, 0.0]).collect();
        (surface(vec![vec![0, 1, 2], vec![2, 3, 4]]), positions)
    }

    #[test]
    fn a_node_over_a_floor_sees_its_height_as_gap_and_up_as_normal() {
        let (s, x) = floor();
        for (slave, element) in [([1.3, 0.2], 0), ([-0.7, -0.1], 1)] {
            let spot = project(slave, &s, &[0], &x, None).unwrap();
            let f = projection_at(&s, spot, &x, slave);
            assert_eq!(spot.element, element);
            assert!((f.gap - slave[1]).abs() < 1e-15 && (f.normal[1] - 1.0).abs() < 1e-15);
            assert!((f.foot[0] - slave[0]).abs() < 1e-14);
            assert_eq!(tangent(f.normal), [-f.normal[1], f.normal[0]]);
        }
    }

    #[test]
    fn there_is_no_contact_beyond_an_end() {
        let (s, x) = floor();
        assert!(project([2.01, 0.0], &s, &[0], &x, None).is_none());
        assert!(project([2.0, -0.3], &s, &[0], &x, None).is_some());
    }

    #[test]
    fn an_endless_line_has_no_ends_and_the_same_gap_everywhere() {
        let mut s = surface(vec![vec![0, 1]]);
        s[0].endless = true;
        let x = [[2.0, 1.0], [0.0, 0.0]];
        let n = [-1.0 / 5f64.sqrt(), 2.0 / 5f64.sqrt()];
        for along in [-1e3, -1.0, 0.3, 1.0, 40.0] {
            let slave = [2.0 * along + 0.1 * n[0], along + 0.1 * n[1]];
            let spot = project(slave, &s, &[0], &x, None).unwrap();
            let f = projection_at(&s, spot, &x, slave);
            assert!((f.gap - 0.1).abs() < 1e-12, "{along}: {}", f.gap);
            assert!((f.normal[0] - n[0]).abs() < 1e-15 && f.curve.is_some());
        }
    }

    #[test]
    fn a_convex_corner_has_the_mean_normal_and_a_concave_one_the_nearer_side() {
        let roof = surface(vec![vec![0, 1], vec![1, 2]]);
        let x = [[1.0, -1.0], [0.0, 0.0], [-1.0, -1.0]];
        let spot = project([0.0, 0.5], &roof, &[0], &x, None).unwrap();
        let f = projection_at(&roof, spot, &x, [0.0, 0.5]);
        assert!(f.normal[0].abs() < 1e-15 && (f.gap - 0.5).abs() < 1e-15);
        let valley = [[1.0, 1.0], [0.0, 0.0], [-1.0, 1.0]];
        let spot = project([0.2, 0.5], &roof, &[0], &valley, None).unwrap();
        assert_eq!(spot.element, 0);
    }

    #[test]
    fn the_closest_point_of_a_curve_is_perpendicular_below_the_node() {
        let m = 5;
        let positions: Vec<[f64; 2]> = (0..m)
            .map(|k| k as f64 * 0.4)
            .map(|a| [-a.cos(), a.sin()])
            .collect();
        let s = surface(vec![(0..m).collect()]);
        for angle in [0.1_f64, 0.77, 1.5] {
            for radius in [0.9, 1.0, 1.4] {
                let slave = [-radius * angle.cos(), radius * angle.sin()];
                let spot = project(slave, &s, &[0], &positions, None).unwrap();
                let f = projection_at(&s, spot, &positions, slave);
                let d = blend(&s[0].elements[0], &positions, &shape(m, spot.xi).d);
                let off = (slave[0] - f.foot[0]) * d[0] + (slave[1] - f.foot[1]) * d[1];
                assert!(off.abs() < 1e-14, "{angle} {radius} {off}");
            }
        }
    }
}
