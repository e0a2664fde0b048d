//! Where the judge found all slave nodes of a state, so that the next state is judged without a search for the last one.

use crate::contact::feet::Foot;

/// Feet and sides that a node has at most, as a rule.
pub(super) const FEW: usize = 16;

/// Where all slave nodes stood in a state.
#[derive(Debug)]
pub(super) struct Stood {
    /// Positions of all nodes, and the length up to which places were the same.
    pub at: Vec<[f64; 2]>,
    pub near: f64,
    /// Feet of all slave nodes, one after the other, and where each one's end.
    pub feet: Vec<Foot>,
    pub ends: Vec<usize>,
}

impl Stood {
    pub fn with_capacity(nodes: usize, slaves: usize) -> Self {
        Stood {
            at: Vec::with_capacity(nodes),
            near: 0.0,
            // On a border of elements a node has two feet.
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

    /// Whether it is this state, seen as sharply.
    pub fn is(&self, at: &[[f64; 2]], near: f64, slaves: usize) -> bool {
        self.ends.len() == slaves && self.near == near && self.at == at
    }
}
