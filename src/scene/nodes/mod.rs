//! Nodes and their names: chains laid out, aliases resolved.
//!
//! `checks` refuses what cannot be laid out before any is made; `layout` makes nodes and chains, `joints` meshes of
//! several blocks; `lookup` finds nodes by their names.

pub(crate) mod checks;
mod joints;
mod layout;
mod lookup;

use super::blocks::Grid;
use super::limits;
use crate::format::error::{Fault, at};
use crate::format::spec::{Nodes, Spec};
use crate::model::{ElementKind, Node};
use checks::{check_ids, check_total};
use std::collections::HashMap;

/// All nodes of a scene, and every name by which they can be called.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Names {
    pub(crate) nodes: Vec<Node>,
    entries: Vec<Entry>,
    index: HashMap<String, usize>,
}

/// What one entry of the scene's `nodes` made.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Entry {
    id: String,
    /// Node numbers in order.
    pub nodes: Vec<usize>,
    pub kind: EntryKind,
    /// Position in the scene's `nodes`.
    pub at: usize,
    /// Of a mesh of several blocks, their entries.
    parts: Vec<usize>,
}

/// What a solid is made on.
pub(crate) struct Mesh {
    /// Distinct nodes.
    pub nodes: Vec<usize>,
    /// Kind and nodes of each element.
    pub elements: Vec<(ElementKind, Vec<usize>)>,
}

/// What an entry's nodes form.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum EntryKind {
    /// A single node.
    Single,
    /// A chain of elements of that many nodes.
    Chain(usize),
    /// A chain of elements of that many nodes along an edge of a block.
    Edge(usize),
    /// A mesh on one block.
    Block(Grid),
    /// A mesh of several blocks.
    Mesh,
}

impl EntryKind {
    /// Nodes per element of a chain.
    fn per_element(self) -> Option<usize> {
        match self {
            EntryKind::Single | EntryKind::Block(_) | EntryKind::Mesh => None,
            EntryKind::Chain(m) | EntryKind::Edge(m) => Some(m),
        }
    }
}

impl Entry {
    /// Node numbers of each element of a chain, in order.
    pub fn elements(&self) -> Vec<Vec<usize>> {
        let step = self.kind.per_element().map_or(1, |m| m - 1);
        let last = self.nodes.len().saturating_sub(1);
        (0..last)
            .step_by(step)
            .map(|k| self.nodes[k..=k + step].to_vec())
            .collect()
    }
}

impl Names {
    /// Lays out all nodes of a scene. Meshes of several blocks, and then chains over existing nodes, come last, so that
    /// they may name what stands below them.
    pub(crate) fn of(spec: &Spec) -> Result<Names, Fault> {
        limits::count(&at!["refine"], spec.refine, 1..=limits::NODES, "refine")?;
        check_ids(spec)?;
        check_total(spec)?;
        let mut names = Names::default();
        let shares = |nodes: &Nodes| matches!(nodes, Nodes::Chain { .. } | Nodes::Mesh { .. });
        let entries = spec.nodes.iter().enumerate();
        for (at, nodes) in entries.clone().filter(|(_, nodes)| !shares(nodes)) {
            names.generate(at, nodes, spec.refine)?;
        }
        let mut twins = Vec::new();
        for (at, nodes) in entries.clone() {
            names.mesh_of_blocks(at, nodes, &mut twins)?;
        }
        names.merge(&twins);
        for (at, nodes) in entries {
            if let Nodes::Chain {
                id,
                of,
                per_element,
            } = nodes
            {
                names.share(at, id, of, *per_element, spec.settings.memory)?;
            }
        }
        Ok(names)
    }

    /// The entries: single nodes, chains, blocks, their edges, and meshes.
    pub(crate) fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Position in the scene's `nodes` of what has an id.
    pub(crate) fn place(&self, id: &str) -> Option<usize> {
        self.index.get(id).map(|&k| self.entries[k].at)
    }

    fn enter(&mut self, at: usize, id: &str, nodes: Vec<usize>, kind: EntryKind) {
        self.index.insert(id.to_owned(), self.entries.len());
        self.entries.push(Entry {
            id: id.to_owned(),
            nodes,
            kind,
            at,
            parts: Vec::new(),
        });
    }
}
