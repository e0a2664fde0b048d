//! Finds nodes, chains and meshes by name, and writes the messages for unknown names.

use super::given::nodes_of;
use super::{EntryKind, Mesh, NameEntry, Names};
use crate::format::error::{did_you_mean, none_called, quoted, some_of};
use crate::joined;
use crate::shown::first_of;
use stickslip_core::counted;

impl Names {
    /// Number of a node by any of its names.
    ///
    /// # Errors
    /// A message that lists the existing names.
    pub fn node(&self, name: &str) -> Result<usize, String> {
        let (entry, selector) = self.split(name)?;
        let count = entry.nodes.len();
        let index = match selector {
            Selector::Whole if entry.kind == EntryKind::Single => 0,
            // A named point of a mesh.
            Selector::Whole if entry.kind == EntryKind::Set && count == 1 => 0,
            Selector::Whole | Selector::All => return Err(entry.many(name, count)),
            Selector::Index(index) => index,
        };
        Ok(entry.nodes[index])
    }

    /// Numbers of the nodes that a name refers to: all nodes of a chain for `ID.all`; all nodes of a block's edge, or of a part,
    /// set or line of a given mesh, for its name alone; otherwise one node.
    ///
    /// # Errors
    /// As [`Names::node`].
    pub fn nodes(&self, name: &str) -> Result<Vec<usize>, String> {
        match self.split(name)? {
            (entry, Selector::All) => Ok(entry.nodes.clone()),
            (entry, Selector::Whole)
                if matches!(
                    entry.kind,
                    EntryKind::Edge(_) | EntryKind::Part | EntryKind::Set | EntryKind::Sides(_)
                ) =>
            {
                Ok(entry.nodes.clone())
            }
            (entry, _) => {
                let node = self.node(name).map_err(|why| match entry.kind {
                    EntryKind::Given => why,
                    _ => format!("{why}, or all of them: {:?}", format!("{name}.all")),
                });
                Ok(vec![node?])
            }
        }
    }

    /// The chain with an id.
    pub(crate) fn chain(&self, id: &str) -> Result<&NameEntry, String> {
        let is_chain =
            |e: &NameEntry| matches!(e.kind, EntryKind::Sides(_)) || e.kind.per_element().is_some();
        let chains = self.ids(is_chain);
        let Some(entry) = self.index.get(id).map(|&k| &self.entries[k]) else {
            return Err(none_called("chain of nodes", id, "chains", chains));
        };
        if is_chain(entry) {
            return Ok(entry);
        }
        let own: Vec<&str> = self.ids(|e| e.at == entry.at && is_chain(e)).collect();
        let chains = if own.is_empty() {
            chains.collect()
        } else {
            own
        };
        Err(format!(
            "{} is {}; it must be a chain of nodes (chains: {})",
            quoted(id),
            entry.kind.called(),
            some_of(chains)
        ))
    }

    /// The mesh with an id, of one or several blocks.
    ///
    /// # Errors
    /// A message that lists the existing meshes.
    pub(crate) fn mesh(&self, id: &str) -> Result<Mesh, String> {
        let meshes = self.ids(|entry| {
            use EntryKind::{Block, Given, Mesh, Part};
            matches!(entry.kind, Block(_) | Mesh | Given | Part)
        });
        let Some(entry) = self.index.get(id).map(|&k| &self.entries[k]) else {
            return Err(none_called("block", id, "blocks", meshes));
        };
        let blocks: Vec<&NameEntry> = match entry.kind {
            EntryKind::Block(_) => vec![entry],
            EntryKind::Mesh => entry.parts.iter().map(|&k| &self.entries[k]).collect(),
            EntryKind::Given | EntryKind::Part if !entry.elements.is_empty() => {
                return Ok(Mesh {
                    nodes: nodes_of(&entry.elements),
                    elements: entry.elements.clone(),
                });
            }
            EntryKind::Given | EntryKind::Part => {
                return Err(format!(
                    "{} has no elements, which a solid needs",
                    quoted(id)
                ));
            }
            _ => {
                return Err(format!(
                    "{id:?} is not a block; a solid needs a mesh (blocks: {})",
                    some_of(meshes)
                ));
            }
        };
        let mut made = Mesh {
            nodes: entry.nodes.clone(),
            elements: Vec::new(),
        };
        for block in blocks {
            let EntryKind::Block(grid) = block.kind else {
                continue;
            };
            made.elements.extend(grid.elements().map(|element| {
                let nodes = element.into_iter().map(|n| block.nodes[n]);
                (grid.kind, nodes.collect())
            }));
        }
        Ok(made)
    }

