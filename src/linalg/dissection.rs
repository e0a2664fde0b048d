//! Elimination order by nested dissection, so that a local change affects few fronts.
//!
//! In a long strip, minimum degree eliminates from one end to the other: a change at one place affects all later fronts. Here a
//! part of the graph is cut in two by a level set of the distance from a far end, which is eliminated last. The halves are cut
//! recursively until a part is no longer many times larger than its cut; such parts are ordered by minimum degree. With m parts,
//! a change then affects one part and log m cuts.

use super::check::SolveError;
use super::graph::Graph;

/// A part is not cut if it has fewer unknowns than this, or fewer than this multiple of its cut.
const LEAST: usize = 48;
const TIMES: usize = 6;
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
    order: Vec<usize>,
}

/// The groups of a graph in elimination order.
pub(super) fn order(graph: &Graph) -> Result<Vec<usize>, SolveError> {
    let count = graph.count();
    let mut dissection = Dissection {
        graph,
        part: vec![0; count],
        parts: 1,
        level: vec![usize::MAX; count],
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
            Some(&far) if self.weight(&found) >= LEAST => {
                let found = self.search(far);
                self.cut(&found)
            }
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
            for &other in self.graph.neighbours(group) {
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

    /// Cuts a part, sorted by levels, at the lightest level near its middle: the halves and the cut. `None` if the cut is not
    /// small.
    fn cut(&self, found: &[usize]) -> Option<[Vec<usize>; 3]> {
        let all = self.weight(found);
        let mut before = 0;
        let mut best: Option<(usize, usize)> = None;
        for level in found.chunk_by(|&a, &b| self.level[a] == self.level[b]) {
            let own = self.weight(level);
            let least = (before.min(all - before - own)) as f64;
            if least >= HALF * all as f64 && best.is_none_or(|(weight, _)| own < weight) {
                best = Some((own, self.level[level[0]]));
            }
            before += own;
        }
        let (_, at) = best.filter(|(weight, _)| weight * TIMES <= all)?;
        let beyond = |group: usize| {
            let mut others = self.graph.neighbours(group).iter();
            others.any(|&other| self.part[other] == self.part[group] && self.level[other] > at)
        };
        let mut parts = [Vec::new(), Vec::new(), Vec::new()];
        for &group in found {
            let which = match self.level[group] {
                level if level < at => 0,
                level if level > at => 1,
                _ if beyond(group) => 2,
                _ => 0,
            };
            parts[which].push(group);
        }
        Some(parts)
    }
}
