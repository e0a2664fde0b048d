//! Rigid motions that supports and closed contacts leave to a body, and the loads of a step that act along them.

use super::numbers::vector;
use super::shape::{DeckShape, PairShape, SlaveGap, Vector};
use nalgebra::{Matrix3, SMatrix, SVector};
use std::collections::{BTreeMap, BTreeSet};
use stickslip_exchange::inp::deck::{Value, Volume};
use stickslip_scene::joined;

/// Translations along x, y, z, then rotations about them, scaled by the body's size.
pub type Motion = SVector<f64, 6>;

/// Stiffness of the supports, relative to the largest, below which a motion is free.
const FREE: f64 = 1e-9;
/// Part of a load along a free motion, relative to the load, above which it moves the body.
pub const LOADED: f64 = 1e-6;
/// Part of a motion outside a space of motions, above which it is not one of them.
const OUTSIDE: f64 = 1e-6;

/// A group of bodies with its supports up to a step, and its loads at the end of it.
pub struct GroupMotion {
    /// The group.
    pub group: usize,
    /// Mean of its nodes.
    pub centre: Vector,
    /// Largest distance of a node from the centre.
    pub size: f64,
    /// Its loads, by what they act on.
    pub forces: BTreeMap<[usize; 3], Force>,
    supports: SMatrix<f64, 6, 6>,
    load: Motion,
}

impl GroupMotion {
    /// A group at the end of a step.
    pub fn new(shape: &DeckShape, group: usize, step: usize) -> GroupMotion {
        let nodes = shape.group_nodes(group);
        let at: Vec<Vector> = nodes.map(|node| shape.at(node)).collect();
        let centre = at.iter().sum::<Vector>() / at.len().max(1) as f64;
        let size = at.iter().map(|p| (p - centre).norm()).fold(0.0, f64::max);
        let mut this = GroupMotion {
            group,
            centre,
            size: size.max(f64::MIN_POSITIVE),
            forces: total_forces(shape, group, step),
            supports: SMatrix::zeros(),
            load: Motion::zeros(),
        };
        let on_beam = shape.is_beam_node();
        for value in supports(shape, step) {
            if shape.group(value.node) != Some(group) {
                continue;
            }
            match value.direction.axis() {
                Some(axis) => this.hold(shape.at(value.node), Vector::ith(axis, 1.0)),
                // Only beams have a rotation, about z.
                None if on_beam[value.node] => this.supports[(5, 5)] += 1.0,
                None => {}
            }
        }
        let forces = this.forces.values();
        this.load = forces.map(|f| this.motion(f.at, f.along)).sum();
        this
    }

    /// Sum of the loads.
    pub fn force(&self) -> Vector {
        self.forces.values().map(|force| force.along).sum()
    }

    /// The loaded nodes.
    pub fn loaded(&self) -> BTreeSet<usize> {
        self.forces
            .values()
            .flat_map(|force| &force.nodes)
            .copied()
            .collect()
    }

    /// The rigid motion that moves a point along a direction.
    pub fn motion(&self, at: Vector, along: Vector) -> Motion {
        let turn = (at - self.centre).cross(&along) / self.size;
        Motion::from_iterator(along.iter().chain(turn.iter()).copied())
    }

    fn hold(&mut self, at: Vector, along: Vector) {
        let row = self.motion(at, along);
        self.supports += row * row.transpose();
    }

    /// Holds the touching nodes of a pair: along the normal, and along the surface if they stick.
    pub fn hold_contacts<'s>(
        &mut self,
        shape: &DeckShape,
        pair: &PairShape,
        touching: impl Iterator<Item = &'s SlaveGap>,
        sticks: bool,
    ) {
        for node in touching {
            let at = shape.at(node.node);
            if sticks {
                (0..3).for_each(|k| self.hold(at, Vector::ith(k, 1.0)));
            } else {
                self.hold(at, pair.masters[node.face].normal);
            }
        }
    }

    /// The free motions as columns of unit length.
    pub fn free(&self, shape: &DeckShape) -> Vec<Motion> {
        let mut supports = self.supports;
        let largest = supports.trace().max(1.0);
        let modes = shape.modes(self.group);
        for k in (0..6).filter(|k| !modes[*k]) {
            supports[(k, k)] += largest;
        }
        let eigen = supports.symmetric_eigen();
        eigen
            .eigenvalues
            .iter()
            .enumerate()
            .filter(|(_, value)| **value < FREE * largest)
            .map(|(k, _)| eigen.eigenvectors.column(k).into_owned())
            .collect()
    }

    /// Whether the load does work on one of the motions.
    pub fn is_loaded(&self, free: &[Motion]) -> bool {
        free.iter()
            .map(|motion| motion.dot(&self.load).abs())
            .fold(0.0, f64::max)
            > LOADED * self.load.norm()
    }
}

/// Supports and prescribed displacements up to a step, without those that OP=NEW removes.
fn supports<'s>(shape: &'s DeckShape, step: usize) -> impl Iterator<Item = &'s Value> {
    let steps = shape.deck.steps.iter().take(step + 1);
    let first = steps.clone().rposition(|step| step.new_motions);
    let model = shape.deck.supports.iter().filter(move |_| first.is_none());
    let steps = steps.skip(first.unwrap_or(0));
    model.chain(steps.flat_map(|step| &step.motions))
}

