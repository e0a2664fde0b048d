//! Patterns of sparse matrices, and matrix-vector products.

use super::check::SolveError;
use super::executor::{Executor, each};
use faer::sparse::SymbolicSparseColMatRef;
use std::ops::Range;

/// Pattern of a square sparse matrix: compressed columns with ascending rows. Indices have four bytes, because large matrices
/// are limited by memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    pub(super) n: usize,
    col_ptr: Vec<u32>,
    pub(super) row_idx: Vec<u32>,
}

impl Pattern {
    /// The pattern of an n by n matrix with these `(row, column)` entries, in any order, possibly repeated. They are iterated
    /// twice.
    ///
    /// # Errors
    /// [`SolveError::OutOfMemory`] if an index needs more than four bytes.
    pub fn new(
        n: usize,
        entries: impl Iterator<Item = (usize, usize)> + Clone,
    ) -> Result<Self, SolveError> {
        narrow(n)?;
        let by_column = || entries.clone().map(|(row, col)| (col, row as u32));
        let (starts, mut rows) = lists(n, by_column);
        let mut col_ptr = Vec::with_capacity(n + 1);
        col_ptr.push(0);
        let mut end = 0;
        for range in starts.windows(2) {
            let count = sort_distinct(&mut rows[range[0]..range[1]]);
            rows.copy_within(range[0]..range[0] + count, end);
            end += count;
            col_ptr.push(narrow(end)?);
        }
        rows.truncate(end);
        rows.shrink_to_fit();
        Ok(Pattern {
            n,
            col_ptr,
            row_idx: rows,
        })
    }

    /// The upper half of the pattern in which the unknowns of each list are coupled, with the whole diagonal. The lists are
    /// ascending and follow one another in `coupled`; `starts` are their first indices and, at the end, its length.
    ///
    /// # Errors
    /// [`SolveError::OutOfMemory`] if an index needs more than four bytes.
    pub fn upper_from_lists(
        n: usize,
        (starts, coupled): (&[usize], &[u32]),
        executor: &dyn Executor,
    ) -> Result<Self, SolveError> {
        /// Columns that one thread finds together.
        const TOGETHER: usize = 4096;
        narrow(n)?;
        let list = |k: usize| &coupled[starts[k]..starts[k + 1]];
        let numbers = 0..starts.len() - 1;
        let (first, lists_of) = lists(n, || {
            let members = |k: usize| list(k).iter().map(move |&i| (i as usize, k as u32));
            numbers.clone().flat_map(members)
        });
        let lists_of = |column: usize| &lists_of[first[column]..first[column + 1]];
        // The number of rows of each column, and the rows.
        type Part = (Range<usize>, Vec<usize>, Vec<u32>);
        let range = |start| start..n.min(start + TOGETHER);
        let part = |start| (range(start), Vec::new(), Vec::new());
        let mut parts: Vec<Part> = (0..n).step_by(TOGETHER).map(part).collect();
        each(executor, &mut parts, &|(columns, counts, rows)| {
            for column in columns.clone() {
                let (start, own) = (rows.len(), lists_of(column));
                match counts.last() {
                    // As the column before, with one more row.
                    Some(before) if !own.is_empty() && own == lists_of(column - 1) => {
                        rows.extend_from_within(start - before..);
                        rows.push(column as u32);
                    }
                    _ => {
                        rows.push(column as u32);
                        for &k in own {
                            let above = list(k as usize)
                                .iter()
                                .take_while(|&&row| row as usize <= column);
                            rows.extend(above);
                        }
                        let end = start + sort_distinct(&mut rows[start..]);
                        rows.truncate(end);
                    }
                }
                counts.push(rows.len() - start);
            }
        });
        let (mut col_ptr, mut row_idx) = (Vec::with_capacity(n + 1), Vec::new());
        row_idx.reserve_exact(parts.iter().map(|(.., rows)| rows.len()).sum());
        let mut end = 0;
        col_ptr.push(0);
        for (_, counts, rows) in parts {
            row_idx.extend(rows);
            for count in counts {
                end += count;
                col_ptr.push(narrow(end)?);
            }
        }
        Ok(Pattern {
            n,
            col_ptr,
            row_idx,
        })
    }

    /// Number of rows and of columns.
    pub fn size(&self) -> usize {
        self.n
    }

    /// Number of stored entries.
    pub fn entries(&self) -> usize {
        self.row_idx.len()
    }

