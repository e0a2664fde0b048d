//! Finds bodies that move although no force acts on them.
//!
//! A body that only contacts hold is in equilibrium wherever it lies if all of its contact forces are zero. The states are
//! accepted, because they obey every law, but its position may follow from the course of the iterations.

use std::ops::RangeInclusive;
use stickslip_core::contact::record::ContactRecord;
use stickslip_core::model::{BodyKind, diagonal};
use stickslip_core::{Body, Model, Norms};
use stickslip_scene::{shortest, sig4};

/// Contact forces below this part of the force scale are round-off.
const NO_FORCE: f64 = 1e-9;
/// Motions below this part of the scene's length are not reported: a body that is let go moves as its strains recover.
const NO_MOTION: f64 = 1e-3;

/// A body that only contacts hold.
struct FreeBody {
    body: usize,
    contacts: Vec<usize>,
    /// Where it moved without a force: first and last increment, and load.
    moved: Option<(RangeInclusive<u32>, [f64; 2])>,
    /// The farthest that a node of it moved in one increment (length).
    farthest: f64,
}

/// Watches the accepted increments of a run for bodies that move without a force.
pub struct UnforcedWatch {
    bodies: Vec<FreeBody>,
    /// Positions after the last accepted increment.
    places: Vec<[f64; 2]>,
    length: f64,
}

impl UnforcedWatch {
    /// Starts to watch a run of a model from a state; `u` are its displacements.
    pub fn new(model: &Model, u: &[f64]) -> UnforcedWatch {
        UnforcedWatch {
            bodies: free_bodies(model),
            places: model.places(u),
            length: diagonal(model.nodes.iter()),
        }
    }

    /// Records an accepted increment: its number and load, and its contacts, norms and displacements at its end.
    pub fn see(
        &mut self,
        model: &Model,
        (increment, load): (u32, f64),
        contacts: &[ContactRecord],
        norms: &Norms,
        u: &[f64],
    ) {
        let size = |contact: &ContactRecord| contact.f_n.hypot(contact.f_t);
        let places = model.places(u);
        for free in &mut self.bodies {
            let force = free.contacts.iter().map(|&c| size(&contacts[c]));
            if force.fold(0.0, f64::max) > NO_FORCE * norms.scale {
                continue;
            }
            let nodes = model.bodies[free.body].nodes.iter();
            let motion = nodes
                .map(|&node| {
                    let ([x, y], [was_x, was_y]) = (places[node], self.places[node]);
                    (x - was_x).hypot(y - was_y)
                })
                .fold(0.0, f64::max);
            if motion <= NO_MOTION * self.length {
                continue;
            }
            free.farthest = free.farthest.max(motion);
            let first = free
                .moved
                .as_ref()
                .map(|(seen, [from, _])| (*seen.start(), *from));
            let (start, from) = first.unwrap_or((increment, load));
            free.moved = Some((start..=increment, [from, load]));
        }
        self.places = places;
    }

    /// Positions of all nodes after the last accepted increment.
    pub fn places(&self) -> &[[f64; 2]] {
        &self.places
    }

    /// One sentence per body that moved without a force.
    pub fn found(&self, model: &Model) -> Vec<String> {
        let moved = self.bodies.iter().filter_map(|free| {
            let (seen, [from, to]) = free.moved.as_ref()?;
            let name = &model.bodies[free.body].name;
            let within = match (seen.start(), seen.end()) {
                (first, last) if first == last => {
                    format!("in increment {first} (load {})", shortest(*to))
                }
                (first, last) => format!(
                    "in increments {first} to {last} (load {} to {})",
                    shortest(*from),
                    shortest(*to)
                ),
            };
            Some(format!(
                "body {name} moved by up to {} {within} although no force acts on it: its place may depend on the course of \
                 the iterations; support it, or hold it by soft springs",
                sig4(free.farthest)
            ))
        });
        moved.collect()
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
    let distinct = |nodes: &mut dyn Iterator<Item = usize>| {
        let bodies = nodes.map(|node| owner[node]).filter(|&b| b != NO_OWNER);
        let mut bodies: Vec<usize> = bodies.collect();
        bodies.sort_unstable();
        bodies.dedup();
        bodies
    };
    let surfaces = model.surfaces.iter();
    let under: Vec<Vec<usize>> = surfaces
        .map(|surface| distinct(&mut surface.elements.iter().flatten().copied()))
        .collect();
    let mut contacts: Vec<Vec<usize>> = vec![Vec::new(); model.bodies.len()];
    for (number, contact) in model.contacts.iter().enumerate() {
        let masters = contact.surfaces.iter().flat_map(|&surface| &under[surface]);
        let slaves = distinct(&mut contact.carriers().map(|(node, _)| node));
        for &body in masters.chain(&slaves) {
            held[body] |= contact.bond.is_tied();
            if contacts[body].last() != Some(&number) {
                contacts[body].push(number);
            }
        }
    }
    let free = contacts.into_iter().zip(held).enumerate();
    free.filter(|(_, (contacts, held))| !held && !contacts.is_empty())
        .map(|(body, (contacts, _))| FreeBody {
            body,
            contacts,
            moved: None,
            farthest: 0.0,
        })
        .collect()
}
