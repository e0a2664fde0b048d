//! Finds bodies that move although no force acts on them, and logs what accepted increments find about places.
//!
//! A body that only contacts hold is in equilibrium wherever it lies if all of its contact forces are zero. The states are
//! accepted, because they obey every law, but its position may follow from the course of the iterations.

use super::names;
use super::surface_end::{SlippedNode, slipped_off};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;
use std::sync::Arc;
use stickslip_core::contact::record::ContactRecord;
use stickslip_core::groups::distinct;
use stickslip_core::model::{BodyKind, diagonal};
use stickslip_core::{Body, Event, IncrementStart, Mode, Model, Outcome};
use stickslip_scene::{first_of, overlaps, shortest, sig4};

/// Contact forces below this part of the force scale are round-off.
const NO_FORCE: f64 = 1e-9;
/// Motions below this part of the scene's length are not reported: a body that is let go moves as its strains recover.
const NO_MOTION: f64 = 1e-3;

/// Maximum number of nodes named.
const MOST_NODES: usize = 3;

/// The bodies of a model that only contacts hold.
#[derive(Debug, Clone, Default)]
pub struct FreeBodies {
    bodies: Vec<FreeBody>,
    /// Length of the scene.
    length: f64,
}

/// A body that only contacts hold: its number, and those of its contacts.
#[derive(Debug, Clone)]
struct FreeBody {
    body: usize,
    contacts: Vec<usize>,
}

/// A body that moved in an increment although no force acts on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnforcedMotion {
    /// Number of the body.
    pub body: usize,
    /// The farthest that a node of it moved (length).
    pub distance: f64,
}

/// What an accepted increment finds about the places of bodies and nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PlaceFinding {
    /// A body moved although no force acts on it.
    Unforced(UnforcedMotion),
    /// A node is a little past the end of its surface.
    Slipped(SlippedNode),
}

impl FreeBodies {
    /// The free bodies of a model.
    pub fn new(model: &Model) -> FreeBodies {
        FreeBodies {
            bodies: free_bodies(model),
            length: diagonal(model.nodes.iter()),
        }
    }

    /// The bodies that moved without a force in an accepted increment, and the nodes that slipped off an end, from the states at its
    /// start and its end.
    pub fn findings(
        &self,
        model: &Model,
        event: &Event,
        states: [&IncrementStart; 2],
    ) -> Vec<PlaceFinding> {
        let motions = self.motions(model, event, states.map(|state| &state.u[..]));
        let slipped = match &event.outcome {
            Outcome::Increment { .. } => {
                let [before, last] = states;
                let touched = |slave: usize, surface: usize| {
                    let node = &before.nodes[slave];
                    let spot = node.spot.filter(|_| node.mode != Mode::Free);
                    spot.is_some_and(|spot| spot.surface == surface)
                };
                slipped_off(model, &touched, last)
            }
            _ => Vec::new(),
        };
        let motions = motions.into_iter().map(PlaceFinding::Unforced);
        motions
            .chain(slipped.into_iter().map(PlaceFinding::Slipped))
            .collect()
    }

    /// The bodies that moved without a force in an accepted increment, from the displacements at its start and its end.
    fn motions(
        &self,
        model: &Model,
        event: &Event,
        [from, to]: [&[f64]; 2],
    ) -> Vec<UnforcedMotion> {
        let Outcome::Increment { after, .. } = &event.outcome else {
            return Vec::new();
        };
        let size = |contact: &ContactRecord| contact.f_n.hypot(contact.f_t);
        let moved = self.bodies.iter().filter_map(|free| {
            let force = free.contacts.iter().map(|&c| size(&event.nodes[c]));
            if force.fold(0.0, f64::max) > NO_FORCE * after.scale {
                return None;
            }
            let nodes = model.bodies[free.body].nodes.iter();
            let motion = nodes.map(|&node| {
                let ([x, y], [was_x, was_y]) = (model.place(to, node), model.place(from, node));
                (x - was_x).hypot(y - was_y)
            });
            let distance = motion.fold(0.0, f64::max);
            let body = free.body;
            (distance > NO_MOTION * self.length).then_some(UnforcedMotion { body, distance })
        });
        moved.collect()
    }
}

