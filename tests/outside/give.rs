//! What a beam element leaves out under a point force, from the beam's own equations: the exact Green's function of the clamped element less
//! that of the element as it is integrated. Nothing of the solver's closed forms is used.
//!
//! ```text
//! M' + Q = 0, Q' = −F δ,   γ = Q/GA,  κ = M/EI       exact, both ends clamped
//! w, θ of degree p, p Gauss points                   the element, its inner nodes free
//! ```
//!
//! Elements of degree 1 and 2 are taken without bending (θ = 0), and so are all under `point_force: shear`.

use super::chain::{Chain, Place, Point, dot, shape};
use super::judge::Seen;
use stickslip::model::{BodyKind, Model, PointForce};

/// Step of differences by ξ.
const STEP: f64 = 1e-4;
/// Rounds in which forces and angles are found: an error falls by tan² α in each.
const ROUNDS: usize = 100;

/// A beam element with both ends clamped.
#[derive(Debug, Clone, Copy)]
struct Clamped {
    length: f64,
    ga: f64,
    /// Without it the section does not turn.
    ei: Option<f64>,
    degree: usize,
}

impl Clamped {
    /// The element of a beam with a shear stiffness on these nodes, whichever way it is walked.
    fn find(model: &Model, nodes: &[usize]) -> Option<Clamped> {
        let wanted = model.settings.point_force;
        let backward: Vec<usize> = nodes.iter().rev().copied().collect();
        let is = |element: &Vec<usize>| *element == nodes || *element == backward;
        model.bodies.iter().find_map(|body| match &body.kind {
            BodyKind::Beam(beam) if beam.elements.iter().any(is) => {
                let at: Vec<Point> = nodes.iter().map(|&n| model.nodes[n].at).collect();
                let line = Chain::through(vec![at]);
                let [from, to] = [-1.0, 1.0].map(|xi| Place { element: 0, xi });
                let degree = nodes.len() - 1;
                let bends = wanted == PointForce::Exact && degree >= 3;
                (wanted != PointForce::Plain).then_some(Clamped {
                    length: line.length(from, to),
                    ga: beam.ga?,
                    ei: bends.then_some(beam.ei),
                    degree,
                })
            }
            _ => None,
        })
    }

    /// Deflection at ξ by a unit force at η, beyond that of the element.
    fn left_out(&self, xi: f64, eta: f64) -> f64 {
        self.exact(xi, eta) - self.element(xi, eta)
    }

    /// Its derivative by ξ; where both are one place, half of that along both.
    fn slope(&self, xi: f64, eta: f64) -> f64 {
        let same = xi == eta;
        let at = |by: f64| match same {
            true => 0.5 * self.left_out(xi + by, xi + by),
            false => self.left_out(xi + by, eta),
        };
        // Of fourth order: at the ends of an element of high degree the deflection bends sharply.
        let sum = |from: i32, weights: [f64; 5]| -> f64 {
            let steps = (from..).map(|k| at(f64::from(k) * STEP));
            steps.zip(weights).map(|(f, w)| w * f).sum::<f64>() / (12.0 * STEP)
        };
        match () {
            () if xi + 2.0 * STEP > 1.0 => sum(-4, [3.0, -16.0, 36.0, -48.0, 25.0]),
            () if xi - 2.0 * STEP < -1.0 => sum(0, [-25.0, 48.0, -36.0, 16.0, -3.0]),
            () => sum(-2, [1.0, -8.0, 0.0, 8.0, -1.0]),
        }
    }

    /// Shear force and moment of a unit force at ξ, in balance and no more.
    fn statics(&self, xi: f64, at: f64) -> [f64; 2] {
        let q = if at < xi { 0.5 } else { -0.5 };
        [q, 0.25 * self.length * (at - xi).abs()]
    }

    /// By the principle of virtual forces; the reactions at the ends do no work.
    fn exact(&self, xi: f64, eta: f64) -> f64 {
        let [low, high] = [xi.min(eta), xi.max(eta)];
        let work = |f: &dyn Fn(f64) -> [f64; 2], g: &dyn Fn(f64) -> [f64; 2]| -> f64 {
            let mut sum = 0.0;
            for (from, to) in [(-1.0, low), (low, high), (high, 1.0)] {
                for (x, w) in gauss(3) {
                    let at = 0.5 * (from + to) + 0.5 * (to - from) * x;
                    let ([q, m], [v, n]) = (f(at), g(at));
                    let bends = self.ei.map_or(0.0, |ei| m * n / ei);
                    sum += 0.25 * (to - from) * self.length * w * (q * v / self.ga + bends);
                }
            }
            sum
        };
        let (one, two) = (
            |at: f64| self.statics(xi, at),
            |at: f64| self.statics(eta, at),
        );
        let shear = |at: f64| [1.0, -0.5 * self.length * at];
        let moment = |_: f64| [0.0, 1.0];
        // Shear with its moment about the middle, and a constant moment, do no work on each other.
        let redundant = |f: &dyn Fn(f64) -> [f64; 2]| {
            let size = work(f, f);
            if size > 0.0 {
                work(&one, f) * work(&two, f) / size
            } else {
                0.0
            }
        };
        work(&one, &two) - redundant(&shear) - redundant(&moment)
    }

