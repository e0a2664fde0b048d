//! Local deflection of elements under point forces, for the judge: computed by quadrature from positions and forces only.
//!
//! The step sgn(η − ξ) and its integral are projected onto Legendre polynomials by a Gauss rule on each side of ξ; c_ij is the
//! inner product of the two remainders. The closed forms of [`super::Pair`] are not used, so this is an independent check of
//! them.

use crate::contact::closest_points::{self, ClosestPoint};
use crate::contact::facing::{MOST, faced};
use crate::contact::point_force;
use crate::fem::lagrange::{MAX_NODES, gauss, legendre};
use crate::model::{Contact, PointGive, Surface};
use crate::plane::{dot, plus};
use crate::{ElementPositions, SurfaceElement, SurfacePoint};

/// The interface in one configuration, with its forces.
#[derive(Debug, Clone, Copy)]
pub struct LoadedInterface<'a> {
    /// Master surfaces of the scene.
    pub surfaces: &'a [Surface],
    /// Slave nodes of the scene.
    pub contacts: &'a [Contact],
    /// Positions of all nodes.
    pub now: &'a [[f64; 2]],
    /// Offset (length, Cartesian) of the point at which each slave node is judged; empty if all offsets are zero.
    pub out: &'a [[f64; 2]],
    /// Interaction force on each slave node (Cartesian).
    pub forces: &'a [[f64; 2]],
}

impl LoadedInterface<'_> {
    /// Position at which a slave node is judged: its own, plus the offset.
    pub fn point(&self, slave: usize) -> [f64; 2] {
        let (at, out) = (self.now[self.contacts[slave].node], self.out.get(slave));
        out.map_or(at, |way| plus(at, *way))
    }
}

/// Minimum and maximum number of fixed-point iterations for forces and angles: an error falls by tan² α in each.
const ROUNDS: [usize; 2] = [8, 100];

/// A slave node over an element with local flexibility.
#[derive(Debug, Clone, Copy)]
struct JudgedForce {
    slave: usize,
    spot: SurfacePoint,
    give: PointGive,
    projected: ProjectedStep,
    line: Line,
    /// Force on the node along n and t of the element's line; `bends` is the part that deforms the element.
    force: [f64; 2],
    bends: f64,
    tilt: f64,
    given: f64,
}

/// Normal and lever of an element's line at a point.
#[derive(Debug, Clone, Copy)]
struct Line {
    normal: [f64; 2],
    /// √m / (m − g k).
    lever: f64,
}

/// Local deflections under all slave nodes over elements with local flexibility.
#[derive(Debug)]
pub struct JudgedGives {
    rule: Vec<(f64, f64)>,
    presses: Vec<JudgedForce>,
}

impl JudgedGives {
    /// Allocates memory for `slaves` slave nodes.
    pub fn with_capacity(slaves: usize) -> Self {
        JudgedGives {
            rule: gauss(MAX_NODES),
            presses: Vec::with_capacity(slaves),
        }
    }

    /// Computes deflection and rotation of all elements with local flexibility under the forces of a state.
    pub fn find(&mut self, seen: &LoadedInterface<'_>, feet: &mut Vec<ClosestPoint>) {
        self.presses.clear();
        if seen.surfaces.iter().all(|surface| surface.gives.is_empty()) {
            return;
        }
        for (slave, contact) in seen.contacts.iter().enumerate() {
            if contact.bond.is_tied() {
                continue;
            }
            let (at, force) = (seen.point(slave), seen.forces[slave]);
            let mut room = [0; MOST];
            let surfaces = faced(contact, seen.surfaces, seen.now, &mut room);
            closest_points::find(at, seen.surfaces, surfaces, seen.now, 0.0, feet);
            let press = feet.first().and_then(|foot| {
                let surface = &seen.surfaces[foot.spot.surface];
                let give = point_force::of(surface, foot.spot)?;
                let line = Line::new(seen, foot.spot, at)?;
                let degree = SurfaceElement::from_surface(surface, foot.spot.element).degree();
                let [c, s] = line.normal;
                let force = [c * force[0] + s * force[1], c * force[1] - s * force[0]];
                Some(JudgedForce {
                    slave,
                    spot: foot.spot,
                    give,
                    projected: ProjectedStep::new(&self.rule, degree, foot.spot.xi),
                    line,
                    force,
                    bends: force[0],
                    tilt: 0.0,
                    given: 0.0,
                })
            });
            self.presses.extend(press);
        }
        for round in 0..ROUNDS[1] {
            let mut still = true;
            for k in 0..self.presses.len() {
                let (given, slope) = self.sums(&self.presses[k], None);
                let press = &mut self.presses[k];
                (press.given, press.tilt) = (given, slope * press.line.lever);
                let (a, [normal, tangential]) = (press.tilt, press.force);
                let bends = (normal + a * tangential) / (1.0 + a * a);
                still &= (bends - press.bends).abs() <= f64::EPSILON * bends.abs();
                press.bends = bends;
            }
            if still && round + 1 >= ROUNDS[0] {
                break;
            }
        }
    }

