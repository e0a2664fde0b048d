//! Factors L D Lᵀ supernode by supernode; separate subtrees of the elimination are factored in parallel.
//!
//! With the lower half of the matrix A, the columns s of L follow from those of earlier supernodes d with rows in s,
//!
//! ```text
//! B = A_·s − Σ_d L_·d D_d L_sdᵀ,      B_ss = L_ss D_s L_ssᵀ,      L_·s = B_·s L_ss⁻ᵀ D_s⁻¹.
//! ```
//!
//! The supernodes of the unknowns that are not eliminated keep B, which is S.
//!
//! Supernodes in different subtrees do not change each other, so the supernodes are split into two halves and a top that follows
//! both; each half is split in the same way. The top has few but large supernodes, whose columns are changed in parallel. Every
//! entry is computed from the same terms in the same order as in a single pass, so the bits do not depend on the split.

use super::check::SolveError;
use super::executor::Executor;
use super::pattern::Pattern;
use super::registers;
use super::supernodes::{Supernode, Supernodes};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::{
    LdltRegularization, cholesky_in_place, cholesky_in_place_scratch,
};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};
use std::ops::Range;

/// A range of supernodes is split if it takes at least this many multiplications, the first for all supernodes, the next for its
/// halves and so on, and if this saves at least this fraction of them on two threads. Every split costs a workspace.
const LEAST: [f64; 4] = [1e7, 1e7, 1e9, 1e9];
const SAVED: f64 = 0.1;
/// Products with at most this many columns are computed in full, with the unused half.
const NARROW: usize = 16;
/// A product is computed in batches of at most this many rows and columns, which bounds the workspace.
const ROWS: usize = 128;
/// Rows below a supernode that is at least this wide are divided by its L in parallel.
const WIDE: usize = 64;

/// A matrix to factor: the pattern and the values of its lower half.
#[derive(Clone, Copy)]
pub(super) struct LowerHalf<'a> {
    pub pattern: &'a Pattern,
    pub values: &'a [f64],
}

/// A range of supernodes, and how it is factored.
pub(super) struct Subtree {
    /// Index of the first value of the range.
    start: usize,
    /// Two parts that do not change each other, factored first.
    halves: Option<Box<[Subtree; 2]>>,
    /// The supernodes that follow.
    pub top: Range<usize>,
    /// Number of parts that are not split, and of workspaces.
    pub leaves: usize,
}

/// Workspace of a thread.
pub(super) struct Workspace {
    /// Row of each unknown in the current supernode.
    place: Vec<u32>,
    /// Of a product: L D of some rows, their places in the supernode, and the result.
    scaled: Vec<f64>,
    places: Vec<u32>,
    result: Vec<f64>,
    dense: MemBuffer,
}

/// Quantities by which the supernodes are split.
struct Costs {
    /// First supernode of the subtree of each.
    first: Vec<usize>,
    /// Multiplications for the supernodes before each.
    before: Vec<f64>,
}

impl Subtree {
    /// All supernodes.
    pub fn new(l: &Supernodes) -> Self {
        let whole = 0..l.nodes.len();
        match Costs::new(l) {
            Some(costs) => Subtree::split(l, whole, &costs, &LEAST),
            None => Subtree::whole(l, whole),
        }
    }

    /// The two parts that do not change each other, if there are any.
    pub fn halves(&self) -> Option<&[Subtree; 2]> {
        self.halves.as_deref()
    }

    /// The first supernode.
    pub fn first(&self) -> usize {
        match self.halves() {
            Some([first, _]) => first.first(),
            None => self.top.start,
        }
    }

    fn whole(l: &Supernodes, top: Range<usize>) -> Self {
        Subtree {
            start: l.nodes.get(top.start).map_or(0, |node| node.values.start),
            halves: None,
            top,
            leaves: 1,
        }
    }

