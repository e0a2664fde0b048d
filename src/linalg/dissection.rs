//! Elimination order by nested dissection, so that a local change affects few fronts, and subtrees are independent.
//!
//! In a long strip, minimum degree eliminates from one end to the other: a change at one place affects all later fronts. Here a
//! part of the graph is cut in two at a height: x or y where the positions are known, otherwise the distance from a far end. The
//! cut, which is eliminated last, contains the groups up to that height with neighbours beyond. The halves are cut recursively
//! until a part is no longer many times larger than its cut; such parts are ordered by minimum degree. With m parts, a change
//! then affects one part and log m cuts.

use super::check::SolveError;
use super::graph::Graph;

/// A part is not cut if it has fewer unknowns than this, or fewer than this multiple of its cut.
const LEAST: usize = 48;
const TIMES: usize = 6;
/// Number of the heights that are levels; 0 and 1 are x and y.
const LEVELS: usize = 2;
/// The smaller half contains at least this fraction of the part.
const HALF: f64 = 0.3;

/// A graph being cut.
struct Dissection<'a> {
    graph: &'a Graph,
    /// The part that contains each group, and the number of parts created so far.
    part: Vec<usize>,
    parts: usize,
    /// Distance from the start of the last search.
    level: Vec<usize>,
    /// Rank of each group's x and y; empty if the positions are unknown.
    ranks: [Vec<usize>; 2],
    /// By height: the unknowns of the groups below that have no neighbours beyond it.
    closing: Vec<usize>,
    order: Vec<usize>,
}

/// A cut of a part: the index of its height among those that can be chosen, and the rank of the highest groups before it.
struct Cut {
    weight: usize,
    heights: usize,
    rank: usize,
}

/// The groups of a graph in elimination order; `positions` are theirs, or empty.
pub(super) fn order(graph: &Graph, positions: &[[f64; 2]]) -> Result<Vec<usize>, SolveError> {
    let count = graph.count();
    let mut dissection = Dissection {
        graph,
        part: vec![0; count],
        parts: 1,
        level: vec![usize::MAX; count],
        ranks: [0, 1].map(|axis| ranks(positions, axis)),
        closing: vec![0; count],
        order: Vec::with_capacity(count),
    };
    dissection.put_in_order((0..count).collect())?;
    Ok(dissection.order)
}

