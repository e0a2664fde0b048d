//! Evaluates the contact laws for the judge: on a single side, or where two sides meet.

use crate::contact::corner::half_angle;
use crate::contact::corner::{Side, beyond_corner, beyond_slid, beyond_vertex};
use crate::model::Surface;
use crate::plane::{cross, dot};
use crate::{JudgedNumbers, Scales, SurfaceElement, SurfacePoint};

/// A side of the master that a node touches.
#[derive(Debug, Clone, Copy)]
pub(super) struct TouchedSide {
    pub spot: SurfacePoint,
    pub side: Side,
    pub tangent: [f64; 2],
    /// ξ (±1) if the node is at an end of the chain.
    pub end: Option<f64>,
    pub past: SideHistory,
}

/// Contact of a node with this side in the last accepted state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum SideHistory {
    /// The node touched the side; its slip along t since then (length).
    Touched(f64),
    /// The node was open; the motion of its closest point along t since then (length).
    Open(f64),
    /// The node was over another surface, or over no surface.
    Elsewhere,
}

/// Violations of the laws on a side or in a corner, relative to the scene's force.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Amounts {
    pub tension: f64,
    pub cone: f64,
    pub slip: f64,
    pub touch: f64,
    /// Whether the node also touched in the last accepted state.
    pub touched: bool,
    pub numbers: JudgedNumbers,
}

impl Amounts {
    pub fn worst(&self) -> f64 {
        self.tension.max(self.cone).max(self.slip).max(self.touch)
    }
}

/// Slip (length) of a node along another surface to the point where that surface meets `this` side. `None` if the node did not
/// slide there.
pub(super) fn slip_into(
    surfaces: &[Surface],
    sides: &[TouchedSide],
    this: &TouchedSide,
    near: f64,
) -> Option<f64> {
    sides
        .iter()
        .filter(|other| other.spot.surface != this.spot.surface)
        .find_map(|other| match other.past {
            SideHistory::Touched(slip) if comes_first(surfaces, other, this) => {
                (slip > near).then_some(slip)
            }
            SideHistory::Touched(slip) => (slip < -near).then_some(slip),
            _ => None,
        })
}

/// Evaluates the laws on a single side.
pub(super) fn on_side(scales: &Scales, force: [f64; 2], at: &TouchedSide) -> Amounts {
    let numbers = numbers(force, at);
    let JudgedNumbers {
        f_n,
        f_t,
        limit,
        slip,
        ..
    } = numbers;
    let against = f_t * slip.signum();
    let slips = slip.abs() > scales.near();
    let at_limit = limit - f_t.abs() <= scales.forces * scales.force;
    Amounts {
        tension: (-f_n).max(0.0) / scales.force,
        cone: (f_t.abs() - limit).max(0.0) / scales.force,
        slip: match at.past {
            SideHistory::Touched(_) if slips => (limit + against).max(0.0) / scales.force,
            _ => 0.0,
        },
        touch: match at.past {
            SideHistory::Open(_) if slips && at_limit => against.max(0.0) / scales.force,
            _ => 0.0,
        },
        touched: matches!(at.past, SideHistory::Touched(_)),
        numbers,
    }
}

fn numbers(force: [f64; 2], at: &TouchedSide) -> JudgedNumbers {
    let f_n = dot(force, at.side.normal);
    JudgedNumbers {
        gap: 0.0,
        f_n,
        f_t: dot(force, at.tangent),
        limit: at.side.coefficient * f_n.max(0.0) + at.side.cohesion,
        slip: match at.past {
            SideHistory::Touched(slip) | SideHistory::Open(slip) => slip,
            SideHistory::Elsewhere => 0.0,
        },
        deviation: None,
    }
}

/// Evaluates the laws where two sides meet, at a concave corner or a convex vertex.
pub(super) fn in_corner(
    surfaces: &[Surface],
    scales: &Scales,
    force: [f64; 2],
    [one, other]: [&TouchedSide; 2],
) -> Amounts {
    let (before, behind) = if comes_first(surfaces, one, other) {
        (one, other)
    } else {
        (other, one)
    };
    let near = scales.near();
    if half_angle(before.tangent, behind.tangent) <= 0.0 {
        let beyond = beyond_vertex(force, &before.side, &behind.side);
        let numbers = numbers(force, before);
        let slid = matches!(before.past, SideHistory::Touched(slip) if slip.abs() > near);
        return Amounts {
            tension: beyond.tension / scales.force,
            cone: beyond.cone / scales.force,
            // At the vertex the friction of neither side is at its limit, so a slip onto it violates the law.
            slip: if slid { f64::INFINITY } else { 0.0 },
            touch: 0.0,
            touched: false,
            numbers,
        };
    }
    let [before_side, behind_side] = [&before.side, &behind.side];
    let cone = beyond_corner(force, [before_side, behind_side]).max(0.0);
    // Friction opposes the slip.
    let (came, slid) = match came_along(before, behind, near) {
        Some(1.0) => (before, beyond_slid(force, [before_side, behind_side], -1.0)),
        Some(_) => (behind, beyond_slid(force, [behind_side, before_side], 1.0)),
        None => (before, 0.0),
    };
    Amounts {
        tension: 0.0,
        cone: cone / scales.force,
        slip: (slid - cone).max(0.0) / scales.force,
        touch: 0.0,
        touched: false,
        numbers: numbers(force, came),
    }
}

/// Whether `one` precedes `other` in walking order, for two sides that meet. On two surfaces, the surface that ends at the common
/// point precedes the surface that begins there; if two surfaces cross, the order is that of the walk into their concave corner.
fn comes_first(surfaces: &[Surface], one: &TouchedSide, other: &TouchedSide) -> bool {
    if one.spot.surface != other.spot.surface {
        return match (one.end, other.end) {
            (Some(a), Some(b)) if a != b => a > b,
            _ => cross(one.tangent, other.tangent) < 0.0,
        };
    }
    let end = SurfacePoint {
        xi: 1.0,
        ..one.spot
    };
    let follows = beyond_border(surfaces, end);
    follows.is_some_and(|next| next.element == other.spot.element)
}

/// Direction (±1, along t) in which a node has slid since the last accepted state to the point where two sides meet: along t on
/// the first side, against t on the second. `None` if it did not slide there.
fn came_along(before: &TouchedSide, behind: &TouchedSide, near: f64) -> Option<f64> {
    let slid = |side: &TouchedSide, sign: f64| matches!(side.past, SideHistory::Touched(slip) if sign * slip > near);
    if slid(before, 1.0) {
        Some(1.0)
    } else if slid(behind, -1.0) {
        Some(-1.0)
    } else {
        None
    }
}

/// The same point as an end (xi = ±1) of the neighbouring element. `None` at an end of the chain.
pub(super) fn beyond_border(surfaces: &[Surface], border: SurfacePoint) -> Option<SurfacePoint> {
    let surface = &surfaces[border.surface];
    let count = surface.elements.len();
    let ahead = border.xi > 0.0;
    let step = if ahead { 1 } else { count - 1 };
    let element = (border.element + step) % count;
    let (own, other) = (
        SurfaceElement::from_surface(surface, border.element),
        SurfaceElement::from_surface(surface, element),
    );
    let (mine, its) = if ahead {
        (own.last(), other.first())
    } else {
        (own.first(), other.last())
    };
    (element != border.element && mine == its).then_some(SurfacePoint {
        element,
        xi: -border.xi,
        ..border
    })
}
