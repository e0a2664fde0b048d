//! The lines of sides of a given mesh, for finding one by its shape.

use super::given::nodes_of;
use super::{EntryKind, NameEntry, Names};
use std::collections::BTreeSet;
use stickslip_core::plane::distance;

/// A line of sides.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Name in the scene.
    pub name: String,
    /// Name of the first part of the mesh that contains all its nodes; `None` for a line on no body.
    pub part: Option<String>,
    /// Positions of its nodes, in walking order.
    pub at: Vec<[f64; 2]>,
    /// Whether it has sides between two elements.
    pub is_inside: bool,
    /// One-line description.
    pub words: String,
}

impl Names {
    /// One-line notes about each given mesh: nodes on no element, and that `refine` has no effect on it.
    pub fn notes(&self, refine: usize) -> Vec<String> {
        let meshes = self
            .entries
            .iter()
            .filter(|entry| entry.kind == EntryKind::Given);
        let of_chains = self
            .entries
            .iter()
            .filter(|entry| matches!(entry.kind, EntryKind::Chain(_)))
            .flat_map(|entry| entry.nodes.iter().copied());
        let of_chains: BTreeSet<usize> = of_chains.collect();
        let note = |mesh: &NameEntry| {
            let mut busy: BTreeSet<usize> = nodes_of(&mesh.elements).into_iter().collect();
            busy.extend(mesh.nodes.iter().filter(|node| of_chains.contains(node)));
            let idle = mesh.nodes.len() - busy.len();
            let idle = (idle > 0).then(|| {
                format!(
                    "mesh {:?}: {idle} of its nodes belong to no element",
                    mesh.id
                )
            });
            let coarse = (refine > 1)
                .then(|| format!("mesh {:?}: refine does not divide its elements", mesh.id));
            idle.into_iter().chain(coarse)
        };
        meshes.flat_map(note).collect()
    }

    /// The lines of sides of the given mesh with an id, in scene order.
    pub fn lines(&self, id: &str) -> Vec<Line> {
        let Some(mesh) = self.index.get(id).map(|&k| &self.entries[k]) else {
            return Vec::new();
        };
        let own = || self.entries.iter().filter(|entry| entry.at == mesh.at);
        let has_all = |part: &&NameEntry, line: &NameEntry| {
            part.kind == EntryKind::Part
                && line
                    .nodes
                    .iter()
                    .all(|n| part.nodes.binary_search(n).is_ok())
        };
        let line = |entry: &NameEntry| {
            let part = own()
                .find(|part| has_all(part, entry))
                .map(|part| part.id.clone());
            let at: Vec<[f64; 2]> = entry.nodes.iter().map(|&n| self.nodes[n].at).collect();
            let place = |n: usize| self.nodes[n].at;
            let sides = entry.elements();
            let length: f64 = sides
                .iter()
                .flat_map(|side| side.windows(2))
                .map(|pair| distance(place(pair[0]), place(pair[1])))
                .sum();
            let words = format!(
                "{}: {} sides, length {length:.4}, of {}; {}",
                entry.id,
                sides.len(),
                part.as_deref().unwrap_or("no part"),
                entry.line.words(&self.nodes)
            );
            Line {
                name: entry.id.clone(),
                part,
                at,
                is_inside: entry.is_inside(),
                words,
            }
        };
        own()
            .filter(|entry| matches!(entry.kind, EntryKind::Sides(_)))
            .map(line)
            .collect()
    }
}