/// The motions without a force in a run, by body, and the nodes that slipped off, by surface.
#[derive(Debug, Clone, Default)]
pub struct PlaceLog {
    moved: BTreeMap<usize, UnforcedRange>,
    slipped: BTreeMap<usize, SlippedNodes>,
}

/// The nodes that slipped off the ends of a surface, since which increment and load, and how far at most (length).
#[derive(Debug, Clone)]
struct SlippedNodes {
    slaves: BTreeSet<usize>,
    since: (u32, f64),
    farthest: f64,
    /// Whether one of them is flush with the end before deformation: the bodies are meant to end together.
    is_flush: bool,
}

/// Where a body moved without a force: first and last increment, and load; and the farthest motion in one of them (length).
#[derive(Debug, Clone)]
struct UnforcedRange {
    increments: RangeInclusive<u32>,
    loads: [f64; 2],
    farthest: f64,
}

impl PlaceLog {
    /// Adds the findings of an accepted increment: its number and load.
    pub fn add(&mut self, increment: u32, load: f64, findings: &[PlaceFinding]) {
        for finding in findings {
            let motion = match finding {
                PlaceFinding::Unforced(motion) => motion,
                PlaceFinding::Slipped(node) => {
                    let on = self.slipped.entry(node.surface).or_insert(SlippedNodes {
                        slaves: BTreeSet::new(),
                        since: (increment, load),
                        farthest: 0.0,
                        is_flush: false,
                    });
                    on.is_flush |= node.is_flush;
                    on.slaves.insert(node.slave);
                    on.farthest = on.farthest.max(node.past);
                    continue;
                }
            };
            let range = self.moved.entry(motion.body).or_insert(UnforcedRange {
                increments: increment..=increment,
                loads: [load; 2],
                farthest: 0.0,
            });
            range.increments = *range.increments.start()..=increment;
            range.loads[1] = load;
            range.farthest = range.farthest.max(motion.distance);
        }
    }

    /// One sentence per body that moved without a force.
    fn words(&self, model: &Model) -> Vec<String> {
        let moved = self.moved.iter().map(|(&body, range)| {
            let name = &model.bodies[body].name;
            let [from, to] = range.loads;
            let within = match (range.increments.start(), range.increments.end()) {
                (first, last) if first == last => {
                    format!("in increment {first} (load {})", shortest(to))
                }
                (first, last) => format!(
                    "in increments {first} to {last} (load {} to {})",
                    shortest(from),
                    shortest(to)
                ),
            };
            format!(
                "body {name} moved by up to {} {within} although no force acts on it: its place may depend on the course of \
                 the iterations; support it, or hold it by soft springs",
                sig4(range.farthest)
            )
        });
        moved.collect()
    }

    /// One sentence per surface off which nodes slipped that are flush with its end, or are still near it in the last accepted
    /// state: others left it.
    fn slipped_words(&self, model: &Model, last: &IncrementStart) -> Vec<String> {
        let known = |slave: usize, surface: usize| {
            let found = self.slipped.get(&surface);
            found.is_some_and(|found| found.slaves.contains(&slave))
        };
        let still = slipped_off(model, &known, last);
        let remain = |surface: usize| still.iter().any(|node| node.surface == surface);
        let meant =
            |(surface, found): &(&usize, &SlippedNodes)| found.is_flush || remain(**surface);
        let slipped = self.slipped.iter().filter(meant);
        let slipped = slipped.map(|(&surface, found)| {
            let slaves = found.slaves.iter().map(|&slave| names::slave(model, slave));
            let (surface, (increment, load)) = (&model.surfaces[surface].name, found.since);
            let [was, touched] = match found.slaves.len() {
                1 => ["was", "it touched there or starts"],
                _ => ["were", "they touched there or start"],
            };
            format!(
                "{} {was} up to {} past the end of surface {surface}, first in increment {increment} (load {}): {touched} flush with it, \
                 but no contact force acts past the end, and pressures next to it are too high. Set surfaces.{surface}.past_ends=0.5",
                first_of(slaves, MOST_NODES, ", "),
                sig4(found.farthest),
                shortest(load)
            )
        });
        slipped.collect()
    }

