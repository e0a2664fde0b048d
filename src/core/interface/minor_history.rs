//! The inputs of the minor iterations of a major iteration, for detecting cycles.

use crate::interface::cycle;
use crate::{ContactState, Mode};
use serde::{Deserialize, Serialize};

/// A true cycle of minor iterations: equal modes and equal numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cycle {
    /// First minor iteration of the cycle.
    pub start: u32,
    /// Number of minor iterations per period.
    pub period: u32,
    /// Contact nodes (by slave number) that change in the cycle, with their modes over one period.
    pub members: Vec<(usize, Vec<Mode>)>,
}

/// The input of each minor iteration of the current major iteration. With frozen geometry a minor iteration depends on nothing
/// else, so a repeated input proves a cycle.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct MinorHistory {
    /// One entry per slave node, iteration after iteration.
    entries: Vec<Input>,
}

/// Input of a minor iteration at one slave node.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// Mode of the minor iteration.
    pub mode: Mode,
    /// T_max if the node slides; else 0.
    pub t_max: f64,
    /// Ratio ρ if the node touches; else 0.
    pub ratio: f64,
}

impl Input {
    fn from_node(node: &ContactState) -> Self {
        Input {
            mode: node.mode,
            t_max: if node.mode == Mode::Sliding {
                node.t_max
            } else {
                0.0
            },
            ratio: if node.mode == Mode::Free {
                0.0
            } else {
                node.ratio
            },
        }
    }

    /// Whether the modes are equal, T_max differs by at most `force`, and ρ by at most `ratio` (1 + |ρ|).
    fn repeats(&self, other: &Input, force: f64, ratio: f64) -> bool {
        self.mode == other.mode
            && (self.t_max - other.t_max).abs() <= force
            && (self.ratio - other.ratio).abs()
                <= ratio * (1.0 + self.ratio.abs().max(other.ratio.abs()))
    }
}

impl MinorHistory {
    /// Removes all entries, keeping the allocation.
    pub fn clear(&mut self) {
        self.entries.clear();
    }

    /// Whether there are no entries.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Memory of the entries (bytes).
    pub fn bytes(&self) -> usize {
        self.entries.capacity() * size_of::<Input>()
    }

    /// Adds the input of the next minor iteration.
    pub fn push(&mut self, nodes: &[ContactState]) {
        self.entries.extend(nodes.iter().map(Input::from_node));
    }

    /// Number of stored iterations, each with this number of nodes.
    pub fn len(&self, nodes: usize) -> usize {
        self.entries.len() / nodes.max(1)
    }

    /// Input of the first iteration, one entry per node; empty without entries.
    pub fn first(&self, nodes: usize) -> &[Input] {
        &self.entries[..nodes.min(self.entries.len())]
    }

    /// Input of the iteration `back` before the next one, one entry per node. `None` if it is not stored.
    pub fn before(&self, nodes: usize, back: usize) -> Option<&[Input]> {
        let from = self.entries.len().checked_sub(back * nodes)?;
        self.entries.get(from..from + nodes)
    }

    /// The cycle that closes if the iteration after `minor`, with input `nodes`, starts from the same input as an earlier
    /// one; else `None`. Two values of T_max are equal if they differ by at most `force`, two ratios ρ if they differ by at
    /// most `ratio` (1 + |ρ|).
    pub fn cycle(
        &self,
        nodes: &[ContactState],
        minor: u32,
        force: f64,
        ratio: f64,
    ) -> Option<Cycle> {
        let width = nodes.len().max(1);
        let same = |then: usize| {
            let then = &self.entries[then * width..(then + 1) * width];
            then.iter()
                .zip(nodes)
                .all(|(then, node)| then.repeats(&Input::from_node(node), force, ratio))
        };
        let found = cycle::closed(self.len(width), 1, same, |_| true)?;
        let round = || self.entries[found.start * width..].chunks_exact(width);
        let period = found.len() as u32;
        let takes_part = |s: &usize| {
            let mut inputs = round().map(|inputs| inputs[*s]);
            let first = inputs.next();
            first.is_some_and(|first| inputs.any(|other| !other.repeats(&first, force, ratio)))
        };
        let pattern = |s: usize| round().map(|inputs| inputs[s].mode).collect();
        Some(Cycle {
            // The last period starts from the input of iteration `minor + 1 - period`.
            start: minor + 1 - period,
            period,
            members: (0..nodes.len())
                .filter(takes_part)
                .map(|s| (s, pattern(s)))
                .collect(),
        })
    }
}