    /// Of the element: its inner nodes' w, and θ where it bends, solved for.
    fn element(&self, xi: f64, eta: f64) -> f64 {
        let (count, p) = (self.degree + 1, self.degree);
        let inner = p - 1;
        if inner == 0 {
            return 0.0;
        }
        let fields = if self.ei.is_some() { 2 } else { 1 };
        let size = fields * inner;
        let mut matrix = vec![vec![0.0; size + 1]; size];
        let half = 0.5 * self.length;
        for (x, w) in gauss(p) {
            let (n, d) = shape(count, x);
            let row = |i: usize| {
                let (field, node) = (i / inner, 1 + i % inner);
                match field {
                    0 => [d[node] / half, 0.0],
                    _ => [-n[node], d[node] / half],
                }
            };
            for (i, line) in matrix.iter_mut().enumerate() {
                let [a, b] = row(i);
                for (j, entry) in line.iter_mut().enumerate().take(size) {
                    let [c, d] = row(j);
                    *entry += w * half * (self.ga * a * c + self.ei.unwrap_or(0.0) * b * d);
                }
            }
        }
        let weights = |xi: f64| shape(count, xi).0;
        for (i, row) in matrix.iter_mut().enumerate().take(inner) {
            row[size] = weights(eta)[1 + i];
        }
        let found = solved(matrix);
        (0..inner).map(|i| weights(xi)[1 + i] * found[i]).sum()
    }
}

/// Points and weights of Gauss' rule: roots of Legendre's polynomial by halving between those of the one before.
fn gauss(count: usize) -> Vec<(f64, f64)> {
    let legendre = |n: usize, x: f64| {
        let (mut before, mut now) = (0.0, 1.0);
        for k in 0..n {
            let k = k as f64;
            (before, now) = (now, ((2.0 * k + 1.0) * x * now - k * before) / (k + 1.0));
        }
        (now, before)
    };
    let mut roots: Vec<f64> = Vec::new();
    for n in 1..=count {
        let mut ends = vec![-1.0];
        ends.extend(&roots);
        ends.push(1.0);
        let root = |pair: &[f64]| {
            let (mut low, mut high) = (pair[0], pair[1]);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                let rises = legendre(n, low).0 * legendre(n, middle).0 > 0.0;
                (low, high) = if rises { (middle, high) } else { (low, middle) };
            }
            0.5 * (low + high)
        };
        roots = ends.windows(2).map(root).collect();
    }
    let weight = |x: f64| {
        let (_, before) = legendre(count, x);
        2.0 * (1.0 - x * x) / (count as f64 * before).powi(2)
    };
    roots.into_iter().map(|x| (x, weight(x))).collect()
}

/// Gauss' elimination of a positive definite matrix with its right-hand side as the last column.
fn solved(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    let size = rows.len();
    for k in 0..size {
        let pivot = rows[k].clone();
        for row in rows.iter_mut().skip(k + 1) {
            let factor = row[k] / pivot[k];
            row.iter_mut()
                .zip(&pivot)
                .for_each(|(a, b)| *a -= factor * b);
        }
    }
    let mut x = vec![0.0; size];
    for k in (0..size).rev() {
        let sum: f64 = (k + 1..size).map(|j| rows[k][j] * x[j]).sum();
        x[k] = (rows[k][size] - sum) / rows[k][k];
    }
    x
}

/// A slave node over an element that leaves something out.
#[derive(Debug, Clone)]
struct Press {
    slave: usize,
    on: (usize, Place),
    clamped: Clamped,
    normal: Point,
    /// Force along n and t of the element's line; that which bends the element.
    force: [f64; 2],
    bends: f64,
}

/// All that a state's forces leave out.
#[derive(Debug, Clone)]
pub struct Gives<'a> {
    model: &'a Model,
    chains: &'a [Chain],
    positions: &'a [Point],
    presses: Vec<Press>,
}