impl Dissection<'_> {
    fn weight(&self, groups: &[usize]) -> usize {
        groups
            .iter()
            .map(|&group| self.graph.members(group).len())
            .sum()
    }

    /// Turns groups into a separate part.
    fn set_apart(&mut self, groups: &[usize]) {
        groups
            .iter()
            .for_each(|&group| self.part[group] = self.parts);
        self.parts += 1;
    }

    /// Orders all groups of one part.
    fn put_in_order(&mut self, mut groups: Vec<usize>) -> Result<(), SolveError> {
        while let Some(&start) = groups.first() {
            let found = self.search(start);
            self.set_apart(&found);
            let part = self.part[start];
            groups.retain(|&group| self.part[group] != part);
            self.put_connected_in_order(found)?;
        }
        Ok(())
    }

    /// As [`Dissection::put_in_order`], where `found` is a whole part sorted by distance from some group.
    fn put_connected_in_order(&mut self, found: Vec<usize>) -> Result<(), SolveError> {
        let cut = match found.last() {
            Some(&far) if self.weight(&found) >= LEAST => self.cut(found.clone(), far),
            _ => None,
        };
        let Some([before, after, cut]) = cut else {
            let ordered = self.graph.part_in_order(found)?;
            self.order.extend(ordered);
            return Ok(());
        };
        for half in [before, after] {
            self.set_apart(&half);
            self.put_in_order(half)?;
        }
        self.order.extend(cut);
        Ok(())
    }

    /// The groups of a part, sorted by distance from one of them.
    fn search(&mut self, start: usize) -> Vec<usize> {
        let part = self.part[start];
        let mut found = vec![start];
        let mut next = 0;
        self.level[start] = 0;
        // Visited groups are temporarily removed from the part.
        self.part[start] = usize::MAX;
        while let Some(&group) = found.get(next) {
            next += 1;
            for other in self.graph.neighbours(group) {
                if self.part[other] == part {
                    self.part[other] = usize::MAX;
                    self.level[other] = self.level[group] + 1;
                    found.push(other);
                }
            }
        }
        found.iter().for_each(|&group| self.part[group] = part);
        found
    }

    /// Cuts a part where the cut is lightest: the halves and the cut. `None` if the cut is not small.
    fn cut(&mut self, mut found: Vec<usize>, far: usize) -> Option<[Vec<usize>; 3]> {
        let cut = if self.ranks[0].is_empty() {
            found = self.search(far);
            self.lightest(&found, LEVELS)
        } else {
            let cuts = [0, 1].map(|axis| {
                found.sort_unstable_by_key(|&group| self.ranks[axis][group]);
                self.lightest(&found, axis)
            });
            cuts.into_iter().flatten().min_by_key(|cut| cut.weight)
        }?;
        if cut.weight * TIMES > self.weight(&found) {
            return None;
        }
        let heights = self.heights(cut.heights);
        let beyond = |group: usize| {
            let mut others = self.graph.neighbours(group);
            others.any(|other| self.part[other] == self.part[group] && heights[other] > cut.rank)
        };
        let mut parts = [Vec::new(), Vec::new(), Vec::new()];
        for group in found {
            let which = match heights[group] > cut.rank {
                true => 1,
                false if beyond(group) => 2,
                false => 0,
            };
            parts[which].push(group);
        }
        Some(parts)
    }

    /// Heights at which a part can be cut: ranks of x, ranks of y, or levels.
    fn heights(&self, which: usize) -> &[usize] {
        self.ranks.get(which).unwrap_or(&self.level)
    }

    /// The lightest cut of a part, sorted by these heights, near its middle.
    fn lightest(&mut self, found: &[usize], which: usize) -> Option<Cut> {
        let mut closing = std::mem::take(&mut self.closing);
        let heights = self.heights(which);
        let all = self.weight(found);
        let (mut below, mut reaching) = (0, 0);
        let mut best: Option<Cut> = None;
        for level in found.chunk_by(|&a, &b| heights[a] == heights[b]) {
            let rank = heights[level[0]];
            let closed = std::mem::take(&mut closing[rank]);
            if ((all - below) as f64) < HALF * all as f64 {
                continue;
            }
            reaching -= closed;
            for &group in level {
                let own = self.graph.members(group).len();
                let same = |&other: &usize| self.part[other] == self.part[group];
                let others = self.graph.neighbours(group).filter(same);
                let reach = others.map(|other| heights[other]).max().unwrap_or(0);
                below += own;
                if reach > rank {
                    reaching += own;
                    closing[reach] += own;
                }
            }
            // A level is weighed whole: nearly all of it has neighbours beyond.
            let weight = match which {
                LEVELS => self.weight(level),
                _ => reaching,
            };
            let least = (below - weight).min(all - below) as f64;
            let lighter = best.as_ref().is_none_or(|best| weight < best.weight);
            if least >= HALF * all as f64 && lighter {
                best = Some(Cut {
                    weight,
                    heights: which,
                    rank,
                });
            }
        }
        self.closing = closing;
        best
    }
}

/// Ranks of a coordinate; equal coordinates have the same.
fn ranks(positions: &[[f64; 2]], axis: usize) -> Vec<usize> {
    let mut sorted: Vec<usize> = (0..positions.len()).collect();
    sorted.sort_by(|&a, &b| positions[a][axis].total_cmp(&positions[b][axis]));
    let mut ranks = vec![0; positions.len()];
    let same = |a: &usize, b: &usize| positions[*a][axis] == positions[*b][axis];
    for (rank, equal) in sorted.chunk_by(same).enumerate() {
        equal.iter().for_each(|&group| ranks[group] = rank);
    }
    ranks
}
