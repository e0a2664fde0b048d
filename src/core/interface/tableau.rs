//! Complementary pivoting: Lemke's path through the bases of any linear complementarity problem.
//!
//! Variables come in pairs of which one is zero; a loose one has no partner, may have either sign, and never leaves the basis. A
//! covering variable relaxes all rows at once. In every pivot the complement of the variable that left last enters the basis,
//! until the covering variable leaves. If nothing bounds the entering variable, the path ends on a ray. Ties are broken
//! lexicographically, so that no basis repeats, or by a small shift of every row. Shifts are cheap, and the path is the same for
//! all sufficiently small ones; the path is then that of the shifted rows, but the reported values are those of the original
//! rows.

use crate::linalg::DenseFactors;
use crate::plane::max_abs;
use crate::{InterfaceResponse, SearchProgress};

/// Entries of an entering column below this fraction of its largest are zero: for original rows, and for shifted ones, where no
/// row needs such a small pivot.
const TINY: f64 = 1e-11;
const TINY_SHIFTED: f64 = 1e-9;
/// Ratios with a smaller difference are tied.
const TIE: f64 = 1e-12;
/// Default maximum number of pivots per row. A path usually takes about one per row. If all forces are round-off, no basis is
/// better than another and the path would not end.
const PIVOTS: usize = 20;
/// Estimated norm of a basis's scaled inverse above which it is singular.
const SINGULAR: f64 = 1e11;

/// The state of a path.
#[derive(Debug, Clone, Default)]
pub struct Tableau {
    rows: usize,
    /// Columns: all variables, the covering variable, the values of the basic variables that the path uses; if these are shifted,
    /// then the original values.
    table: Vec<f64>,
    /// The complement of every variable; a loose variable is its own.
    partners: Vec<usize>,
    /// The basic variable of every row.
    basis: Vec<usize>,
    /// The row of every variable, the covering one last; `None` for zero variables.
    row_of: Vec<Option<usize>>,
    /// The initial basis, which breaks ties.
    first: Vec<usize>,
    /// Whether small shifts break ties instead.
    shifted: bool,
    /// The next entering variable. `None` before the first pivot and after the last.
    entering: Option<usize>,
    /// The variable that left last. `None` if that was the covering variable.
    left: Option<usize>,
    ended: Option<PathEnd>,
    pivots: usize,
    most: usize,
}

/// The rows common to all problems, (I + R / k) F − R v = start, divided by a unit of force: the columns of forces and motions.
pub struct Columns<'a> {
    /// Dependence of forces on motions: R, k and the start.
    pub relation: &'a InterfaceResponse,
    /// The unit (force).
    pub force: f64,
}

impl Columns<'_> {
    /// The right-hand side with only the relation's start; `rows` is at least the number of the relation's rows.
    pub fn start(&self, rows: usize) -> Vec<f64> {
        let mut rhs = vec![0.0; rows];
        for (to, start) in rhs.iter_mut().zip(&self.relation.start) {
            *to = start / self.force;
        }
        rhs
    }

    /// Adds `times` (force) the column of force component j to a column.
    pub fn add_force(&self, j: usize, times: f64, column: &mut [f64]) {
        for (to, r) in column.iter_mut().zip(self.response(j)) {
            *to += times * r / self.relation.stiffness / self.force;
        }
        column[j] += times / self.force;
    }

    /// Adds `times` (length) the column of motion component j to a column.
    pub fn add_motion(&self, j: usize, times: f64, column: &mut [f64]) {
        for (to, r) in column.iter_mut().zip(self.response(j)) {
            *to -= times * r / self.force;
        }
    }

    fn response(&self, j: usize) -> &[f64] {
        let count = self.relation.count();
        &self.relation.response[j * count..(j + 1) * count]
    }
}

/// A unit of force or length: the scale of a problem if it has one.
pub fn positive(scale: f64) -> f64 {
    if scale > 0.0 { scale } else { 1.0 }
}

