//! Nodes and their names: chains laid out, aliases resolved.

use super::blocks::{EDGES, Grid, Shape, block};
use super::curves::{arc, check_chain_count, check_per_element, intervals, line, point, through};
use super::error::{Fault, Path, at, did_you_mean, quoted};
use super::geometry::distance;
use super::limits;
use super::spec::{Nodes, Point, Spec};
use crate::model::Node;
use std::collections::{HashMap, HashSet};

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
    /// Of a mesh of several blocks, their entries.
    parts: Vec<usize>,
}

/// What a solid is made on.
pub(crate) struct Mesh {
    /// Distinct nodes.
    pub nodes: Vec<usize>,
    pub elements: Vec<[usize; 8]>,
    /// The outline: elements of 3 nodes, walked with the body on the left.
    pub edges: Vec<Vec<usize>>,
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
    /// A mesh of quadrilaterals on one block.
    Block(Grid),
    /// A mesh of several blocks.
    Mesh,
}

impl Kind {
    /// Nodes per element of a chain.
    fn per_element(self) -> Option<usize> {
        match self {
            Kind::Single | Kind::Block(_) | Kind::Mesh => None,
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
            Kind::Mesh => ("a mesh", format!("\"{id}.{}\"", count.min(2))),
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
    /// Lays out all nodes of a scene. Meshes of several blocks, and then chains over existing nodes, come last, so that
    /// they may name what stands below them.
    pub(crate) fn of(spec: &Spec) -> Result<Names, Fault> {
        limits::count(&at!["refine"], spec.refine, 1..=limits::NODES, "refine")?;
        ids(spec)?;
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
                Kind::Mesh => Err(format!(
                    "{id:?} is a mesh; name an edge of one of its blocks, as \"{}.bottom\", or make a Chain of several",
                    self.entries[k]
                        .parts
                        .first()
                        .map_or("block", |&part| &self.entries[part].id)
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

    /// The mesh with an id, of one block or of several.
    ///
    /// # Errors
    /// A message that tells which meshes there are.
    pub(crate) fn mesh(&self, id: &str) -> Result<Mesh, String> {
        let meshes = || {
            let is_mesh = |e: &&Entry| matches!(e.kind, Kind::Block(_) | Kind::Mesh);
            self.entries.iter().filter(is_mesh).map(|e| e.id.as_str())
        };
        let Some(entry) = self.index.get(id).map(|&k| &self.entries[k]) else {
            return Err(format!(
                "no block called {}{} (blocks: {})",
                quoted(id),
                did_you_mean(id, meshes()),
                super::error::some_of(meshes())
            ));
        };
        let blocks: Vec<&Entry> = match entry.kind {
            Kind::Block(_) => vec![entry],
            Kind::Mesh => entry.parts.iter().map(|&k| &self.entries[k]).collect(),
            _ => {
                return Err(format!(
                    "{id:?} is no block; a solid needs the mesh of one (blocks: {})",
                    super::error::some_of(meshes())
                ));
            }
        };
        let mut made = Mesh {
            nodes: entry.nodes.clone(),
            elements: Vec::new(),
            edges: Vec::new(),
        };
        for block in blocks {
            let Kind::Block(grid) = block.kind else {
                continue;
            };
            let elements = grid.elements();
            made.elements
                .extend(elements.map(|element| element.map(|n| block.nodes[n])));
            let edges = EDGES
                .iter()
                .filter_map(|edge| self.chain(&format!("{}.{edge}", block.id)).ok());
            made.edges.extend(edges.flat_map(Entry::elements));
        }
        // An edge that two blocks share is inside; each walks it its own way.
        let walked: HashSet<(usize, usize)> = made.edges.iter().map(|e| (e[0], e[2])).collect();
        made.edges.retain(|e| !walked.contains(&(e[2], e[0])));
        Ok(made)
    }

    /// Position of the block with an id among the entries.
    fn block(&self, id: &str) -> Result<usize, String> {
        let blocks = || {
            let is_block = |e: &&Entry| matches!(e.kind, Kind::Block(_));
            self.entries.iter().filter(is_block).map(|e| e.id.as_str())
        };
        let found = self.index.get(id).copied();
        found
            .filter(|&k| matches!(self.entries[k].kind, Kind::Block(_)))
            .ok_or_else(|| {
                format!(
                    "no block called {}{} (blocks: {})",
                    quoted(id),
                    did_you_mean(id, blocks()),
                    super::error::some_of(blocks())
                )
            })
    }

    /// Enters a mesh of several blocks, and tells which nodes its joints make one: pairs of those that stay and those
    /// that go.
    fn mesh_of_blocks(
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
            let message = format!(
                "the tolerance is {tolerance:?}; it must be 0 to 0.1, in lengths of the edge"
            );
            return Err(Fault::new(here.then("tolerance"), message));
        }
        if of.is_empty() {
            return Err(Fault::new(
                here.then("of"),
                "the list is empty; name the blocks of the mesh",
            ));
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
        self.enter(at, id, all, Kind::Mesh);
        if let Some(entry) = self.entries.last_mut() {
            entry.parts = parts;
        }
        Ok(())
    }

    /// An edge of one of these blocks.
    fn edge(&self, here: &Path, name: &str, parts: &[usize]) -> Result<&Entry, Fault> {
        let fault = |message| Fault::new(here.clone(), message);
        let edge = self.chain(name).map_err(fault)?;
        let owner = parts.iter().any(|&k| self.entries[k].at == edge.at);
        if edge.kind == Kind::Edge && owner {
            return Ok(edge);
        }
        Err(fault(format!(
            "{name:?} is no edge of a block of this mesh, which is what can be joined, as \"{}.right\"",
            parts.first().map_or("block", |&k| &self.entries[k].id)
        )))
    }

    /// The nodes that become one where two edges are joined. Both are walked with their block on the left, so that one
    /// runs against the other.
    fn joint(
        &self,
        here: &Path,
        a: &Entry,
        b: &Entry,
        tolerance: f64,
    ) -> Result<Vec<(usize, usize)>, Fault> {
        let elements = |edge: &Entry| edge.nodes.len() / 2;
        if a.nodes.len() != b.nodes.len() {
            let message = format!(
                "{:?} has {} elements and {:?} has {}; edges that are joined need as many",
                a.id,
                elements(a),
                b.id,
                elements(b)
            );
            return Err(Fault::new(here.clone(), message));
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
        let message = format!(
            "the edges do not coincide: {} is at ({x:?}, {y:?}) and {} at ({v:?}, {w:?}), {:.3e} apart; \
             at most {:.3e} is allowed (tolerance {tolerance:?} of the length {length:.4})",
            self.nodes[n].name,
            self.nodes[m].name,
            distance(place(n), place(m)),
            tolerance * length
        );
        Err(Fault::new(here.clone(), message))
    }

    /// Makes one node of those that are twins, the first of them, and numbers the rest anew.
    fn merge(&mut self, twins: &[(usize, usize)]) {
        if twins.is_empty() {
            return;
        }
        let mut root: Vec<usize> = (0..self.nodes.len()).collect();
        fn find(root: &[usize], mut n: usize) -> usize {
            while root[n] != n {
                n = root[n];
            }
            n
        }
        for &(a, b) in twins {
            let (a, b) = (find(&root, a), find(&root, b));
            root[a.max(b)] = a.min(b);
        }
        let mut number = vec![0; root.len()];
        let mut kept = Vec::with_capacity(root.len());
        for (n, node) in std::mem::take(&mut self.nodes).into_iter().enumerate() {
            let first = find(&root, n);
            if first == n {
                number[n] = kept.len();
                kept.push(node);
            } else {
                // The first of its twins was numbered before.
                number[n] = number[first];
            }
        }
        self.nodes = kept;
        for entry in &mut self.entries {
            entry.nodes.iter_mut().for_each(|n| *n = number[*n]);
            if entry.kind == Kind::Mesh {
                let mut seen = HashSet::new();
                entry.nodes.retain(|n| seen.insert(*n));
            }
        }
    }

    /// The entries: single nodes, chains, blocks, their edges, and meshes.
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
                    match entry.kind {
                        Kind::Block(_) => "block",
                        Kind::Mesh => "mesh",
                        _ => "chain",
                    },
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
                Kind::Block(_) | Kind::Mesh => {
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
                corners,
                elements,
                grading,
                sides,
                place,
                ..
            } => {
                let shape = Shape {
                    corners,
                    elements: *elements,
                    grading: *grading,
                    sides,
                    place,
                };
                let (grid, points) = block(&here, &shape, refine, &|id| self.curve(id))?;
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
            Nodes::Chain { .. } | Nodes::Mesh { .. } => return Ok(()),
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

    /// Points along a chain that exists already, and nodes per element.
    fn curve(&self, id: &str) -> Result<(Vec<Point>, usize), String> {
        let chain = self.chain(id)?;
        let place = |n: &usize| (self.nodes[*n].at[0], self.nodes[*n].at[1]);
        Ok((
            chain.nodes.iter().map(place).collect(),
            chain.kind.per_element().unwrap_or(2),
        ))
    }

    fn share(
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
            let total = before + shared.len() + found.len();
            limits::memory(total as f64 * limits::NAMED_BYTES, memory).map_err(|why| {
                fault(format!(
                    "with this, all chains have {total} nodes together, which take {why}"
                ))
            })?;
            if found.len() > 1 && shared.last().is_some() && shared.last() == found.first() {
                shared.pop();
            } else if shared.last().is_some() && shared.last() == found.first() {
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
            parts: Vec::new(),
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
            Nodes::Mesh { .. } | Nodes::Chain { .. } => 0.0,
        };
        let why = if total > limits::NODES as f64 {
            format!("at most {} can be had", limits::NODES)
        } else {
            match limits::memory(total * limits::NODE_BYTES, spec.settings.memory) {
                Ok(()) => continue,
                Err(why) => format!("they take {why}"),
            }
        };
        let refine = spec.refine;
        let message =
            format!("up to here the scene has about {total} nodes (refine: {refine}); {why}");
        return Err(Fault::new(at!["nodes", k], message));
    }
    Ok(())
}
