//! Rigid motions that supports and closed contacts leave to a body, and the loads that act along them.

use super::shape::{DeckShape, PairShape, SlaveGap, Vector};
use nalgebra::{SMatrix, SVector};
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use stickslip_core::RunFinding;
use stickslip_exchange::inp::deck::{Direction, Normal, Step, Value, Volume};
use stickslip_scene::number::sig4;

/// Translations along x, y, z, then rotations about them, scaled by the body's size.
type Motion = SVector<f64, 6>;

/// Stiffness of the supports, relative to the largest, below which a motion is free.
const FREE: f64 = 1e-9;
/// Part of a load along a free motion, relative to the load, above which it moves the body.
const LOADED: f64 = 1e-6;
/// Cosine between normals of a contact that counts as flat.
const FLAT: f64 = 0.99;
/// Distance beyond the edge of a contact at which loads tip a body over, in sizes of a slave face. Contact in CalculiX also pulls slightly.
const EDGE: f64 = 0.1;
/// Directions in which the edge of a contact is looked for.
const DIRECTIONS: usize = 72;

/// A group of bodies with what supports and loads it in the first step.
struct GroupMotion {
    centre: Vector,
    size: f64,
    supports: SMatrix<f64, 6, 6>,
    load: Motion,
    /// Nodes with loads, and the sum of the forces.
    loaded: BTreeSet<usize>,
    force: Vector,
}

impl GroupMotion {
    fn new(shape: &DeckShape, group: usize) -> GroupMotion {
        let nodes = (0..shape.deck.nodes.len()).filter(|n| shape.group(*n) == Some(group));
        let at: Vec<Vector> = nodes.map(|node| shape.at(node)).collect();
        let centre = at.iter().sum::<Vector>() / at.len().max(1) as f64;
        let size = at.iter().map(|p| (p - centre).norm()).fold(0.0, f64::max);
        let mut this = GroupMotion {
            centre,
            size: size.max(f64::MIN_POSITIVE),
            supports: SMatrix::zeros(),
            load: Motion::zeros(),
            loaded: BTreeSet::new(),
            force: Vector::zeros(),
        };
        for value in supports(shape) {
            if shape.group(value.node) == Some(group)
                && let Some(along) = axis(value.direction)
            {
                this.hold(shape.at(value.node), along);
            }
        }
        for force in forces(shape, 0) {
            if shape.group(force.nodes[0]) == Some(group) {
                this.load += this.motion(force.at, force.along);
                this.force += force.along;
                this.loaded.extend(force.nodes);
            }
        }
        this
    }

    /// The rigid motion that moves a point along a direction.
    fn motion(&self, at: Vector, along: Vector) -> Motion {
        let turn = (at - self.centre).cross(&along) / self.size;
        Motion::from_iterator(along.iter().chain(turn.iter()).copied())
    }

    fn hold(&mut self, at: Vector, along: Vector) {
        let row = self.motion(at, along);
        self.supports += row * row.transpose();
    }

    /// Holds the nodes of a pair that touch at the start: along the normal, and along the surface with friction.
    fn hold_contacts(&mut self, shape: &DeckShape, pair: &PairShape, friction: bool) {
        for node in pair.nodes.iter().filter(|node| pair.is_closed(node)) {
            let at = shape.at(node.node);
            match friction {
                true => [Vector::x(), Vector::y(), Vector::z()]
                    .into_iter()
                    .for_each(|along| self.hold(at, along)),
                false => self.hold(at, pair.masters[node.face].normal),
            }
        }
    }

    /// The free motions as columns of unit length.
    fn free(&self, modes: [bool; 6]) -> Vec<Motion> {
        let mut supports = self.supports;
        let largest = supports.trace().max(1.0);
        for (k, _) in modes.iter().enumerate().filter(|(_, moves)| !**moves) {
            supports[(k, k)] += largest;
        }
        let eigen = supports.symmetric_eigen();
        let values = eigen.eigenvalues.iter().enumerate();
        let free = values.filter(|(_, value)| **value < FREE * largest);
        free.map(|(k, _)| eigen.eigenvectors.column(k).into_owned())
            .collect()
    }

