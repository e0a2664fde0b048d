//! Forward and back substitution with the supernodes of L, and products with the matrix, along the elimination tree.
//!
//! Branches that do not change each other run in parallel if they are large. What a branch adds to the rows after it is summed
//! separately, so the bits do not depend on the executor.

use super::executor::Executor;
use super::pattern::sum_of;
use super::registers::vectorise;
use super::subtrees::{LowerHalf, Subtree};
use super::supernodes::Supernodes;
use std::ops::Range;

/// A branch is not split if its halves have fewer values together.
const LARGE: usize = 200_000;

/// The elimination tree, with workspace.
pub(super) struct Substitution {
    root: Branch,
    /// By row: its place among the later rows of the branches before it.
    place: Vec<u32>,
}

/// Consecutive supernodes: two halves that do not change each other and a top that follows both; or only a top.
struct Branch {
    halves: Option<Box<[Branch; 2]>>,
    nodes: Range<usize>,
    /// The columns of the top, and the first one of the branch.
    columns: Range<usize>,
    first: usize,
    /// Contribution of a supernode's columns to the rows below it.
    below: Vec<f64>,
    /// Values of the later rows that the branch can change: those of the tops around it, from the root on.
    later: Vec<f64>,
}

/// The top of a branch in a pass.
struct Top<'a> {
    nodes: Range<usize>,
    columns: Range<usize>,
    /// Values of its rows.
    own: &'a mut [f64],
    later: &'a mut [f64],
    below: &'a mut [f64],
}

/// The columns of L.
#[derive(Clone, Copy)]
struct Columns<'a> {
    l: &'a Supernodes,
    values: &'a [f64],
    place: &'a [u32],
}

type Job<'a> = dyn Fn(Top<'_>) + Sync + 'a;

impl Substitution {
    pub fn new(l: &Supernodes, tree: &Subtree) -> Self {
        let count = l.nodes.last().map_or(0, |node| node.columns.end);
        let mut place = vec![0; count];
        Substitution {
            root: Branch::new(l, tree, 0, &mut place),
            place,
        }
    }

    /// Whether branches of a branch run in parallel.
    #[cfg(test)]
    pub fn is_split_twice(&self) -> bool {
        let halves = self.root.halves.iter().flat_map(|halves| halves.iter());
        halves.filter(|half| half.halves.is_some()).count() == 2
    }

    /// Forward substitution L y = b, which also updates the rows that are not eliminated.
    pub fn forward(
        &mut self,
        (l, values): (&Supernodes, &[f64]),
        b: &mut [f64],
        executor: &dyn Executor,
    ) {
        let place = &self.place[..];
        let columns = Columns { l, values, place };
        self.root.rise(b, executor, &|top| {
            vectorise(
                #[inline(always)]
                || columns.substitute(top),
            );
        });
    }

    /// Back substitution Lᵀ u = y, with known u in the rows that are not eliminated.
    pub fn backward(
        &mut self,
        (l, values): (&Supernodes, &[f64]),
        y: &mut [f64],
        executor: &dyn Executor,
    ) {
        let place = &self.place[..];
        let columns = Columns { l, values, place };
        self.root.descend(y, executor, &|top| {
            vectorise(
                #[inline(always)]
                || columns.substitute_back(top),
            );
        });
    }

    /// y = A x in the first `count` rows, for a symmetric A.
    pub fn multiply(
        &mut self,
        matrix: LowerHalf<'_>,
        x: &[f64],
        y: &mut [f64],
        count: usize,
        executor: &dyn Executor,
    ) {
        y.fill(0.0);
        let place = &self.place[..];
        self.root.rise(y, executor, &|top| {
            let (start, end) = (top.columns.start, top.columns.end.min(count));
            for column in start..end {
                let entries = matrix.pattern.column(column);
                let rows = &matrix.pattern.row_idx[entries.clone()];
                let values = &matrix.values[entries];
                for (value, &row) in values.iter().zip(rows) {
                    let row = row as usize;
                    match row < top.columns.end {
                        true => top.own[row - start] += value * x[column],
                        false => top.later[place[row] as usize] += value * x[column],
                    }
                }
                top.own[column - start] += sum_of(values, rows, |value, row| match row == column {
                    true => 0.0,
                    false => value * x[row],
                });
            }
        });
    }
}

