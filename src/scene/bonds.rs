//! Summary of contact laws other than hard contact, as `check` shows it: their cost and effects.

use super::Scene;
use crate::format::contact_law::ContactLaw;
use crate::format::spec::SlaveSpec;
use crate::gaps::from_to;
use crate::joined;
use std::collections::HashSet;
use stickslip_core::{Contact, Model, Surface, counted, plane};

/// One line per contact law other than hard contact that a slave node has; empty without any.
pub fn words(scene: &Scene) -> Vec<String> {
    let model = &scene.model;
    let having = |k: usize| -> Vec<f64> {
        model
            .contacts
            .iter()
            .map(|contact| contact.bond.give()[k])
            .filter(|give| *give > 0.0)
            .collect()
    };
    let mut lines = Vec::new();
    let (normal, tangential) = (having(0), having(1));
    if !normal.is_empty() {
        lines.push(format!(
            "penalty at {}: penetration c F_n, c {}; adds no unknowns, only a diagonal term on the interface",
            counted(normal.len(), "slave node"),
            range(&normal)
        ));
    }
    if !tangential.is_empty() {
        lines.push(format!(
            "stick stiffness at {}: elastic slip c F_t, c {}; adds no unknowns",
            counted(tangential.len(), "slave node"),
            range(&tangential)
        ));
    }
    if !normal.is_empty() || !tangential.is_empty() {
        lines.push("with these laws, condensed bodies are supported by springs, and nodes are not held in corners".into());
    }
    lines.extend(kinked(model));
    let tied = model
        .contacts
        .iter()
        .filter(|contact| contact.bond.is_tied())
        .count();
    if tied > 0 {
        lines.push(format!(
            "tied: {}, always fixed and without friction; strategies do not choose their modes",
            counted(tied, "slave node")
        ));
    }
    lines.extend(left_out(scene));
    if !lines.is_empty() {
        lines.push(areas(&model.contacts));
    }
    lines
}

/// Surfaces whose kinks may make nodes with a compliance hop.
fn kinked(model: &Model) -> Option<String> {
    let touched = |k: usize| {
        model
            .contacts
            .iter()
            .any(|c| c.bond.give() != [0.0; 2] && c.surfaces.contains(&k))
    };
    let kinks = |(k, surface): &(usize, &Surface)| {
        !surface.rigid && surface.smooth.is_empty() && surface.elements.len() > 1 && touched(*k)
    };
    let named = joined(
        model
            .surfaces
            .iter()
            .enumerate()
            .filter(kinks)
            .map(|(_, surface)| surface.name.as_str()),
        ", ",
    );
    let why = "may have kinks when they deform, where a node inside may hop between two elements; use smooth: true";
    (!named.is_empty()).then(|| format!("surfaces {named}: {why}"))
}

/// Nodes listed with a penalty that are not slave nodes, for example on the axis of bodies whose elements have midside nodes.
fn left_out(scene: &Scene) -> Option<String> {
    let slaves: HashSet<usize> = scene
        .model
        .contacts
        .iter()
        .map(|slave| slave.node)
        .collect();
    let penalty =
        |group: &SlaveSpec| group.by.is_node() && matches!(group.law, ContactLaw::Penalty { .. });
    let mut listed = HashSet::new();
    let named = joined(
        scene
            .spec
            .slaves
            .iter()
            .filter(|group| penalty(group))
            .flat_map(|group| &group.nodes)
            .filter_map(|name| scene.names().nodes(name).ok())
            .flatten()
            .filter(|node| !slaves.contains(node) && listed.insert(*node))
            .map(|node| scene.model.nodes[node].name.clone()),
        ", ",
    );
    let why = "left out of the penalty, without contact force, because they have no area (A = 0) or cannot move";
    (!named.is_empty()).then(|| format!("{why}: {named}"))
}

/// The smallest and the largest value.
fn range(values: &[f64]) -> String {
    let [least, largest] = plane::range(values.iter().copied());
    from_to(least, largest)
}

/// Total tributary area, and the number of nodes without one.
fn areas(contacts: &[Contact]) -> String {
    let known = || contacts.iter().filter_map(|contact| contact.area);
    let (count, sum) = (known().count(), known().sum::<f64>());
    let without = match contacts.len() - count {
        0 => String::new(),
        none => format!("; {} without", counted(none, "slave node")),
    };
    format!(
        "areas of {} (undeformed): {sum:.6} in total{without}",
        counted(count, "slave node")
    )
}
