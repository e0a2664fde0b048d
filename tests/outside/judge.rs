//! Coulomb's law between two accepted states, from positions and forces alone.
//!
//! Signs: the normal n of the master points outward, the tangent t along the walk of the chain. A slave node that goes
//! along t over the master has a positive slip, which is the length of the chain, as it lies now, from the material point
//! S* of the first state to that of the second. Forces are those on the slave node: F_n = F · n presses where it is positive,
//! and friction opposes slip where F_t has the other sign.
//!
//! A node within the tolerance of a border between two elements may be on either of them, or on the vertex. What only a
//! vertex explains is counted apart.

use super::chain::{At, Chain, Place, Point, Seen as Sight, cross, dot, norm};
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
    let mut verdict = Verdict::default();
    for (number, slave) in model.contacts.iter().enumerate() {
        let node = Node {
            then: before.positions[slave.node],
            now: now.positions[slave.node],
            force: now.forces[number],
            friction: friction[number],
            brought: brought[number],
        };
        let sides = Sides {
            surfaces: &slave.surfaces,
            then: &then,
            now: &chains,
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
            return Chain::new(&s.elements, &state.positions, s.endless);
        }
        // Of the pieces only the nodes that they go through are taken, one after the other.
        let pieces = s.elements.iter().zip(&s.smooth);
        let ends = pieces.map(|(nodes, piece)| [nodes[piece.first], nodes[piece.first + 1]]);
        let mut walk: Vec<usize> = ends.flatten().collect();
        walk.dedup();
        let at: Vec<_> = walk.iter().map(|&n| state.positions[n]).collect();
        let knots: Vec<_> = walk.iter().map(|&n| model.nodes[n].at).collect();
        let closed = walk.len() > 2 && walk.first() == walk.last();
        Chain::smooth(&at, &knots, closed)
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
    scales: Scales,
}

/// What was found at a node.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Found {
    worst: Option<(Law, f64)>,
    vertex: bool,
    unexplained: bool,
}

/// A surface, and a material point of it.
type On = (usize, Place);

impl Sides<'_> {
    fn judge(&self, node: &Node) -> Found {
        let (length, force) = (self.scales.length, self.scales.force);
        let gap = self.gap(self.now, node.now);
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

    /// Signed distance of the closest of all surfaces; `None` if that is an end, past which the node lies.
    fn gap(&self, chains: &[Chain], p: Point) -> Option<f64> {
        let mut closest: Option<(f64, Option<f64>)> = None;
        for &surface in self.surfaces {
            let (distance, gap) = match chains[surface].see(p) {
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

    /// Everything that the node may be doing: it stands on an element, on either of two, or on a vertex.
    fn explanations(&self, node: &Node) -> Vec<Found> {
        let mut all = Vec::new();
        for &surface in self.surfaces {
            let touching = self.now[surface].sites(node.now);
            for site in touching {
                if site.distance > LENGTH * self.scales.length {
                    continue;
                }
                match site.at {
                    At::Inside(place) | At::End(place) => all.push(self.on((surface, place), node)),
                    At::Border(one, other) => {
                        all.push(self.on((surface, one), node));
                        all.push(self.on((surface, other), node));
                        all.push(self.on_vertex(surface, one, other, node));
                    }
                }
            }
        }
        all
    }

    /// The node stands on one element.
    fn on(&self, (surface, place): On, node: &Node) -> Found {
        let (n, t) = self.now[surface].frame(place);
        let (f_n, f_t) = (dot(node.force, n), dot(node.force, t));
        let limit = node.friction.coefficient() * f_n.max(0.0) + node.friction.cohesion;
        let Scales { length, force } = self.scales;
        let (tiny, short) = (FORCE * force, LENGTH * length);
        let broken = |law: Law, amount: f64| Found {
            worst: Some((law, amount)),
            ..Found::default()
        };
        if f_n < -tiny {
            return broken(Law::Tension, -f_n / force);
        }
        if f_t.abs() > limit + tiny {
            return broken(Law::Cone, (f_t.abs() - limit) / force);
        }
        let (slip, touched) = self.slip((surface, place), node);
        let lacks = limit + f_t * slip.signum();
        if slip.abs() <= short || lacks <= tiny {
            return Found::default();
        }
        if !touched {
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

    /// The node stands where one element ends and another begins. What it slid over on its way there is not asked: a part of
    /// the increment may have passed since.
    fn on_vertex(&self, surface: usize, one: Place, other: Place, node: &Node) -> Found {
        let chain = &self.now[surface];
        let [(n1, t1), (n2, t2)] = [chain.frame(one), chain.frame(other)];
        let (mu, cohesion) = (node.friction.coefficient(), node.friction.cohesion);
        let excess = if cross(t1, t2) > 0.0 {
            let side = |n: Point, away: Point| {
                let (f_n, f_t) = (dot(node.force, n), dot(node.force, away));
                (-f_n).max(-f_t - mu * f_n - cohesion)
            };
            side(n1, [-t1[0], -t1[1]]).max(side(n2, t2))
        } else {
            outside([(n1, t1), (n2, t2)], mu, cohesion, node.force)
        };
        let excess = excess / self.scales.force;
        Found {
            worst: (excess > FORCE).then_some((Law::Cone, excess)),
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

/// By how much a force is outside of the sum of two friction cones, which are those of the sides of a concave corner.
///
/// The edges of a sum of convex sets are those of either, moved as far as the other reaches that way.
fn outside(sides: [(Point, Point); 2], mu: f64, cohesion: f64, force: Point) -> f64 {
    let scale = (1.0 + mu * mu).sqrt();
    let at = |(n, t): (Point, Point), a: f64, b: f64| [a * n[0] + b * t[0], a * n[1] + b * t[1]];
    let reach = |side: (Point, Point), d: Point| {
        let grows = [-mu, mu].iter().any(|&b| dot(d, at(side, 1.0, b)) > 1e-12);
        if grows {
            f64::INFINITY
        } else {
            cohesion * dot(d, side.1).abs()
        }
    };
    let mut worst = f64::NEG_INFINITY;
    for side in sides {
        let edges = [
            at(side, -1.0, 0.0),
            at(side, -mu / scale, 1.0 / scale),
            at(side, -mu / scale, -1.0 / scale),
        ];
        for d in edges {
            worst = worst.max(dot(force, d) - reach(sides[0], d) - reach(sides[1], d));
        }
    }
    worst
}
