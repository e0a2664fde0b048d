//! Elimination order in the full system of bodies and interface.

use super::coupling::Link;
use super::system::System;
use crate::Model;
use crate::model::{Beam, BodyKind, Component};

impl System {
    /// Groups of unknowns for the elimination: a node's displacements with the forces of its interface equations, and each
    /// internal unknown of a body. If a slave node has no unknown displacement, its forces join a master node's group. An element
    /// of a shear-rigid beam has one more shear force than interior nodes, and contacts may hold all of these; the last shear
    /// force therefore joins the group of an end node.
    pub(super) fn groups(&self, model: &Model) -> Vec<usize> {
        let dofs = &model.dofs;
        let mut groups = vec![0; dofs.equations + 2 * self.interfaces.len()];
        let mut node_of = vec![None; dofs.len()];
        for node in 0..dofs.first.len() {
            node_of[dofs.of_node(node)].fill(Some(node));
        }
        for body in &model.bodies {
            if let BodyKind::Beam(beam) = &body.kind {
                give_shears(model, beam, &mut node_of);
            }
        }
        let mut more = dofs.first.len()..;
        for (dof, equation) in dofs.equation.iter().enumerate() {
            if let Some(equation) = equation {
                groups[*equation] = node_of[dof].or_else(|| more.next()).unwrap_or(0);
            }
        }
        for (s, interface) in self.interfaces.iter().enumerate() {
            let free = |link: &&Link| dofs.equation[link.dof].is_some();
            let home = interface
                .links
                .iter()
                .find(free)
                .and_then(|l| node_of[l.dof]);
            let home = home.or_else(|| more.next()).unwrap_or(0);
            let row = dofs.equations + 2 * s;
            groups[row..row + 2].fill(home);
        }
        groups
    }
}

/// Assigns every element's last shear force to the node at the element's end, or at its start if the beam's end cannot rotate
/// freely.
fn give_shears(model: &Model, beam: &Beam, node_of: &mut [Option<usize>]) {
    let turns = |node: &usize| {
        let dof = model.dofs.dof(*node, Component::Rotation);
        dof.is_some_and(|dof| model.dofs.equation[dof].is_some())
    };
    let last = beam.elements.last().and_then(|nodes| nodes.last());
    let at_end = last.is_some_and(turns);
    for (e, nodes) in beam.elements.iter().enumerate() {
        let end = if at_end { nodes.last() } else { nodes.first() };
        if let (Some(first), Some(node)) = (beam.first_shear, end.filter(|n| turns(n))) {
            node_of[first + (e + 1) * (nodes.len() - 1) - 1] = Some(*node);
        }
    }
}