impl Branch {
    /// `later` is the number of later rows that it can change.
    fn new(l: &Supernodes, tree: &Subtree, later: usize, place: &mut [u32]) -> Self {
        let values =
            |halves: &[Subtree; 2]| l.values(&(halves[0].first()..halves[1].top.end)).len();
        let halves = tree.halves().filter(|halves| values(halves) >= LARGE);
        let nodes = match halves {
            Some(_) => tree.top.clone(),
            None => tree.first()..tree.top.end,
        };
        let column = |s: usize| {
            l.nodes
                .get(s)
                .map_or(place.len(), |node| node.columns.start)
        };
        let columns = column(nodes.start)..column(nodes.end);
        let first = column(tree.first());
        for (k, place) in (later as u32..).zip(&mut place[columns.clone()]) {
            *place = k;
        }
        let below = nodes.clone().map(|s| l.rows(s).len()).max();
        let inside = later + columns.len();
        let mut half = |half| Branch::new(l, half, inside, place);
        Branch {
            halves: halves.map(|[one, other]| Box::new([half(one), half(other)])),
            nodes,
            columns,
            first,
            below: vec![0.0; below.unwrap_or(0)],
            later: vec![0.0; later],
        }
    }

    fn top<'a>(&'a mut self, own: &'a mut [f64]) -> Top<'a> {
        Top {
            nodes: self.nodes.clone(),
            columns: self.columns.clone(),
            own,
            later: &mut self.later,
            below: &mut self.below,
        }
    }

    /// Does a job from the leaves to the root. It changes the top's rows, and adds to the later ones.
    fn rise(&mut self, own: &mut [f64], executor: &dyn Executor, job: &Job<'_>) {
        self.later.fill(0.0);
        let (parts, top) = own.split_at_mut(self.columns.start - self.first);
        if let Some([one, other]) = self.halves.as_deref_mut() {
            let (left, right) = parts.split_at_mut(other.first - one.first);
            executor.join(&mut || one.rise(left, executor, job), &mut || {
                other.rise(right, executor, job)
            });
            let sums = one.later.iter().zip(&other.later);
            for (to, (one, other)) in self.later.iter_mut().chain(&mut *top).zip(sums) {
                *to += one + other;
            }
        }
        job(self.top(top));
    }

    /// Does a job from the root to the leaves, which know the values of later rows.
    fn descend(&mut self, own: &mut [f64], executor: &dyn Executor, job: &Job<'_>) {
        let (parts, top) = own.split_at_mut(self.columns.start - self.first);
        job(self.top(top));
        if let Some([one, other]) = self.halves.as_deref_mut() {
            for half in [&mut *one, &mut *other] {
                let known = self.later.iter().chain(&*top);
                half.later
                    .iter_mut()
                    .zip(known)
                    .for_each(|(to, known)| *to = *known);
            }
            let (left, right) = parts.split_at_mut(other.first - one.first);
            executor.join(&mut || one.descend(left, executor, job), &mut || {
                other.descend(right, executor, job)
            });
        }
    }
}

impl Columns<'_> {
    #[inline(always)]
    fn substitute(&self, top: Top<'_>) {
        let (first, end) = (top.columns.start, top.columns.end);
        for s in top.nodes.start..top.nodes.end.min(self.l.tail) {
            let (node, rows) = (&self.l.nodes[s], self.l.rows(s));
            let (start, width) = (node.columns.start - first, node.width());
            let below = &mut top.below[..rows.len()];
            below.fill(0.0);
            let b = &mut top.own[start..start + width];
            for k in 0..width {
                let (column, value) = (node.column(self.values, k), b[k]);
                add(&mut b[k + 1..], -value, &column[k + 1..width]);
                add(below, value, &column[width..]);
            }
            let inside = rows.partition_point(|&row| (row as usize) < end);
            for (&row, below) in rows.iter().zip(&*below).take(inside) {
                top.own[row as usize - first] -= below;
            }
            for (&row, below) in rows.iter().zip(&*below).skip(inside) {
                top.later[self.place[row as usize] as usize] -= below;
            }
        }
    }

    #[inline(always)]
    fn substitute_back(&self, top: Top<'_>) {
        let (first, end) = (top.columns.start, top.columns.end);
        for s in (top.nodes.start..top.nodes.end.min(self.l.tail)).rev() {
            let (node, rows) = (&self.l.nodes[s], self.l.rows(s));
            let (start, width) = (node.columns.start - first, node.width());
            let below = &mut top.below[..rows.len()];
            let inside = rows.partition_point(|&row| (row as usize) < end);
            for (below, &row) in below.iter_mut().zip(&rows[..inside]) {
                *below = top.own[row as usize - first];
            }
            for (below, &row) in below[inside..].iter_mut().zip(&rows[inside..]) {
                *below = top.later[self.place[row as usize] as usize];
            }
            let y = &mut top.own[start..start + width];
            for k in (0..width).rev() {
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