    /// Whether the load does work on one of the motions.
    fn is_loaded(&self, free: &[Motion]) -> bool {
        let work = free.iter().map(|motion| motion.dot(&self.load).abs());
        work.fold(0.0, f64::max) > LOADED * self.load.norm()
    }
}

fn axis(direction: Direction) -> Option<Vector> {
    match direction {
        Direction::X => Some(Vector::x()),
        Direction::Y => Some(Vector::y()),
        Direction::Z => Some(Vector::z()),
        Direction::Rotation => None,
    }
}

/// Supports and prescribed displacements of the first step.
fn supports<'s>(shape: &'s DeckShape) -> impl Iterator<Item = &'s Value> {
    let first = shape.deck.steps.first();
    let motions = first.into_iter().flat_map(|step| &step.motions);
    shape.deck.supports.iter().chain(motions)
}

/// A point load, or the resultant of a load on a side or an element.
struct Force {
    /// The kind of load, and its node, or its element and side.
    of: [usize; 3],
    /// The nodes that it acts on; at least one.
    nodes: Vec<usize>,
    at: Vector,
    along: Vector,
}

/// The forces at the end of a step.
fn forces(shape: &DeckShape, step: usize) -> Vec<Force> {
    let deck = shape.deck;
    let Some(step) = deck.steps.get(step) else {
        return Vec::new();
    };
    let part = |amplitude: Option<usize>| match amplitude {
        None => 1.0,
        Some(_) => shape.factor(step, amplitude, step.time.period),
    };
    let mut all = Vec::new();
    for force in &step.forces {
        let along = axis(force.direction).map(|along| along * force.value * part(force.amplitude));
        all.extend(along.map(|along| Force {
            of: [0, force.node, 0],
            nodes: vec![force.node],
            at: shape.at(force.node),
            along,
        }));
    }
    for pressure in &step.pressures {
        if let Some(face) = shape.face(pressure.element, pressure.side) {
            let size = -pressure.value * face.area * part(pressure.amplitude);
            let (corners, middles) = deck.face(pressure.element, pressure.side);
            all.push(Force {
                of: [1, pressure.element, pressure.side],
                nodes: [corners, middles].concat(),
                at: face.centre,
                along: face.normal * size,
            });
        }
    }
    for weight in &step.weights {
        let element = &deck.elements[weight.element];
        let faces = (0..element.kind.cell.sides().len())
            .filter_map(|side| shape.face(weight.element, side));
        let faces: Vec<_> = faces.collect();
        let Some(first) = faces.first() else {
            continue;
        };
        let parts = faces
            .iter()
            .map(|face| face.area * (face.centre - first.centre).dot(&face.normal));
        let volume = parts.sum::<f64>() / if deck.is_solid() { 3.0 } else { 2.0 };
        let per_volume = match weight.load {
            Volume::Force(force) => Vector::from(force),
            Volume::Gravity(acceleration) => {
                let material = shape.material(weight.element);
                let density = material.and_then(|k| deck.materials[k].density);
                Vector::from(acceleration) * density.unwrap_or(0.0)
            }
        };
        all.push(Force {
            of: [2, weight.element, 0],
            nodes: element.nodes.clone(),
            at: faces.iter().map(|face| face.centre).sum::<Vector>() / faces.len() as f64,
            along: per_volume * volume * part(weight.amplitude),
        });
    }
    all
}

/// Free motions in words.
fn words(free: &[Motion]) -> String {
    let held = |k: usize| {
        let part: f64 = free.iter().map(|motion| motion[k] * motion[k]).sum();
        part > 1.0 - 1e-6
    };
    let axes = |from: usize| -> Vec<&str> {
        let axes = ["x", "y", "z"].into_iter().enumerate();
        axes.filter(|(k, _)| held(from + k))
            .map(|(_, axis)| axis)
            .collect()
    };
    let (along, about) = (axes(0), axes(3));
    let pure = [("along", &along), ("about", &about)];
    let pure = pure.iter().filter(|(_, axes)| !axes.is_empty());
    let mut words: Vec<String> = pure
        .map(|(word, axes)| format!("{word} {}", axes.join(", ")))
        .collect();
    if along.len() + about.len() < free.len() {
        words.push("about a skew axis".into());
    }
    words.join(" and ")
}

