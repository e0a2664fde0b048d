//! The shape of a state as lines, for all front ends that draw it: node positions, curves of elements, the
//! visible extent, and clipping.

use stickslip_core::fem::lagrange;
use stickslip_core::plane::minus;
use stickslip_core::{Body, BodyKind, Event, Model, SurfaceElement};

/// A point in the scene or on the sheet.
pub type Point = [f64; 2];

stickslip_core::words! {
    /// How a scene in space is drawn.
    #[derive(Default)]
    pub enum Projection, ALL, word {
        /// x to the right, z upwards, y to the upper right.
        #[default]
        Oblique "oblique",
        /// Along z: x to the right, y upwards.
        Top "top",
        /// Along y: x to the right, z upwards.
        Side "side",
    }
}

impl Projection {
    /// The next projection.
    pub fn next(self) -> Projection {
        Projection::ALL[(self as usize + 1) % Projection::ALL.len()]
    }

    /// A point or vector on the sheet; in the plane its x and y.
    pub fn flat(self, model: &Model, [x, y, z]: [f64; 3]) -> Point {
        match model.space {
            None => [x, y],
            Some(_) => self.sheet([x, y, z]),
        }
    }

    /// A point or vector in space on the sheet.
    pub fn sheet(self, [x, y, z]: [f64; 3]) -> Point {
        match self {
            Projection::Oblique => [x + 0.5 * y, z + 0.35 * y],
            Projection::Top => [x, y],
            Projection::Side => [x, z],
        }
    }

    /// The undeformed position of a node.
    pub fn at(self, model: &Model, node: usize) -> Point {
        self.flat(model, model.at_in_space(node))
    }

    /// The contact force on a slave node, as a vector on the sheet.
    pub fn force(self, model: &Model, event: &Event, slave: usize) -> Point {
        self.flat(model, event.force(slave).unwrap_or_default())
    }
}

/// Number of straight pieces per element curve.
const PIECES: usize = 12;

/// The Lagrange curve through the nodes of an element.
pub fn curve(nodes: &[Point]) -> Vec<Point> {
    if nodes.len() < 2 || nodes.len() > lagrange::MAX_NODES {
        return nodes.to_vec();
    }
    let pieces = if nodes.len() == 2 { 1 } else { PIECES };
    (0..=pieces)
        .map(|piece| {
            let shape = lagrange::shape(nodes.len(), -1.0 + 2.0 * piece as f64 / pieces as f64);
            [0, 1].map(|axis| {
                nodes
                    .iter()
                    .zip(shape.n)
                    .map(|(node, n)| n * node[axis])
                    .sum()
            })
        })
        .collect()
}

/// The points whose Lagrange curve is that of a master element; `place` gives the positions of nodes.
pub fn element(element: SurfaceElement<'_>, place: impl Fn(usize) -> Point) -> Vec<Point> {
    let nodes: Vec<Point> = element.nodes.iter().map(|&node| place(node)).collect();
    if element.is_plain() {
        return nodes;
    }
    let count = element.degree() + 1;
    (0..count)
        .map(|k| {
            let shares = element.shape(lagrange::node(count, k)).n;
            [0, 1].map(|axis| nodes.iter().zip(shares).map(|(x, n)| n * x[axis]).sum())
        })
        .collect()
}

/// A rectangle in the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Minimum x and y.
    pub low: Point,
    /// Maximum x and y.
    pub high: Point,
}

impl Bounds {
    /// Contains no points.
    pub const NOTHING: Bounds = Bounds {
        low: [f64::INFINITY; 2],
        high: [f64::NEG_INFINITY; 2],
    };

    /// Around the origin, for empty scenes.
    pub const UNIT: Bounds = Bounds {
        low: [-1.0, -1.0],
        high: [1.0, 1.0],
    };

    /// Extends the bounds to a point; NaN is ignored.
    pub fn add(&mut self, point: Point) {
        for (axis, x) in point.into_iter().enumerate().filter(|(_, x)| x.is_finite()) {
            self.low[axis] = self.low[axis].min(x);
            self.high[axis] = self.high[axis].max(x);
        }
    }

    /// Width and height.
    pub fn size(&self) -> Point {
        minus(self.high, self.low)
    }

    /// Length of the diagonal.
    pub fn diagonal(&self) -> f64 {
        let [x, y] = self.size();
        x.hypot(y)
    }
}

/// The nodes of a body that enclose it: those of a solid's boundary, some of them repeatedly, or all nodes.
pub fn outer_nodes(body: &Body) -> impl Iterator<Item = usize> {
    let (edges, nodes) = match &body.kind {
        BodyKind::Solid(solid) => (&solid.edges[..], &[][..]),
        _ => (&[][..], &body.nodes[..]),
    };
    edges.iter().flatten().chain(nodes).copied()
}

