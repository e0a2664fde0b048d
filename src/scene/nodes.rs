//! Nodes and their names: chains laid out, aliases resolved.

use super::blocks::{EDGES, Grid, block};
use super::curves::{arc, check_chain_count, check_per_element, intervals, line, point, through};
use super::error::{Fault, at, did_you_mean, quoted};
use super::limits;
use super::model::Node;
use super::spec::{Nodes, Spec};
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
    pub kind: Kind,
    /// Position in the scene's `nodes`.
    pub at: usize,
}

/// What an entry's nodes form.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A single node.
    Single,
    /// A chain of elements of that many nodes.
    Chain(usize),
    /// A chain of 3-node elements along an edge of a block.
    Edge,
    /// A mesh of quadrilaterals.
    Block(Grid),
}

impl Kind {
    /// Nodes per element of a chain.
    fn per_element(self) -> Option<usize> {
        match self {
            Kind::Single | Kind::Block(_) => None,
            Kind::Chain(m) => Some(m),
            Kind::Edge => Some(3),
        }
    }
}

impl Entry {
    /// What to say where one node is wanted and this, called `name`, has many.
    fn many(&self, name: &str, count: usize) -> String {
        let id = &self.id;
        let (what, examples) = match self.kind {
            Kind::Block(_) => (
                "a block",
                format!("\"{id}.left.start\" or \"{id}.{}\"", count.min(2)),
            ),
            kind => (
                if kind == Kind::Edge {
                    "an edge"
                } else {
                    "a chain"
                },
                format!("\"{id}.start\", \"{id}.end\" or \"{id}.{}\"", count.min(2)),
            ),
        };
        format!("{name:?} is {what} of {count} nodes; name one of them, as {examples}")
    }

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
    /// Lays out all nodes of a scene. Chains over existing nodes come last, so that they may name what stands below
    /// them.
    pub(crate) fn of(spec: &Spec) -> Result<Names, Fault> {
        limits::count(&at!["refine"], spec.refine, 1..=limits::NODES, "refine")?;
        ids(spec)?;
        check_total(spec)?;
        let mut names = Names::default();
        let shares = |nodes: &Nodes| matches!(nodes, Nodes::Chain { .. });
        let entries = spec.nodes.iter().enumerate();
        for (at, nodes) in entries.clone().filter(|(_, nodes)| !shares(nodes)) {
            names.generate(at, nodes, spec.refine)?;
        }
        for (at, nodes) in entries {
            if let Nodes::Chain {
                id,
                of,
                per_element,
            } = nodes
            {
                names.share(at, id, of, *per_element)?;
            }
        }
        Ok(names)
    }

    /// The number of a node by any of its names.
    ///
    /// # Errors
    /// A message that tells which names there are.
    pub fn node(&self, name: &str) -> Result<usize, String> {
        let (entry, selector) = self.split(name)?;
        let count = entry.nodes.len();
        let index = match selector {
            Selector::Whole if entry.kind == Kind::Single => 0,
            Selector::Whole | Selector::All => return Err(entry.many(name, count)),
            Selector::Index(index) => index,
        };
        Ok(entry.nodes[index])
    }

    /// The numbers of the nodes that a name stands for: all of a chain for `ID.all`, and of a block's edge for its name
    /// alone; else one.
    ///
    /// # Errors
    /// As [`Names::node`].
    pub fn nodes(&self, name: &str) -> Result<Vec<usize>, String> {
        match self.split(name)? {
            (entry, Selector::All) => Ok(entry.nodes.clone()),
            (entry, Selector::Whole) if entry.kind == Kind::Edge => Ok(entry.nodes.clone()),
            _ => Ok(vec![self.node(name)?]),
        }
    }

    /// The chain with an id.
    pub(crate) fn chain(&self, id: &str) -> Result<&Entry, String> {
        if let Some(&k) = self.index.get(id) {
            let entry = &self.entries[k];
            return match entry.kind {
                Kind::Chain(_) | Kind::Edge => Ok(entry),
                Kind::Single => Err(format!(
                    "{id:?} is a single node; a chain is needed (Line, Arc, Through or Chain, or an edge of a Block)"
                )),
                Kind::Block(_) => Err(format!(
                    "{id:?} is a block; name one of its edges, \"{id}.bottom\", \"{id}.right\", \"{id}.top\" or \"{id}.left\""
                )),
            };
        }
        let chains = || {
            self.entries
                .iter()
                .filter(|e| e.kind.per_element().is_some())
                .map(|e| e.id.as_str())
        };
        Err(format!(
            "no chain of nodes called {}{} (chains: {})",
            quoted(id),
            did_you_mean(id, chains()),
            super::error::some_of(chains())
        ))
    }

    /// Position in the scene's `nodes` of what has an id.
    pub(crate) fn place(&self, id: &str) -> Option<usize> {
        self.index.get(id).map(|&k| self.entries[k].at)
    }

