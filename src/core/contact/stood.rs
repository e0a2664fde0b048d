//! Caches the feet of all slave nodes of a judged state, so that judging the next state does not search for them again.

use crate::contact::feet::Foot;

/// Initial capacity for the feet and sides of a node.
pub(super) const FEW: usize = 16;

/// Feet of all slave nodes in a state.
#[derive(Debug)]
pub(super) struct Stood {
    /// Positions of all nodes; `near` is the length within which positions counted as equal.
    pub at: Vec<[f64; 2]>,
    pub near: f64,
    /// Concatenated feet of all slave nodes; `ends` contains the end index of each node's feet.
    pub feet: Vec<Foot>,
    pub ends: Vec<usize>,
}

impl Stood {
    pub fn with_capacity(nodes: usize, slaves: usize) -> Self {
        Stood {
            at: Vec::with_capacity(nodes),
            near: 0.0,
            // A node on the border of two elements has two feet.
            feet: Vec::with_capacity(2 * slaves + FEW),
            ends: Vec::with_capacity(slaves),
        }
    }

    pub fn clear(&mut self) {
        self.feet.clear();
        self.ends.clear();
    }

    pub fn add(&mut self, feet: &[Foot]) {
        self.feet.extend_from_slice(feet);
        self.ends.push(self.feet.len());
    }

    /// Feet of a slave node.
    pub fn of(&self, slave: usize) -> &[Foot] {
        let from = slave.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.feet[from..self.ends[slave]]
    }

    /// Whether the cache belongs to this state, with the same tolerance.
    pub fn is(&self, at: &[[f64; 2]], near: f64, slaves: usize) -> bool {
        self.ends.len() == slaves && self.near == near && self.at == at
    }
}