/// The visible extent of a scene with nodes at `place`: the undeformed and deformed bodies, and nearby parts of
/// surfaces. `None` if it has no size.
pub fn extent(
    model: &Model,
    projection: Projection,
    place: &dyn Fn(usize) -> Point,
) -> Option<Bounds> {
    let mut bodies = Bounds::NOTHING;
    for node in model.bodies.iter().flat_map(outer_nodes) {
        bodies.add(projection.at(model, node));
        bodies.add(place(node));
    }
    if bodies.diagonal() <= 0.0 || !bodies.diagonal().is_finite() {
        (0..model.nodes.len()).for_each(|node| bodies.add(projection.at(model, node)));
    }
    let reach = 0.2 * bodies.diagonal();
    let mut all = bodies;
    for node in model.surfaces.iter().flat_map(|surface| surface.nodes()) {
        let at = place(*node);
        let clamped =
            |axis: usize| at[axis].clamp(bodies.low[axis] - reach, bodies.high[axis] + reach);
        if bodies.diagonal().is_finite() {
            all.add([clamped(0), clamped(1)]);
        }
    }
    (all.diagonal() > 0.0 && all.diagonal().is_finite()).then_some(all)
}

/// The extent rounded to coarse steps, so that the picture does not rescale at every step.
pub fn bounds(model: &Model, projection: Projection, place: &dyn Fn(usize) -> Point) -> Bounds {
    let all = extent(model, projection, place);
    let step = all.map_or(0.0, |all| all.diagonal() / 16.0);
    let Some(all) = all.filter(|_| step > 0.0 && step.is_finite()) else {
        return Bounds::UNIT;
    };
    // With powers of two, the step itself seldom changes.
    let step = 2f64.powf(step.log2().ceil());
    let down = |x: f64| (x / step).floor() * step;
    let up = |x: f64| (x / step).ceil() * step;
    Bounds {
        low: all.low.map(down),
        high: all.high.map(up),
    }
}

/// The part of a line inside the rectangle from `low` to `high` (Liang and Barsky); `None` if there is none or
/// an end is NaN.
pub fn clip(from: Point, to: Point, low: Point, high: Point) -> Option<(Point, Point)> {
    if !from.iter().chain(&to).all(|x| x.is_finite()) {
        return None;
    }
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let run = to[axis] - from[axis];
        for (p, q) in [
            (-run, from[axis] - low[axis]),
            (run, high[axis] - from[axis]),
        ] {
            match p {
                0.0 if q < 0.0 => return None,
                0.0 => {}
                _ if p < 0.0 => enter = enter.max(q / p),
                _ => leave = leave.min(q / p),
            }
        }
    }
    (enter <= leave).then(|| (mix(from, to, enter), mix(from, to, leave)))
}

/// Linear interpolation between two points.
pub fn mix(from: Point, to: Point, part: f64) -> Point {
    [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * part)
}

/// The largest of 1, 2 and 5 times a power of ten that does not exceed a value.
pub fn round_down(value: f64) -> f64 {
    if !(value > 0.0 && value.is_finite()) {
        return 0.0;
    }
    let power = 10f64.powf(value.log10().floor());
    let step = [5.0, 2.0, 1.0]
        .into_iter()
        .find(|step| step * power <= value);
    // Formatted and parsed, so that the value equals its label.
    format!("{:.0e}", step.unwrap_or(1.0) * power)
        .parse()
        .unwrap_or(value)
}

/// Part of the scene's size that the largest displacement is magnified to, and above which it is drawn to scale.
const SEEN: f64 = 0.06;
const TO_SCALE: f64 = 0.015;
/// Largest automatic magnification.
const MOST: f64 = 1e6;

/// A round magnification that makes the largest of the outlines' displacements visible; 1 if it is visible to scale, or too small to
/// be made visible.
pub fn magnification<'a>(model: &Model, displacements: impl Iterator<Item = &'a [f64]>) -> f64 {
    let outer = || model.bodies.iter().flat_map(outer_nodes);
    let largest = displacements
        .flat_map(|u| outer().map(move |node| displacement(model, u, node)))
        .filter(|size| size.is_finite())
        .fold(0.0, f64::max);
    let part = largest / model.length;
    if part < TO_SCALE && SEEN / part <= MOST {
        round_down(SEEN / part).max(1.0)
    } else {
        1.0
    }
}

/// Length of a node's displacement.
pub fn displacement(model: &Model, u: &[f64], node: usize) -> f64 {
    let (at, now) = (model.at_in_space(node), model.place_in_space(u, node));
    let [x, y, z] = [0, 1, 2].map(|axis| now[axis] - at[axis]);
    (x * x + y * y + z * z).sqrt()
}

/// Position of a node with its displacement magnified.
pub fn magnified(
    model: &Model,
    u: &[f64],
    node: usize,
    (factor, projection): (f64, Projection),
) -> Point {
    let (at, now) = (model.at_in_space(node), model.place_in_space(u, node));
    let place = if factor == 1.0 {
        now
    } else {
        [0, 1, 2].map(|axis| at[axis] + factor * (now[axis] - at[axis]))
    };
    projection.flat(model, place)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_round_numbers_below_the_limit() {
        for (value, wanted) in [(0.37, 0.2), (5.0, 5.0), (99.0, 50.0), (1.2e-4, 1e-4)] {
            assert_eq!(round_down(value), wanted);
        }
        assert_eq!(round_down(0.0), 0.0);
    }
}
