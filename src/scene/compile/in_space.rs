//! Interface problems in space: contacts side by side above a floor, in a square grid.

use super::history;
use crate::Spec;
use crate::format::error::{Fault, at, bail};
use crate::format::in_space::SpaceSpec;
use crate::limits;
use crate::nodes::Names;
use std::collections::HashSet;
use std::sync::Arc;
use stickslip_core::model::SpaceProblem;
use stickslip_core::plane::max_abs;
use stickslip_core::{Contact, Model, Node, Surface, counted};

/// Checks a problem; the texts have been checked.
pub(super) fn compile(spec: &Spec, problem: &SpaceSpec) -> Result<(Model, Names), Fault> {
    history::memory(&spec.settings)?;
    history::settings(&spec.settings)?;
    check(problem)?;
    let count = problem.contacts.len();
    let longest = max_abs(&problem.free);
    let spacing = if longest > 0.0 { longest } else { 1.0 };
    let mut side = 1;
    while side * side < count {
        side += 1;
    }
    let at = |i: f64, j: f64| [i * spacing, j * spacing];
    let contacts = problem.contacts.iter().enumerate();
    let mut nodes: Vec<Node> = contacts
        .map(|(k, (id, _))| Node {
            name: id.clone(),
            at: at((k % side) as f64, (k / side) as f64),
        })
        .collect();
    let (low, wide, deep) = (-0.5, side as f64 - 0.5, count.div_ceil(side) as f64 - 0.5);
    for (k, [i, j]) in [[low, low], [wide, low], [wide, deep], [low, deep]]
        .into_iter()
        .enumerate()
    {
        nodes.push(Node {
            name: format!("floor.{}", k + 1),
            at: at(i, j),
        });
    }
    let sides = [[0, 1], [1, 2], [2, 3], [3, 0]];
    let sides = sides.map(|ends| ends.map(|end| count + end).to_vec());
    let floor = Surface::new("floor", sides.to_vec(), true);
    let contacts = problem
        .contacts
        .iter()
        .enumerate()
        .map(|(k, (_, friction))| Contact::new(k, vec![0], *friction))
        .collect();
    let mut model = Model {
        about: spec.about.clone(),
        settings: spec.settings,
        ..Model::from_contacts(&spec.title, nodes, vec![floor], contacts)
    };
    model.raise(vec![0.0; count + 4]);
    if let Some(space) = &mut model.space {
        space.problem = Some(Arc::new(SpaceProblem {
            entries: problem.compliance.clone(),
            free: problem.free.clone(),
        }));
    }
    let names = Names::single(&model.nodes);
    Ok((model, names))
}

fn check(problem: &SpaceSpec) -> Result<(), Fault> {
    let count = problem.contacts.len();
    if count == 0 {
        bail!(
            at!["contacts"],
            "the list is empty; a problem needs at least one contact"
        );
    }
    let mut names = HashSet::new();
    for (k, (id, friction)) in problem.contacts.iter().enumerate() {
        limits::node_id(&at!["contacts", k, "id"], id)?;
        if id.split('.').next() == Some("floor") || !names.insert(id) {
            bail!(at!["contacts", k, "id"], "{id:?} is already used");
        }
        let sound = (0.0..90.0).contains(&friction.angle)
            && (0.0..=limits::MAGNITUDE).contains(&friction.cohesion);
        if !sound {
            bail!(
                at!["contacts", k, "friction"],
                "the angle must be at least 0 and below 90 degrees, and the cohesion not negative"
            );
        }
    }
    if problem.free.len() != 3 * count {
        bail!(
            at!["free"],
            "it has {}; a problem in space with {} has {}",
            counted(problem.free.len(), "number"),
            counted(count, "contact"),
            3 * count
        );
    }
    for (k, q) in problem.free.iter().enumerate() {
        limits::finite(&at!["free", k], *q, "the motion")?;
    }
    for (k, &(i, j, value)) in problem.compliance.iter().enumerate() {
        if i.max(j) >= 3 * count {
            bail!(
                at!["matrix", k],
                "row {} and column {}: the matrix has {} rows, three per contact",
                i + 1,
                j + 1,
                3 * count
            );
        }
        limits::finite(&at!["matrix", k], value, "the entry")?;
    }
    Ok(())
}
