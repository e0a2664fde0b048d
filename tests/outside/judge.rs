//! Coulomb's law between two accepted states, from positions and forces alone.
//!
//! Signs: the normal n of the master points outward, the tangent t along the walk of the chain. A slave node that goes
//! along t over the master has a positive slip, which is the length of the chain, as it lies now, from the material point
//! S* of the first state to that of the second. Forces are those on the slave node: F_n = F · n presses where it is positive,
//! and friction opposes slip where F_t has the other sign.
//!
//! A node within the tolerance of a border between two elements may be on either of them, or on the vertex; so may one that
//! touches two surfaces. What only a vertex explains is counted apart.
//!
//! In a concave corner, with half the angle h between the normals and forces about their mean, a node that did not slip is
//! held up to the angle φ + h. One that slid there has come with the friction of the side that it slid on, at φ − h against the
//! slip, and what loads it further turns its force towards φ + h, at which it slides on along the other side. The cohesion c is
//! that of one side, or of the other. On a convex vertex nothing stays that slid there, but at the limit of one of the sides.

use super::chain::{At, Chain, Place, Point, Seen as Sight, Site, cross, dot, norm};
use super::give::Gives;
use std::f64::consts::FRAC_PI_2;
use stickslip::model::{Friction, Model, Surface};

/// Lengths that are no larger than this part of the scene's extent are nothing.
pub const LENGTH: f64 = 1e-8;
/// Forces that are no larger than this part of the largest are nothing.
pub const FORCE: f64 = 1e-7;

/// What can be broken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Law {
    /// A node is inside, or bears a force away from the surface.
    Gap,
    /// A node is pulled.
    Tension,
    /// The force is outside of the friction cone; on a smooth surface, is not normal to it.
    Cone,
    /// The force is inside the cone, and yet the node has slipped.
    Stuck,
    /// The force is on the cone, and friction is along the slip.
    Driven,
    /// Loads and reactions are not in balance.
    Balance,
}

impl Law {
    pub const ALL: [Law; 6] = [
        Law::Gap,
        Law::Tension,
        Law::Cone,
        Law::Stuck,
        Law::Driven,
        Law::Balance,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Law::Gap => "gap",
            Law::Tension => "tension",
            Law::Cone => "cone",
            Law::Stuck => "stuck",
            Law::Driven => "driven",
            Law::Balance => "balance",
        }
    }
}

/// A law that is broken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Breach {
    pub law: Law,
    /// Slave number; `None` if the whole is out of balance.
    pub slave: Option<usize>,
    /// By how much: a part of the scene's extent (gap), or of the largest force; of slips the smaller of both, that by which
    /// the node has slipped and that which friction lacks.
    pub amount: f64,
}

/// An accepted state.
#[derive(Debug, Clone, PartialEq)]
pub struct Seen {
    /// Current positions of the scene's nodes.
    pub positions: Vec<Point>,
    /// Force on every slave node, in the scene's axes.
    pub forces: Vec<Point>,
    /// All that acts from outside of the scene, reactions too; a rigid master's are those of its nodes.
    pub pulls: Vec<Pull>,
}

/// A force and a moment from outside that act at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pull {
    pub at: Point,
    pub force: Point,
    pub moment: f64,
}

/// The largest force and the extent of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    pub length: f64,
    pub force: f64,
}

/// What the judge found in an increment.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Verdict {
    pub breaches: Vec<Breach>,
    /// Nodes whose force only a vertex explains, and rightly.
    pub vertices: usize,
    /// Nodes that were open, or elsewhere, and whose friction no point explains at which they could have touched on the way.
    pub unexplained: usize,
}

/// Judges the increment between two accepted states. `brought` is a slip that every slave node brings into it.
pub fn judge(
    model: &Model,
    [before, now]: [&Seen; 2],
    friction: &[Friction],
    brought: &[f64],
    scales: Scales,
) -> Verdict {
    let [then, chains] = [before, now].map(|state| chains(model, state));
    let [gave, gives] =
        [(before, &then), (now, &chains)].map(|(state, chains)| Gives::new(model, state, chains));
    let mut verdict = Verdict::default();
    for (number, slave) in model.contacts.iter().enumerate() {
        let node = Node {
            number,
            then: gave.point(number),
            now: gives.point(number),
            force: now.forces[number],
            friction: friction[number],
            brought: brought[number],
        };
        let sides = Sides {
            surfaces: &slave.surfaces,
            then: &then,
            now: &chains,
            gives: &gives,
            scales,
        };
        let found = sides.judge(&node);
        verdict.vertices += usize::from(found.vertex);
        verdict.unexplained += usize::from(found.unexplained);
        verdict.breaches.extend(found.worst.map(|(law, amount)| {
            let slave = Some(number);
            Breach { law, slave, amount }
        }));
    }
    verdict.breaches.extend(balance(now, scales));
    verdict
}