    /// Σ c_j F_j and Σ ∂c_j/∂ξ F_j (length) at the point of a press, over all forces on the element. If `own` is given, it
    /// replaces the force of this press.
    fn sums(&self, at: &JudgedForce, own: Option<f64>) -> (f64, f64) {
        let element = |spot: &SurfacePoint| (spot.surface, spot.element);
        let mut sums = (0.0, 0.0);
        let mut add = |other: &ProjectedStep, force: f64| {
            let (give, slope) = pair(&self.rule, &at.give, &at.projected, other);
            sums = (sums.0 + give * force, sums.1 + slope * force);
        };
        for press in &self.presses {
            let here = press.slave == at.slave;
            if element(&press.spot) == element(&at.spot) && !(here && own.is_some()) {
                add(&press.projected, press.bends);
            }
        }
        if let Some(force) = own {
            add(&at.projected, force);
        }
        sums
    }

    /// Local deflection of the surface under a slave node, as a vector (length) along the outward normal of the element's axis.
    /// `None` if it is zero.
    pub fn way(&self, slave: usize) -> Option<[f64; 2]> {
        let press = self.presses.iter().find(|press| press.slave == slave)?;
        (press.given != 0.0).then(|| press.line.normal.map(|n| n * press.given))
    }

    /// F_n of a slave node along the rotated n. `None` if its element has no local flexibility.
    pub fn normal_force(&self, slave: usize) -> Option<f64> {
        let press = self.presses.iter().find(|press| press.slave == slave)?;
        Some(press.bends * (1.0 + press.tilt * press.tilt).sqrt())
    }

    /// Tangent of a side (unit) under a slave node, rotated by the forces on the side's element.
    pub fn turned(
        &self,
        seen: &LoadedInterface<'_>,
        slave: usize,
        spot: SurfacePoint,
        tangent: [f64; 2],
    ) -> [f64; 2] {
        let Some(own) = self.presses.iter().find(|press| press.slave == slave) else {
            return tangent;
        };
        let surface = &seen.surfaces[spot.surface];
        let line = Line::new(seen, spot, seen.point(slave));
        let (Some(give), Some(line)) = (point_force::of(surface, spot), line) else {
            return tangent;
        };
        let degree = SurfaceElement::from_surface(surface, spot.element).degree();
        let there = JudgedForce {
            spot,
            give,
            projected: ProjectedStep::new(&self.rule, degree, spot.xi),
            line,
            ..*own
        };
        let (_, slope) = self.sums(&there, Some(own.bends));
        let a = slope * line.lever;
        let across = [-tangent[1], tangent[0]];
        let size = (1.0 + a * a).sqrt();
        [0, 1].map(|k| (tangent[k] + a * across[k]) / size)
    }
}

impl Line {
    fn new(seen: &LoadedInterface<'_>, spot: SurfacePoint, point: [f64; 2]) -> Option<Line> {
        let element = SurfaceElement::from_surface(&seen.surfaces[spot.surface], spot.element);
        let (places, s) = (
            ElementPositions::from_nodes(element.nodes, seen.now),
            element.shape(spot.xi),
        );
        let [x, d, dd] = [&s.n, &s.d, &s.dd].map(|weights| places.sum(weights));
        let m = dot(d, d);
        let away = (point[0] - x[0]) * dd[0] + (point[1] - x[1]) * dd[1];
        (m > 0.0).then(|| Line {
            normal: [d[1] / m.sqrt(), -d[0] / m.sqrt()],
            lever: m.sqrt() / (m - away),
        })
    }
}

/// c_ij of two points of an element (length per force), and ∂c_ij/∂ξ_i.
fn pair(
    rule: &[(f64, f64)],
    give: &PointGive,
    one: &ProjectedStep,
    two: &ProjectedStep,
) -> (f64, f64) {
    let (xi, other, degree) = (one.xi, two.xi, one.degree);
    let [low, high] = if xi < other { [xi, other] } else { [other, xi] };
    let over = |f: &dyn Fn(f64) -> f64| -> f64 {
        let pieces = [(-1.0, low), (low, high), (high, 1.0)];
        pieces
            .map(|(from, to)| integral(rule, from, to, f))
            .iter()
            .sum()
    };
    let sgn = |eta: f64, xi: f64| if eta < xi { -1.0 } else { 1.0 };
    let hat = |eta: f64, xi: f64| (eta - xi).abs();
    let side = if xi == other {
        0.0
    } else {
        (xi - other).signum()
    };
    let mut shear = (over(&|eta| sgn(eta, xi) * sgn(eta, other)), -2.0 * side);
    let mut bending = (
        over(&|eta| hat(eta, xi) * hat(eta, other)),
        over(&|eta| -sgn(eta, xi) * hat(eta, other)),
    );
    for k in 0..degree {
        let square = 2.0 / (2 * k + 1) as f64;
        shear.0 -= square * one.step[k] * two.step[k];
        shear.1 -= square * one.step_slope[k] * two.step[k];
        bending.0 -= square * one.hat[k] * two.hat[k];
        bending.1 -= square * one.hat_slope[k] * two.hat[k];
    }
    let bends = if degree < 3 { 0.0 } else { give.bending };
    (
        give.shear * shear.0 + bends * bending.0,
        give.shear * shear.1 + bends * bending.1,
    )
}