    /// The block with an id: its nodes and its grid.
    pub(crate) fn block(&self, id: &str) -> Result<(&Entry, Grid), String> {
        let blocks = || {
            let is_block = |e: &&Entry| matches!(e.kind, Kind::Block(_));
            self.entries.iter().filter(is_block).map(|e| e.id.as_str())
        };
        let entry = self.index.get(id).map(|&k| &self.entries[k]);
        match entry.map(|e| (e, e.kind)) {
            Some((entry, Kind::Block(grid))) => Ok((entry, grid)),
            Some(_) => Err(format!(
                "{id:?} is no block; a solid needs the mesh of one (blocks: {})",
                super::error::some_of(blocks())
            )),
            None => Err(format!(
                "no block called {}{} (blocks: {})",
                quoted(id),
                did_you_mean(id, blocks()),
                super::error::some_of(blocks())
            )),
        }
    }

    /// The entries: single nodes, chains, blocks and their edges.
    pub(crate) fn entries(&self) -> &[Entry] {
        &self.entries
    }

    fn split(&self, name: &str) -> Result<(&Entry, Selector), String> {
        let Some((entry, selector)) = self.entry_of(name) else {
            return Err(self.unknown(name));
        };
        let id = &entry.id;
        if selector.is_empty() {
            return Ok((entry, Selector::Whole));
        }
        if entry.kind == Kind::Single {
            return Err(format!(
                "{id:?} is a single node, not a chain; its only name is {id:?}"
            ));
        }
        let found = match selector
            .strip_prefix('@')
            .filter(|_| entry.kind.per_element().is_some())
        {
            Some(fraction) => Ok(Selector::Index(at_fraction(
                name,
                fraction,
                entry.nodes.len(),
            )?)),
            None => self.selected(name, &selector[1..], entry),
        };
        Ok((entry, found?))
    }

    /// The entry that a name begins with, an edge before its block, and the rest of the name.
    fn entry_of<'n>(&self, name: &'n str) -> Option<(&Entry, &'n str)> {
        let cut_from = |start: usize| {
            let rest = name.get(start..).unwrap_or_default();
            rest.find(['.', '@']).map_or(name.len(), |k| start + k)
        };
        let first = cut_from(0);
        let second = cut_from(first + 1);
        let found = |cut: usize| {
            let (id, selector) = name.split_at(cut);
            self.index.get(id).map(|&k| (&self.entries[k], selector))
        };
        found(second).or_else(|| found(first))
    }

    fn selected(&self, name: &str, selector: &str, entry: &Entry) -> Result<Selector, String> {
        let count = entry.nodes.len();
        let is_chain = entry.kind.per_element().is_some();
        match selector {
            "start" if is_chain => Ok(Selector::Index(0)),
            "end" if is_chain => Ok(Selector::Index(count - 1)),
            "all" => Ok(Selector::All),
            _ => match selector.parse::<usize>() {
                Ok(k) if (1..=count).contains(&k) => Ok(Selector::Index(k - 1)),
                Ok(_) => Err(format!(
                    "no node called {}: the {} has {count} nodes, \"{}.1\" to \"{}.{count}\"",
                    quoted(name),
                    if is_chain { "chain" } else { "block" },
                    entry.id,
                    entry.id
                )),
                Err(_) => Err(self.unknown(name)),
            },
        }
    }

    fn unknown(&self, name: &str) -> String {
        let mut known = Vec::new();
        let mut shown = Vec::new();
        for Entry {
            id, nodes, kind, ..
        } in &self.entries
        {
            known.push(id.clone());
            match kind {
                Kind::Single => shown.push(id.clone()),
                Kind::Chain(_) | Kind::Edge => {
                    known.extend(["start", "end", "all"].map(|which| format!("{id}.{which}")));
                    shown.push(format!("{id}.1 to {id}.{}", nodes.len()));
                }
                Kind::Block(_) => {
                    known.push(format!("{id}.all"));
                    shown.push(format!("{id}.1 to {id}.{}", nodes.len()));
                }
            }
        }
        let more = shown.len().saturating_sub(8);
        shown.truncate(8);
        let more = if more > 0 {
            format!(" and {more} more")
        } else {
            String::new()
        };
        format!(
            "no node called {}{} (nodes: {}{more})",
            quoted(name),
            did_you_mean(name, known.iter().map(String::as_str)),
            shown.join(", ")
        )
    }

    fn generate(&mut self, at: usize, nodes: &Nodes, refine: usize) -> Result<(), Fault> {
        let here = at!["nodes", at];
        let (points, kind) = match nodes {
            Nodes::Node { at, .. } => {
                point(&here.then("at"), *at)?;
                (vec![*at], Kind::Single)
            }
            Nodes::Block {
                corners, elements, ..
            } => {
                let (grid, points) = block(&here, corners, *elements, refine)?;
                (points, Kind::Block(grid))
            }
            Nodes::Line {
                from,
                to,
                elements,
                per_element,
                ..
            } => {
                let n = intervals(&here, *elements, *per_element, refine)?;
                (line(&here, *from, *to, n)?, Kind::Chain(*per_element))
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
                    Kind::Chain(*per_element),
                )
            }
            Nodes::Through {
                points,
                per_element,
                ..
            } => (
                through(&here, points, *per_element, refine)?,
                Kind::Chain(*per_element),
            ),
            Nodes::Chain { .. } => return Ok(()),
        };
        let id = nodes.id();
        let first = self.nodes.len();
        for (k, at) in points.iter().enumerate() {
            let name = match kind {
                Kind::Single => id.to_owned(),
                _ => format!("{id}.{}", k + 1),
            };
            self.nodes.push(Node {
                name,
                at: [at.0, at.1],
            });
        }
        self.enter(at, id, (first..self.nodes.len()).collect(), kind);
        if let Kind::Block(grid) = kind {
            for (which, edge) in EDGES.iter().enumerate() {
                let nodes = grid.edge(which).iter().map(|n| first + n).collect();
                self.enter(at, &format!("{id}.{edge}"), nodes, Kind::Edge);
            }
        }
        Ok(())
    }

    fn share(
        &mut self,
        at: usize,
        id: &str,
        of: &[String],
        per_element: usize,
    ) -> Result<(), Fault> {
        let here = at!["nodes", at];
        check_per_element(&here, per_element)?;
        let before: usize = self.entries.iter().map(|entry| entry.nodes.len()).sum();
        let mut shared: Vec<usize> = Vec::new();
        for (k, name) in of.iter().enumerate() {
            let fault = |message: String| Fault::new(here.then("of").then(k), message);
            let found = self.nodes(name).map_err(fault)?;
            if before + shared.len() + found.len() > 2 * limits::NODES {
                return Err(fault(format!(
                    "with this, all chains have more than {} nodes together",
                    2 * limits::NODES
                )));
            }
            if shared.last().is_some() && shared.last() == found.first() {
                return Err(fault(format!(
                    "{name:?} stands twice in a row; a chain must go on to another node"
                )));
            }
            shared.extend(found);
        }
        check_chain_count(&here.then("of"), shared.len(), per_element)?;
        self.enter(at, id, shared, Kind::Chain(per_element));
        Ok(())
    }

    fn enter(&mut self, at: usize, id: &str, nodes: Vec<usize>, kind: Kind) {
        self.index.insert(id.to_owned(), self.entries.len());
        self.entries.push(Entry {
            id: id.to_owned(),
            nodes,
            kind,
            at,
        });
    }
}

