//! Checks before any node is generated: invalid or duplicate ids, and too many nodes.

use super::super::blocks::Grid;
use super::super::limits;
use crate::Spec;
use crate::format::error::{Fault, at, bail};
use crate::format::spec::Nodes;
use std::collections::HashMap;

/// Checks the ids of nodes: valid and unique.
pub(super) fn check_ids(spec: &Spec) -> Result<(), Fault> {
    if spec.nodes.is_empty() {
        bail!(at!["nodes"], "the scene has no nodes");
    }
    for (k, nodes) in spec.nodes.iter().enumerate() {
        let here = at!["nodes", k, "id"];
        let Nodes::Node { id, .. } = nodes else {
            limits::id(&here, nodes.id())?;
            continue;
        };
        limits::node_id(&here, id)?;
        // The part before a dot could be a chain with this node.
        let mut dots = id.match_indices('.').map(|(at, _)| &id[..at]);
        let chain = dots.find(|chain| {
            let named = spec.nodes.iter().find(|other| other.id() == *chain);
            named.is_some_and(|other| !matches!(other, Nodes::Node { .. }))
        });
        if let Some(chain) = chain {
            bail!(
                here,
                "the id {id:?} would also be the name of a node of {chain:?}"
            );
        }
    }
    once("nodes", spec.nodes.iter().map(Nodes::id))
}

/// Rejects invalid and duplicate ids in a list.
pub(crate) fn unique<'a>(list: &str, ids: impl Iterator<Item = &'a str>) -> Result<(), Fault> {
    let ids: Vec<&str> = ids.collect();
    for (k, id) in ids.iter().enumerate() {
        limits::id(&at![list, k, "id"], id)?;
    }
    once(list, ids.into_iter())
}

/// Rejects duplicate ids in a list.
fn once<'a>(list: &str, ids: impl Iterator<Item = &'a str>) -> Result<(), Fault> {
    let mut seen = HashMap::new();
    for (k, id) in ids.enumerate() {
        let here = at![list, k, "id"];
        if let Some(first) = seen.insert(id, k) {
            bail!(here, "the id {id:?} is already used by {list}[{first}]");
        }
    }
    Ok(())
}

/// Rejects too many nodes before any is generated.
pub(super) fn check_total(spec: &Spec) -> Result<(), Fault> {
    let mut total = 0.0;
    for (k, nodes) in spec.nodes.iter().enumerate() {
        // Floating point cannot overflow here, and is exact where it matters.
        total += match nodes {
            Nodes::Node { .. } => 1.0,
            Nodes::Line {
                elements,
                per_element,
                ..
            }
            | Nodes::Arc {
                elements,
                per_element,
                ..
            } => *elements as f64 * *per_element as f64 * spec.refine as f64,
            Nodes::Through { points, .. } => points.len() as f64 * spec.refine as f64,
            Nodes::Block {
                elements, element, ..
            } => {
                let (nx, ny) = (elements.0 as f64, elements.1 as f64);
                let refine = spec.refine as f64;
                let border = (element.per_face() - 1) as f64;
                (Grid::nodes_per_cell(*element) * nx * ny * refine + border * (nx + ny)) * refine
                    + 1.0
            }
            Nodes::Given { nodes, .. } => nodes.len() as f64,
            Nodes::Mesh { .. } | Nodes::Chain { .. } | Nodes::Import { .. } => 0.0,
        };
        let why = if total > limits::NODES as f64 {
            format!("at most {} are allowed", limits::NODES)
        } else {
            match limits::memory(total * limits::NODE_BYTES, spec.settings.memory) {
                Ok(()) => continue,
                Err(why) => format!("they need {why}"),
            }
        };
        let refine = spec.refine;
        bail!(
            at!["nodes", k],
            "up to here the scene has about {total} nodes (refine: {refine}); {why}"
        );
    }
    Ok(())
}
