//! Meshes given node by node: converts labels to numbers, and names parts, sets and sides.

use super::super::curves::point;
use super::super::geometry::Folds;
use super::super::limits;
use super::elements::{Element, check_doubled, check_orders, sound};
use super::sides::{Faces, line};
use super::{EntryKind, NameEntry, Names};
use crate::format::error::{Fault, Path, at, bail, fault, quoted};
use crate::format::given::{Cells, NodeSet, SideSet};
use crate::format::spec::Nodes;
use std::collections::HashMap;
use stickslip_core::Node;
use stickslip_core::groups::distinct;

impl Names {
    /// Adds a mesh given node by node: the whole mesh, then its parts, sets and sides.
    pub(super) fn add_mesh(&mut self, at: usize, nodes: &Nodes) -> Result<(), Fault> {
        let Nodes::Given {
            id,
            nodes: listed,
            elements,
            sets,
            sides,
        } = nodes
        else {
            return Ok(());
        };
        let here = at!["nodes", at];
        check_names(&here, elements, sets, sides)?;
        let labels = self.labelled(&here.then("nodes"), id, listed)?;
        let first = self.nodes.len() - labels.len();
        let mesh = Labels { labels, first };
        let (made, parts) = self.elements_of(&here.then("elements"), &mesh, elements)?;
        let own = |name: &str| format!("{id}.{name}");
        let mut entries = Vec::new();
        for (part, members) in parts {
            let elements: Vec<Element> = members.iter().map(|&k| made[k].clone()).collect();
            let mut entry = NameEntry::new(at, &own(part), nodes_of(&elements), EntryKind::Part);
            entry.elements = elements;
            entries.push(entry);
        }
        for (k, set) in sets.iter().enumerate() {
            let nodes = mesh.set(&here.then("sets").then(k), set)?;
            entries.push(NameEntry::new(at, &own(&set.name), nodes, EntryKind::Set));
        }
        let mut numbered = Vec::with_capacity(sides.len());
        for (k, set) in sides.iter().enumerate() {
            let path = here.then("sides").then(k).then("sides");
            let all: Result<Vec<_>, _> = set
                .sides
                .iter()
                .enumerate()
                .map(|(j, side)| mesh.numbers(|| path.then(j), side))
                .collect();
            numbered.push((path.clone(), all?));
        }
        let named = numbered
            .iter()
            .flat_map(|(_, sides)| sides.iter().flatten());
        let faces = Faces::among(named, &made);
        for ((path, numbered), set) in numbered.iter().zip(sides) {
            let line = line(path, &self.nodes, &faces, numbered)?;
            let kind = EntryKind::Sides(line.per_element());
            let mut entry = NameEntry::new(at, &own(&set.name), line.nodes(), kind);
            entry.line = line;
            entries.push(entry);
        }
        let all = (first..self.nodes.len()).collect();
        let mut whole = NameEntry::new(at, id, all, EntryKind::Given);
        whole.elements = made;
        whole.labels = mesh.labels;
        self.add(whole);
        entries.into_iter().for_each(|entry| self.add(entry));
        Ok(())
    }

    /// Adds the nodes in the order of their labels, which are returned.
    fn labelled(
        &mut self,
        here: &Path,
        id: &str,
        listed: &[(usize, f64, f64)],
    ) -> Result<Vec<usize>, Fault> {
        let mut order: Vec<usize> = (0..listed.len()).collect();
        order.sort_by_key(|&k| listed[k].0);
        let mut labels: Vec<usize> = Vec::with_capacity(listed.len());
        for k in order {
            let (label, x, y) = listed[k];
            let path = || here.then(k);
            if labels.last() == Some(&label) {
                bail!(
                    path().then(0),
                    "the label {label} is already used by another node"
                );
            }
            if !(x.is_finite() && y.is_finite()) || x.abs().max(y.abs()) > limits::MAGNITUDE {
                point(&path(), (x, y))?;
            }
            labels.push(label);
            self.nodes.push(Node {
                name: format!("{id}.{label}"),
                at: [x, y],
            });
        }
        Ok(labels)
    }

    /// The elements of all lists, and the indices of the elements of each part.
    #[allow(clippy::type_complexity)]
    fn elements_of<'s>(
        &self,
        here: &Path,
        mesh: &Labels,
        lists: &'s [Cells],
    ) -> Result<(Vec<Element>, Vec<(&'s str, Vec<usize>)>), Fault> {
        let mut made = Vec::with_capacity(lists.iter().map(|cells| cells.nodes.len()).sum());
        let mut parts: Vec<(&str, Vec<usize>)> = Vec::new();
        let mut place_of = HashMap::new();
        for (k, cells) in lists.iter().enumerate() {
            let first = made.len();
            let here = here.then(k).then("nodes");
            let folds = Folds::from_kind(cells.kind);
            for (e, labels) in cells.nodes.iter().enumerate() {
                let path = || here.then(e);
                let nodes = mesh.numbers(path, labels)?;
                made.push(sound(path, &self.nodes, &folds, cells.kind, nodes)?);
            }
            for part in std::iter::once(&cells.part).chain(&cells.also) {
                let place = *place_of.entry(part.as_str()).or_insert(parts.len());
                if place == parts.len() {
                    parts.push((part, Vec::new()));
                }
                parts[place].1.extend(first..made.len());
            }
        }
        check_doubled(here, &self.nodes, &made)?;
        check_orders(|element| place(here, lists, element), &self.nodes, &made)?;
        Ok((made, parts))
    }
}

