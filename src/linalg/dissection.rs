//! An order of elimination by halves, so that a change somewhere reaches few fronts.
//!
//! In a long strip, minimum degree eliminates from one end to the other: a change at one place changes all fronts after it.
//! Here a part of the graph is cut in two by a level of the distance from a far end, which is eliminated last; so are the
//! halves, down to parts that are no longer many times as large as what cuts them. Such parts are put in order by minimum
//! degree. Of m parts a change then reaches one and log m cuts.

use super::check::SolveError;
use super::graph::Graph;

/// A part smaller than this many unknowns, or so many times its cut, stays whole.
const LEAST: usize = 48;
const TIMES: usize = 6;
/// The smaller half has at least this part of all.
const HALF: f64 = 0.3;

/// A graph while it is cut.
struct Dissection<'a> {
    graph: &'a Graph,
    /// The part that each group is in, and how many parts there have been.
    part: Vec<usize>,
    parts: usize,
    /// Distance from where the last search began.
    level: Vec<usize>,
    order: Vec<usize>,
}

/// The groups of a graph in their order.
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

    /// Makes groups a part of their own.
    fn set_apart(&mut self, groups: &[usize]) {
        groups
            .iter()
            .for_each(|&group| self.part[group] = self.parts);
        self.parts += 1;
    }

    /// Puts all groups of one part in order.
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

    /// As [`Dissection::put_in_order`], where `found` is all of a part in the order of its distance from some group.
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

    /// The groups of a part in the order of their distance from one of them.
    fn search(&mut self, start: usize) -> Vec<usize> {
        let part = self.part[start];
        let mut found = vec![start];
        let mut next = 0;
        self.level[start] = 0;
        // Those that are found leave the part meanwhile.
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

    /// Cuts a part, given in the order of its levels, at the lightest level near its middle: the halves and the cut.
    /// `None` where the cut is not small.
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