    /// Rejects sides of a given mesh unless they form a single open chain of elements of one kind.
    pub(super) fn check_one_chain(&self, name: &str) -> Result<(), String> {
        let Some(entry) = self
            .index
            .get(name)
            .map(|&k| &self.entries[k])
            .filter(|entry| entry.kind == EntryKind::Sides(None))
        else {
            return Ok(());
        };
        Err(format!(
            "{} is {}; it must be one open chain",
            quoted(name),
            entry.line.words(&self.nodes)
        ))
    }

    /// Index of the block with an id among the entries.
    pub(super) fn block(&self, id: &str) -> Result<usize, String> {
        let is_block = |entry: &NameEntry| matches!(entry.kind, EntryKind::Block(_));
        self.index
            .get(id)
            .copied()
            .filter(|&k| is_block(&self.entries[k]))
            .ok_or_else(|| none_called("block", id, "blocks", self.ids(is_block)))
    }

    /// Ids of some of the entries.
    fn ids(
        &self,
        is_one: impl Fn(&NameEntry) -> bool + Clone,
    ) -> impl Iterator<Item = &str> + Clone {
        self.entries
            .iter()
            .filter(move |entry| is_one(entry))
            .map(|e| e.id.as_str())
    }

    fn split(&self, name: &str) -> Result<(&NameEntry, Selector), String> {
        let Some((entry, selector)) = self.entry_of(name) else {
            // Problems written by earlier versions use beam-5 for beam.5.
            let other = |from: char, to: &str| {
                let at = name.rfind(from)?;
                let other = format!("{}{to}{}", &name[..at], &name[at + 1..]);
                self.entry_of(&other).is_some().then_some(other)
            };
            let known = other('-', ".").or_else(|| other('.', "-"));
            return match known {
                Some(known) => self.split(&known),
                None => Err(self.unknown(name)),
            };
        };
        let id = &entry.id;
        if selector.is_empty() {
            return Ok((entry, Selector::Whole));
        }
        if entry.kind == EntryKind::Single {
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

    /// The entry that a name starts with (an edge takes precedence over its block), and the rest of the name.
    fn entry_of<'n>(&self, name: &'n str) -> Option<(&NameEntry, &'n str)> {
        let cut_from = |start: usize| {
            let rest = name.get(start..).unwrap_or_default();
            rest.find(['.', '@']).map_or(name.len(), |k| start + k)
        };
        // A single node's id may contain dots.
        if let Some(&k) = self.index.get(name) {
            return Some((&self.entries[k], ""));
        }
        let first = cut_from(0);
        let second = cut_from(first + 1);
        let found = |cut: usize| {
            let (id, selector) = name.split_at(cut);
            self.index.get(id).map(|&k| (&self.entries[k], selector))
        };
        found(second).or_else(|| found(first))
    }

    fn selected(&self, name: &str, selector: &str, entry: &NameEntry) -> Result<Selector, String> {
        let count = entry.nodes.len();
        let is_chain = entry.kind.per_element().is_some();
        if entry.kind == EntryKind::Given && selector != "all" {
            return match selector.parse::<usize>() {
                Ok(label) => entry.labelled(label).map(Selector::Index),
                Err(_) => Err(self.unknown(name)),
            };
        }
        match selector {
            "start" if is_chain => Ok(Selector::Index(0)),
            "end" if is_chain => Ok(Selector::Index(count - 1)),
            "all" => Ok(Selector::All),
            _ => match selector.parse::<usize>() {
                Ok(k) if (1..=count).contains(&k) => Ok(Selector::Index(k - 1)),
                Ok(_) => Err(format!(
                    "no node called {0}: {1:?} is {2} of {3}, \"{1}.1\" to \"{1}.{count}\"",
                    quoted(name),
                    entry.id,
                    entry.kind.called(),
                    counted(count, "node")
                )),
                Err(_) => Err(self.unknown(name)),
            },
        }
    }

    fn unknown(&self, name: &str) -> String {
        let mut known = Vec::new();
        let mut shown = Vec::new();
        for NameEntry {
            id,
            nodes,
            kind,
            labels,
            ..
        } in &self.entries
        {
            known.push(id.clone());
            match kind {
                EntryKind::Single => shown.push(id.clone()),
                EntryKind::Chain(_) | EntryKind::Edge(_) | EntryKind::Sides(Some(_)) => {
                    known.extend(["start", "end", "all"].map(|which| format!("{id}.{which}")));
                    shown.push(format!("{id}.1 to {id}.{}", nodes.len()));
                }
                EntryKind::Block(_) | EntryKind::Mesh => {
                    known.push(format!("{id}.all"));
                    shown.push(format!("{id}.1 to {id}.{}", nodes.len()));
                }
                EntryKind::Given => {
                    known.push(format!("{id}.all"));
                    if let [first, .., last] | [first @ last] = labels[..] {
                        shown.push(format!("{id}.{first} to {id}.{last}"));
                    }
                }
                EntryKind::Part | EntryKind::Set | EntryKind::Sides(None) => {
                    known.push(id.clone());
                    shown.push(id.clone());
                }
            }
        }
        format!(
            "no node called {}{} (nodes: {})",
            quoted(name),
            did_you_mean(name, known.iter().map(String::as_str)),
            first_of(shown, 8, ", ")
        )
    }
}

impl EntryKind {
    /// Description, after "is".
    fn called(self) -> &'static str {
        match self {
            EntryKind::Single => "a single node",
            EntryKind::Edge(_) => "an edge",
            EntryKind::Chain(_) => "a chain",
            EntryKind::Block(_) => "a block",
            EntryKind::Mesh | EntryKind::Given => "a mesh",
            EntryKind::Part => "a part of a mesh",
            EntryKind::Set => "a set of nodes",
            EntryKind::Sides(_) => "a line of sides",
        }
    }
}

impl NameEntry {
    /// Index of the node of a given mesh with a label.
    fn labelled(&self, label: usize) -> Result<usize, String> {
        self.labels.binary_search(&label).map_err(|place| {
            let near = place.saturating_sub(1)..self.labels.len().min(place + 1);
            let near = joined(
                self.labels[near].iter().map(|l| format!("{}.{l}", self.id)),
                " and ",
            );
            format!(
                "mesh {:?} has no node with the label {label}; its neighbours are {}",
                self.id, near
            )
        })
    }

    /// Error for `name` if one node is needed but this has several.
    fn many(&self, name: &str, count: usize) -> String {
        let id = &self.id;
        let ends = match self.kind {
            EntryKind::Block(_) => format!("\"{id}.left.start\" or "),
            kind if kind.per_element().is_some() => format!("\"{id}.start\", \"{id}.end\" or "),
            _ => String::new(),
        };
        let number = self.labels.first().copied().unwrap_or(count.min(2));
        format!(
            "{name:?} is {} of {}; name one of them, as {ends}\"{id}.{number}\"",
            self.kind.called(),
            counted(count, "node")
        )
    }
}

/// The part of an entry that a name selects.
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
                "no node called {}: @ must be followed by a number from 0 to 1",
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