/// Location of the k-th element of all lists.
fn place(here: &Path, lists: &[Cells], mut k: usize) -> Path {
    for (list, cells) in lists.iter().enumerate() {
        if k < cells.nodes.len() {
            return here.then(list).then("nodes").then(k);
        }
        k -= cells.nodes.len();
    }
    here.clone()
}

/// The distinct nodes of elements, ascending.
pub(super) fn nodes_of(elements: &[Element]) -> Vec<usize> {
    distinct(elements.iter().flat_map(|(_, own)| own).copied())
}

/// The labels of a mesh, ascending: label k belongs to node number `first + k`.
struct Labels {
    labels: Vec<usize>,
    first: usize,
}

impl Labels {
    /// Converts labels, located at `path`, to node numbers.
    fn numbers(&self, path: impl Fn() -> Path, labels: &[usize]) -> Result<Vec<usize>, Fault> {
        labels
            .iter()
            .enumerate()
            .map(|(k, label)| match self.labels.binary_search(label) {
                Ok(place) => Ok(self.first + place),
                Err(_) => Err(fault!(
                    path().then(k),
                    "no node of the mesh has the label {label}"
                )),
            })
            .collect()
    }

    fn set(&self, here: &Path, set: &NodeSet) -> Result<Vec<usize>, Fault> {
        let here = here.then("nodes");
        let nodes = self.numbers(|| here.clone(), &set.nodes)?;
        if nodes.is_empty() {
            bail!(here, "the set has no nodes");
        }
        Ok(distinct(nodes))
    }
}

/// Rejects names of parts, sets and sides that are invalid after the mesh's id or ambiguous.
fn check_names(
    here: &Path,
    elements: &[Cells],
    sets: &[NodeSet],
    sides: &[SideSet],
) -> Result<(), Fault> {
    if elements.iter().all(|cells| cells.nodes.is_empty()) && sides.is_empty() {
        bail!(
            here.then("elements"),
            "the mesh has neither elements nor sides"
        );
    }
    let mut seen: HashMap<&str, &str> = HashMap::new();
    let mut check = |path: Path, name, what: &'static str| {
        usable(&path, name)?;
        match seen.insert(name, what) {
            // Several lists may belong to the same part.
            Some("part") if what == "part" => Ok(()),
            Some(other) => Err(fault!(
                path,
                "the mesh already has a {other} called {}; names of parts, sets and sides must be unique",
                quoted(name)
            )),
            None => Ok(()),
        }
    };
    for (k, cells) in elements.iter().enumerate() {
        let here = here.then("elements").then(k);
        check(here.then("part"), &cells.part, "part")?;
        for (j, part) in cells.also.iter().enumerate() {
            if cells.part == *part || cells.also[..j].contains(part) {
                bail!(
                    here.then("also").then(j),
                    "the part {} is named twice",
                    quoted(part)
                );
            }
            check(here.then("also").then(j), part, "part")?;
        }
    }
    for (k, set) in sets.iter().enumerate() {
        check(here.then("sets").then(k).then("name"), &set.name, "set")?;
    }
    for (k, set) in sides.iter().enumerate() {
        check(
            here.then("sides").then(k).then("name"),
            &set.name,
            "line of sides",
        )?;
    }
    limits::entries("names of the mesh", seen.len())
        .map_err(|fault| Fault::new(here, fault.message))
}

/// Rejects a name that looks like a label or cannot be separated from the text after it.
fn usable(path: &Path, name: &str) -> Result<(), Fault> {
    let wrong = if name.is_empty() {
        "is empty"
    } else if name.chars().count() > limits::NAME {
        "is longer than 64 characters"
    } else if name.trim() != name {
        "starts or ends with a space"
    } else if name
        .chars()
        .any(|c| matches!(c, '.' | '@' | '"' | '\\') || c.is_control())
    {
        "contains a point, an @, a quote or a backslash"
    } else if name.chars().all(|c| c.is_ascii_digit()) {
        "is a number, and would be the label of a node"
    } else if limits::TAKEN.contains(&name) {
        "is a reserved word after the id of a mesh"
    } else {
        return Ok(());
    };
    Err(fault!(
        path,
        "the name {} {wrong}; use another name",
        quoted(name)
    ))
}
