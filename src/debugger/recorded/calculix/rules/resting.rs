//! Loads on bodies that rest on a single, flat contact: above friction, away from it, beyond its edge, above the plastic limit.

use super::motion::{GroupMotion, LOADED, Motion};
use super::numbers::{boundary, displaced, plain, rounded, rounded_up, vector};
use super::shape::{DeckShape, PairShape, SlaveGap, Vector};
use stickslip_core::RunFinding;
use stickslip_scene::sig4;

/// Cosine between normals of a contact that counts as flat.
const FLAT: f64 = 0.99;
/// Distance beyond the edge of a contact at which loads tip a body over, in sizes of a slave face. Contact in CalculiX also pulls slightly.
const EDGE: f64 = 0.1;
/// Friction that is advised, in parts of what the load needs: pressures are not uniform.
const SPARE: f64 = 1.25;
/// Directions in which the edge of a contact is looked for.
const DIRECTIONS: usize = 72;

/// A body that a single, flat pair holds at the end of a step.
struct Resting<'s> {
    pair: &'s PairShape,
    step: usize,
    motion: GroupMotion,
    /// The motions that supports leave free.
    free: Vec<Motion>,
    /// Normal of the contact, into the body.
    normal: Vector,
    force: Vector,
    /// The contact's nodes, from their mean.
    at: &'s [Vector],
    mean: Vector,
}

/// The slave nodes in front of the master, if it is flat there and the pair can open.
fn flat<'s>(shape: &DeckShape, pair: &'s PairShape) -> Option<Vec<&'s SlaveGap>> {
    let normal = pair.normal();
    let touching: Vec<&SlaveGap> = pair.in_front().collect();
    let rests = !touching.is_empty()
        && touching
            .iter()
            .all(|node| pair.masters[node.face].normal.dot(&normal) > FLAT)
        && !shape.is_tied(pair);
    rests.then_some(touching)
}

/// Whether displacements of later steps than the first drive a group until the end of a step.
fn is_driven(shape: &DeckShape, group: usize, step: usize) -> bool {
    shape
        .deck
        .steps
        .iter()
        .take(step + 1)
        .skip(1)
        .flat_map(|step| &step.motions)
        .any(|value| shape.group(value.node) == Some(group))
}

/// Whether the loads of a step alone press a group onto a single, flat contact, so that friction is known.
pub fn is_pressed_by_loads(shape: &DeckShape, group: usize, step: usize) -> bool {
    let pairs: Vec<_> = shape.pairs_of(group).collect();
    let [pair] = pairs[..] else {
        return false;
    };
    let motion = GroupMotion::new(shape, group, step);
    let along = motion.motion(motion.centre, pair.normal());
    flat(shape, pair).is_some()
        && is_within(&motion.free(shape), along)
        && !is_driven(shape, group, step)
}

/// Whether a motion lies in a space of motions.
fn is_within(space: &[Motion], motion: Motion) -> bool {
    let motion = motion.normalize();
    let part: f64 = space.iter().map(|m| m.dot(&motion).powi(2)).sum();
    part > 1.0 - 1e-6
}

impl Resting<'_> {
    /// Whether supports leave a motion free, at least as a translation, or as a rotation about an axis through a point.
    fn is_free(&self, along: Vector, about: Option<Vector>) -> bool {
        let motion = match about {
            None => self.motion.motion(self.motion.centre, along),
            Some(point) => {
                let shift = along.cross(&(self.motion.centre - point));
                let turn = along * self.motion.size;
                Motion::from_iterator(shift.iter().chain(turn.iter()).copied())
            }
        };
        is_within(&self.free, motion)
    }

    /// The first finding on a step of each body that rests on a single pair.
    fn findings(
        shape: &DeckShape,
        finding: impl Fn(&Resting) -> Option<RunFinding>,
    ) -> Vec<RunFinding> {
        if shape.deck.is_incomplete {
            return Vec::new();
        }
        let mut found = Vec::new();
        for pair in &shape.pairs {
            let Some(touching) = flat(shape, pair) else {
                continue;
            };
            let at = touching.iter().map(|node| shape.at(node.node));
            let mean = at.clone().sum::<Vector>() / touching.len() as f64;
            let at: Vec<Vector> = at.map(|at| at - mean).collect();
            let normal = pair.normal();
            for (group, normal) in [(pair.groups[0], normal), (pair.groups[1], -normal)] {
                if shape.pairs_of(group).count() != 1 {
                    continue;
                }
                let mut resting = shape
                    .reached()
                    .map(|(step, _)| step)
                    .take_while(|step| !is_driven(shape, group, *step));
                found.extend(resting.find_map(|step| {
                    let motion = GroupMotion::new(shape, group, step);
                    let rest = Resting {
                        pair,
                        step: step + 1,
                        force: motion.force(),
                        free: motion.free(shape),
                        motion,
                        normal,
                        at: &at,
                        mean,
                    };
                    finding(&rest)
                }));
            }
        }
        found
    }
}

