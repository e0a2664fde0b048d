//! Forward and back substitution with the supernodes of L.
//!
//! The two parts of the tree that do not change each other run in parallel if they are large. What each of them subtracts from the
//! rows after both is summed separately, so the bits do not depend on the executor.

use super::executor::Executor;
use super::registers::vectorise;
use super::subtrees::Subtree;
use super::supernodes::Supernodes;
use std::ops::Range;

/// Parts that have fewer values together run in sequence.
const LARGE: usize = 200_000;

/// How substitutions are split, and their workspace.
pub(super) struct Substitution {
    /// The supernodes of the two parts, which may be empty, and those after them.
    parts: [Range<usize>; 2],
    rest: Range<usize>,
    /// First column of the second part, and of the rest.
    columns: [usize; 2],
    sums: [PartialSums; 2],
}

/// Workspace of a part.
struct PartialSums {
    /// Contribution of a supernode's columns to the rows below it.
    below: Vec<f64>,
    /// Contribution of the part to the rows of the rest.
    later: Vec<f64>,
}

/// Some consecutive supernodes of L.
struct Part<'a> {
    l: &'a Supernodes,
    values: &'a [f64],
    nodes: Range<usize>,
    /// First column of the part and of the rest.
    first: usize,
    rest: usize,
    /// The columns from this one on are left out.
    count: usize,
}

impl Substitution {
    pub fn new(l: &Supernodes, tree: &Subtree) -> Self {
        let parts = tree.parts();
        let size = |nodes: &Range<usize>| l.values(nodes).len();
        let parts = parts.filter(|parts| parts.iter().map(size).sum::<usize>() >= LARGE);
        let parts = parts.unwrap_or_default();
        let rest = parts[1].end..l.nodes.len();
        let count = l.nodes.last().map_or(0, |node| node.columns.end);
        let first = |s: usize| l.nodes.get(s).map_or(count, |node| node.columns.start);
        let columns = [first(parts[1].start), first(rest.start)];
        let below = l.nodes.iter().map(|node| node.height() - node.width());
        let below = below.max().unwrap_or(0);
        let later = if columns[1] > 0 {
            count - columns[1]
        } else {
            0
        };
        let sums = [(); 2].map(|()| PartialSums {
            below: vec![0.0; below],
            later: vec![0.0; later],
        });
        Substitution {
            parts,
            rest,
            columns,
            sums,
        }
    }

    /// Whether two parts run in parallel.
    #[cfg(test)]
    pub fn is_split(&self) -> bool {
        self.columns[1] > 0
    }

    /// Forward substitution L y = b in the first `count` columns, which also updates the later rows.
    pub fn forward(
        &mut self,
        l: (&Supernodes, &[f64]),
        b: &mut [f64],
        count: usize,
        executor: &dyn Executor,
    ) {
        let [first, second, rest] = self.parts(l, count);
        let (own, later) = b.split_at_mut(rest.first);
        let (left, right) = own.split_at_mut(second.first);
        let [sums, others] = &mut self.sums;
        if rest.first > 0 {
            executor.join(&mut || first.forward(left, sums), &mut || {
                second.forward(right, others)
            });
        }
        for ((b, left), right) in later.iter_mut().zip(&sums.later).zip(&others.later) {
            *b -= left + right;
        }
        rest.forward(later, sums);
    }

    /// Back substitution Lᵀ u = y in the first `count` columns, with known u in the others.
    pub fn backward(
        &mut self,
        l: (&Supernodes, &[f64]),
        y: &mut [f64],
        count: usize,
        executor: &dyn Executor,
    ) {
        let [first, second, rest] = self.parts(l, count);
        let (own, later) = y.split_at_mut(rest.first);
        let (left, right) = own.split_at_mut(second.first);
        let [sums, others] = &mut self.sums;
        rest.backward(later, &[], &mut sums.below);
        if rest.first > 0 {
            executor.join(
                &mut || first.backward(left, later, &mut sums.below),
                &mut || second.backward(right, later, &mut others.below),
            );
        }
    }

    /// The two parts, and the rest.
    fn parts<'a>(&self, (l, values): (&'a Supernodes, &'a [f64]), count: usize) -> [Part<'a>; 3] {
        let [second, rest] = self.columns;
        let [one, other] = self.parts.clone();
        let all = [(one, 0), (other, second), (self.rest.clone(), rest)];
        all.map(|(nodes, first)| Part {
            l,
            values,
            nodes,
            first,
            rest,
            count,
        })
    }
}

impl Part<'_> {
    fn forward(&self, own: &mut [f64], sums: &mut PartialSums) {
        sums.later.fill(0.0);
        vectorise(
            #[inline(always)]
            || self.substitute(own, sums),
        );
    }

    #[inline(always)]
    fn substitute(&self, own: &mut [f64], sums: &mut PartialSums) {
        let end = self.first + own.len();
        for s in self.nodes.clone() {
            let (node, rows) = (&self.l.nodes[s], self.l.rows(s));
            let (start, width) = (node.columns.start - self.first, node.width());
            let columns = self.count.saturating_sub(node.columns.start).min(width);
            if columns == 0 {
                break;
            }
            let below = &mut sums.below[..rows.len()];
            below.fill(0.0);
            let b = &mut own[start..start + width];
            for k in 0..columns {
                let (column, value) = (node.column(self.values, k), b[k]);
                add(&mut b[k + 1..], -value, &column[k + 1..width]);
                add(below, value, &column[width..]);
            }
            let inside = rows.partition_point(|&row| (row as usize) < end);
            for (&row, below) in rows.iter().zip(&*below).take(inside) {
                own[row as usize - self.first] -= below;
            }
            for (&row, below) in rows.iter().zip(&*below).skip(inside) {
                sums.later[row as usize - self.rest] += below;
            }
        }
    }

    fn backward(&self, own: &mut [f64], later: &[f64], below: &mut [f64]) {
        vectorise(
            #[inline(always)]
            || self.substitute_back(own, later, below),
        );
    }

    #[inline(always)]
    fn substitute_back(&self, own: &mut [f64], later: &[f64], below: &mut [f64]) {
        let end = self.first + own.len();
        for s in self.nodes.clone().rev() {
            let (node, rows) = (&self.l.nodes[s], self.l.rows(s));
            let (start, width) = (node.columns.start - self.first, node.width());
            let columns = self.count.saturating_sub(node.columns.start).min(width);
            if columns == 0 {
                continue;
            }
            let below = &mut below[..rows.len()];
            let inside = rows.partition_point(|&row| (row as usize) < end);
            for (below, &row) in below.iter_mut().zip(&rows[..inside]) {
                *below = own[row as usize - self.first];
            }
            for (below, &row) in below[inside..].iter_mut().zip(&rows[inside..]) {
                *below = later[row as usize - self.rest];
            }
            let y = &mut own[start..start + width];
            for k in (0..columns).rev() {
                let column = node.column(self.values, k);
                let sum = dot(&column[width..], below) + dot(&column[k + 1..width], &y[k + 1..]);
                y[k] -= sum;
            }
        }
    }
}

/// y = y + a x.
#[inline(always)]
fn add(y: &mut [f64], a: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += a * x;
    }
}

/// Uses eight sums, so that the processor can vectorise it.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 8;
    let mut sums = [0.0; LANES];
    let (a, b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest = a.remainder().iter().zip(b.remainder());
    let rest: f64 = rest.map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    sums.iter().sum::<f64>() + rest
}
