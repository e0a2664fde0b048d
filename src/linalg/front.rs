//! One front: a dense matrix, some of whose unknowns are eliminated.
//!
//! ```text
//! F = [F_11 F_12; F_21 F_22],      P F_11 = L_11 U_11,      R = F_22 − (F_21 U_11⁻¹) (L_11⁻¹ P F_12).
//! ```
//!
//! Pivots are searched in the rows of F_11 and must not be much smaller than the entries that they eliminate below. The first
//! attempt keeps the columns in order: small fronts use plain loops, whose bits are the same on every processor, large ones
//! recursive halving with faer's kernels. If a column has no pivot, plain loops repeat the elimination with column exchanges;
//! columns without any pivot are delayed to the next front, with the same number of rows.

use super::registers;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};

/// A pivot must exceed this fraction of the largest entry below it in its column.
const THRESHOLD: f64 = 1e-6;
/// Fronts up to this size, and column blocks up to this width in larger ones, are eliminated by plain loops.
const SMALL: usize = 64;
const NARROW: usize = 16;
/// Steps that are applied in one pass, in order.
pub(super) const STEPS: usize = 4;

/// A front's matrix in column-major order, and the meaning of its rows and columns.
#[derive(Default)]
pub(super) struct Front {
    pub matrix: Vec<f64>,
    pub rows: Vec<usize>,
    pub columns: Vec<usize>,
    /// The row exchanged in each step.
    exchanged: Vec<usize>,
}

impl Front {
    /// Resizes to the listed rows and columns, and sets all entries to zero.
    pub fn clear(&mut self) {
        let size = self.rows.len();
        self.matrix.clear();
        self.matrix.resize(size * size, 0.0);
    }

    /// Eliminates the first `most` rows and columns. `None` if a column has no pivot.
    pub fn eliminate_in_order(&mut self, most: usize) -> Option<()> {
        let size = self.rows.len();
        if most == 0 {
            return Some(());
        }
        self.exchanged.clear();
        self.exchanged.resize(most, 0);
        let (own, rest) = self.matrix.split_at_mut(most * size);
        halves(own, size, 0, most, &mut self.exchanged)?;
        if !rest.is_empty() {
            exchange(rest, size, 0, &self.exchanged);
            if size <= SMALL {
                rest.chunks_exact_mut(size).for_each(|c| substitute(own, c));
            } else {
                update(own, rest, size, 0);
            }
        }
        for (k, &row) in self.exchanged.iter().enumerate() {
            self.rows.swap(k, row);
        }
        Some(())
    }

    /// Eliminates as many as possible of the first `most` rows and columns, one by one; returns how many.
    pub fn eliminate_in_any_order(&mut self, most: usize) -> usize {
        let size = self.rows.len();
        for k in 0..most {
            let Some((row, column)) = pivot(&self.matrix, size, k, most) else {
                return k;
            };
            if column != k {
                let (first, second) = self.matrix.split_at_mut(column * size);
                first[k * size..(k + 1) * size].swap_with_slice(&mut second[..size]);
                self.columns.swap(k, column);
            }
            if row != k {
                for column in self.matrix.chunks_exact_mut(size) {
                    column.swap(k, row);
                }
                self.rows.swap(k, row);
            }
            let (done, rest) = self.matrix.split_at_mut((k + 1) * size);
            step(&mut done[k * size..], rest, size, k);
        }
        most
    }
}

/// Divides the column of step k by its pivot, and updates the later columns.
fn step(own: &mut [f64], rest: &mut [f64], size: usize, k: usize) {
    let (head, lower) = own[k..].split_at_mut(1);
    let inverse = 1.0 / head[0];
    for value in lower.iter_mut() {
        *value *= inverse;
    }
    for column in rest.chunks_exact_mut(size) {
        let (factor, column) = (column[k], &mut column[k + 1..]);
        if factor != 0.0 {
            for (value, lower) in column.iter_mut().zip(lower.iter()) {
                *value -= factor * lower;
            }
        }
    }
}

/// Applies all steps of `own` to a column, in order.
pub(super) fn substitute(own: &[f64], column: &mut [f64]) {
    let size = column.len().max(1);
    let mut blocks = own.chunks_exact(STEPS * size);
    let mut first = 0;
    for block in &mut blocks {
        let steps: [&[f64]; STEPS] =
            std::array::from_fn(|k| &block[k * size + first..][..size - first]);
        let (head, rest) = column[first..].split_at_mut(STEPS);
        for k in 1..STEPS {
            for j in 0..k {
                head[k] -= head[j] * steps[j][k];
            }
        }
        subtract_all(
            rest,
            steps.map(|step| &step[STEPS..]),
            std::array::from_fn(|k| head[k]),
        );
        first += STEPS;
    }
    for (k, lower) in blocks.remainder().chunks_exact(size).enumerate() {
        let k = first + k;
        let factor = column[k];
        subtract(&mut column[k + 1..], &lower[k + 1..], factor);
    }
}

