//! Factors L D Lᵀ supernode by supernode; separate subtrees of the elimination are factored in parallel.
//!
//! With the lower half of the matrix A, the columns s of L follow from those of earlier supernodes d with rows in s,
//!
//! ```text
//! B = A_·s − Σ_d L_·d D_d L_sdᵀ,      B_ss = L_ss D_s L_ssᵀ,      L_·s = B_·s L_ss⁻ᵀ D_s⁻¹.
//! ```
//!
//! Supernodes in different subtrees do not change each other, so the supernodes are split into two halves and a top that follows
//! both; each half is split in the same way. The top has few but large supernodes, whose columns are changed in parallel. Every
//! entry is computed from the same terms in the same order as in a single pass, so the bits do not depend on the split. (They are
//! also those of faer's own sequential factorization.)

use super::check::SolveError;
use super::executor::Executor;
use super::pattern::Pattern;
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

/// A range of supernodes is split at most this many times.
const DEPTH: usize = 3;
/// A range is split if it takes at least this many multiplications, and if this saves at least this fraction of them on two threads.
const LEAST: f64 = 1e7;
const SAVED: f64 = 0.1;
/// Number of columns of a supernode that are changed together, and the most such parts.
const COLUMNS: usize = 64;
const PARTS: usize = 8;
/// Products with at most this many columns are computed in full, with the unused half.
const NARROW: usize = 16;

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
    top: Range<usize>,
    room: Workspace,
}

/// Workspace for one supernode at a time.
struct Workspace {
    /// Row of each unknown in the supernode.
    place: Vec<u32>,
    products: Vec<Product>,
    dense: MemBuffer,
}

/// Workspace of a product: L D of some rows, their places in the supernode, and the result.
#[derive(Clone)]
struct Product {
    scaled: Vec<f64>,
    places: Vec<u32>,
    result: Vec<f64>,
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
    ///
    /// # Errors
    /// [`SolveError::OutOfMemory`].
    pub fn new(l: &Supernodes) -> Result<Self, SolveError> {
        let whole = 0..l.nodes.len();
        match Costs::new(l) {
            Some(costs) => Subtree::split(l, whole, &costs, DEPTH),
            None => Subtree::whole(l, whole),
        }
    }

    /// Whether there is parallel work.
    #[cfg(test)]
    pub fn is_split(&self) -> bool {
        self.halves.is_some()
    }

    fn whole(l: &Supernodes, top: Range<usize>) -> Result<Self, SolveError> {
        Ok(Subtree {
            start: l.nodes.get(top.start).map_or(0, |node| node.values.start),
            halves: None,
            room: Workspace::new(l, top.clone())?,
            top,
        })
    }

