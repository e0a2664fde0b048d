//! Points along lines, arcs and Lagrange curves.

use super::limits;
use crate::format::error::{Fault, Path, bail, fault};
use crate::format::spec::Point;
use stickslip_core::counted;

pub(crate) fn point(path: &Path, (x, y): Point) -> Result<(), Fault> {
    limits::finite(&path.then(0), x, "x")?;
    limits::finite(&path.then(1), y, "y")
}

pub(crate) fn check_per_element(here: &Path, per_element: usize) -> Result<(), Fault> {
    limits::count(
        &here.then("per_element"),
        per_element,
        2..=9,
        "the number of nodes per element",
    )
}

pub(crate) fn check_chain_count(
    path: &Path,
    count: usize,
    per_element: usize,
) -> Result<(), Fault> {
    let step = per_element - 1;
    if count > step && (count - 1).is_multiple_of(step) {
        return Ok(());
    }
    let below = (count.saturating_sub(1) / step).max(1) * step + 1;
    let fits = if below < count {
        format!("{below} or {}", below + step)
    } else {
        below.to_string()
    };
    Err(fault!(
        path,
        "{} cannot form complete elements of {per_element} nodes with shared ends; {fits} would",
        counted(count, "node")
    ))
}

/// Number of intervals between nodes along a generated chain.
pub(crate) fn intervals(
    here: &Path,
    elements: usize,
    per_element: usize,
    refine: usize,
) -> Result<usize, Fault> {
    limits::count(
        &here.then("elements"),
        elements,
        1..=limits::NODES,
        "the number of elements",
    )?;
    check_per_element(here, per_element)?;
    // Bounded by `check_total`.
    Ok(elements * (per_element - 1) * refine)
}

pub(crate) fn line(here: &Path, from: Point, to: Point, n: usize) -> Result<Vec<Point>, Fault> {
    point(&here.then("from"), from)?;
    point(&here.then("to"), to)?;
    if from == to {
        bail!(
            here.then("to"),
            "the line has zero length: it starts and ends at {to:?}"
        );
    }
    let between = |a: f64, b: f64, t: f64| a * (1.0 - t) + b * t;
    let at = |t| (between(from.0, to.0, t), between(from.1, to.1, t));
    Ok((0..=n).map(|k| at(k as f64 / n as f64)).collect())
}

pub(crate) fn arc(
    here: &Path,
    center: Point,
    radius: f64,
    (from, to): (f64, f64),
    n: usize,
) -> Result<Vec<Point>, Fault> {
    point(&here.then("center"), center)?;
    limits::positive(&here.then("radius"), radius, "the radius")?;
    limits::finite(&here.then("from"), from, "the angle")?;
    limits::finite(&here.then("to"), to, "the angle")?;
    if from == to || (to - from).abs() > 360.0 {
        bail!(
            here.then("to"),
            "the arc runs from {from:?} to {to:?} degrees; it must turn by more than 0 and at most 360"
        );
    }
    let at = |t: f64| {
        let (sin, cos) = sin_cos_degrees(from * (1.0 - t) + to * t);
        (center.0 + radius * cos, center.1 + radius * sin)
    };
    Ok((0..=n).map(|k| at(k as f64 / n as f64)).collect())
}

/// Sine and cosine of an angle in degrees, exact at right angles.
pub(crate) fn sin_cos_degrees(angle: f64) -> (f64, f64) {
    let quarter = (angle / 90.0).round();
    let (sin, cos) = (angle - 90.0 * quarter).to_radians().sin_cos();
    match quarter.rem_euclid(4.0) as u8 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// The nodes along Lagrange curves through points, each curve divided into `refine` elements.
pub(crate) fn through(
    here: &Path,
    points: &[Point],
    m: usize,
    refine: usize,
) -> Result<Vec<Point>, Fault> {
    check_per_element(here, m)?;
    let list = here.then("points");
    for (k, at) in points.iter().enumerate() {
        point(&list.then(k), *at)?;
        if k > 0 && points[k - 1] == *at {
            bail!(list.then(k), "the point {at:?} is repeated");
        }
    }
    check_chain_count(&list, points.len(), m)?;
    let mut made = vec![points[0]];
    for start in (0..points.len() - 1).step_by(m - 1) {
        let curve = &points[start..start + m];
        let steps = (m - 1) * refine;
        made.extend((1..=steps).map(|k| on_curve(curve, k, refine)));
    }
    Ok(made)
}

/// The Lagrange function i of m at t, for nodes at the parameters 0, 1, 2, …
pub(crate) fn shape(m: usize, i: usize, t: f64) -> f64 {
    (0..m)
        .filter(|j| *j != i)
        .map(|j| (t - j as f64) / (i as f64 - j as f64))
        .product()
}

/// The point of the Lagrange curve through equally spaced nodes, at `k / refine` intervals between nodes.
fn on_curve(curve: &[Point], k: usize, refine: usize) -> Point {
    if k.is_multiple_of(refine) {
        // At a node, return it without rounding.
        return curve[k / refine];
    }
    lagrange(curve, k as f64 / refine as f64)
}

/// The point of the Lagrange curve through nodes at the parameters 0, 1, 2, …
pub(crate) fn lagrange(curve: &[Point], t: f64) -> Point {
    let mut at = (0.0, 0.0);
    for (i, node) in curve.iter().enumerate() {
        let shape = shape(curve.len(), i, t);
        at = (at.0 + shape * node.0, at.1 + shape * node.1);
    }
    at
}