/// What a name picks of an entry.
enum Selector {
    Whole,
    All,
    Index(usize),
}

/// Index of the node at a fraction of a chain of `count` nodes.
fn at_fraction(name: &str, fraction: &str, count: usize) -> Result<usize, String> {
    let last = count.saturating_sub(1) as f64;
    let place = match fraction.parse::<f64>() {
        Ok(value) if (0.0..=1.0).contains(&value) => value * last,
        _ => {
            return Err(format!(
                "no node called {}: what follows @ is a number from 0 to 1",
                quoted(name)
            ));
        }
    };
    let index = place.round();
    if (place - index).abs() <= 1e-6 {
        return Ok(index as usize);
    }
    Err(format!(
        "no node called {}: the chain has {count} nodes; the nearest are at @{} and @{}",
        quoted(name),
        place.floor() / last,
        place.ceil() / last
    ))
}

/// Ids of nodes: usable, and none twice.
fn ids(spec: &Spec) -> Result<(), Fault> {
    if spec.nodes.is_empty() {
        return Err(Fault::new(at!["nodes"], "the scene has no nodes"));
    }
    unique("nodes", spec.nodes.iter().map(Nodes::id))
}

/// Refuses unusable ids and second ones of the entries of a list.
pub(crate) fn unique<'a>(list: &str, ids: impl Iterator<Item = &'a str>) -> Result<(), Fault> {
    let mut seen = HashMap::new();
    for (k, id) in ids.enumerate() {
        let here = at![list, k, "id"];
        limits::id(&here, id)?;
        if let Some(first) = seen.insert(id, k) {
            return Err(Fault::new(
                here,
                format!("the id {id:?} is taken already by {list}[{first}]"),
            ));
        }
    }
    Ok(())
}

/// Refuses too many nodes before any is made.
fn check_total(spec: &Spec) -> Result<(), Fault> {
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
            Nodes::Block { elements, .. } => {
                let (nx, ny) = (elements.0 as f64, elements.1 as f64);
                let refine = spec.refine as f64;
                (3.0 * nx * ny * refine + 2.0 * (nx + ny)) * refine + 1.0
            }
            Nodes::Chain { .. } => 0.0,
        };
        if total > limits::NODES as f64 {
            let message = format!(
                "up to here the scene has about {total} nodes (refine: {}); at most {} can be had",
                spec.refine,
                limits::NODES
            );
            return Err(Fault::new(at!["nodes", k], message));
        }
    }
    Ok(())
}