    /// Warnings about the places of bodies after a run: those that moved without a force, nodes that slipped off the end of a
    /// surface, and bodies that overlap in the last accepted state.
    pub fn warnings(&self, model: &Model, last: &IncrementStart) -> Vec<String> {
        let mut all = self.words(model);
        all.extend(self.slipped_words(model, last));
        all.extend(overlaps::at_end(model, last));
        all
    }
}

/// Watches the accepted increments of a run for bodies that move without a force, and for nodes that slip off an end.
pub struct PlaceWatch {
    bodies: FreeBodies,
    /// The last accepted state.
    last: Arc<IncrementStart>,
    log: PlaceLog,
}

impl PlaceWatch {
    /// Starts to watch a run of a model from its last accepted state.
    pub fn new(model: &Model, start: &Arc<IncrementStart>) -> PlaceWatch {
        PlaceWatch {
            bodies: FreeBodies::new(model),
            last: start.clone(),
            log: PlaceLog::default(),
        }
    }

    /// Records an accepted increment and the state at its end.
    pub fn see(&mut self, model: &Model, event: &Event, last: &Arc<IncrementStart>) {
        let found = self.bodies.findings(model, event, [&self.last, last]);
        self.log
            .add(event.position.increment, event.load_factor, &found);
        self.last = last.clone();
    }

    /// The motions so far.
    pub fn log(&self) -> &PlaceLog {
        &self.log
    }
}

/// The bodies that only contacts hold: no supports, other bodies or ties.
fn free_bodies(model: &Model) -> Vec<FreeBody> {
    /// Marks nodes of several bodies, or of none.
    const NO_OWNER: usize = usize::MAX;
    let mut owner = vec![NO_OWNER; model.nodes.len()];
    let mut shared = vec![false; model.nodes.len()];
    for (number, body) in model.bodies.iter().enumerate() {
        for &node in &body.nodes {
            shared[node] |= owner[node] != NO_OWNER && owner[node] != number;
            owner[node] = number;
        }
    }
    let is_free = |node: usize| {
        let dofs = model.dofs.of_node(node);
        !shared[node] && model.dofs.equation[dofs].iter().all(Option::is_some)
    };
    let is_held = |body: &Body| {
        let resists_strains = matches!(body.kind, BodyKind::Beam(_) | BodyKind::Solid(_));
        !resists_strains || !body.nodes.iter().all(|&node| is_free(node))
    };
    let mut held: Vec<bool> = model.bodies.iter().map(is_held).collect();
    let bodies_of = |nodes: &mut dyn Iterator<Item = usize>| {
        distinct(nodes.map(|node| owner[node]).filter(|&b| b != NO_OWNER))
    };
    let surfaces = model.surfaces.iter();
    let under: Vec<Vec<usize>> = surfaces
        .map(|surface| bodies_of(&mut surface.nodes().copied()))
        .collect();
    let mut contacts: Vec<Vec<usize>> = vec![Vec::new(); model.bodies.len()];
    for (number, contact) in model.contacts.iter().enumerate() {
        let masters = contact.surfaces.iter().flat_map(|&surface| &under[surface]);
        let slaves = bodies_of(&mut contact.carriers().map(|(node, _)| node));
        for &body in masters.chain(&slaves) {
            held[body] |= contact.bond.is_tied();
            if contacts[body].last() != Some(&number) {
                contacts[body].push(number);
            }
        }
    }
    let free = contacts.into_iter().zip(held).enumerate();
    free.filter(|(_, (contacts, held))| !held && !contacts.is_empty())
        .map(|(body, (contacts, _))| FreeBody { body, contacts })
        .collect()
}