    /// Splits a range where two threads need the least time.
    fn split(l: &Supernodes, range: Range<usize>, costs: &Costs, least: &[f64]) -> Self {
        let Some((&least, deeper)) = least.split_first() else {
            return Subtree::whole(l, range);
        };
        let whole = costs.of(&range);
        let mut best = (whole * (1.0 - SAVED), None);
        let mut top = range.end.min(l.tail);
        while whole >= least && costs.of(&(top..range.end)) < best.0 {
            let mut middle = top;
            while middle > range.start {
                middle = costs.first[middle - 1].max(range.start);
                let [first, second] = [range.start..middle, middle..top];
                let time = costs.of(&first).max(costs.of(&second)) + costs.of(&(top..range.end));
                if time < best.0 {
                    best = (time, Some((middle, top)));
                }
            }
            top = top.saturating_sub(1);
        }
        let Some((middle, top)) = best.1 else {
            return Subtree::whole(l, range);
        };
        let half = |half| Subtree::split(l, half, costs, deeper);
        let halves = [half(range.start..middle), half(middle..top)];
        Subtree {
            start: halves[0].start,
            leaves: halves[0].leaves + halves[1].leaves,
            halves: Some(Box::new(halves)),
            top: top..range.end,
        }
    }

    /// Factors the supernodes; `values` are theirs, and there is a room for each leaf.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if a pivot vanishes.
    pub fn factor(
        &self,
        l: &Supernodes,
        matrix: LowerHalf<'_>,
        values: &mut [f64],
        rooms: &mut [Workspace],
        executor: &dyn Executor,
    ) -> Result<(), SolveError> {
        if let Some([first, second]) = self.halves.as_deref() {
            let (before, after) = rooms.split_at_mut(first.leaves);
            let (left, right) = values.split_at_mut(second.start - self.start);
            let mut done = [Ok(()); 2];
            let [first_done, second_done] = &mut done;
            executor.join(
                &mut || *first_done = first.factor(l, matrix, left, before, executor),
                &mut || *second_done = second.factor(l, matrix, right, after, executor),
            );
            done[0].and(done[1])?;
        }
        for s in self.top.clone() {
            let node = &l.nodes[s];
            let (earlier, own) = values.split_at_mut(node.values.start - self.start);
            let own = &mut own[..node.values.len()];
            rooms[0].find_places(l, s);
            let place = std::mem::take(&mut rooms[0].place);
            let sum = Sum {
                l,
                s,
                matrix,
                earlier,
                start: self.start,
                place: &place,
            };
            sum.all(node.columns.clone(), own, rooms, executor);
            rooms[0].place = place;
            if s < l.tail {
                eliminate(node, own, rooms, executor)?;
            }
        }
        Ok(())
    }
}

impl Costs {
    /// `None` if a subtree is not a consecutive range of supernodes.
    fn new(l: &Supernodes) -> Option<Self> {
        let mut first: Vec<usize> = (0..l.nodes.len()).collect();
        let mut size = vec![1; l.nodes.len()];
        let mut before = vec![0.0];
        for (s, node) in l.nodes.iter().enumerate() {
            let (width, height) = (node.width() as f64, node.height() as f64);
            let own = match s < l.tail {
                true => width * (height * (height - width) + width * width / 3.0),
                false => 0.0,
            };
            before.push(before[s] + own);
            // What is not eliminated may belong to several subtrees.
            if s < l.tail && s + 1 - first[s] != size[s] {
                return None;
            }
            if let Some(parent) = l.parent(s) {
                first[parent] = first[parent].min(first[s]);
                size[parent] += size[s];
            }
        }
        Some(Costs { first, before })
    }

    fn of(&self, range: &Range<usize>) -> f64 {
        self.before[range.end] - self.before[range.start]
    }
}