    /// Splits a range where two threads need the least time.
    fn split(
        l: &Supernodes,
        range: Range<usize>,
        costs: &Costs,
        depth: usize,
    ) -> Result<Self, SolveError> {
        let whole = costs.of(&range);
        let mut best = (whole * (1.0 - SAVED), None);
        let mut top = range.end;
        while depth > 0 && whole >= LEAST && costs.of(&(top..range.end)) < best.0 {
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
        let half = |half| Subtree::split(l, half, costs, depth - 1);
        let halves = [half(range.start..middle)?, half(middle..top)?];
        Ok(Subtree {
            start: halves[0].start,
            halves: Some(Box::new(halves)),
            ..Subtree::whole(l, top..range.end)?
        })
    }

    /// Factors the supernodes; `values` are theirs.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if a pivot vanishes.
    pub fn factor(
        &mut self,
        l: &Supernodes,
        matrix: LowerHalf<'_>,
        values: &mut [f64],
        executor: &dyn Executor,
    ) -> Result<(), SolveError> {
        if let Some(halves) = &mut self.halves {
            let [first, second] = &mut **halves;
            let (left, right) = values.split_at_mut(second.start - self.start);
            let mut done = [Ok(()); 2];
            let [first_done, second_done] = &mut done;
            executor.join(
                &mut || *first_done = first.factor(l, matrix, left, executor),
                &mut || *second_done = second.factor(l, matrix, right, executor),
            );
            done[0].and(done[1])?;
        }
        for s in self.top.clone() {
            let node = &l.nodes[s];
            let (earlier, own) = values.split_at_mut(node.values.start - self.start);
            let own = &mut own[..node.values.len()];
            self.room.find_places(l, s);
            let sum = Sum {
                l,
                s,
                matrix,
                earlier,
                start: self.start,
                place: &self.room.place,
            };
            let products = &mut self.room.products[..parts(node.width())];
            sum.all(node.columns.clone(), own, products, executor);
            eliminate(node, own, &mut self.room.dense, executor)?;
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
            before.push(before[s] + node.width() as f64 * (node.height() as f64).powi(2));
            if s + 1 - first[s] != size[s] {
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
    /// For these supernodes.
    fn new(l: &Supernodes, range: Range<usize>) -> Result<Self, SolveError> {
        let (mut longest, mut scaled, mut result, mut count, mut width) = (0, 0, 0, 1, 0);
        for s in range {
            let own = &l.nodes[s];
            let most = own.width().div_ceil(parts(own.width()));
            for &d in l.earlier(s) {
                let (rows, shared) = l.shared(d, &own.columns);
                longest = longest.max(rows.len());
                scaled = scaled.max(rows.len() * l.nodes[d].width());
                result = result.max(rows.len() * shared.min(most));
            }
            count = count.max(parts(own.width()));
            width = width.max(own.width());
        }
        let product = Product {
            scaled: vec![0.0; scaled],
            places: vec![0; longest],
            result: vec![0.0; result],
        };
        let dense = cholesky_in_place_scratch::<f64>(width, Par::Seq, Default::default());
        Ok(Workspace {
            place: vec![0; l.nodes.last().map_or(0, |node| node.columns.end)],
            products: vec![product; count],
            dense: MemBuffer::try_new(dense).map_err(|_| SolveError::OutOfMemory)?,
        })
    }

    /// Finds the row of each unknown of a supernode.
    fn find_places(&mut self, l: &Supernodes, s: usize) {
        let own = l.nodes[s].columns.clone();
        for (k, row) in (0..).zip(own.chain(l.rows(s).iter().copied())) {
            self.place[row] = k;
        }
    }
}

/// Number of parts in which the columns of a supernode of this width are changed.
fn parts(width: usize) -> usize {
    (width / COLUMNS).clamp(1, PARTS)
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
    /// B in these columns, in as many parts as there are products.
    fn all(
        &self,
        columns: Range<usize>,
        out: &mut [f64],
        products: &mut [Product],
        executor: &dyn Executor,
    ) {
        if let [product] = products {
            return self.columns(columns, out, product);
        }
        let (first, second) = products.split_at_mut(products.len() / 2);
        let middle = columns.start + columns.len() * first.len() / (first.len() + second.len());
        let height = self.l.nodes[self.s].height();
        let (left, right) = out.split_at_mut((middle - columns.start) * height);
        executor.join(
            &mut || self.all(columns.start..middle, left, first, executor),
            &mut || self.all(middle..columns.end, right, second, executor),
        );
    }

    fn columns(&self, columns: Range<usize>, out: &mut [f64], product: &mut Product) {
        out.fill(0.0);
        let height = self.l.nodes[self.s].height();
        for (column, out) in columns.clone().zip(out.chunks_exact_mut(height)) {
            let pattern = self.matrix.pattern;
            let entries = pattern.col_ptr[column]..pattern.col_ptr[column + 1];
            let rows = &pattern.row_idx[entries.clone()];
            for (value, &row) in self.matrix.values[entries].iter().zip(rows) {
                out[self.place[row] as usize] += value;
            }
        }
        for &d in self.l.earlier(self.s) {
            self.subtract(d, &columns, out, product);
        }
    }

    /// Subtracts L_·d D_d L_sdᵀ.
    fn subtract(&self, d: usize, columns: &Range<usize>, out: &mut [f64], product: &mut Product) {
        let node = &self.l.nodes[d];
        let (rows, shared) = self.l.shared(d, columns);
        if shared == 0 {
            return;
        }
        let (count, first) = (rows.len(), node.height() - rows.len());
        let earlier = &self.earlier[node.values.start - self.start..node.values.end - self.start];
        let scaled = &mut product.scaled[..count * node.width()];
        let own = earlier.chunks_exact(node.height());
        for ((k, column), scaled) in own.enumerate().zip(scaled.chunks_exact_mut(count)) {
            for (scaled, l) in scaled.iter_mut().zip(&column[first..]) {
                *scaled = l * column[k];
            }
        }
        let scaled = MatRef::from_column_major_slice(scaled, count, node.width());
        let l = MatRef::from_column_major_slice(earlier, node.height(), node.width());
        let l = l.subrows(first, shared).transpose();
        let result = &mut product.result[..count * shared];
        multiply(
            scaled,
            l,
            MatMut::from_column_major_slice_mut(result, count, shared),
        );
        let places = &mut product.places[..count];
        for (place, &row) in places.iter_mut().zip(rows) {
            *place = self.place[row];
        }
        let height = self.l.nodes[self.s].height();
        for (k, column) in result.chunks_exact(count).enumerate() {
            let to = (rows[k] - columns.start) * height;
            let to = &mut out[to..to + height];
            subtract_at(to, &column[k..], &places[k..]);
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

/// The lower half of a product, and perhaps some of the upper half.
fn multiply(a: MatRef<'_, f64>, b: MatRef<'_, f64>, out: MatMut<'_, f64>) {
    use BlockStructure::{Rectangular, TriangularLower};
    let (all, count) = (a.nrows(), b.ncols());
    if count <= NARROW {
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
    memory: &mut MemBuffer,
    executor: &dyn Executor,
) -> Result<(), SolveError> {
    let (width, height) = (node.width(), node.height());
    let all = MatMut::from_column_major_slice_mut(values, height, width);
    let (mut own, below) = all.split_at_row_mut(width);
    cholesky_in_place(
        own.as_mut(),
        LdltRegularization::default(),
        Par::Seq,
        MemStack::new(memory),
        Default::default(),
    )
    .map_err(|_| SolveError::Singular)?;
    divide(own.as_ref(), below, parts(width), executor);
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
        return solve_unit_lower_triangular_in_place(l, below.transpose_mut(), Par::Seq);
    }
    let middle = below.nrows() / 2;
    let (mut first, mut second) = below.split_at_row_mut(middle);
    executor.join(
        &mut || divide(l, first.as_mut(), parts / 2, executor),
        &mut || divide(l, second.as_mut(), parts - parts / 2, executor),
    );
}