fn chains(model: &Model, state: &Seen) -> Vec<Chain> {
    let chain = |s: &Surface| {
        if s.smooth.is_empty() {
            let chain = Chain::new(&s.elements, &state.positions, s.endless);
            return chain.extended(s.past_ends);
        }
        // Of the pieces only the nodes that they go through are taken, one after the other.
        let pieces = s.elements.iter().zip(&s.smooth);
        let ends = pieces.map(|(nodes, piece)| [nodes[piece.first], nodes[piece.first + 1]]);
        let mut walk: Vec<usize> = ends.flatten().collect();
        walk.dedup();
        let at: Vec<_> = walk.iter().map(|&n| state.positions[n]).collect();
        let knots: Vec<_> = walk.iter().map(|&n| model.nodes[n].at).collect();
        let closed = walk.len() > 2 && walk.first() == walk.last();
        Chain::smooth(&at, &knots, closed).extended(s.past_ends)
    };
    model.surfaces.iter().map(chain).collect()
}

/// Sum of all forces from outside, and of their moments about the middle of where they act.
fn balance(now: &Seen, scales: Scales) -> Option<Breach> {
    let count = now.pulls.len().max(1) as f64;
    let mut middle = [0.0; 2];
    for pull in &now.pulls {
        middle[0] += pull.at[0] / count;
        middle[1] += pull.at[1] / count;
    }
    let (mut force, mut moment) = ([0.0; 2], 0.0);
    for pull in &now.pulls {
        force[0] += pull.force[0];
        force[1] += pull.force[1];
        let arm = [pull.at[0] - middle[0], pull.at[1] - middle[1]];
        moment += pull.moment + cross(arm, pull.force);
    }
    let amount = norm(force).max(moment.abs() / scales.length) / scales.force;
    (amount > FORCE).then_some(Breach {
        law: Law::Balance,
        slave: None,
        amount,
    })
}

/// A slave node between two states.
struct Node {
    number: usize,
    then: Point,
    now: Point,
    force: Point,
    friction: Friction,
    brought: f64,
}

/// The surfaces that a node may touch, in both states.
struct Sides<'a> {
    surfaces: &'a [usize],
    then: &'a [Chain],
    now: &'a [Chain],
    gives: &'a Gives<'a>,
    scales: Scales,
}

/// What was found at a node.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Found {
    worst: Option<(Law, f64)>,
    vertex: bool,
    unexplained: bool,
}

/// A node as it stands on one element.
#[derive(Debug, Clone, Copy)]
struct Stand {
    surface: usize,
    /// ξ of the end of its chain, if the node is there.
    end: Option<f64>,
    n: Point,
    t: Point,
    slip: f64,
    /// Whether it touched in the state before, too.
    touched: bool,
}

/// A surface, and a material point of it.
type On = (usize, Place);