    /// Index of the first entry of a column in the array of values.
    pub fn start(&self, column: usize) -> usize {
        self.col_ptr[column] as usize
    }

    /// The entries of a column in the array of values.
    pub(super) fn column(&self, column: usize) -> Range<usize> {
        self.start(column)..self.start(column + 1)
    }

    /// Index of an entry in the array of values, if the pattern has it.
    pub fn slot(&self, row: usize, col: usize) -> Option<usize> {
        let range = self.column(col);
        let place = self.row_idx[range.clone()].binary_search(&(row as u32));
        place.ok().map(|k| range.start + k)
    }

    /// The diagonal blocks without entries outside, as consecutive ranges of unknowns. Works for an upper half like for a full
    /// matrix.
    pub fn blocks(&self) -> Vec<Range<usize>> {
        let mut starts = Vec::new();
        // The smallest row in this and all later columns.
        let mut reach = self.n;
        for col in (0..self.n).rev() {
            let first = self.row_idx[self.column(col)].first();
            reach = reach.min(first.map_or(col, |&row| col.min(row as usize)));
            if reach == col {
                starts.push(col);
            }
        }
        starts.reverse();
        let ends = starts.iter().skip(1).copied().chain([self.n]);
        starts
            .iter()
            .copied()
            .zip(ends)
            .map(|(a, b)| a..b)
            .collect()
    }

    /// For a symmetric matrix's upper half and a new order of the unknowns: the pattern of the lower half, and the source of each
    /// of its entries.
    pub(super) fn in_order(&self, order: &[usize]) -> (Pattern, Vec<u32>) {
        let mut place = vec![0; self.n];
        for (k, &unknown) in (0..).zip(order) {
            place[unknown] = k;
        }
        let entries = self.iter().map(|(i, j)| (place[i], place[j]));
        let lower = entries.zip(0..).map(|((i, j), entry)| {
            let (row, column): (u32, u32) = (i.max(j), i.min(j));
            (column as usize, (row, entry))
        });
        let (starts, mut pairs) = lists(self.n, || lower.clone());
        for range in starts.windows(2) {
            pairs[range[0]..range[1]].sort_unstable();
        }
        let (row_idx, from) = pairs.into_iter().unzip();
        let pattern = Pattern {
            n: self.n,
            col_ptr: starts.iter().map(|&start| start as u32).collect(),
            row_idx,
        };
        (pattern, from)
    }

    /// The rows below the diagonal of a column.
    fn below(&self, column: usize) -> &[u32] {
        let rows = &self.row_idx[self.column(column)];
        &rows[rows.partition_point(|&row| row as usize <= column)..]
    }

    /// For a symmetric matrix's lower half: groups of consecutive unknowns that are coupled to the same others, as the first of
    /// each, and the number of unknowns at the end. None contains unknowns on both sides of `border`.
    pub(super) fn groups(&self, border: usize) -> Vec<usize> {
        // By unknown: earlier columns with its row, and those also with the row before.
        let (mut own, mut both) = (vec![0_u32; self.n], vec![0_u32; self.n]);
        for column in 0..self.n {
            let rows = self.below(column);
            rows.iter().for_each(|&row| own[row as usize] += 1);
            for pair in rows.windows(2) {
                both[pair[1] as usize] += u32::from(pair[0] + 1 == pair[1]);
            }
        }
        let follows = |k: &usize| {
            let k = *k;
            let same = || self.below(k - 1).strip_prefix(&[k as u32]) == Some(self.below(k));
            k != border && own[k - 1] == both[k] && own[k] == both[k] + 1 && same()
        };
        let first = (0..self.n.min(1)).chain((1..self.n).filter(|k| !follows(k)));
        first.chain([self.n]).collect()
    }

    /// The lower half of the pattern of these groups.
    pub(super) fn of_groups(&self, groups: &[usize]) -> Pattern {
        let mut number = vec![0_u32; self.n];
        for (group, range) in (0..).zip(groups.windows(2)) {
            number[range[0]..range[1]].fill(group);
        }
        let (mut col_ptr, mut row_idx) = (vec![0], Vec::new());
        for (group, range) in (0..).zip(groups.windows(2)) {
            row_idx.push(group);
            for &row in self.below(range[1] - 1) {
                let other = number[row as usize];
                if row_idx.last() != Some(&other) {
                    row_idx.push(other);
                }
            }
            col_ptr.push(row_idx.len() as u32);
        }
        Pattern {
            n: groups.len() - 1,
            col_ptr,
            row_idx,
        }
    }