/// Numbers of a vector, shortened.
fn vector(of: Vector) -> String {
    let [x, y, z] = [of.x, of.y, of.z].map(|part| {
        sig4(if part.abs() < 1e-9 * of.norm() {
            0.0
        } else {
            part
        })
    });
    format!("({x}, {y}, {z})")
}

/// The pairs that touch a group, with whether they have friction.
fn pairs_of<'s>(
    shape: &'s DeckShape,
    group: usize,
) -> impl Iterator<Item = (usize, &'s PairShape)> {
    let pairs = shape.pairs.iter().enumerate();
    pairs.filter(move |(_, pair)| pair.groups.contains(&group))
}

/// Whether a pair holds in tension and shear, too.
fn is_tied(shape: &DeckShape, pair: usize) -> bool {
    let law = &shape.deck.interactions[shape.deck.pairs[pair].interaction];
    matches!(law.normal, Normal::Tied { .. })
}

fn groups(shape: &DeckShape) -> BTreeSet<usize> {
    shape.group_of.iter().copied().collect()
}

/// Whether supports alone leave a group free.
pub fn is_free(shape: &DeckShape, group: usize) -> bool {
    !GroupMotion::new(shape, group)
        .free(shape.modes(group))
        .is_empty()
}

/// A body that no support, tie or contact holds.
pub fn unconnected(shape: &DeckShape) -> Vec<RunFinding> {
    if shape.deck.is_incomplete {
        return Vec::new();
    }
    let far = shape
        .ties
        .iter()
        .filter(|tie| !tie.nodes.iter().any(|n| tie.is_closed(n)));
    let far: BTreeSet<usize> = far.flat_map(|tie| tie.groups).collect();
    let alone = groups(shape).into_iter().filter(|group| {
        let free = GroupMotion::new(shape, *group).free(shape.modes(*group));
        !free.is_empty() && pairs_of(shape, *group).next().is_none() && !far.contains(group)
    });
    alone
        .map(|group| {
            let name = shape.group_name(group);
            let free = GroupMotion::new(shape, group).free(shape.modes(group));
            let nodes = (0..shape.deck.nodes.len()).filter(|n| shape.group(*n) == Some(group));
            let first = nodes.map(|node| shape.deck.nodes[node].label).min();
            RunFinding {
                rule: "unconnected body",
                cause: format!(
                    "{name} is in no contact pair and no tie, and its supports leave it free {}",
                    words(&free)
                ),
                cure: format!("support {name}, or put it into a *CONTACT PAIR or *TIE"),
                lines: format!("*BOUNDARY\n{}, 1, 3", first.unwrap_or_default()),
            }
        })
        .collect()
}