/// A point load, or the resultant of a load on a side or an element.
pub struct Force {
    /// The kind of load, and its node, or its element and side.
    of: [usize; 3],
    /// The nodes that it acts on; at least one.
    pub nodes: Vec<usize>,
    /// Where it acts.
    pub at: Vector,
    /// The force.
    pub along: Vector,
}

/// The forces at the end of a step.
fn forces(shape: &DeckShape, step: usize) -> Vec<Force> {
    let deck = shape.deck;
    let Some(step) = deck.steps.get(step) else {
        return Vec::new();
    };
    let part = |amplitude: Option<usize>| shape.last_factor(step, amplitude);
    let mut all = Vec::new();
    for force in &step.forces {
        all.extend(force.direction.axis().map(|axis| Force {
            of: [0, force.node, 0],
            nodes: vec![force.node],
            at: shape.at(force.node),
            along: Vector::ith(axis, force.value * part(force.amplitude)),
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
        let faces: Vec<_> = shape.element_faces(weight.element).collect();
        let Some(first) = faces.first() else {
            continue;
        };
        let volume = faces
            .iter()
            .map(|face| face.area * (face.centre - first.centre).dot(&face.normal))
            .sum::<f64>()
            / if deck.is_solid() { 3.0 } else { 2.0 };
        let per_volume = match weight.load {
            Volume::Force { axis, value } => Vector::ith(axis, value),
            Volume::Gravity { acceleration, .. } => {
                let material = shape.material(weight.element);
                let density = material.and_then(|k| deck.materials[k].density);
                Vector::from(acceleration) * density.unwrap_or(0.0)
            }
        };
        all.push(Force {
            of: [2, weight.element, 0],
            nodes: deck.elements[weight.element].nodes.clone(),
            at: faces.iter().map(|face| face.centre).sum::<Vector>() / faces.len() as f64,
            along: per_volume * volume * part(weight.amplitude),
        });
    }
    all
}

/// Free motions in words: `along x, y and about z`.
pub fn words(free: &[Motion]) -> String {
    let all: SMatrix<f64, 6, 6> = free.iter().map(|motion| motion * motion.transpose()).sum();
    let block = |from: usize| all.fixed_view::<3, 3>(from, from).into_owned();
    // Translations that are free by themselves, and the axes of motions that turn.
    let spaces = [
        ("along", space(block(0), 1.0 - OUTSIDE)),
        ("about", space(block(3), OUTSIDE)),
    ];
    let names = spaces.map(|(word, space)| (word, names(space)));
    let names = names.iter().filter(|(_, names)| !names.is_empty());

    joined(
        names.map(|(word, names)| format!("{word} {}", names.join(", "))),
        " and ",
    )
}

/// Projection onto the eigenvectors with eigenvalues above a limit.
fn space(of: Matrix3<f64>, least: f64) -> Matrix3<f64> {
    let eigen = of.symmetric_eigen();
    eigen
        .eigenvalues
        .iter()
        .enumerate()
        .filter(|(_, value)| **value > least)
        .map(|(k, _)| eigen.eigenvectors.column(k) * eigen.eigenvectors.column(k).transpose())
        .sum()
}

/// The axes in a space, then directions that span the rest of it.
fn names(mut space: Matrix3<f64>) -> Vec<String> {
    let mut names = Vec::new();
    for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
        if space[(k, k)] > 1.0 - OUTSIDE {
            names.push(name.to_owned());
            space[(k, k)] = 0.0;
        }
    }
    let eigen = space.symmetric_eigen();
    let rest = eigen
        .eigenvalues
        .iter()
        .enumerate()
        .filter(|(_, value)| **value > 0.5)
        .map(|(k, _)| {
            let along: Vector = eigen.eigenvectors.column(k).into_owned();
            vector(along * along[along.iamax()].signum())
        });
    names.extend(rest);
    names
}

/// The loads on a group at the end of a step, those of earlier steps included.
fn total_forces(shape: &DeckShape, group: usize, step: usize) -> BTreeMap<[usize; 3], Force> {
    let mut total = BTreeMap::new();
    (0..=step).for_each(|step| add_forces(shape, group, step, &mut total));
    total
}

/// Adds the forces of a step to those of the steps before.
fn add_forces(
    shape: &DeckShape,
    group: usize,
    number: usize,
    total: &mut BTreeMap<[usize; 3], Force>,
) {
    let Some(step) = shape.deck.steps.get(number) else {
        return;
    };
    total.retain(|of, _| match of[0] {
        0 => !step.new_forces,
        1 => !step.new_pressures,
        _ => !step.new_weights,
    });
    let mut here: BTreeMap<[usize; 3], Force> = BTreeMap::new();
    for force in forces(shape, number) {
        if shape.group(force.nodes[0]) == Some(group) {
            let along = here
                .get(&force.of)
                .map_or_else(Vector::zeros, |of| of.along);
            let along = along + force.along;
            here.insert(force.of, Force { along, ..force });
        }
    }
    for (of, mut force) in here {
        // A step replaces the components that it gives.
        if let Some(known) = total.get(&of) {
            let known = known.along;
            force.along = force
                .along
                .zip_map(&known, |new, old| if new != 0.0 { new } else { old });
        }
        total.insert(of, force);
    }
}
