//! The state of reading a deck.

use super::assembly::Instance;
use super::deck::{Deck, Remark, Step};
use std::collections::{BTreeMap, HashMap};

/// Lookup tables for labels and names of a deck.
#[derive(Debug, Default)]
pub(super) struct Names {
    pub nodes: BTreeMap<u64, usize>,
    pub elements: BTreeMap<u64, usize>,
    pub node_sets: HashMap<String, usize>,
    pub element_sets: HashMap<String, usize>,
    pub surfaces: HashMap<String, usize>,
    pub members: usize,
    /// The instances of parts, and the one to which the current card belongs.
    pub instances: Vec<Instance>,
    pub within: Instance,
}

/// State of reading a deck.
#[derive(Debug, Default)]
pub struct Reader {
    pub(super) deck: Deck,
    pub(super) names: Names,
    /// The step that has begun.
    pub(super) step: Option<Step>,
    pub(super) has_time: bool,
    /// Whether the first card of each keyword in this step removes earlier values (OP=NEW).
    pub(super) operations: HashMap<String, bool>,
    /// Whether the deck is only outlined: three-dimensional elements are read, and cards that cannot be read are skipped.
    pub(super) is_outline: bool,
    pub(super) skipped: Vec<Remark>,
    /// NLGEOM stays on in later steps until it is switched off.
    pub(super) nlgeom: bool,
}

/// Kind of a set's members.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MeshKind {
    Nodes,
    Elements,
}

impl MeshKind {
    pub fn word(self) -> &'static str {
        match self {
            MeshKind::Nodes => "node",
            MeshKind::Elements => "element",
        }
    }
}

impl Names {
    /// The number in the deck of a node or an element of the current instance.
    pub fn number(&self, label: u64) -> u64 {
        label.saturating_add(self.within.first)
    }

    /// The name in the deck of a set or a surface of the current instance.
    pub fn name(&self, name: &str) -> String {
        format!("{}{name}", self.within.prefix)
    }

    /// The index of the node or the element to which a word such as `12` or `PART-1-1.12` refers; `None` if the word is no number.
    pub fn labelled(&self, word: &str, kind: MeshKind) -> Option<Result<usize, u64>> {
        let (of, label) = match word.rsplit_once('.') {
            Some((instance, label)) => (self.instance(instance)?, label),
            None => (&self.within, word),
        };
        let label = label.parse::<u64>().ok()?.saturating_add(of.first);
        let labels = match kind {
            MeshKind::Nodes => &self.nodes,
            MeshKind::Elements => &self.elements,
        };
        Some(labels.get(&label).copied().ok_or(label))
    }

    /// An instance by its name in uppercase.
    pub fn instance(&self, name: &str) -> Option<&Instance> {
        self.instances
            .iter()
            .find(|own| own.prefix.strip_suffix('.') == Some(name))
    }
}