/// Parameters for starting a path.
#[derive(Clone, Copy)]
pub struct PathStart<'a> {
    /// Relaxation of each row by the covering variable; positive.
    pub cover: &'a dyn Fn(usize) -> f64,
    /// Shift of each row. `None` to break ties lexicographically.
    pub shift: Option<&'a dyn Fn(usize) -> f64>,
    /// Maximum number of pivots of the path, per row.
    pub pivots: usize,
}

impl PathStart<'_> {
    /// All rows are relaxed equally, and ties are broken lexicographically.
    pub const PLAIN: PathStart<'static> = PathStart {
        cover: &|_| 1.0,
        shift: None,
        pivots: PIVOTS,
    };
}

/// Result of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PathEnd {
    /// The basis solves the problem.
    Solved,
    /// Nothing bounds the entering variable: this start leads to no solution.
    Ray,
    /// It reached the maximum number of pivots.
    Astray,
}

impl PathEnd {
    /// Where a search continues from this step of a path: after a path without a solution, at the next start.
    pub fn next(ended: Option<PathEnd>, start: usize, step: usize) -> SearchProgress {
        match ended {
            None => SearchProgress::At { start, step },
            Some(PathEnd::Solved) => SearchProgress::Found { start },
            Some(PathEnd::Ray | PathEnd::Astray) => SearchProgress::At {
                start: start + 1,
                step: 0,
            },
        }
    }
}

