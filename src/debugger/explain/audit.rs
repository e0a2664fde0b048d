//! The judge's findings over a whole history, and what no single increment shows.
//!
//! Every accepted increment carries what the judge found of it. An audit keeps the worst of each law, those that were only
//! marked apart, and adds what contact of slave nodes with master surfaces cannot see: nodes of a master that lie inside
//! a slave's body, and increments in which friction gave work.

use stickslip_core::contact::element::Element;
use stickslip_core::contact::feet::place;
use stickslip_core::contact::laws::{Finding, Law};
use stickslip_core::fem::deformation::{PointDeformation, deformation};
use stickslip_core::model::Model;
use stickslip_core::model::{BodyKind, Solid};
use stickslip_core::step::event::Outcome;
use stickslip_core::step::stepper::Stepper;

/// Points of every edge of an outline, for the search for nodes inside it.
const POINTS: usize = 8;

/// What was found where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// From 1.
    pub increment: u32,
    /// λ at the end of the increment.
    pub load_factor: f64,
    /// The worst violation of a contact law there.
    pub finding: Finding,
}

/// A master's node inside the body of slave nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Inside {
    /// From 1.
    pub increment: u32,
    /// λ at the end of the increment.
    pub load_factor: f64,
    /// Number of the node and of the body in the scene.
    pub node: usize,
    /// Number of the body in the model, from 0.
    pub body: usize,
    /// How far it is from the outline (length).
    pub depth: f64,
}

/// A point of a solid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretched {
    /// Increment number, from 1.
    pub increment: u32,
    /// λ at the end of the increment.
    pub load_factor: f64,
    /// Deformation at the point.
    pub point: PointDeformation,
}

/// A history judged.
#[derive(Debug, Clone, Default)]
pub struct Audit {
    /// Accepted increments, and those of them that were only marked.
    pub increments: u32,
    /// Those of them that were only marked.
    pub marked: u32,
    /// The worst place of each law over all increments that were not marked, in the order of [`Law::ALL`], and then of
    /// [`Law::OF_BONDS`].
    pub worst: [Option<Found>; 11],
    /// The same of the marked ones.
    pub worst_marked: [Option<Found>; 11],
    /// Where friction gave the most work.
    pub work: Option<Found>,
    /// The deepest place of a master's node in a slave's body.
    pub inside: Option<Inside>,
    /// The smallest principal stretch of the solids.
    pub stretch: Option<Stretched>,
    /// The first point outside the range of its law.
    pub outside: Option<Stretched>,
}

impl Audit {
    /// Takes in what the last minor iteration led to, if it was an accepted increment.
    pub fn take(&mut self, stepper: &Stepper) {
        let (event, state) = (stepper.event(), stepper.state());
        let (Outcome::Increment { marked, .. }, Some(verdict)) =
            (&event.outcome, &state.start.verdict)
        else {
            return;
        };
        self.increments += 1;
        self.marked += u32::from(marked.is_some());
        let found = |finding: Finding| Found {
            increment: event.position.increment,
            load_factor: event.load_factor,
            finding,
        };
        let worst = match marked {
            Some(_) => &mut self.worst_marked,
            None => &mut self.worst,
        };
        let all = verdict.worst.iter().chain(&verdict.bonds);
        for (worst, &finding) in worst.iter_mut().zip(all) {
            keep_worse(worst, finding.map(found));
        }
        keep_worse(&mut self.work, verdict.work.map(found));
        if let Some(found) = deformation(stepper.model(), &state.start.u) {
            let stretched = |point: PointDeformation| Stretched {
                increment: event.position.increment,
                load_factor: event.load_factor,
                point,
            };
            let least = self
                .stretch
                .map_or(f64::INFINITY, |known| known.point.stretch);
            if found.smallest.stretch < least {
                self.stretch = Some(stretched(found.smallest));
            }
            self.outside = self.outside.or(found.outside.map(stretched));
        }
        let deepest = deepest(stepper.model(), &state.start.u);
        if let Some((node, body, depth)) = deepest
            && self
                .inside
                .as_ref()
                .is_none_or(|inside| depth > inside.depth)
        {
            self.inside = Some(Inside {
                increment: event.position.increment,
                load_factor: event.load_factor,
                node,
                body,
                depth,
            });
        }
    }

    /// The laws that unmarked increments broke.
    pub fn broken(&self) -> impl Iterator<Item = &Found> {
        let all = self.worst.iter().flatten();
        all.filter(|found| found.finding.is_broken())
    }

