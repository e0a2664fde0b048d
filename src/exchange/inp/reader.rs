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
    /// Whether the deck is only outlined: three-dimensional elements are read, and cards that cannot be read are skipped.
    pub(super) is_outline: bool,
    pub(super) skipped: Vec<Remark>,
    /// NLGEOM stays on in later steps until it is switched off.
    pub(super) nlgeom: bool,
}