impl Sides<'_> {
    fn judge(&self, node: &Node) -> Found {
        let (length, force) = (self.scales.length, self.scales.force);
        let gap = self.gap(self.now, node.now, node.force != [0.0; 2]);
        let pressed = norm(node.force) > FORCE * force;
        let off = match gap {
            Some(gap) if pressed => gap.abs(),
            Some(gap) => (-gap).max(0.0),
            None if pressed => f64::INFINITY,
            None => 0.0,
        };
        if off > LENGTH * length {
            return Found {
                worst: Some((Law::Gap, off / length)),
                ..Found::default()
            };
        }
        if !pressed {
            return Found::default();
        }
        let mut best: Option<Found> = None;
        for found in self.explanations(node) {
            let rank = |f: &Found| (f.worst.map_or(0.0, |w| w.1), f.unexplained, f.vertex);
            if best.as_ref().is_none_or(|b| rank(&found) < rank(b)) {
                best = Some(found);
            }
        }
        best.unwrap_or_default()
    }

    /// Signed distance of the closest of all surfaces; `None` if that is an end, past which the node lies, or where only a node
    /// that is pressed is over it.
    fn gap(&self, chains: &[Chain], p: Point, pressed: bool) -> Option<f64> {
        let mut closest: Option<(f64, Option<f64>)> = None;
        for &surface in self.surfaces {
            let (distance, gap) = match chains[surface].see(p) {
                Sight::Over(
                    Site {
                        at: At::Inside(place),
                        distance,
                        ..
                    },
                    _,
                ) if !pressed && chains[surface].only_holds(place) => (distance, None),
                Sight::Over(site, gap) => (site.distance, Some(gap)),
                Sight::Beyond(site, by) => (
                    site.distance,
                    (by <= LENGTH * self.scales.length).then_some(site.distance),
                ),
            };
            if closest.is_none_or(|(other, _)| distance < other) {
                closest = Some((distance, gap));
            }
        }
        closest.and_then(|(_, gap)| gap)
    }

    /// Everything that the node may be doing: it stands on an element, on either of two, on a vertex, or between two surfaces.
    fn explanations(&self, node: &Node) -> Vec<Found> {
        let near = LENGTH * self.scales.length;
        let (mut stands, mut pairs) = (Vec::new(), Vec::new());
        for &surface in self.surfaces {
            let sites = self.now[surface].sites(node.now);
            let touching = || sites.iter().filter(|site| site.distance <= near);
            let end = touching().find_map(|site| match site.at {
                At::End(place) => Some(place.xi),
                _ => None,
            });
            for site in touching() {
                let mut stand = |place: Place| {
                    stands.push(self.stand((surface, place), end, node));
                    stands.len() - 1
                };
                match site.at {
                    At::Inside(place) | At::End(place) => _ = stand(place),
                    At::Border(one, other) => pairs.push((stand(one), stand(other))),
                }
            }
        }
        for (k, one) in stands.iter().enumerate() {
            for (l, other) in stands.iter().enumerate().skip(k + 1) {
                if let Some(first) = first_of(one, other) {
                    pairs.push(if first { (k, l) } else { (l, k) });
                }
            }
        }
        // What slid on one surface to where it meets another has slid as far where it stands on that one.
        for &(first, next) in &pairs {
            let [a, b] = [stands[first], stands[next]];
            if a.touched && !b.touched && a.slip > near {
                (stands[next].slip, stands[next].touched) = (a.slip, true);
            } else if b.touched && !a.touched && b.slip < -near {
                (stands[first].slip, stands[first].touched) = (b.slip, true);
            }
        }
        let mut all: Vec<Found> = stands.iter().map(|stand| self.on(stand, node)).collect();
        all.extend(pairs.into_iter().map(|(one, other)| {
            let [one, other] = [&stands[one], &stands[other]];
            if cross(one.t, other.t) > 0.0 {
                self.on_ridge(one, other, node)
            } else {
                self.in_corner(one, other, node)
            }
        }));
        all
    }

    /// The node as it stands on one element.
    fn stand(&self, (surface, place): On, end: Option<f64>, node: &Node) -> Stand {
        let (n, t) = self.gives.frame(node.number, (surface, place));
        let (slip, touched) = self.slip((surface, place), node);
        Stand {
            surface,
            end,
            n,
            t,
            slip,
            touched,
        }
    }

    /// The node stands on one element.
    fn on(&self, stand: &Stand, node: &Node) -> Found {
        let (f_n, f_t) = (dot(node.force, stand.n), dot(node.force, stand.t));
        let limit = node.friction.coefficient() * f_n.max(0.0) + node.friction.cohesion;
        let Scales { length, force } = self.scales;
        let (tiny, short) = (FORCE * force, LENGTH * length);
        if f_n < -tiny {
            return broken(Law::Tension, -f_n / force);
        }
        if f_t.abs() > limit + tiny {
            return broken(Law::Cone, (f_t.abs() - limit) / force);
        }
        let slip = stand.slip;
        let lacks = limit + f_t * slip.signum();
        if slip.abs() <= short || lacks <= tiny {
            return Found::default();
        }
        if !stand.touched {
            // What it stuck to may be where it is now; what it slid from, anywhere on the way.
            return Found {
                unexplained: f_t * slip > 0.0 && f_t.abs() >= limit - tiny,
                ..Found::default()
            };
        }
        let inside = f_t.abs() < limit - tiny;
        let law = if inside { Law::Stuck } else { Law::Driven };
        broken(law, (slip.abs() / length).min(lacks / force))
    }

    /// The node stands on a convex vertex, between two sides in the order of the walk.
    fn on_ridge(&self, one: &Stand, other: &Stand, node: &Node) -> Found {
        let (mu, cohesion) = (node.friction.coefficient(), node.friction.cohesion);
        let side = |n: Point, away: Point| {
            let (f_n, f_t) = (dot(node.force, n), dot(node.force, away));
            (-f_n).max(-f_t - mu * f_n - cohesion)
        };
        let ahead = side(other.n, other.t);
        let excess = side(one.n, one.t.map(|x| -x)).max(ahead) / self.scales.force;
        let slip = one.slip.abs() / self.scales.length;
        let worst = if excess > FORCE {
            Some((Law::Cone, excess))
        } else {
            (one.touched && slip > LENGTH).then_some((Law::Stuck, slip))
        };
        Found {
            worst,
            vertex: true,
            unexplained: false,
        }
    }

    /// The node is held in a concave corner, between two sides in the order of the walk.
    fn in_corner(&self, one: &Stand, other: &Stand, node: &Node) -> Found {
        let Scales { length, force } = self.scales;
        let short = LENGTH * length;
        let corner = Corner::new([one, other], &node.friction);
        let held = corner.beyond_held(node.force) / force;
        if held > FORCE {
            return broken(Law::Cone, held);
        }
        let slip = if one.touched && one.slip > short {
            one.slip
        } else if other.touched && other.slip < -short {
            other.slip
        } else {
            0.0
        };
        let against = -slip.signum();
        let lacks = corner.beyond_slid(node.force, against) / force;
        let law = if against * dot(node.force, corner.t) < 0.0 {
            Law::Driven
        } else {
            Law::Stuck
        };
        Found {
            worst: (slip != 0.0 && lacks > FORCE).then(|| (law, lacks.min(slip.abs() / length))),
            vertex: true,
            unexplained: false,
        }
    }

    /// How far the node has slipped, and whether it touched that surface before: if not, from where it was closest to.
    fn slip(&self, (surface, place): On, node: &Node) -> (f64, bool) {
        let (then, now) = (&self.then[surface], &self.now[surface]);
        let mut sites = then.sites(node.then);
        sites.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        let from = |at: At| match at {
            At::Inside(first) | At::End(first) | At::Border(first, _) => now.length(first, place),
        };
        let near = LENGTH * self.scales.length;
        let touched = sites.iter().filter(|site| site.distance <= near);
        let shortest = touched
            .map(|site| from(site.at) + node.brought)
            .min_by(|a, b| a.abs().total_cmp(&b.abs()));
        match shortest {
            Some(slip) => (slip, true),
            None => (from(sites[0].at), false),
        }
    }
}