    /// The worst place of a law in increments that were not marked.
    pub fn of(&self, law: Law) -> Option<&Found> {
        let mut all = self.worst.iter().flatten();
        all.find(|found| found.finding.law == law)
    }
}

fn keep_worse(worst: &mut Option<Found>, found: Option<Found>) {
    let Some(found) = found else { return };
    let times = found.finding.times();
    #[cfg(mutants)]
    let times = stickslip_core::mutants::pick("audit-of-the-last-increment", times, f64::INFINITY);
    let worse = |worst: &Found| times > worst.finding.times() || times.is_nan();
    if worst.as_ref().is_none_or(worse) {
        *worst = Some(found);
    }
}

/// The node of a master surface that lies deepest inside a solid that slave nodes belong to: node, body, depth.
fn deepest(model: &Model, u: &[f64]) -> Option<(usize, usize, f64)> {
    let now: Vec<[f64; 2]> = model
        .nodes
        .iter()
        .zip(&model.dofs.first)
        .map(|(node, &first)| [node.at[0] + u[first], node.at[1] + u[first + 1]])
        .collect();
    let mut deepest: Option<(usize, usize, f64)> = None;
    for (number, body) in model.bodies.iter().enumerate() {
        let BodyKind::Solid(solid) = &body.kind else {
            continue;
        };
        let slaves: Vec<_> = model
            .contacts
            .iter()
            .filter(|s| body.nodes.contains(&s.node))
            .collect();
        let mut masters: Vec<usize> = slaves
            .iter()
            .flat_map(|slave| &slave.surfaces)
            .flat_map(|&surface| model.surfaces[surface].elements.iter().flatten().copied())
            .filter(|node| !body.nodes.contains(node))
            .collect();
        masters.sort_unstable();
        masters.dedup();
        if masters.is_empty() {
            continue;
        }
        let outline = outline(solid, &now);
        for node in masters {
            let depth = depth(&outline, now[node]);
            if depth > deepest.map_or(0.0, |(.., most)| most) {
                deepest = Some((node, number, depth));
            }
        }
    }
    deepest
}

/// The outline of a solid as a chain of short straight lines; the body lies on their left.
fn outline(solid: &Solid, now: &[[f64; 2]]) -> Vec<[[f64; 2]; 2]> {
    let at = |k: usize| -1.0 + 2.0 * k as f64 / POINTS as f64;
    let lines = solid.edges.iter().flat_map(|nodes| {
        let edge = Element::lagrange(nodes);
        (0..POINTS).map(move |k| [at(k), at(k + 1)].map(|xi| place(edge, now, xi)))
    });
    lines.collect()
}

/// Distance of a point from an outline where it is inside; else 0.
fn depth(outline: &[[[f64; 2]; 2]], point: [f64; 2]) -> f64 {
    let mut turns = 0;
    let mut nearest = f64::INFINITY;
    for [a, b] in outline {
        let side = (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0]);
        if a[1] <= point[1] && b[1] > point[1] && side > 0.0 {
            turns += 1;
        } else if a[1] > point[1] && b[1] <= point[1] && side < 0.0 {
            turns -= 1;
        }
        nearest = nearest.min(distance(*a, *b, point));
    }
    if turns == 0 { 0.0 } else { nearest }
}

/// Distance of a point from a straight line between two others.
fn distance(a: [f64; 2], b: [f64; 2], point: [f64; 2]) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let to = [point[0] - a[0], point[1] - a[1]];
    let squared = along[0] * along[0] + along[1] * along[1];
    let part = (to[0] * along[0] + to[1] * along[1]) / squared.max(f64::MIN_POSITIVE);
    let part = part.clamp(0.0, 1.0);
    let off = [to[0] - part * along[0], to[1] - part * along[1]];
    (off[0] * off[0] + off[1] * off[1]).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_is_the_distance_from_the_outline_inside_and_nothing_outside() {
        let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
        let square: Vec<_> = (0..4).map(|k| [corners[k], corners[(k + 1) % 4]]).collect();
        assert_eq!(depth(&square, [1.0, 0.25]), 0.25);
        assert_eq!(depth(&square, [1.9, 0.5]), 0.10000000000000009);
        for outside in [[-0.1, 0.5], [1.0, 1.2], [3.0, 0.0], [1.0, -0.3]] {
            assert_eq!(depth(&square, outside), 0.0);
        }
    }
}