impl<'a> Gives<'a> {
    pub fn new(model: &'a Model, state: &'a Seen, chains: &'a [Chain]) -> Self {
        let mut all = Gives {
            model,
            chains,
            positions: &state.positions,
            presses: Vec::new(),
        };
        for (slave, contact) in model.contacts.iter().enumerate() {
            let (p, f) = (state.positions[contact.node], state.forces[slave]);
            let inside = |&surface: &usize| {
                let sites = chains[surface].sites(p);
                let closest = sites
                    .iter()
                    .min_by(|a, b| a.distance.total_cmp(&b.distance));
                let place = match closest?.at {
                    super::chain::At::Inside(place) => place,
                    _ => return None,
                };
                Some((closest?.distance, (surface, place)))
            };
            let found = contact.surfaces.iter().filter_map(inside);
            let Some((_, on)) = found.min_by(|a, b| a.0.total_cmp(&b.0)) else {
                continue;
            };
            let Some(clamped) = all.clamped(on) else {
                continue;
            };
            let (n, t) = chains[on.0].frame(on.1);
            let force = [dot(f, n), dot(f, t)];
            all.presses.push(Press {
                slave,
                on,
                clamped,
                normal: n,
                force,
                bends: force[0],
            });
        }
        for _ in 0..ROUNDS {
            let mut still = true;
            for k in 0..all.presses.len() {
                let press = &all.presses[k];
                let a = all.tilt(press.slave, press.on);
                let [n, t] = press.force;
                let bends = (n + a * t) / (1.0 + a * a);
                still &= (bends - press.bends).abs() <= 1e-15 * bends.abs();
                all.presses[k].bends = bends;
            }
            if still {
                break;
            }
        }
        all
    }

    fn clamped(&self, (surface, place): (usize, Place)) -> Option<Clamped> {
        let surface = &self.model.surfaces[surface];
        let plain = surface.smooth.is_empty() && !surface.endless && !surface.rigid;
        plain.then(|| Clamped::find(self.model, &surface.elements[place.element]))?
    }

    /// Where a slave node is as its surface sees it, which gives way under it.
    pub fn point(&self, slave: usize) -> Point {
        let at = self.positions[self.model.contacts[slave].node];
        let Some(press) = self.presses.iter().find(|press| press.slave == slave) else {
            return at;
        };
        let here = |other: &&Press| self.shares(press.on, other.on);
        let others = self.presses.iter().filter(here);
        let given: f64 = others
            .map(|o| press.clamped.left_out(press.on.1.xi, o.on.1.xi) * o.bends)
            .sum();
        [0, 1].map(|k| at[k] + given * press.normal[k])
    }

    fn shares(&self, one: (usize, Place), other: (usize, Place)) -> bool {
        (one.0, one.1.element) == (other.0, other.1.element)
    }

    /// Normal and tangent of the surface under a slave node, turned as its line really is.
    pub fn frame(&self, slave: usize, (surface, place): (usize, Place)) -> (Point, Point) {
        let (n, t) = self.chains[surface].frame(place);
        let a = self.tilt(slave, (surface, place));
        let size = (1.0 + a * a).sqrt();
        let turned = |n: Point, t: Point| [0, 1].map(|k| (n[k] + a * t[k]) / size);
        (turned(n, t), turned(t, [-n[0], -n[1]]))
    }

    /// Tangent of the angle by which it is turned: what the energy left out gains by the way along the surface, by the force.
    fn tilt(&self, slave: usize, on: (usize, Place)) -> f64 {
        let Some(own) = self.presses.iter().find(|press| press.slave == slave) else {
            return 0.0;
        };
        let Some(clamped) = self.clamped(on) else {
            return 0.0;
        };
        let others = self
            .presses
            .iter()
            .filter(|p| p.slave != slave && self.shares(p.on, on));
        let others: f64 = others
            .map(|p| clamped.slope(on.1.xi, p.on.1.xi) * p.bends)
            .sum();
        let slope = others + clamped.slope(on.1.xi, on.1.xi) * own.bends;
        // The closest point goes by dξ = √m ds / (m − g k) where the node goes by ds.
        let foot = |xi: f64| self.chains[on.0].at(Place { xi, ..on.1 });
        let (x, d) = foot(on.1.xi);
        let to = {
            let p = self.positions[self.model.contacts[slave].node];
            [p[0] - x[0], p[1] - x[1]]
        };
        let step = if on.1.xi > 0.0 { -STEP } else { STEP };
        // Of second order: exact for elements up to degree 3.
        let [one, two] = [step, 2.0 * step].map(|by| foot(on.1.xi + by).1);
        let bend = [0, 1].map(|k| (4.0 * one[k] - two[k] - 3.0 * d[k]) / (2.0 * step));
        let m = dot(d, d);
        slope * m.sqrt() / (m - dot(to, bend))
    }
}
