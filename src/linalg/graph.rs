//! Graph of groups of unknowns and their coupling, for computing an elimination order.

use super::check::SolveError;
use super::pattern::{Pattern, lists};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;
use std::collections::HashMap;

/// Marks groups without a number.
pub(super) const NONE: usize = usize::MAX;

/// The groups, numbered consecutively, and their neighbours.
pub(super) struct Graph {
    starts: Vec<usize>,
    members: Vec<u32>,
    edges: Vec<usize>,
    neighbours: Vec<u32>,
    /// Whether a changing row has an entry in a group's columns.
    pub changing: Vec<bool>,
}

impl Graph {
    /// `groups` is the group of each unknown, or [`NONE`] for those that are left out. Rows from `first` on may change.
    pub fn new(pattern: &Pattern, groups: &[usize], first: usize) -> Self {
        let known = || groups.iter().copied().filter(|&g| g != NONE);
        let mut number = vec![NONE; known().max().map_or(0, |most| most + 1)];
        let mut count = 0;
        let mut group = Vec::with_capacity(groups.len());
        for &g in groups {
            if g != NONE && number[g] == NONE {
                number[g] = count;
                count += 1;
            }
            group.push(number.get(g).copied().unwrap_or(NONE));
        }
        let members = || group.iter().copied().zip(0..).filter(|&(g, _)| g != NONE);
        let (starts, members) = lists(count, members);
        let mut changing = vec![false; count];
        let mut seen_by = vec![NONE; count];
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        for own in 0..count {
            for &column in &members[starts[own]..starts[own + 1]] {
                for &row in &pattern.row_idx[pattern.column(column as usize)] {
                    let other = group[row as usize];
                    changing[own] |= row as usize >= first;
                    if other != own && other != NONE && seen_by[other] != own {
                        seen_by[other] = own;
                        pairs.push((own as u32, other as u32));
                    }
                }
            }
        }
        // Symmetric, even if the pattern is not.
        let both = || {
            pairs
                .iter()
                .flat_map(|&(a, b)| [(a as usize, b), (b as usize, a)])
        };
        let (edges, neighbours) = lists(count, both);
        let mut graph = Graph {
            starts,
            members,
            edges,
            neighbours,
            changing,
        };
        graph.tidy();
        graph
    }

    /// Sorts the neighbours and removes duplicates.
    fn tidy(&mut self) {
        let (mut kept, mut from) = (0, 0);
        for group in 0..self.edges.len() - 1 {
            let to = self.edges[group + 1];
            self.neighbours[from..to].sort_unstable();
            let start = kept;
            for k in from..to {
                let neighbour = self.neighbours[k];
                if kept == start || self.neighbours[kept - 1] != neighbour {
                    self.neighbours[kept] = neighbour;
                    kept += 1;
                }
            }
            (from, self.edges[group + 1]) = (to, kept);
        }
        self.neighbours.truncate(kept);
    }

    pub fn count(&self) -> usize {
        self.edges.len() - 1
    }

    pub fn members(&self, group: usize) -> &[u32] {
        &self.members[self.starts[group]..self.starts[group + 1]]
    }

    pub fn neighbours(&self, group: usize) -> impl Iterator<Item = usize> + '_ {
        let all = self.neighbours[self.edges[group]..self.edges[group + 1]].iter();
        all.map(|&other| other as usize)
    }

    /// Orders some of the groups for little fill.
    pub fn part_in_order(&self, groups: Vec<usize>) -> Result<Vec<usize>, SolveError> {
        let mut number = HashMap::with_capacity(groups.len());
        number.extend(groups.iter().enumerate().map(|(k, &group)| (group, k)));
        let (mut starts, mut seen) = (vec![0], Vec::new());
        for &group in &groups {
            seen.extend(
                self.neighbours(group)
                    .filter_map(|other| number.get(&other)),
            );
            let start = starts[starts.len() - 1];
            seen[start..].sort_unstable();
            starts.push(seen.len());
        }
        let order = least_fill(&starts, &seen)?;
        Ok(order.iter().map(|&k| groups[k]).collect())
    }
}

/// A fill-reducing order of a symmetric graph, given by its adjacency lists.
pub(super) fn least_fill(starts: &[usize], neighbours: &[usize]) -> Result<Vec<usize>, SolveError> {
    let count = starts.len() - 1;
    let graph = SymbolicSparseColMatRef::new_checked(count, count, starts, None, neighbours);
    let (mut order, mut place) = (vec![0; count], vec![0; count]);
    let request = amd::order_scratch::<usize>(count, neighbours.len());
    let mut memory = MemBuffer::try_new(request).map_err(|_| SolveError::OutOfMemory)?;
    let stack = MemStack::new(&mut memory);
    amd::order(&mut order, &mut place, graph, Default::default(), stack)
        .map_err(|_| SolveError::OutOfMemory)?;
    Ok(order)
}
