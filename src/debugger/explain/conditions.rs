//! Supports, loads and prescribed motions of a state, as marks for a picture.

use super::outline::Point;
use std::collections::{BTreeMap, BTreeSet};
use stickslip_core::groups::distinct;
use stickslip_core::model::Factor;
use stickslip_core::plane::{dot, minus};
use stickslip_core::{Component, Model};

/// What an arrow or a turn stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Given {
    /// A force, a moment or a pressure.
    Load,
    /// A prescribed displacement or rotation.
    Motion,
}

/// An arrow that ends where it acts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConditionArrow {
    /// What it stands for.
    pub given: Given,
    /// Where it acts, in the configuration of the picture.
    pub at: Point,
    /// Its direction; the largest of its kind has length 1.
    pub along: Point,
}

impl ConditionArrow {
    /// Whether a contact force that starts at the same point covers the arrow.
    pub fn is_under(&self, force: Point) -> bool {
        /// Cosine of the angle from which on two arrows are apart.
        const APART: f64 = 0.9;
        let side = match self.given {
            Given::Load => -1.0,
            Given::Motion => 1.0,
        };
        let [[a, b], [x, y]] = [self.along, force];
        side * dot(self.along, force) > APART * a.hypot(b) * x.hypot(y)
    }
}

/// A supported node, and whether x, y and its rotation are restrained.
pub type Support = (usize, [bool; 3]);

/// The marks of a state, besides its supports.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Conditions {
    /// Forces, pressures and prescribed displacements.
    pub arrows: Vec<ConditionArrow>,
    /// Moments and prescribed rotations: node, kind, and whether it turns anticlockwise.
    pub turns: Vec<(usize, Given, bool)>,
}

/// The marks at a load factor, with nodes at `place`. At the start, a load that is 0 is shown as at the end of the path.
pub fn conditions(model: &Model, load_factor: f64, place: &dyn Fn(usize) -> Point) -> Conditions {
    let [start, end] = [model.path.first(), model.path.last()];
    let amplitude = |value: f64, scale: &Factor| match value * scale.at(load_factor) {
        0.0 if start == Some(&load_factor) => value * scale.at(end.copied().unwrap_or(1.0)),
        now => now,
    };
    let loads = model
        .loads
        .iter()
        .filter(|load| load.volume.is_none())
        .map(|load| (Given::Load, load.dof, amplitude(load.value, &load.scale)));
    let motions = model
        .prescribed
        .iter()
        .map(|one| (Given::Motion, one.dof, amplitude(one.value, &one.scale)));
    let mut found = Conditions::default();
    let mut vectors: BTreeMap<(usize, Given), Point> = BTreeMap::new();
    for (given, dof, value) in loads.chain(motions).filter(|(.., value)| *value != 0.0) {
        match model.dofs.node_of(dof) {
            Some((node, axis @ (0 | 1))) => {
                vectors.entry((node, given)).or_default()[axis] += value;
            }
            Some((node, _)) => found.turns.push((node, given, value > 0.0)),
            None => {}
        }
    }
    let arrows = vectors.into_iter().map(|((node, given), along)| {
        let at = place(node);
        ConditionArrow { given, at, along }
    });
    let resultants = resultants(model, &amplitude, place);
    found.arrows = scaled(arrows.chain(resultants).collect());
    found
        .arrows
        .extend(scaled(pressures(model, &amplitude, place)));
    found
}

/// Loads per volume, one arrow each, at the centre of the volume.
fn resultants(
    model: &Model,
    amplitude: &dyn Fn(f64, &Factor) -> f64,
    place: &dyn Fn(usize) -> Point,
) -> Vec<ConditionArrow> {
    // The force, and for each of its components the sum of component times position.
    let mut sums: BTreeMap<usize, (Point, [Point; 2])> = BTreeMap::new();
    for load in &model.loads {
        let (Some(volume), Some((node, axis @ (0 | 1)))) =
            (load.volume, model.dofs.node_of(load.dof))
        else {
            continue;
        };
        let (value, at) = (amplitude(load.value, &load.scale), place(node));
        let (force, moments) = sums.entry(volume).or_default();
        force[axis] += value;
        moments[axis] = [0, 1].map(|k| moments[axis][k] + value * at[k]);
    }
    let arrow = |(along, moments): (Point, [Point; 2])| {
        let at = [0, 1].map(|k| dot(along, [moments[0][k], moments[1][k]]) / dot(along, along));
        ConditionArrow {
            given: Given::Load,
            at,
            along,
        }
    };
    let found = sums.into_values().map(arrow);
    found
        .filter(|arrow| arrow.at.iter().all(|x| x.is_finite()))
        .collect()
}

