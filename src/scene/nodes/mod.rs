//! Nodes and their names: generates chains and resolves aliases.
//!
//! `checks` rejects invalid input before any node is generated; `layout` creates nodes and chains, `joints` meshes of several
//! blocks, `given` meshes given node by node, which `elements` and `sides` check; `lookup` finds nodes by name, and `lines`
//! describes the sides of a mesh.

pub(crate) mod checks;
mod elements;
mod given;
mod joints;
mod layout;
pub mod lines;
mod lookup;
mod sides;

use super::blocks::Grid;
use super::limits;
use crate::Spec;
use crate::format::error::{Fault, at};
use crate::format::spec::Nodes;
use checks::{check_ids, check_total};
use elements::Element;
use stickslip_core::{ElementKind, Node};

use sides::SideLine as Sides;
use std::collections::HashMap;

/// All nodes of a scene, with all their names.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Names {
    pub(crate) nodes: Vec<Node>,
    entries: Vec<NameEntry>,
    index: HashMap<String, usize>,
}

/// The result of one entry of the scene's `nodes`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NameEntry {
    id: String,
    /// Node numbers in order.
    pub nodes: Vec<usize>,
    pub kind: EntryKind,
    /// Index in the scene's `nodes`.
    pub at: usize,
    /// The entries of the blocks, for a mesh of several blocks.
    parts: Vec<usize>,
    /// The node labels of a given mesh, ascending; nodes of other entries are numbered from 1.
    labels: Vec<usize>,
    /// The elements of a given mesh or of its parts.
    elements: Vec<Element>,
    /// The sides, for sides of a given mesh.
    line: Sides,
}

/// The nodes and elements of a solid.
pub(crate) struct Mesh {
    /// Distinct nodes.
    pub nodes: Vec<usize>,
    /// Kind and nodes of each element.
    pub elements: Vec<(ElementKind, Vec<usize>)>,
}

/// Kind of an entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum EntryKind {
    /// A single node.
    Single,
    /// A chain with this number of nodes per element.
    Chain(usize),
    /// A chain along an edge of a block, with this number of nodes per element.
    Edge(usize),
    /// A mesh on one block.
    Block(Grid),
    /// A mesh of several blocks.
    Mesh,
    /// A mesh given node by node.
    Given,
    /// A part of such a mesh.
    Part,
    /// A node set of such a mesh.
    Set,
    /// Sides of such a mesh, with their nodes per side if they form one chain.
    Sides(Option<usize>),
}

impl EntryKind {
    /// Nodes per element of a chain.
    fn per_element(self) -> Option<usize> {
        match self {
            EntryKind::Chain(m) | EntryKind::Edge(m) => Some(m),
            EntryKind::Sides(m) => m,
            _ => None,
        }
    }
}

impl Names {
    /// Names for single nodes, each under its own name.
    pub(crate) fn single(nodes: &[Node]) -> Names {
        let entry =
            |(k, node): (usize, &Node)| NameEntry::new(k, &node.name, vec![k], EntryKind::Single);
        let named = |(k, node): (usize, &Node)| (node.name.clone(), k);
        Names {
            nodes: nodes.to_vec(),
            entries: nodes.iter().enumerate().map(entry).collect(),
            index: nodes.iter().enumerate().map(named).collect(),
        }
    }
}

impl NameEntry {
    fn new(at: usize, id: &str, nodes: Vec<usize>, kind: EntryKind) -> NameEntry {
        NameEntry {
            id: id.to_owned(),
            nodes,
            kind,
            at,
            parts: Vec::new(),
            labels: Vec::new(),
            elements: Vec::new(),
            line: Sides::default(),
        }
    }

    /// Node numbers of each element of a chain in order, chain by chain: sides of a given mesh may form several chains.
    pub fn pieces(&self) -> Vec<Vec<Vec<usize>>> {
        match self.kind {
            EntryKind::Sides(_) => self.line.pieces.clone(),
            _ => vec![self.elements()],
        }
    }

    /// Whether it has sides between two elements, which have no outward side.
    pub fn is_inside(&self) -> bool {
        self.line.inside
    }

    /// Mutable access to all node numbers.
    fn numbers_mut(&mut self) -> impl Iterator<Item = &mut usize> {
        let of_elements = self.elements.iter_mut().flat_map(|(_, nodes)| nodes);
        let of_line = self.line.numbers_mut();
        self.nodes.iter_mut().chain(of_elements).chain(of_line)
    }

    /// Node numbers of each element of a chain, in order.
    pub fn elements(&self) -> Vec<Vec<usize>> {
        if let EntryKind::Sides(_) = self.kind {
            return self.line.pieces.concat();
        }
        let step = self.kind.per_element().map_or(1, |m| m - 1);
        let last = self.nodes.len().saturating_sub(1);
        (0..last)
            .step_by(step)
            .map(|k| self.nodes[k..=k + step].to_vec())
            .collect()
    }
}

impl Names {
    /// Generates all nodes of a scene. Meshes of several blocks, and then chains over existing nodes, come last, so that they may
    /// refer to later entries of the scene.
    pub(crate) fn from_spec(spec: &Spec) -> Result<Names, Fault> {
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
    pub(crate) fn entries(&self) -> &[NameEntry] {
        &self.entries
    }

    /// Index in the scene's `nodes` of the entry with an id.
    pub(crate) fn place(&self, id: &str) -> Option<usize> {
        self.index.get(id).map(|&k| self.entries[k].at)
    }

    fn enter(&mut self, at: usize, id: &str, nodes: Vec<usize>, kind: EntryKind) {
        self.add(NameEntry::new(at, id, nodes, kind));
    }

    fn add(&mut self, entry: NameEntry) {
        self.index.insert(entry.id.clone(), self.entries.len());
        self.entries.push(entry);
    }
}
