//! Meshes of several blocks: joins edges and merges their nodes.

use super::{EntryKind, NameEntry, Names};
use crate::format::error::{Fault, Path, at, bail, fault};
use crate::format::spec::Nodes;
use crate::number::sig4;
use std::collections::HashSet;
use stickslip_core::counted;
use stickslip_core::groups::Connected;
use stickslip_core::plane::distance;

impl Names {
    /// Adds a mesh of several blocks, and returns the node pairs that its joints merge: the node that stays and the one that is
    /// removed.
    pub(super) fn mesh_of_blocks(
        &mut self,
        at: usize,
        nodes: &Nodes,
        twins: &mut Vec<(usize, usize)>,
    ) -> Result<(), Fault> {
        let Nodes::Mesh {
            id,
            of,
            joints,
            tolerance,
        } = nodes
        else {
            return Ok(());
        };
        let here = at!["nodes", at];
        if !(0.0..=0.1).contains(tolerance) {
            bail!(
                here.then("tolerance"),
                "the tolerance is {tolerance:?}; it must be 0 to 0.1 (relative to the edge's length)"
            );
        }
        if of.is_empty() {
            bail!(
                here.then("of"),
                "the list is empty; name the blocks of the mesh"
            );
        }
        let mut parts = Vec::new();
        for (k, block) in of.iter().enumerate() {
            let fault = |message| Fault::new(here.then("of").then(k), message);
            let part = self.block(block).map_err(fault)?;
            if parts.contains(&part) {
                return Err(fault(format!("block {block:?} is named twice")));
            }
            parts.push(part);
        }
        for (k, (a, b)) in joints.iter().enumerate() {
            let here = here.then("joints").then(k);
            let a = self.edge(&here.then(0), a, &parts)?;
            let b = self.edge(&here.then(1), b, &parts)?;
            twins.extend(self.joint(&here, a, b, *tolerance)?);
        }
        let all: Vec<usize> = parts
            .iter()
            .flat_map(|&k| self.entries[k].nodes.clone())
            .collect();
        self.enter(at, id, all, EntryKind::Mesh);
        if let Some(entry) = self.entries.last_mut() {
            entry.parts = parts;
        }
        Ok(())
    }

    /// An edge of one of these blocks.
    fn edge(&self, here: &Path, name: &str, parts: &[usize]) -> Result<&NameEntry, Fault> {
        let fault = |message| Fault::new(here, message);
        let edge = self.chain(name).map_err(fault)?;
        let owner = parts.iter().any(|&k| self.entries[k].at == edge.at);
        if matches!(edge.kind, EntryKind::Edge(_)) && owner {
            return Ok(edge);
        }
        Err(fault(format!(
            "{name:?} is not an edge of a block of this mesh, e.g. \"{}.right\"",
            parts.first().map_or("block", |&k| &self.entries[k].id)
        )))
    }

    /// The nodes merged by joining two edges. Both are walked with their block on the left, so they run in opposite directions.
    fn joint(
        &self,
        here: &Path,
        a: &NameEntry,
        b: &NameEntry,
        tolerance: f64,
    ) -> Result<Vec<(usize, usize)>, Fault> {
        let per = |edge: &NameEntry| edge.kind.per_element().unwrap_or(2);
        if per(a) != per(b) {
            bail!(
                here,
                "{:?} has {} nodes per side and {:?} has {}; joined blocks need elements with the same number",
                a.id,
                per(a),
                b.id,
                per(b)
            );
        }
        let elements = |edge: &NameEntry| edge.nodes.len() / (per(edge) - 1);
        if a.nodes.len() != b.nodes.len() {
            bail!(
                here,
                "{:?} has {} and {:?} has {}; joined edges need the same number",
                a.id,
                counted(elements(a), "element"),
                b.id,
                elements(b)
            );
        }
        let place = |n: usize| self.nodes[n].at;
        let length: f64 = a
            .nodes
            .windows(2)
            .map(|w| distance(place(w[0]), place(w[1])))
            .sum();
        let pairs: Vec<(usize, usize)> = a
            .nodes
            .iter()
            .copied()
            .zip(b.nodes.iter().rev().copied())
            .collect();
        let apart = |&&(n, m): &&(usize, usize)| {
            let far = distance(place(n), place(m)) > tolerance * length;
            far || !distance(place(n), place(m)).is_finite()
        };
        let Some(&(n, m)) = pairs.iter().find(apart) else {
            return Ok(pairs);
        };
        let ([x, y], [v, w]) = (place(n), place(m));
        Err(fault!(
            here,
            "the edges do not coincide: {} is at ({x:?}, {y:?}) and {} at ({v:?}, {w:?}), {} apart; \
             at most {} is allowed (tolerance {tolerance:?} of the length {length:.4})",
            self.nodes[n].name,
            self.nodes[m].name,
            sig4(distance(place(n), place(m))),
            sig4(tolerance * length)
        ))
    }

    /// Merges twin nodes into the first of them, and renumbers the others.
    pub(super) fn merge(&mut self, twins: &[(usize, usize)]) {
        if twins.is_empty() {
            return;
        }
        let mut groups = Connected::new(self.nodes.len());
        twins.iter().for_each(|&(a, b)| groups.join(a, b));
        let mut number = vec![0; self.nodes.len()];
        let mut kept = Vec::with_capacity(self.nodes.len());
        for (n, node) in std::mem::take(&mut self.nodes).into_iter().enumerate() {
            let first = groups.root(n);
            if first == n {
                number[n] = kept.len();
                kept.push(node);
            } else {
                // The first of its twins is already numbered.
                number[n] = number[first];
            }
        }
        self.nodes = kept;
        for entry in &mut self.entries {
            entry.numbers_mut().for_each(|n| *n = number[*n]);
            if entry.kind == EntryKind::Mesh {
                let mut seen = HashSet::new();
                entry.nodes.retain(|n| seen.insert(*n));
            }
        }
    }
}