impl Workspace {
    /// # Errors
    /// [`SolveError::OutOfMemory`].
    pub fn new(l: &Supernodes) -> Result<Self, SolveError> {
        let width = l.nodes[..l.tail].iter().map(Supernode::width).max();
        let width = width.unwrap_or(0);
        let rows = (0..l.tail).map(|s| l.rows(s).len()).max();
        let rows = rows.map_or(0, |rows| rows.min(ROWS));
        let dense = cholesky_in_place_scratch::<f64>(width, Par::Seq, Default::default());
        Ok(Workspace {
            place: vec![0; l.nodes.last().map_or(0, |node| node.columns.end)],
            scaled: vec![0.0; rows * width],
            places: vec![0; rows],
            result: vec![0.0; rows * rows],
            dense: MemBuffer::try_new(dense).map_err(|_| SolveError::OutOfMemory)?,
        })
    }

    /// Finds the row of each unknown of a supernode.
    fn find_places(&mut self, l: &Supernodes, s: usize) {
        let own = l.nodes[s].columns.clone();
        let below = l.rows(s).iter().map(|&row| row as usize);
        for (k, row) in (0..).zip(own.chain(below)) {
            self.place[row] = k;
        }
    }
}

/// The sum B of a supernode.
struct Sum<'a> {
    l: &'a Supernodes,
    s: usize,
    matrix: LowerHalf<'a>,
    /// The values of earlier supernodes, and the index of the first of them.
    earlier: &'a [f64],
    start: usize,
    place: &'a [u32],
}

impl Sum<'_> {
    /// B in these columns, of which no more than `ROWS` are computed together; separate ones are computed in parallel if there are
    /// several rooms.
    fn all(
        &self,
        columns: Range<usize>,
        out: &mut [f64],
        rooms: &mut [Workspace],
        executor: &dyn Executor,
    ) {
        if columns.len() <= ROWS {
            return self.columns(columns, out, &mut rooms[0]);
        }
        let middle = columns.start + columns.len() / 2;
        let height = self.l.nodes[self.s].height();
        let (left, right) = out.split_at_mut((middle - columns.start) * height);
        if rooms.len() == 1 {
            self.all(columns.start..middle, left, rooms, executor);
            return self.all(middle..columns.end, right, rooms, executor);
        }
        let (first, second) = rooms.split_at_mut(rooms.len() / 2);
        executor.join(
            &mut || self.all(columns.start..middle, left, first, executor),
            &mut || self.all(middle..columns.end, right, second, executor),
        );
    }

    fn columns(&self, columns: Range<usize>, out: &mut [f64], room: &mut Workspace) {
        out.fill(0.0);
        let height = self.l.nodes[self.s].height();
        for (column, out) in columns.clone().zip(out.chunks_exact_mut(height)) {
            let pattern = self.matrix.pattern;
            let entries = pattern.column(column);
            let rows = &pattern.row_idx[entries.clone()];
            for (value, &row) in self.matrix.values[entries].iter().zip(rows) {
                out[self.place[row as usize] as usize] += value;
            }
        }
        for &d in self.l.earlier(self.s) {
            self.subtract(d as usize, &columns, out, room);
        }
    }

    /// Subtracts L_·d D_d L_sdᵀ.
    fn subtract(&self, d: usize, columns: &Range<usize>, out: &mut [f64], room: &mut Workspace) {
        let node = &self.l.nodes[d];
        let (rows, shared) = self.l.shared(d, columns);
        if shared == 0 {
            return;
        }
        let values = &self.earlier[node.values.start - self.start..node.values.end - self.start];
        let (all, first) = (rows.len(), node.height() - rows.len());
        let l = MatRef::from_column_major_slice(values, node.height(), node.width());
        let l = l.subrows(first, shared).transpose();
        let height = self.l.nodes[self.s].height();
        for start in (0..all).step_by(ROWS) {
            let count = ROWS.min(all - start);
            let scaled = &mut room.scaled[..count * node.width()];
            let own = values.chunks_exact(node.height());
            for ((k, column), scaled) in own.enumerate().zip(scaled.chunks_exact_mut(count)) {
                for (scaled, l) in scaled.iter_mut().zip(&column[first + start..]) {
                    *scaled = l * column[k];
                }
            }
            let scaled = MatRef::from_column_major_slice(scaled, count, node.width());
            let result = &mut room.result[..count * shared];
            let out_of = MatMut::from_column_major_slice_mut(result, count, shared);
            multiply(scaled, l, out_of, start == 0);
            registers::release();
            let places = &mut room.places[..count];
            for (place, &row) in places.iter_mut().zip(&rows[start..]) {
                *place = self.place[row as usize];
            }
            for (k, column) in result.chunks_exact(count).enumerate() {
                let to = (rows[k] as usize - columns.start) * height;
                let to = &mut out[to..to + height];
                let above = k.saturating_sub(start);
                subtract_at(to, &column[above..], &places[above..]);
            }
        }
    }
}

