//! Groups of connected nodes, and sets of nodes.

use std::collections::BTreeMap;

/// Which of this many nodes are among some.
pub fn marked<'a>(count: usize, nodes: impl IntoIterator<Item = &'a usize>) -> Vec<bool> {
    let mut marked = vec![false; count];
    nodes.into_iter().for_each(|&node| marked[node] = true);
    marked
}

/// The different items, ascending.
pub fn distinct<T: Ord>(items: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut items: Vec<T> = items.into_iter().collect();
    items.sort_unstable();
    items.dedup();
    items
}

/// The groups, by the representative of each node: a node of its group with a smaller number, or itself.
pub struct Connected(Vec<usize>);

impl Connected {
    /// Each node by itself.
    pub fn new(nodes: usize) -> Self {
        Connected((0..nodes).collect())
    }

    /// The representative of a node's group: its smallest node.
    pub fn root(&mut self, mut node: usize) -> usize {
        while self.0[node] != node {
            self.0[node] = self.0[self.0[node]];
            node = self.0[node];
        }
        node
    }

    /// Connects two nodes.
    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
    }

    /// Connects all of some nodes.
    pub fn join_all(&mut self, nodes: &[usize]) {
        nodes
            .windows(2)
            .for_each(|pair| self.join(pair[0], pair[1]));
    }

    /// The nodes of each group, ascending; by the smallest node.
    pub fn parts(mut self) -> Vec<Vec<usize>> {
        let mut parts: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for node in 0..self.0.len() {
            parts.entry(self.root(node)).or_default().push(node);
        }
        parts.into_values().collect()
    }
}