/// Legendre coefficients of the projected step at ξ (`step`) and of its projected integral (`hat`), with derivatives with respect
/// to ξ.
#[derive(Debug, Clone, Copy)]
struct ProjectedStep {
    degree: usize,
    xi: f64,
    step: [f64; MAX_NODES],
    step_slope: [f64; MAX_NODES],
    hat: [f64; MAX_NODES],
    hat_slope: [f64; MAX_NODES],
}

impl ProjectedStep {
    fn new(rule: &[(f64, f64)], degree: usize, xi: f64) -> Self {
        let mut all = ProjectedStep {
            degree,
            xi,
            step: [0.0; MAX_NODES],
            step_slope: [0.0; MAX_NODES],
            hat: [0.0; MAX_NODES],
            hat_slope: [0.0; MAX_NODES],
        };
        let part = |k: usize| (2 * k + 1) as f64 / 2.0;
        for k in 0..degree {
            let by = |from: f64, to: f64| integral(rule, from, to, &|eta| legendre(k, eta).0);
            all.step[k] = part(k) * (by(xi, 1.0) - by(-1.0, xi));
            all.step_slope[k] = -2.0 * part(k) * legendre(k, xi).0;
        }
        let (step, slope) = (all.step, all.step_slope);
        let series = |of: &[f64; MAX_NODES], eta: f64| -> f64 {
            of.iter()
                .enumerate()
                .take(degree)
                .map(|(k, a)| a * legendre(k, eta).0)
                .sum()
        };
        // The integration starts at the left end, where the integral is 1 + ξ.
        let line = |eta: f64| 1.0 + xi + integral(rule, -1.0, eta, &|x| series(&step, x));
        let line_slope = |eta: f64| 1.0 + integral(rule, -1.0, eta, &|x| series(&slope, x));
        for (eta, weight) in rule {
            let (value, slope) = (weight * line(*eta), weight * line_slope(*eta));
            for k in 0..degree {
                all.hat[k] += part(k) * value * legendre(k, *eta).0;
                all.hat_slope[k] += part(k) * slope * legendre(k, *eta).0;
            }
        }
        all
    }
}

fn integral(rule: &[(f64, f64)], from: f64, to: f64, f: &dyn Fn(f64) -> f64) -> f64 {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let points = rule.iter().map(|(x, w)| w * f(middle + half * x));
    half * points.sum::<f64>()
}

/// Adds the force of a slave node to `contact` at the node, and its reaction at the nodes of the master element: at the closest
/// point, plus the moment of the gap if `lever` is set.
pub fn hand_on(
    seen: &LoadedInterface<'_>,
    slave: usize,
    foot: &ClosestPoint,
    lever: bool,
    contact: &mut [[f64; 2]],
) {
    let force = seen.forces[slave];
    let element =
        SurfaceElement::from_surface(&seen.surfaces[foot.spot.surface], foot.spot.element);
    let s = element.shape(foot.spot.xi);
    let mut moment = [0.0; 2];
    if lever && foot.spot.xi.abs() < 1.0 {
        let (places, at) = (
            ElementPositions::from_nodes(element.nodes, seen.now),
            seen.point(slave),
        );
        let [x, d] = [&s.n, &s.d].map(|weights| places.sum(weights));
        let m = dot(d, d);
        let across = [d[1], -d[0]];
        // (g / √m) (F · t) n, the weight of dx/dξ of the element.
        let gap = (at[0] - x[0]) * across[0] + (at[1] - x[1]) * across[1];
        let along = dot(force, d);
        moment = across.map(|n| gap * along * n / (m * m));
    }
    for k in 0..2 {
        for (node, weight) in seen.contacts[slave].carriers() {
            contact[node][k] += weight * force[k];
        }
        for ((&master, share), slope) in element.nodes.iter().zip(s.n).zip(s.d) {
            contact[master][k] -= share * force[k] - slope * moment[k];
        }
    }
}

/// c_ij and ∂c_ij/∂ξ_i by quadrature, for tests of the closed forms.
#[cfg(test)]
pub fn quadrature(give: &PointGive, degree: usize, xi: f64, other: f64) -> (f64, f64) {
    let rule = gauss(MAX_NODES);
    let [one, two] = [xi, other].map(|xi| ProjectedStep::new(&rule, degree, xi));
    pair(&rule, give, &one, &two)
}