/// Following pressures, one arrow per face.
fn pressures(
    model: &Model,
    amplitude: &dyn Fn(f64, &Factor) -> f64,
    place: &dyn Fn(usize) -> Point,
) -> Vec<ConditionArrow> {
    let mut found = Vec::new();
    for pressure in &model.pressures {
        let value = amplitude(pressure.value, &pressure.scale);
        for face in &pressure.faces {
            let (Some(&first), Some(&last)) = (face.nodes.first(), face.nodes.last()) else {
                continue;
            };
            let (from, to) = (place(first), place(last));
            let [x, y] = minus(to, from);
            let length = x.hypot(y);
            if length > 0.0 {
                found.push(ConditionArrow {
                    given: Given::Load,
                    at: [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])],
                    // The body is on the left.
                    along: [-y * value / length, x * value / length],
                });
            }
        }
    }
    found
}

/// Arrows with the largest of each kind at length 1.
fn scaled(mut arrows: Vec<ConditionArrow>) -> Vec<ConditionArrow> {
    for given in [Given::Load, Given::Motion] {
        let of = |arrow: &&mut ConditionArrow| arrow.given == given;
        let largest = arrows
            .iter_mut()
            .filter(of)
            .map(|arrow| arrow.along[0].hypot(arrow.along[1]))
            .filter(|size| size.is_finite())
            .fold(0.0, f64::max);
        for arrow in arrows.iter_mut().filter(of) {
            arrow.along = arrow.along.map(|x| x / largest);
        }
    }
    arrows.retain(|arrow| arrow.along.iter().all(|x| x.is_finite()));
    arrows
}

/// Nodes of bodies with restrained components.
pub fn supports(model: &Model) -> Vec<Support> {
    let bodies = model.bodies.iter().filter(|body| !body.is_linear());
    let nodes = distinct(bodies.flat_map(|body| body.nodes.iter().copied()));
    let moved: BTreeSet<usize> = model.prescribed.iter().map(|one| one.dof).collect();
    let held = |node: usize, component| {
        let dof = model.dofs.dof(node, component);
        dof.is_some_and(|dof| model.dofs.equation[dof].is_none() && !moved.contains(&dof))
    };
    nodes
        .into_iter()
        .map(|node| {
            let components = [Component::X, Component::Y, Component::Rotation];
            (node, components.map(|component| held(node, component)))
        })
        .filter(|(_, held)| held.contains(&true))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip_scene::Scene;

    #[test]
    fn only_loads_that_act_are_shown_except_at_the_start() {
        let text = "(title: \"t\", nodes: [Line(id: \"b\", from: (0, 0), to: (1, 0), elements: 2, per_element: 2)],
            materials: [Section(id: \"m\", EA: 1, EI: 1)], bodies: [Beam(id: \"b\", along: \"b\", material: \"m\")],
            supports: [(node: \"b.start\", fix: [x, y, rotation])], loads: [Force(node: \"b.end\", x: 1),
            Force(node: \"b.2\", x: 1, scale: [(1, 0), (2, 1)])], history: (path: [0, 2], increment: 1))";
        let model = Scene::from_text("t", text, &[]).unwrap().model;
        let count = |load: f64| {
            let place = |node: usize| model.nodes[node].at;
            conditions(&model, load, &place).arrows.len()
        };
        assert_eq!([0.0, 0.5, 1.5].map(count), [2, 1, 2]);
    }

    #[test]
    fn a_weight_is_one_arrow_although_nodal_forces_of_second_order_elements_point_either_way() {
        let text = "(title: \"t\", nodes: [Block(id: \"b\", corners: [(1, 0), (3, 1)], elements: (4, 2))],
            materials: [Elastic(id: \"m\", E: 1, nu: 0.3)], bodies: [Solid(id: \"b\", mesh: \"b\", material: \"m\")],
            supports: [(node: \"b.bottom\", fix: [x, y])],
            loads: [Volume(on: \"b\", x: 3, y: -4), Force(node: \"b.top@0.5\", y: -5)],
            history: (path: [0, 1], increment: 1))";
        let model = Scene::from_text("t", text, &[]).unwrap().model;
        let upward = |load: &stickslip_core::model::Load| load.value * load.scale.at(1.0) > 0.0;
        assert!(
            model
                .loads
                .iter()
                .any(|load| upward(load) && load.dof % 2 == 1)
        );
        let found = conditions(&model, 1.0, &|node| model.nodes[node].at);
        let [force, weight] = &found.arrows[..] else {
            panic!("{:?}", found.arrows)
        };
        let near = |a: Point, b: Point| minus(a, b).iter().all(|x| x.abs() < 1e-12);
        assert!(
            near(force.at, [2.0, 1.0]) && near(force.along, [0.0, -0.5]),
            "{force:?}"
        );
        // Two units of area.
        assert!(near(weight.at, [2.0, 0.5]), "{:?}", weight.at);
        assert!(near(weight.along, [0.6, -0.8]), "{:?}", weight.along);
    }
}