/// A loaded body that only contact holds, and all of it is open at the start.
pub fn open_at_start(shape: &DeckShape) -> Vec<RunFinding> {
    free_groups(shape, |shape, group, motion, free| {
        let pairs: Vec<&PairShape> = pairs_of(shape, group).map(|(_, pair)| pair).collect();
        let closed = pairs
            .iter()
            .any(|pair| pair.nodes.iter().any(|n| pair.is_closed(n)));
        let first = *pairs.first()?;
        if closed {
            return None;
        }
        let nearest = pairs
            .iter()
            .filter_map(|pair| Some((*pair, pair.nearest()?)));
        let nearest = nearest.min_by(|a, b| a.1.gap.total_cmp(&b.1.gap));
        let name = shape.group_name(group);
        let force = motion.force;
        let set = shape.set_name(&motion.loaded);
        let modes = shape.modes(group);
        let moves = |k: usize| free.iter().any(|motion| motion[k].abs() > 1e-3);
        // The direction in which the body closes the gap.
        let closing = nearest.map(|(pair, node)| {
            let normal = pair.masters[node.face].normal;
            let is_slave = pair.groups[0] == group;
            (node.gap, if is_slave { -normal } else { normal })
        });
        // Supports that keep the body from following the load also keep it from closing the gap.
        let closes = closing.filter(|(_, to)| moves(to.iamax()));
        let held = (0..3).filter(|&k| match closes {
            Some((_, to)) => modes[k] && k != to.iamax(),
            None => moves(k),
        });
        let mut lines: Vec<String> = held
            .map(|k| format!("{set}, {0}, {0}, 0.", k + 1))
            .collect();
        lines.extend(closes.map(|(gap, to)| {
            let along = to.iamax();
            let travel = rounded_up(1.2 * gap / to[along].abs()).copysign(to[along]);
            format!("{set}, {0}, {0}, {travel}", along + 1)
        }));
        let cure = match (closing, closes) {
            (_, Some(_)) => format!(
                "close the gap first: a step before the load with a displacement of {set} by more than the gap"
            ),
            (Some(_), None) => {
                format!("hold {name} in these directions until the contact is closed")
            }
            (None, None) => format!("move {name} to its contact, or hold it in these directions"),
        };
        let open = match nearest {
            Some((pair, node)) => format!(
                "smallest gap {}, node {} of {}",
                sig4(node.gap),
                shape.deck.nodes[node.node].label,
                shape.pair_name(pair)
            ),
            None => format!(
                "no slave node is in front of the master, {}",
                shape.pair_name(first)
            ),
        };
        let away = match closing.is_some_and(|(_, to)| to.dot(&force) < -LOADED * force.norm()) {
            true => ", away from it",
            false => "",
        };
        Some(RunFinding {
            rule: "held by open contact",
            cause: format!(
                "{name} is free {} until it touches: all its contact is open at the start ({open}), and step 1 loads it \
                 with the force {}{away}",
                words(free),
                vector(force)
            ),
            cure,
            lines: match lines.is_empty() {
                true => String::new(),
                false => format!("*BOUNDARY\n{}", lines.join("\n")),
            },
        })
    })
}

/// A loaded body that can slide along its closed contact, because it has no friction.
pub fn free_to_slide(shape: &DeckShape) -> Vec<RunFinding> {
    free_groups(shape, |shape, group, motion, free| {
        let closed = |pair: &PairShape| pair.nodes.iter().any(|n| pair.is_closed(n));
        let (_, pair) = pairs_of(shape, group).find(|(_, pair)| closed(pair))?;
        let name = shape.group_name(group);
        let set = shape.set_name(&motion.loaded);
        let moving = (0..3).filter(|&k| free.iter().any(|m| m[k].abs() > 1e-3));
        let lines: Vec<String> = moving
            .map(|k| format!("{set}, {0}, {0}, 0.", k + 1))
            .collect();
        Some(RunFinding {
            rule: "free to slide",
            cause: format!(
                "{name} is free {}: {} touches without friction, no support acts that way, and step 1 \
                 loads it with the force {}",
                words(free),
                shape.pair_name(pair),
                vector(motion.force)
            ),
            cure: format!("hold {name} in these directions, or give the pair *FRICTION"),
            lines: match lines.is_empty() {
                true => "*FRICTION\n0.1, 1e4".into(),
                false => format!("*BOUNDARY\n{}", lines.join("\n")),
            },
        })
    })
}

/// The findings on groups that closed contacts and supports leave free, and that the first step moves.
fn free_groups(
    shape: &DeckShape,
    finding: impl Fn(&DeckShape, usize, &GroupMotion, &[Motion]) -> Option<RunFinding>,
) -> Vec<RunFinding> {
    if shape.deck.is_incomplete {
        return Vec::new();
    }
    let of = |group: usize| {
        let mut motion = GroupMotion::new(shape, group);
        for (k, pair) in pairs_of(shape, group) {
            let law = &shape.deck.interactions[shape.deck.pairs[k].interaction];
            let sticks = law.friction > 0.0 || is_tied(shape, k);
            motion.hold_contacts(shape, pair, sticks);
        }
        let free = motion.free(shape.modes(group));
        let moves = !free.is_empty() && motion.is_loaded(&free);
        moves
            .then(|| finding(shape, group, &motion, &free))
            .flatten()
    };
    groups(shape).into_iter().filter_map(of).collect()
}

