//! Creates the nodes and chains of the scene and adds them under their names.

use super::super::blocks::{EDGES, Shape, block};
use super::super::curves::{
    arc, check_chain_count, check_per_element, intervals, line, point, through,
};
use super::super::limits;
use super::{EntryKind, Names};
use crate::format::error::{Fault, at, bail};
use crate::format::spec::{Nodes, Point};
use stickslip_core::Node;

impl Names {
    pub(super) fn generate(
        &mut self,
        at: usize,
        nodes: &Nodes,
        refine: usize,
    ) -> Result<(), Fault> {
        let here = at!["nodes", at];
        let (points, kind) = match nodes {
            Nodes::Node { at, .. } => {
                point(&here.then("at"), *at)?;
                (vec![*at], EntryKind::Single)
            }
            Nodes::Block {
                corners,
                elements,
                element,
                grading,
                sides,
                place,
                ..
            } => {
                let shape = Shape {
                    corners,
                    elements: *elements,
                    kind: *element,
                    grading: *grading,
                    sides,
                    place,
                };
                let (grid, points) = block(&here, &shape, refine, &|id| self.curve(id))?;
                (points, EntryKind::Block(grid))
            }
            Nodes::Line {
                from,
                to,
                elements,
                per_element,
                ..
            } => {
                let n = intervals(&here, *elements, *per_element, refine)?;
                (line(&here, *from, *to, n)?, EntryKind::Chain(*per_element))
            }
            Nodes::Arc {
                center,
                radius,
                from,
                to,
                elements,
                per_element,
                ..
            } => {
                let n = intervals(&here, *elements, *per_element, refine)?;
                (
                    arc(&here, *center, *radius, (*from, *to), n)?,
                    EntryKind::Chain(*per_element),
                )
            }
            Nodes::Through {
                points,
                per_element,
                ..
            } => (
                through(&here, points, *per_element, refine)?,
                EntryKind::Chain(*per_element),
            ),
            Nodes::Given { .. } => return self.add_mesh(at, nodes),
            Nodes::Import { file, .. } => {
                bail!(
                    here.then("file"),
                    "the file {file:?} has not been read; scenes with an Import must be opened from a file"
                );
            }
            Nodes::Chain { .. } | Nodes::Mesh { .. } => return Ok(()),
        };
        let id = nodes.id();
        let first = self.nodes.len();
        for (k, at) in points.iter().enumerate() {
            let name = match kind {
                EntryKind::Single => id.to_owned(),
                _ => format!("{id}.{}", k + 1),
            };
            self.nodes.push(Node {
                name,
                at: [at.0, at.1],
            });
        }
        self.enter(at, id, (first..self.nodes.len()).collect(), kind);
        if let EntryKind::Block(grid) = kind {
            for (which, edge) in EDGES.iter().enumerate() {
                let nodes = grid.edge(which).iter().map(|n| first + n).collect();
                self.enter(
                    at,
                    &format!("{id}.{edge}"),
                    nodes,
                    EntryKind::Edge(grid.per_edge()),
                );
            }
        }
        Ok(())
    }

    pub(super) fn share(
        &mut self,
        at: usize,
        id: &str,
        of: &[String],
        per_element: usize,
        memory: Option<f64>,
    ) -> Result<(), Fault> {
        let here = at!["nodes", at];
        check_per_element(&here, per_element)?;
        let before: usize = self.entries.iter().map(|entry| entry.nodes.len()).sum();
        let mut shared: Vec<usize> = Vec::new();
        for (k, name) in of.iter().enumerate() {
            let fault = |message: String| Fault::new(here.then("of").then(k), message);
            let found = self.nodes(name).map_err(fault)?;
            self.check_one_chain(name).map_err(fault)?;
            let total = before + shared.len() + found.len();
            limits::memory(total as f64 * limits::NAMED_BYTES, memory).map_err(|why| {
                fault(format!(
                    "with this item, all chains have {total} nodes in total, which need {why}"
                ))
            })?;
            if found.len() > 1 && shared.last().is_some() && shared.last() == found.first() {
                shared.pop();
            } else if shared.last().is_some() && shared.last() == found.first() {
                return Err(fault(format!(
                    "{name:?} is repeated; a chain must continue to another node"
                )));
            }
            shared.extend(found);
        }
        check_chain_count(&here.then("of"), shared.len(), per_element)?;
        self.enter(at, id, shared, EntryKind::Chain(per_element));
        Ok(())
    }

    /// Points along an existing chain, and its nodes per element.
    fn curve(&self, id: &str) -> Result<(Vec<Point>, usize), String> {
        let chain = self.chain(id)?;
        self.check_one_chain(id)?;
        Ok((
            chain
                .nodes
                .iter()
                .map(|n| (self.nodes[*n].at[0], self.nodes[*n].at[1]))
                .collect(),
            chain.kind.per_element().unwrap_or(2),
        ))
    }
}
