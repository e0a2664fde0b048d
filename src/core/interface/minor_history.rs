//! What went into the minor iterations of a major one, and the cycle that they close.

use crate::contact::state::ContactState;
use crate::interface::cycle;
use crate::model::Mode;
use serde::{Deserialize, Serialize};

/// A true cycle of minor iterations: same modes, same numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cycle {
    /// Minor iteration from which on it repeats.
    pub start: u32,
    /// Number of minor iterations after which it repeats.
    pub period: u32,
    /// Contact nodes (by slave number) that change in it, with the modes that each takes over one period.
    pub members: Vec<(usize, Vec<Mode>)>,
}

/// The input of each minor iteration of the present major one. While the geometry is frozen, a minor iteration depends on
/// nothing else, so an input that returns proves a cycle.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct MinorHistory {
    /// One entry a slave node, iteration after iteration.
    entries: Vec<Input>,
}

/// What one slave node brings into a minor iteration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// Mode of the minor iteration.
    pub mode: Mode,
    /// T_max, where the node slides; else 0.
    pub t_max: f64,
    /// Ratio ρ, where the node touches; else 0.
    pub ratio: f64,
}

impl Input {
    fn of(node: &ContactState) -> Self {
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

    /// Whether the mode is the same, T_max differs by at most `force`, and ρ by at most `ratio` (1 + |ρ|).
    fn repeats(&self, other: &Input, force: f64, ratio: f64) -> bool {
        #[cfg(mutants)]
        let force = crate::mutants::pick("cycle-by-modes-alone", force, f64::INFINITY);
        self.mode == other.mode
            && (self.t_max - other.t_max).abs() <= force
            && (self.ratio - other.ratio).abs()
                <= ratio * (1.0 + self.ratio.abs().max(other.ratio.abs()))
    }
}

impl MinorHistory {
    /// Forgets everything, keeping its memory.
    pub fn clear(&mut self) {
        self.entries.clear();
    }

    /// Whether nothing is remembered.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Memory of the entries (bytes).
    pub fn bytes(&self) -> usize {
        self.entries.capacity() * size_of::<Input>()
    }

    /// Remembers what goes into the next minor iteration.
    pub fn push(&mut self, nodes: &[ContactState]) {
        self.entries.extend(nodes.iter().map(Input::of));
    }

    /// Number of iterations remembered, each with this number of nodes.
    pub fn len(&self, nodes: usize) -> usize {
        self.entries.len() / nodes.max(1)
    }

    /// Input of the first of the iterations, one entry a node; empty if nothing is remembered.
    pub fn first(&self, nodes: usize) -> &[Input] {
        &self.entries[..nodes.min(self.entries.len())]
    }

    /// Input of the iteration `back` before the next one, one entry a node. `None` if it is not remembered.
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
            let mut pairs = then.iter().zip(nodes);
            pairs.all(|(then, node)| then.repeats(&Input::of(node), force, ratio))
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
            // The last round starts with what iteration `minor + 1 - period` started from.
            start: minor + 1 - period,
            period,
            members: (0..nodes.len())
                .filter(takes_part)
                .map(|s| (s, pattern(s)))
                .collect(),
        })
    }
}