    /// The transposed pattern.
    pub(super) fn transposed(&self) -> Pattern {
        let (starts, row_idx) = lists(self.n, || self.iter().map(|(row, col)| (row, col as u32)));
        Pattern {
            n: self.n,
            col_ptr: starts.iter().map(|&start| start as u32).collect(),
            row_idx,
        }
    }

    /// The pattern of one of [`Pattern::blocks`], or of consecutive ones, and the range of its values.
    pub fn block(&self, unknowns: Range<usize>) -> (Pattern, Range<usize>) {
        let columns = &self.col_ptr[unknowns.start..=unknowns.end];
        let (first, last) = (columns[0], columns[unknowns.len()]);
        let values = first as usize..last as usize;
        let rows = self.row_idx[values.clone()].iter();
        let pattern = Pattern {
            n: unknowns.len(),
            col_ptr: columns.iter().map(|k| k - first).collect(),
            row_idx: rows.map(|row| row - unknowns.start as u32).collect(),
        };
        (pattern, values)
    }

    /// All entries as `(row, column)`, in the order of the values.
    pub fn iter(&self) -> impl Iterator<Item = (usize, usize)> + Clone + '_ {
        (0..self.n).flat_map(move |col| {
            let rows = self.row_idx[self.column(col)].iter();
            rows.map(move |&row| (row as usize, col))
        })
    }

    /// y = A x.
    pub fn multiply(&self, values: &[f64], x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for (col, &xc) in x.iter().enumerate() {
            let range = self.column(col);
            for (&value, &row) in values[range.clone()].iter().zip(&self.row_idx[range]) {
                y[row as usize] += value * xc;
            }
        }
    }

    /// y = |A| |x|: the sum of the terms' magnitudes in a product, which is the scale of its round-off. With `half`, this is the
    /// upper half of a symmetric A.
    pub fn multiply_abs(&self, values: &[f64], x: &[f64], y: &mut [f64], half: bool) {
        y.fill(0.0);
        for (col, &xc) in x.iter().enumerate() {
            let range = self.column(col);
            let (values, rows) = (&values[range.clone()], &self.row_idx[range]);
            for (&value, &row) in values.iter().zip(rows) {
                y[row as usize] += (value * xc).abs();
            }
            if half {
                y[col] += sum_of(values, rows, |value, row| match row == col {
                    true => 0.0,
                    false => (value * x[row]).abs(),
                });
            }
        }
    }
}

/// Sorts rows and moves the first of each to the front; returns their number.
fn sort_distinct(rows: &mut [u32]) -> usize {
    rows.sort_unstable();
    let mut count = 0;
    for k in 0..rows.len() {
        if k == 0 || rows[k] != rows[count - 1] {
            rows[count] = rows[k];
            count += 1;
        }
    }
    count
}

/// Sum of the terms of values and their rows, in four parts that do not wait for each other.
pub(super) fn sum_of(values: &[f64], rows: &[u32], term: impl Fn(f64, usize) -> f64) -> f64 {
    const PARTS: usize = 4;
    let mut sums = [0.0; PARTS];
    let (values, rows) = (values.chunks_exact(PARTS), rows.chunks_exact(PARTS));
    let rest = values.remainder().iter().zip(rows.remainder());
    let rest: f64 = rest.map(|(&value, &row)| term(value, row as usize)).sum();
    for (values, rows) in values.zip(rows) {
        for ((sum, &value), &row) in sums.iter_mut().zip(values).zip(rows) {
            *sum += term(value, row as usize);
        }
    }
    sums.iter().sum::<f64>() + rest
}

/// Groups values into lists by number, in order of appearance; also returns the start of each list.
pub(super) fn lists<T: Copy + Default, P: Iterator<Item = (usize, T)>>(
    count: usize,
    pairs: impl Fn() -> P,
) -> (Vec<usize>, Vec<T>) {
    let mut starts = vec![0; count + 1];
    pairs().for_each(|(number, _)| starts[number + 1] += 1);
    for number in 0..count {
        starts[number + 1] += starts[number];
    }
    let mut next = starts.clone();
    let mut values = vec![T::default(); starts[count]];
    pairs().for_each(|(number, value)| {
        values[next[number]] = value;
        next[number] += 1;
    });
    (starts, values)
}