/// Subtracts values at ascending places.
fn subtract_at(to: &mut [f64], values: &[f64], places: &[u32]) {
    let [Some(&first), Some(&last)] = [places.first(), places.last()] else {
        return;
    };
    if (last - first) as usize + 1 == places.len() {
        let to = &mut to[first as usize..];
        to.iter_mut()
            .zip(values)
            .for_each(|(to, value)| *to -= value);
    } else if places.len() > 8 {
        let middle = places.len() / 2;
        subtract_at(to, &values[..middle], &places[..middle]);
        subtract_at(to, &values[middle..], &places[middle..]);
    } else {
        for (value, &place) in values.iter().zip(places) {
            to[place as usize] -= value;
        }
    }
}

/// A product; of a square at the top, perhaps only the lower half.
fn multiply(a: MatRef<'_, f64>, b: MatRef<'_, f64>, out: MatMut<'_, f64>, at_top: bool) {
    use BlockStructure::{Rectangular, TriangularLower};
    let (all, count) = (a.nrows(), b.ncols());
    if !at_top || count <= NARROW {
        return matmul(out, Accum::Replace, a, b, 1.0, Par::Seq);
    }
    let (top, bottom) = out.split_at_row_mut(count);
    let square = a.subrows(0, count);
    triangular::matmul(
        top,
        TriangularLower,
        Accum::Replace,
        square,
        Rectangular,
        b,
        Rectangular,
        1.0,
        Par::Seq,
    );
    let rest = a.subrows(count, all - count);
    matmul(bottom, Accum::Replace, rest, b, 1.0, Par::Seq);
}

/// Factors B_ss and computes the rows below.
fn eliminate(
    node: &Supernode,
    values: &mut [f64],
    rooms: &mut [Workspace],
    executor: &dyn Executor,
) -> Result<(), SolveError> {
    let (width, height) = (node.width(), node.height());
    let all = MatMut::from_column_major_slice_mut(values, height, width);
    let (mut own, below) = all.split_at_row_mut(width);
    cholesky_in_place(
        own.as_mut(),
        LdltRegularization::default(),
        Par::Seq,
        MemStack::new(&mut rooms[0].dense),
        Default::default(),
    )
    .map_err(|_| SolveError::Singular)?;
    let parts = if width < WIDE { 1 } else { rooms.len() };
    divide(own.as_ref(), below, parts, executor);
    for (k, column) in values.chunks_exact_mut(height).enumerate() {
        let (own, below) = column.split_at_mut(width);
        let inverse = own[k].recip();
        below.iter_mut().for_each(|l| *l *= inverse);
    }
    Ok(())
}

/// B L⁻ᵀ, in parts of rows.
fn divide(l: MatRef<'_, f64>, below: MatMut<'_, f64>, parts: usize, executor: &dyn Executor) {
    if parts == 1 {
        solve_unit_lower_triangular_in_place(l, below.transpose_mut(), Par::Seq);
        return registers::release();
    }
    let middle = below.nrows() / 2;
    let (mut first, mut second) = below.split_at_row_mut(middle);
    executor.join(
        &mut || divide(l, first.as_mut(), parts / 2, executor),
        &mut || divide(l, second.as_mut(), parts - parts / 2, executor),
    );
}