impl Tableau {
    /// A tableau with this number of rows and no variables.
    pub fn new(rows: usize) -> Self {
        Tableau {
            rows,
            ..Self::default()
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of pivots done.
    pub fn pivots(&self) -> usize {
        self.pivots.min(self.most)
    }

    /// Number of variables so far.
    pub fn variables(&self) -> usize {
        self.partners.len()
    }

    /// Adds a variable with its column, initially zero; `partner` is the index of its complement, or its own if it is loose.
    pub fn add(&mut self, partner: usize, fill: impl FnOnce(&mut [f64])) {
        self.partners.push(partner);
        let from = self.table.len();
        self.table.resize(from + self.rows, 0.0);
        fill(&mut self.table[from..]);
    }

    /// The column of a variable, before the path starts.
    pub fn column(&mut self, variable: usize) -> &mut [f64] {
        &mut self.table[variable * self.rows..(variable + 1) * self.rows]
    }

    /// Starts the path from a basis (one variable per row, ascending). `None` if it is singular.
    pub fn start(&mut self, basis: Vec<usize>, rhs: Vec<f64>, begin: PathStart<'_>) -> Option<()> {
        let (rows, cover) = (self.rows, self.variables());
        self.basis = basis;
        self.row_of = vec![None; cover + 1];
        for (row, &variable) in self.basis.iter().enumerate() {
            self.row_of[variable] = Some(row);
        }
        self.first.clone_from(&self.basis);
        self.table.extend(vec![0.0; rows]);
        self.table.extend(rhs);
        self.reduce()?;
        self.most = begin.pivots * rows;
        for row in 0..rows {
            let loose = self.is_loose(row);
            self.table[cover * rows + row] = if loose { 0.0 } else { -(begin.cover)(row) };
        }
        if let Some(shift) = begin.shift {
            self.shifted = true;
            self.table.extend_from_within((cover + 1) * rows..);
            let values = &mut self.table[(cover + 1) * rows..(cover + 2) * rows];
            for (row, value) in values.iter_mut().enumerate() {
                *value += shift(row);
            }
        }
        let all_hold = (0..rows).all(|row| self.is_loose(row) || self.truth(row) >= 0.0);
        if all_hold {
            self.ended = Some(PathEnd::Solved);
        }
        Some(())
    }

    /// Multiplies the tableau by the inverse of the basis. Rows in which a basic variable has its only entry, a one, follow from the
    /// other rows, which alone are factored; columns of the basis become unit vectors.
    fn reduce(&mut self) -> Option<()> {
        let rows = self.rows;
        let mut single = vec![None; rows];
        let mut own = Vec::new();
        for (place, &variable) in self.basis.iter().enumerate() {
            let column = &self.table[variable * rows..(variable + 1) * rows];
            let mut entries = (0..rows).filter(|&row| column[row] != 0.0);
            match (entries.next(), entries.next()) {
                (Some(row), None) if column[row] == 1.0 && single[row].is_none() => {
                    single[row] = Some(place);
                }
                _ => own.push(place),
            }
        }
        let kept: Vec<usize> = (0..rows).filter(|&row| single[row].is_none()).collect();
        let basic = |place: usize| &self.table[self.basis[place] * rows..][..rows];
        let matrix: Vec<f64> = own
            .iter()
            .flat_map(|&place| kept.iter().map(move |&row| basic(place)[row]))
            .collect();
        let entries = |(row, place): (usize, &usize)| {
            let entries: Vec<(usize, f64)> = own
                .iter()
                .enumerate()
                .map(|(k, &other)| (k, basic(other)[row]))
                .filter(|(_, x)| *x != 0.0)
                .collect();
            (row, *place, entries)
        };
        let following: Vec<_> = single
            .iter()
            .enumerate()
            .filter_map(|(row, place)| Some((row, place.as_ref()?)))
            .map(entries)
            .collect();
        let columns = self.table.len() / rows.max(1);
        let others: Vec<usize> = (0..columns)
            .filter(|&column| self.row_of.get(column).is_none_or(Option::is_none))
            .collect();
        let mut dense = DenseFactors::new(kept.len(), others.len()).ok()?;
        dense.factor(&matrix);
        if dense.inverse_norm() > SINGULAR {
            return None;
        }
        let table = &self.table;
        let mut solved: Vec<f64> = others
            .iter()
            .flat_map(|&column| kept.iter().map(move |&row| table[column * rows + row]))
            .collect();
        dense.solve(&mut solved).ok()?;
        let mut new = vec![0.0; rows];
        for (k, &column) in others.iter().enumerate() {
            let solved = &solved[k * kept.len()..(k + 1) * kept.len()];
            let old = &mut self.table[column * rows..(column + 1) * rows];
            for (row, place, entries) in &following {
                let sum: f64 = entries.iter().map(|(k, x)| x * solved[*k]).sum();
                new[*place] = old[*row] - sum;
            }
            own.iter()
                .zip(solved)
                .for_each(|(&place, &x)| new[place] = x);
            old.copy_from_slice(&new);
        }
        for (place, &variable) in self.basis.iter().enumerate() {
            let column = &mut self.table[variable * rows..(variable + 1) * rows];
            column.fill(0.0);
            column[place] = 1.0;
        }
        Some(())
    }

    fn is_loose(&self, row: usize) -> bool {
        let variable = self.basis[row];
        self.partners.get(variable) == Some(&variable)
    }

    fn value(&self, row: usize) -> f64 {
        self.table[(self.variables() + 1) * self.rows + row]
    }

    /// The value without shift.
    fn truth(&self, row: usize) -> f64 {
        self.table[(self.variables() + 1 + usize::from(self.shifted)) * self.rows + row]
    }

    /// Whether a variable is in the basis.
    pub fn is_basic(&self, variable: usize) -> bool {
        self.row_of[variable].is_some()
    }

    /// The value of a variable.
    pub fn of(&self, variable: usize) -> f64 {
        self.row_of[variable].map_or(0.0, |row| self.truth(row))
    }

    /// Result of the path. `None` while it continues.
    pub fn ended(&self) -> Option<PathEnd> {
        self.ended
    }

    /// The variable that left last. `None` if that was the covering variable, or before the first pivot.
    pub fn left(&self) -> Option<usize> {
        self.left
    }

    /// The covering variable: remaining relaxation of the problem.
    pub fn cover(&self) -> f64 {
        match self.row_of[self.variables()] {
            Some(row) => self.value(row),
            None if self.ended == Some(PathEnd::Solved) => 0.0,
            None => (0..self.rows)
                .filter(|&row| !self.is_loose(row))
                .fold(0.0, |most, row| most.max(-self.value(row))),
        }
    }

    /// One pivot. `None` if the path has already ended.
    pub fn pivot(&mut self) -> Option<()> {
        if self.ended.is_some() {
            return None;
        }
        self.pivots += 1;
        if self.pivots > self.most {
            self.ended = Some(PathEnd::Astray);
            return Some(());
        }
        let cover = self.variables();
        let (entering, row) = match self.entering {
            None => (cover, self.most_broken()?),
            Some(entering) => match self.bounding(entering) {
                Some(row) => (entering, row),
                None => {
                    self.ended = Some(PathEnd::Ray);
                    return Some(());
                }
            },
        };
        let leaving = self.basis[row];
        self.left = (leaving != cover).then_some(leaving);
        self.exchange(entering, row);
        if leaving == cover {
            (self.ended, self.entering) = (Some(PathEnd::Solved), None);
        } else {
            self.entering = Some(self.partners[leaving]);
        }
        Some(())
    }

    /// The row with the most negative value.
    fn most_broken(&self) -> Option<usize> {
        let rows = (0..self.rows).filter(|&row| !self.is_loose(row));
        let covers = |row: usize| -self.table[self.variables() * self.rows + row];
        rows.reduce(|best, row| {
            if self.comes_before(row, best, covers) {
                row
            } else {
                best
            }
        })
    }

    /// The row that bounds an entering variable: the one with the smallest ratio; among ties, the covering variable's row first,
    /// then lexicographically.
    fn bounding(&self, entering: usize) -> Option<usize> {
        let column = &self.table[entering * self.rows..(entering + 1) * self.rows];
        let tiny = if self.shifted { TINY_SHIFTED } else { TINY };
        let tiny = tiny * max_abs(column);
        (0..self.rows)
            .filter(|&row| column[row] > tiny && !self.is_loose(row))
            .reduce(|best, row| {
                let ratio = |row: usize| self.value(row) / column[row];
                let tied = (ratio(row) - ratio(best)).abs() <= TIE;
                let cover = self.variables();
                if tied && self.basis[best] == cover {
                    return best;
                }
                let first = tied && self.basis[row] == cover;
                if first || self.comes_before(row, best, |row| column[row]) {
                    row
                } else {
                    best
                }
            })
    }

    /// Whether a row is lexicographically less than another, each divided by its divisor.
    fn comes_before(&self, row: usize, other: usize, divisor: impl Fn(usize) -> f64) -> bool {
        let (mine, its) = (divisor(row), divisor(other));
        let gap = self.value(row) / mine - self.value(other) / its;
        if gap.abs() > TIE || self.shifted {
            return gap < 0.0;
        }
        for &v in &self.first {
            let of = |row: usize| self.table[v * self.rows + row];
            let gap = of(row) / mine - of(other) / its;
            if gap.abs() > TIE {
                return gap < 0.0;
            }
        }
        false
    }

    fn exchange(&mut self, entering: usize, row: usize) {
        let rows = self.rows;
        let column: Vec<f64> = self.table[entering * rows..(entering + 1) * rows].to_vec();
        let pivot = column[row];
        for other in self.table.chunks_exact_mut(rows) {
            let times = other[row] / pivot;
            if times != 0.0 {
                for (x, c) in other.iter_mut().zip(&column) {
                    *x -= times * c;
                }
            }
            other[row] = times;
        }
        self.row_of[self.basis[row]] = None;
        self.row_of[entering] = Some(row);
        self.basis[row] = entering;
    }
}