/// The loads at the end of a step on a body that a single, flat pair holds.
struct Resting<'s> {
    pair: usize,
    group: usize,
    step: usize,
    motion: &'s GroupMotion,
    free: &'s [Motion],
    /// Normal of the contact, into the body.
    normal: Vector,
    force: Vector,
    /// About the mean of the contact's nodes.
    moment: Vector,
    /// The contact's nodes, from their mean.
    at: &'s [Vector],
    mean: Vector,
    /// The loaded nodes.
    loaded: BTreeSet<usize>,
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
        let motion = motion.normalize();
        let part: f64 = self.free.iter().map(|m| m.dot(&motion).powi(2)).sum();
        part > 1.0 - 1e-6
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
        for (k, pair) in shape.pairs.iter().enumerate() {
            let normal = pair.normal();
            let touching = pair.nodes.iter();
            let touching = touching.filter(|node| node.beyond <= 0.1 * pair.sizes[0]);
            let is_flat = |node: &SlaveGap| pair.masters[node.face].normal.dot(&normal) > FLAT;
            let touching: Vec<&SlaveGap> = touching.collect();
            let rests = !touching.is_empty() && touching.iter().all(|node| is_flat(node));
            if !rests || is_tied(shape, k) {
                continue;
            }
            let at = touching.iter().map(|node| shape.at(node.node));
            let mean = at.clone().sum::<Vector>() / touching.len() as f64;
            let at: Vec<Vector> = at.map(|at| at - mean).collect();
            for (group, normal) in [(pair.groups[0], normal), (pair.groups[1], -normal)] {
                let motion = GroupMotion::new(shape, group);
                let free = motion.free(shape.modes(group));
                if free.is_empty() || pairs_of(shape, group).count() != 1 {
                    continue;
                }
                let mut total = BTreeMap::new();
                let steps = shape.reached();
                // Later displacements drive the body.
                let driven = |step: &Step| {
                    let mut motions = step.motions.iter();
                    motions.any(|value| shape.group(value.node) == Some(group))
                };
                let resting = steps.take_while(|(number, step)| *number == 0 || !driven(step));
                found.extend(resting.into_iter().find_map(|(number, step)| {
                    add_forces(shape, group, (number, step), &mut total);
                    finding(&Resting {
                        pair: k,
                        group,
                        step: number + 1,
                        motion: &motion,
                        free: &free,
                        normal,
                        force: total.values().map(|force| force.along).sum(),
                        moment: total.values().map(|f| (f.at - mean).cross(&f.along)).sum(),
                        at: &at,
                        mean,
                        loaded: total.values().flat_map(|f| f.nodes.clone()).collect(),
                    })
                }));
            }
        }
        found
    }
}

