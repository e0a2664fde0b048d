//! Caches the closest points of all slave nodes of a judged state, so that judging the next state need not search for them.

use crate::contact::closest_points::ClosestPoint;

/// Initial capacity for the closest points and sides of a node.
pub(super) const FEW: usize = 16;

/// Closest points of all slave nodes in a state.
#[derive(Debug)]
pub(super) struct ClosestPoints {
    /// Positions of all nodes; `near` is the length within which positions counted as equal.
    pub at: Vec<[f64; 2]>,
    pub near: f64,
    /// Concatenated closest points of all slave nodes; `ends` contains the end index for each node.
    pub feet: Vec<ClosestPoint>,
    pub ends: Vec<usize>,
}

impl ClosestPoints {
    pub fn with_capacity(nodes: usize, slaves: usize) -> Self {
        ClosestPoints {
            at: Vec::with_capacity(nodes),
            near: 0.0,
            // A node on the border of two elements has two closest points.
            feet: Vec::with_capacity(2 * slaves + FEW),
            ends: Vec::with_capacity(slaves),
        }
    }

    pub fn clear(&mut self) {
        self.feet.clear();
        self.ends.clear();
    }

    pub fn add(&mut self, feet: &[ClosestPoint]) {
        self.feet.extend_from_slice(feet);
        self.ends.push(self.feet.len());
    }

    /// Closest points of a slave node.
    pub fn of(&self, slave: usize) -> &[ClosestPoint] {
        let from = slave.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.feet[from..self.ends[slave]]
    }

    /// Whether the cache belongs to this state, with the same tolerance.
    pub fn is(&self, at: &[[f64; 2]], near: f64, slaves: usize) -> bool {
        self.ends.len() == slaves && self.near == near && self.at == at
    }
}
