//! Rigid motions that supports and closed contacts leave to a body, and the loads of a step that act along them.

use super::numbers::vector;
use super::shape::{DeckShape, PairShape, SlaveGap, Vector};
use nalgebra::{Matrix3, SMatrix, SVector};
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use stickslip_exchange::inp::deck::{Step, Value, Volume, VolumeKind};
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
    /// Its loads.
    pub forces: BTreeMap<LoadTarget, Force>,
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

/// What a load acts on; a step replaces the earlier loads on the same target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum LoadTarget {
    /// A node, along an axis.
    Node(usize, usize),
    /// A side of an element.
    Side(usize, usize),
    /// An element.
    Element(usize, VolumeKind),
}

/// A point load, or the resultant of a load on a side or an element.
pub struct Force {
    target: LoadTarget,
    /// The nodes that it acts on; at least one.
    pub nodes: Vec<usize>,
    /// Where it acts.
    pub at: Vector,
    /// The force.
    pub along: Vector,
}

/// The forces that a step gives, at its end.
fn forces(shape: &DeckShape, step: &Step) -> Vec<Force> {
    let deck = shape.deck;
    let part = |amplitude: Option<usize>| shape.last_factor(step, amplitude);
    let mut all = Vec::new();
    for force in &step.forces {
        all.extend(force.direction.axis().map(|axis| Force {
            target: LoadTarget::Node(force.node, axis),
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
                target: LoadTarget::Side(pressure.element, pressure.side),
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
            target: LoadTarget::Element(weight.element, weight.load.kind()),
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
fn total_forces(shape: &DeckShape, group: usize, step: usize) -> BTreeMap<LoadTarget, Force> {
    let mut total = BTreeMap::new();
    for step in shape.deck.steps.iter().take(step + 1) {
        total.retain(|target, _| match target {
            LoadTarget::Node(..) => !step.new_forces,
            LoadTarget::Side(..) => !step.new_pressures,
            LoadTarget::Element(..) => !step.new_weights,
        });
        let mut of_step: BTreeMap<LoadTarget, Force> = BTreeMap::new();
        let forces = forces(shape, step).into_iter();
        for force in forces.filter(|force| shape.group(force.nodes[0]) == Some(group)) {
            match of_step.entry(force.target) {
                Entry::Occupied(mut known) => known.get_mut().along += force.along,
                Entry::Vacant(new) => {
                    new.insert(force);
                }
            }
        }
        total.extend(of_step);
    }
    total
}