/// A body that only contact holds, with a tangential load above what friction can bear.
pub fn beyond_friction(shape: &DeckShape) -> Vec<RunFinding> {
    Resting::findings(shape, |rest| {
        let law = shape.law(rest.pair);
        let pressed = -rest.force.dot(&rest.normal);
        let along = rest.force + pressed * rest.normal;
        let limit = law.friction * pressed.max(0.0);
        let is_small = LOADED * rest.force.norm();
        if law.friction == 0.0
            || along.norm() <= limit * (1.0 + 1e-6)
            || pressed < -is_small
            || !rest.is_free(along, None)
        {
            return None;
        }
        let name = shape.group_name(rest.motion.group);
        let pushes = format!(
            "step {} pushes {name} along {} with {}",
            rest.step,
            rest.pair.name,
            sig4(along.norm())
        );
        if pressed <= is_small {
            let set = shape.set_name(&rest.motion.loaded());
            return Some(RunFinding {
                rule: "load above friction",
                cause: format!(
                    "{pushes}, but no load presses it onto the contact, so friction holds nothing"
                ),
                cure: "a step before it that presses, or a displacement instead of the force"
                    .into(),
                lines: boundary([displaced(set, along.iamax(), "0.")]),
            });
        }
        let needed = rounded_up(SPARE * along.norm() / pressed);
        let stick = law
            .stick
            .map(|slope| format!(", {}", plain(slope)))
            .unwrap_or_default();
        let line = law.friction_place.line;
        Some(RunFinding {
            rule: "load above friction",
            cause: format!(
                "{pushes}, but friction holds at most {} x {} = {}: it slides away",
                sig4(law.friction),
                sig4(pressed),
                sig4(limit)
            ),
            cure: format!(
                "prescribe the displacement instead of the force, or a friction of at least {needed} (line {line})"
            ),
            lines: format!("{needed}{stick}"),
        })
    })
}

/// A body that only contact holds, pulled off it, or tipped over an edge of the contact.
pub fn off_the_contact(shape: &DeckShape) -> Vec<RunFinding> {
    Resting::findings(shape, |rest| {
        let (name, normal) = (shape.group_name(rest.motion.group), rest.normal);
        let pair = rest.pair;
        let pressed = -rest.force.dot(&normal);
        // Loaded nodes far from the contact.
        let height = |node: &usize| (shape.at(*node) - rest.mean).dot(&normal);
        let loaded = rest.motion.loaded();
        let most = loaded.iter().map(height).fold(0.0, f64::max);
        let mut far = loaded;
        far.retain(|node| height(node) > 0.75 * most);
        let set = shape.set_name(&far);
        let hold = |first: usize, last: usize| format!("*BOUNDARY\n{set}, {first}, {last}, 0.");
        if pressed < -LOADED * rest.force.norm() && rest.is_free(normal, None) {
            let axes = if shape.deck.is_solid() { 3 } else { 2 };
            return Some(RunFinding {
                rule: "pulled off",
                cause: format!(
                    "step {} pulls {name} off its only contact, {}, with the force {}: nothing else holds it",
                    rest.step,
                    pair.name,
                    sig4(-pressed)
                ),
                cure: format!(
                    "reverse the load if it should press; otherwise prescribe the displacement of {set}"
                ),
                lines: hold(1, axes),
            });
        }
        if pressed <= 0.0 {
            return None;
        }
        // Where the resultant meets the contact, against the edge of the contact in each direction.
        let moment: Vector = rest
            .motion
            .forces
            .values()
            .map(|f| (f.at - rest.mean).cross(&f.along))
            .sum();
        let meets = moment.cross(&normal) / pressed;
        let across = normal.cross(&Vector::ith(normal.iamin(), 1.0)).normalize();
        let beyond = (0..DIRECTIONS)
            .map(|k| {
                let angle = std::f64::consts::TAU * k as f64 / DIRECTIONS as f64;
                across * angle.cos() + normal.cross(&across) * angle.sin()
            })
            .map(|to| {
                let edge = rest
                    .at
                    .iter()
                    .map(|at| at.dot(&to))
                    .fold(f64::NEG_INFINITY, f64::max);
                (meets.dot(&to) - edge, edge, to)
            });
        let (beyond, edge, to) = beyond.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let axis = normal.cross(&to);
        if beyond <= EDGE * pair.sizes[0] || !rest.is_free(axis, Some(rest.mean + edge * to)) {
            return None;
        }
        let held = to.iamax() + 1;
        Some(RunFinding {
            rule: "tipping over",
            cause: format!(
                "the loads of step {} on {name} meet {} at {} beyond its edge, in direction {}: it tips over",
                rest.step,
                pair.name,
                sig4(beyond),
                vector(to)
            ),
            cure: format!("guide {set} in this direction, or load it less"),
            lines: hold(held, held),
        })
    })
}

/// A body pressed onto its contact with more than its material bears.
pub fn beyond_plastic_limit(shape: &DeckShape) -> Vec<RunFinding> {
    Resting::findings(shape, |rest| {
        let (name, pair) = (shape.group_name(rest.motion.group), rest.pair);
        let pressed = -rest.force.dot(&rest.normal);
        let area: f64 = pair.slaves.iter().map(|face| face.area).sum();
        let element = shape.group_elements(rest.motion.group).next()?;
        let material = &shape.deck.materials[shape.material(element)?];
        let most = material.yields?;
        if area == 0.0 || pressed <= most * area || !rest.is_free(rest.normal, None) {
            return None;
        }
        let set = shape.set_name(&rest.motion.loaded());
        let axis = rest.normal.iamax();
        let part = rounded(0.1 * pair.sizes[0]).copysign(-rest.normal[axis]);
        Some(RunFinding {
            rule: "load above the plastic limit",
            cause: format!(
                "step {} presses {name} onto {} with {} on an area of {}, {} per area, but {} yields at no more than {}",
                rest.step,
                pair.name,
                sig4(pressed),
                sig4(area),
                sig4(pressed / area),
                material.name,
                sig4(most)
            ),
            cure: format!("prescribe the displacement of {set} instead of the load"),
            lines: boundary([displaced(set, axis, plain(part))]),
        })
    })
}