/// An index with four bytes.
///
/// # Errors
/// [`SolveError::OutOfMemory`] if it needs more.
pub(super) fn narrow(index: usize) -> Result<u32, SolveError> {
    u32::try_from(index).map_err(|_| SolveError::OutOfMemory)
}

/// The pattern in faer's form.
pub(super) fn symbolic_view(pattern: &Pattern) -> SymbolicSparseColMatRef<'_, u32> {
    SymbolicSparseColMatRef::new_checked(
        pattern.n,
        pattern.n,
        &pattern.col_ptr,
        None,
        &pattern.row_idx,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::executor::Threads;

    #[test]
    fn uncoupled_blocks_are_found() {
        let entries = vec![
            (0, 0),
            (0, 2),
            (1, 1),
            (2, 2),
            (3, 3),
            (4, 4),
            (4, 5),
            (5, 5),
        ];
        let pattern = Pattern::new(6, entries.into_iter()).unwrap();
        assert_eq!(pattern.blocks(), [0..3, 3..4, 4..6]);
        let (block, values) = pattern.block(4..6);
        let expected = Pattern::new(2, [(0, 0), (0, 1), (1, 1)].into_iter());
        assert_eq!(Ok(block), expected);
        let all: Vec<_> = pattern.iter().collect();
        assert_eq!(all[values], [(4, 4), (4, 5), (5, 5)]);
    }

    #[test]
    fn the_pattern_of_lists_is_that_of_their_pairs() {
        // Across the border of two parts, with a list of one, an empty one and unknowns in no list.
        let lists: [&[u32]; 6] = [
            &[0, 1, 4095, 4096],
            &[4094, 4095, 4096, 4097],
            &[7],
            &[],
            &[4096, 4097, 4098],
            &[1, 4098, 4099],
        ];
        let starts = lists.iter().scan(0, |end, list| {
            *end += list.len();
            Some(*end)
        });
        let starts: Vec<usize> = [0].into_iter().chain(starts).collect();
        let coupled = lists.concat();
        let found = Pattern::upper_from_lists(5000, (&starts, &coupled), &Threads).unwrap();
        let pairs = lists.iter().flat_map(|list| {
            let pair = |&i: &u32| list.iter().map(move |&j| (i as usize, j as usize));
            list.iter().flat_map(pair)
        });
        let pairs = pairs.filter(|(i, j)| i <= j);
        let pairs = pairs.chain((0..5000).map(|i| (i, i)));
        assert!(Ok(found) == Pattern::new(5000, pairs));
    }

    #[test]
    fn unknowns_coupled_to_the_same_others_are_in_a_group() {
        // Nodes of two unknowns in a row, of which the last has one.
        let coupled = |i: usize, j: usize| (j / 2).abs_diff(i / 2) <= 1;
        let entries = (0..7).flat_map(|j| (j..7).map(move |i| (i, j)));
        let pattern = Pattern::new(7, entries.filter(|&(i, j)| coupled(i, j))).unwrap();
        assert_eq!(pattern.groups(4), [0, 2, 4, 6, 7]);
        assert_eq!(pattern.groups(3), [0, 2, 3, 4, 6, 7]);
        let chain = [(0, 0), (1, 0), (1, 1), (2, 1), (2, 2), (3, 2), (3, 3)];
        let chain = Pattern::new(4, chain.into_iter());
        assert_eq!(Ok(pattern.of_groups(&[0, 2, 4, 6, 7])), chain);
        assert_eq!(chain.unwrap().groups(4), [0, 1, 2, 3, 4]);
        let alone = Pattern::new(2, [(0, 0), (1, 1)].into_iter()).unwrap();
        assert_eq!(alone.groups(2), [0, 1, 2]);
        assert_eq!(Pattern::new(0, [].into_iter()).unwrap().groups(0), [0]);
    }

    #[test]
    fn entries_in_any_order_and_repeated_give_one_each() {
        let entries = vec![
            (2, 2),
            (1, 0),
            (0, 0),
            (1, 0),
            (2, 0),
            (0, 2),
            (2, 2),
            (1, 0),
        ];
        let pattern = Pattern::new(3, entries.into_iter()).unwrap();
        let all: Vec<_> = pattern.iter().collect();
        assert_eq!(all, [(0, 0), (1, 0), (2, 0), (0, 2), (2, 2)]);
        assert_eq!((pattern.entries(), pattern.slot(0, 2)), (5, Some(3)));
    }
}