/// A body that only contact holds, with a tangential load above what friction can bear.
pub fn beyond_friction(shape: &DeckShape) -> Vec<RunFinding> {
    Resting::findings(shape, |rest| {
        let pair = &shape.pairs[rest.pair];
        let law = &shape.deck.interactions[shape.deck.pairs[rest.pair].interaction];
        let pressed = -rest.force.dot(&rest.normal);
        let along = rest.force + pressed * rest.normal;
        let limit = law.friction * pressed.max(0.0);
        if law.friction == 0.0
            || along.norm() <= limit * (1.0 + 1e-6)
            || pressed <= 0.0
            || !rest.is_free(along, None)
        {
            return None;
        }
        let needed = rounded_up(along.norm() / pressed);
        let stick = law
            .stick
            .map_or(String::new(), |slope| format!(", {}", plain(slope)));
        let line = law.friction_place.line;
        Some(RunFinding {
            rule: "load above friction",
            cause: format!(
                "step {} pushes {} along {} with {}, but friction holds at most {} x {} = {}: it slides away",
                rest.step,
                shape.group_name(rest.group),
                shape.pair_name(pair),
                sig4(along.norm()),
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
        let (name, normal) = (shape.group_name(rest.group), rest.normal);
        let pair = &shape.pairs[rest.pair];
        let pressed = -rest.force.dot(&normal);
        // Loaded nodes far from the contact.
        let height = |node: &usize| (shape.at(*node) - rest.mean).dot(&normal);
        let most = rest.loaded.iter().map(height).fold(0.0, f64::max);
        let far = rest.loaded.iter().copied();
        let set = shape.set_name(&far.filter(|node| height(node) > 0.75 * most).collect());
        let hold = |first: usize, last: usize| format!("*BOUNDARY\n{set}, {first}, {last}, 0.");
        if pressed < -LOADED * rest.force.norm() && rest.is_free(normal, None) {
            let axes = if shape.deck.is_solid() { 3 } else { 2 };
            return Some(RunFinding {
                rule: "pulled off",
                cause: format!(
                    "step {} pulls {name} off its only contact, {}, with the force {}: nothing else holds it",
                    rest.step,
                    shape.pair_name(pair),
                    sig4(-pressed)
                ),
                cure: format!("prescribe the displacement of {set}, or load it less"),
                lines: hold(1, axes),
            });
        }
        if pressed <= 0.0 {
            return None;
        }
        // Where the resultant meets the contact, against the edge of the contact in each direction.
        let meets = rest.moment.cross(&normal) / pressed;
        let across = normal.cross(&Vector::ith(normal.iamin(), 1.0)).normalize();
        let directions = (0..DIRECTIONS).map(|k| {
            let angle = std::f64::consts::TAU * k as f64 / DIRECTIONS as f64;
            across * angle.cos() + normal.cross(&across) * angle.sin()
        });
        let beyond = directions.map(|to| {
            let edge = rest.at.iter().map(|at| at.dot(&to));
            let edge = edge.fold(f64::NEG_INFINITY, f64::max);
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
                shape.pair_name(pair),
                sig4(beyond),
                vector(to)
            ),
            cure: format!("guide {set} in this direction, or load it less"),
            lines: hold(held, held),
        })
    })
}

/// Adds the forces of a step to those of the steps before.
fn add_forces(
    shape: &DeckShape,
    group: usize,
    (number, step): (usize, &Step),
    total: &mut BTreeMap<[usize; 3], Force>,
) {
    total.retain(|of, _| match of[0] {
        0 => !step.new_forces,
        _ => !step.new_pressures,
    });
    let mut here: BTreeMap<[usize; 3], Force> = BTreeMap::new();
    for force in forces(shape, number) {
        if shape.group(force.nodes[0]) == Some(group) {
            match here.entry(force.of) {
                Entry::Occupied(mut known) => known.get_mut().along += force.along,
                Entry::Vacant(entry) => {
                    entry.insert(force);
                }
            }
        }
    }
    for (of, force) in here {
        // A step replaces the components that it gives.
        match total.entry(of) {
            Entry::Occupied(mut known) => (0..3)
                .filter(|k| force.along[*k] != 0.0)
                .for_each(|k| known.get_mut().along[k] = force.along[k]),
            Entry::Vacant(entry) => {
                entry.insert(force);
            }
        }
    }
}

/// A number with one significant digit, as a deck has it.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.0e}").parse().unwrap_or(value)
}

/// The next larger number with two significant digits.
pub fn rounded_up(value: f64) -> f64 {
    format!("{:.1e}", 1.05 * value).parse().unwrap_or(value)
}

/// A number as a deck has it.
pub fn plain(value: f64) -> String {
    match (1e-3..1e5).contains(&value.abs()) {
        true => format!("{value}"),
        false => format!("{value:e}"),
    }
}