/// Whether, of two sides on two surfaces, `one` comes first along the walk: where one surface ends and the other begins; or, where
/// they cross, into their concave corner. `None` on one surface, and between two that face each other.
fn first_of(one: &Stand, other: &Stand) -> Option<bool> {
    let faces = norm([one.t[0] + other.t[0], one.t[1] + other.t[1]]) < 1e-6;
    if one.surface == other.surface || faces {
        return None;
    }
    Some(match (one.end, other.end) {
        (Some(a), Some(b)) if a != b => a > b,
        _ => cross(one.t, other.t) < 0.0,
    })
}

fn broken(law: Law, amount: f64) -> Found {
    Found {
        worst: Some((law, amount)),
        ..Found::default()
    }
}

/// A concave corner, seen along the mean of its two normals.
pub struct Corner {
    n: Point,
    t: Point,
    /// Half the angle between the normals.
    half: f64,
    /// Friction angle.
    phi: f64,
    cohesion: f64,
}

impl Corner {
    /// Between two sides in the order of the walk.
    fn new([one, other]: [&Stand; 2], friction: &Friction) -> Corner {
        let sum = [one.t[0] + other.t[0], one.t[1] + other.t[1]];
        let t = sum.map(|x| x / norm(sum));
        let half = 0.5 * cross(other.t, one.t).atan2(dot(one.t, other.t));
        Corner::with(t, half, friction)
    }

    /// With the mean tangent, and half the angle between the normals (radians).
    pub fn with(t: Point, half: f64, friction: &Friction) -> Corner {
        Corner {
            n: [t[1], -t[0]],
            t,
            half,
            phi: friction.angle.to_radians(),
            cohesion: friction.cohesion,
        }
    }

    /// By how much a force is beyond that to which a node is held that did not slip.
    pub fn beyond_held(&self, force: Point) -> f64 {
        let edge = self.phi + self.half;
        // Between such sides a node is jammed whatever pulls at it.
        if edge >= FRAC_PI_2 {
            return 0.0;
        }
        let over = |against: f64| self.over(edge, against, force);
        over(1.0).max(over(-1.0)).max(self.pull(force))
    }

    /// The same for a node that slid there, whose friction is to act in the direction `against` (±1, along t).
    pub fn beyond_slid(&self, force: Point, against: f64) -> f64 {
        let (far, near) = (self.phi + self.half, self.phi - self.half);
        let mut worst = self.over(far, against, force);
        worst = worst.max(-self.over(near, against, force));
        if near > 0.0 {
            // What pulls at the side that it slid on is held by the cohesion of both.
            worst = worst.max(self.cohesion * self.half.cos() - against * dot(force, self.t));
        }
        if far < FRAC_PI_2 {
            worst = worst.max(self.pull(force));
        }
        worst
    }

    /// How far a force lies beyond the edge at an angle from the mean normal.
    fn over(&self, edge: f64, against: f64, force: Point) -> f64 {
        let (f_n, f_t) = (dot(force, self.n), against * dot(force, self.t));
        edge.cos() * f_t - edge.sin() * f_n - self.cohesion * self.phi.cos()
    }

    fn pull(&self, force: Point) -> f64 {
        -dot(force, self.n) - self.cohesion * self.half.sin()
    }
}