/// Solves U x = b, in `b`, for the steps of `own` with columns of length `size`.
pub(super) fn substitute_back(own: &[f64], size: usize, b: &mut [f64]) {
    let mut last = b.len();
    let column = |k: usize| &own[k * size..];
    while last > 0 {
        let first = last.saturating_sub(STEPS);
        for k in (first..last).rev() {
            b[k] /= column(k)[k];
            let value = b[k];
            subtract(&mut b[first..k], &column(k)[first..k], value);
        }
        let (rest, block) = b[..last].split_at_mut(first);
        if block.len() == STEPS {
            let steps: [&[f64]; STEPS] = std::array::from_fn(|k| &column(last - 1 - k)[..first]);
            subtract_all(rest, steps, std::array::from_fn(|k| block[STEPS - 1 - k]));
        }
        last = first;
    }
}

/// Subtracts columns times their factors from `to`, one after the other, in one pass.
pub(super) fn subtract_all(
    to: &mut [f64],
    [a, b, c, d]: [&[f64]; STEPS],
    [p, q, r, s]: [f64; STEPS],
) {
    if [p, q, r, s] == [0.0; STEPS] {
        return;
    }
    for ((((to, a), b), c), d) in to.iter_mut().zip(a).zip(b).zip(c).zip(d) {
        *to = *to - p * a - q * b - r * c - s * d;
    }
}

/// Subtracts a column times a factor from `to`.
pub(super) fn subtract(to: &mut [f64], column: &[f64], factor: f64) {
    if factor != 0.0 {
        for (to, value) in to.iter_mut().zip(column) {
            *to -= factor * value;
        }
    }
}

/// The entry with the largest magnitude, and its index.
fn largest(values: &[f64]) -> (usize, f64) {
    let mut best = (0, 0.0);
    for (k, value) in values.iter().enumerate() {
        if value.abs() > best.1 {
            best = (k, value.abs());
        }
    }
    best
}

/// The pivot row of a column, between `k` and `most`.
fn pivot_row(column: &[f64], k: usize, most: usize) -> Option<usize> {
    let (own, rest) = (largest(&column[k..most]), largest(&column[most..]));
    (own.1 > THRESHOLD * rest.1 && own.1.is_finite()).then_some(k + own.0)
}

/// The pivot of step k, in the first column that has one.
fn pivot(matrix: &[f64], size: usize, k: usize, most: usize) -> Option<(usize, usize)> {
    (k..most).find_map(|c| {
        let row = pivot_row(&matrix[c * size..(c + 1) * size], k, most)?;
        Some((row, c))
    })
}

/// Factors columns starting with step `first`; they are up to date with all earlier steps.
fn halves(
    columns: &mut [f64],
    size: usize,
    first: usize,
    most: usize,
    exchanged: &mut [usize],
) -> Option<()> {
    let width = exchanged.len();
    if width <= NARROW || size <= SMALL {
        for k in first..first + width {
            let (done, rest) = columns.split_at_mut((k + 1 - first) * size);
            let own = &mut done[(k - first) * size..];
            let row = pivot_row(own, k, most)?;
            exchanged[k - first] = row;
            if row != k {
                done.chunks_exact_mut(size).for_each(|c| c.swap(k, row));
                rest.chunks_exact_mut(size).for_each(|c| c.swap(k, row));
            }
            step(&mut done[(k - first) * size..], rest, size, k);
        }
        return Some(());
    }
    let half = width / 2;
    let (left, right) = columns.split_at_mut(half * size);
    let (early, late) = exchanged.split_at_mut(half);
    halves(left, size, first, most, early)?;
    exchange(right, size, first, early);
    update(left, right, size, first);
    halves(right, size, first + half, most, late)?;
    exchange(left, size, first + half, late);
    Some(())
}

/// Applies the row exchanges of the steps from `first` on.
fn exchange(columns: &mut [f64], size: usize, first: usize, exchanged: &[usize]) {
    for column in columns.chunks_exact_mut(size) {
        for (k, &row) in exchanged.iter().enumerate() {
            column.swap(first + k, row);
        }
    }
}

/// Applies the steps of `left`, starting with `first`, to the columns of `right`.
fn update(left: &[f64], right: &mut [f64], size: usize, first: usize) {
    let steps = left.len() / size;
    let columns = right.len() / size;
    let left = MatRef::from_column_major_slice(left, size, steps)
        .split_at_row(first)
        .1;
    let right = MatMut::from_column_major_slice_mut(right, size, columns);
    let (_, right) = right.split_at_row_mut(first);
    let (own, below) = left.split_at_row(steps);
    let (mut upper, lower) = right.split_at_row_mut(steps);
    solve_unit_lower_triangular_in_place(own, upper.as_mut(), Par::Seq);
    matmul(lower, Accum::Add, below, upper.as_ref(), -1.0, Par::Seq);
    registers::release();
}
