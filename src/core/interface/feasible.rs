//! Feasibility of linear conditions: simplex tableaus over bounded affine forms.
//!
//! A form is c + a·z in free coordinates z, and has a lower and an upper bound, either of which may be infinite. As many forms as
//! there are coordinates represent the coordinates (the columns of the tableau); all others are expressed by them (its rows).
//! [`BoundedForms::can_hold`] moves the forms into their bounds by the dual simplex method with long steps. The objective does not
//! matter, so its costs are arbitrary, and bounds may change at any time without restarting.
//!
//! Infeasible" is a proof: one row violates its bound for all values of the columns within theirs (Farkas). The row is checked
//! against the original forms, with an allowance for round-off; without such a proof the problem counts as feasible

use crate::plane::max_abs;

/// A coefficient below this fraction of the largest in its row cannot be a pivot.
const TINY: f64 = 1e-9;
/// Allowed round-off in a row, relative to the sum of its terms' magnitudes.
const ROUND_OFF: f64 = 1e-11;
/// Number of pivots after which the tableau is rebuilt from the forms.
const FRESH: usize = 200;
/// Magnitude of the coordinates up to which a row with round-off still proves infeasibility.
const REACH: f64 = 1e6;

/// Affine forms with bounds.
#[derive(Debug, Clone)]
pub struct BoundedForms {
    /// Number of coordinates.
    count: usize,
    /// A row of `count` coefficients and a constant per form.
    forms: Vec<f64>,
    /// Lower and upper bound of each form.
    bounds: Vec<[f64; 2]>,
    /// Relaxation of each bound.
    slack: f64,
    /// Rows of the tableau, like `forms`, but in terms of the columns' forms.
    table: Vec<f64>,
    /// The form of each row, and of each column.
    rows: Vec<usize>,
    columns: Vec<usize>,
    /// Value of each form.
    values: Vec<f64>,
    /// Cost per increase of each column's form.
    prices: Vec<f64>,
    candidates: Vec<(f64, usize)>,
    since: usize,
}

impl BoundedForms {
    /// Forms of `count` coordinates in sequence (coefficients, then the constant), initially unbounded; all bounds are relaxed by
    /// `slack`. `None` if they do not determine the coordinates.
    pub fn new(count: usize, forms: Vec<f64>, slack: f64) -> Option<BoundedForms> {
        let all = forms.len() / (count + 1);
        let mut made = BoundedForms {
            count,
            forms,
            bounds: vec![[f64::NEG_INFINITY, f64::INFINITY]; all],
            slack,
            table: Vec::new(),
            rows: Vec::new(),
            columns: Vec::new(),
            values: vec![0.0; all],
            prices: vec![0.0; count],
            candidates: Vec::new(),
            since: 0,
        };
        let any: Vec<usize> = (0..all).collect();
        made.make(&any)?;
        Some(made)
    }

    /// Sets a form's bounds.
    pub fn bound(&mut self, form: usize, low: f64, high: f64) {
        self.bounds[form] = [low - self.slack, high + self.slack];
    }

    /// Value of a form at the last point.
    pub fn value(&self, form: usize) -> f64 {
        self.values[form]
    }

    fn width(&self) -> usize {
        self.count + 1
    }

    /// Builds the tableau from the forms; its columns are selected among `from`.
    fn make(&mut self, from: &[usize]) -> Option<()> {
        let (width, all) = (self.width(), self.bounds.len());
        let mut table = self.forms.clone();
        let mut column_of: Vec<Option<usize>> = vec![None; self.count];
        let mut taken = vec![false; all];
        for _ in 0..self.count {
            let (mut at, mut largest) = ((0, 0), 0.0);
            for &row in from.iter().filter(|&&row| !taken[row]) {
                for column in (0..self.count).filter(|&c| column_of[c].is_none()) {
                    let size = table[row * width + column].abs();
                    if size > largest {
                        (at, largest) = ((row, column), size);
                    }
                }
            }
            if largest < 1e-13 {
                return None;
            }
            exchange(&mut table, width, at.0, at.1);
            taken[at.0] = true;
            column_of[at.1] = Some(at.0);
        }
        self.columns = column_of.into_iter().flatten().collect();
        self.rows = (0..all).filter(|&row| !taken[row]).collect();
        self.table.clear();
        for &row in &self.rows {
            self.table
                .extend_from_slice(&table[row * width..(row + 1) * width]);
        }
        self.since = 0;
        self.prices.fill(0.0);
        self.evaluate();
        Some(())
    }

    /// Computes the values of the rows' forms from those of the columns.
    fn evaluate(&mut self) {
        let width = self.width();
        for (row, line) in self.rows.iter().zip(self.table.chunks_exact(width)) {
            let sum: f64 = line
                .iter()
                .zip(&self.columns)
                .map(|(x, &c)| x * self.values[c])
                .sum();
            self.values[*row] = sum + line[self.count];
        }
    }

    /// Moves the columns' forms to the bounds with the lower cost.
    fn clamp(&mut self) {
        let mut moved = false;
        for (column, &form) in self.columns.iter().enumerate() {
            let [low, high] = self.bounds[form];
            let price = &mut self.prices[column];
            if (*price > 0.0 && low.is_infinite()) || (*price < 0.0 && high.is_infinite()) {
                *price = 0.0;
            }
            if *price == 0.0 {
                let own = own_price(form);
                match (low.is_finite(), high.is_finite()) {
                    (true, _) => *price = own,
                    (_, true) => *price = -own,
                    _ => {}
                }
            }
            let value = self.values[form];
            let to = match *price {
                0.0 => value,
                p if p > 0.0 => low,
                _ => high,
            };
            if to != value {
                self.values[form] = to;
                moved = true;
            }
        }
        if moved {
            self.evaluate();
        }
    }

    /// Whether all forms can be within their bounds; false is proven.
    pub fn can_hold(&mut self) -> bool {
        if self.bounds.iter().any(|[low, high]| low > high) {
            return false;
        }
        self.clamp();
        let mut restarted = false;
        for _ in 0..20 * self.bounds.len() {
            let Some((row, to)) = self.broken() else {
                return true;
            };
            match self.entering(row, to) {
                Some(column) => self.pivot(row, column, to),
                None if self.is_proven(row, to) => return false,
                None if self.since > 0 => self.renew(),
                // These columns may determine the coordinates badly; others may give a proof.
                None if !restarted => {
                    restarted = true;
                    self.restart();
                }
                None => return true,
            }
            if self.since > FRESH {
                self.renew();
            }
        }
        true
    }

    /// The row that violates its bounds most, with the violated bound.
    fn broken(&self) -> Option<(usize, f64)> {
        let (mut found, mut most) = (None, 0.1 * self.slack);
        for (row, &form) in self.rows.iter().enumerate() {
            let ([low, high], value) = (self.bounds[form], self.values[form]);
            let (missed, to) = if value < low {
                (low - value, low)
            } else {
                (value - high, high)
            };
            if missed > most {
                (found, most) = (Some((row, to)), missed);
            }
        }
        found
    }

    /// The column to exchange with a row such that no cost changes its sign; columns that are passed move to their other bound.
    /// `None` if the row still violates its bound.
    fn entering(&mut self, row: usize, to: f64) -> Option<usize> {
        let width = self.width();
        let line = &self.table[row * width..row * width + self.count];
        let missed = to - self.values[self.rows[row]];
        let largest = max_abs(line);
        let candidates = &mut self.candidates;
        candidates.clear();
        for (column, &factor) in line.iter().enumerate() {
            let form = self.columns[column];
            let [low, high] = self.bounds[form];
            let price = self.prices[column];
            let rises = (missed > 0.0) == (factor > 0.0);
            let can = price == 0.0 || rises == (price > 0.0);
            if can && factor.abs() > TINY * largest && high > low {
                candidates.push((price.abs() / factor.abs(), column));
            }
        }
        candidates.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut left = missed.abs();
        let mut passed = 0;
        let mut found = None;
        for &(_, column) in candidates.iter() {
            let form = self.columns[column];
            let factor = line[column].abs();
            let room = match self.prices[column] {
                0.0 => f64::INFINITY,
                _ => self.bounds[form][1] - self.bounds[form][0],
            };
            if left - factor * room <= 0.0 {
                found = Some(column);
                break;
            }
            left -= factor * room;
            passed += 1;
        }
        found?;
        if passed > 0 {
            for k in 0..passed {
                let column = self.candidates[k].1;
                let form = self.columns[column];
                let [low, high] = self.bounds[form];
                let to = if self.prices[column] > 0.0 { high } else { low };
                let step = to - self.values[form];
                self.values[form] = to;
                for (form, line) in self.rows.iter().zip(self.table.chunks_exact(width)) {
                    self.values[*form] += step * line[column];
                }
            }
        }
        found
    }

    /// Rebuilds the tableau with the same columns.
    fn renew(&mut self) {
        let columns = self.columns.clone();
        match self.make(&columns) {
            Some(()) => self.clamp(),
            None => self.restart(),
        }
    }

    /// Rebuilds the tableau with the columns that determine the coordinates best.
    fn restart(&mut self) {
        let any: Vec<usize> = (0..self.bounds.len()).collect();
        // They determined the coordinates initially.
        let _ = self.make(&any);
        self.clamp();
    }

    /// Replaces a form that is not a column by a sum of others with the upper bound `high`. False if it is a column.
    pub fn replace(&mut self, form: usize, sum: &[(usize, f64)], high: f64) -> bool {
        let width = self.width();
        let Some(row) = self.rows.iter().position(|&f| f == form) else {
            return false;
        };
        let (mut own, mut line) = (vec![0.0; width], vec![0.0; width]);
        for &(other, times) in sum {
            let from = &self.forms[other * width..(other + 1) * width];
            own.iter_mut().zip(from).for_each(|(x, y)| *x += times * y);
            match self.rows.iter().position(|&f| f == other) {
                Some(r) => {
                    let from = &self.table[r * width..(r + 1) * width];
                    line.iter_mut().zip(from).for_each(|(x, y)| *x += times * y);
                }
                None => {
                    let column = self.columns.iter().position(|&f| f == other);
                    if let Some(column) = column {
                        line[column] += times;
                    }
                }
            }
        }
        self.forms[form * width..(form + 1) * width].copy_from_slice(&own);
        self.table[row * width..(row + 1) * width].copy_from_slice(&line);
        self.bound(form, f64::NEG_INFINITY, high);
        self.values[form] = sum.iter().map(|&(f, t)| t * self.values[f]).sum();
        true
    }

    fn line(&self, row: usize) -> &[f64] {
        let width = self.width();
        &self.table[row * width..(row + 1) * width]
    }

    /// Exchanges the forms of a row and a column; the row's form takes the value `to`.
    fn pivot(&mut self, row: usize, column: usize, to: f64) {
        let width = self.width();
        let step = (to - self.values[self.rows[row]]) / self.table[row * width + column];
        let price = self.prices[column] / self.table[row * width + column];
        for (p, x) in self
            .prices
            .iter_mut()
            .zip(&self.table[row * width..row * width + self.count])
        {
            *p -= price * x;
        }
        self.prices[column] = price;
        for (form, line) in self.rows.iter().zip(self.table.chunks_exact(width)) {
            self.values[*form] += step * line[column];
        }
        self.values[self.columns[column]] += step;
        self.values[self.rows[row]] = to;
        exchange(&mut self.table, width, row, column);
        std::mem::swap(&mut self.rows[row], &mut self.columns[column]);
        self.since += 1;
    }

    /// Whether a row cannot reach its bound `to` for any values of the columns within their bounds.
    fn is_proven(&self, row: usize, to: f64) -> bool {
        let width = self.width();
        let up = self.values[self.rows[row]] < to;
        let line = self.line(row);
        // Difference between the original form and the row.
        let own = &self.forms[self.rows[row] * width..(self.rows[row] + 1) * width];
        let mut rest: Vec<f64> = own.to_vec();
        let mut sizes: Vec<f64> = own.iter().map(|x| x.abs()).collect();
        let (mut best, mut size) = (0.0, to.abs());
        for (&factor, &form) in line[..self.count].iter().zip(&self.columns) {
            if factor == 0.0 {
                continue;
            }
            let [low, high] = self.bounds[form];
            let end = if up == (factor > 0.0) { high } else { low };
            let other = &self.forms[form * width..(form + 1) * width];
            for ((rest, size), x) in rest.iter_mut().zip(&mut sizes).zip(other) {
                *rest -= factor * x;
                *size += (factor * x).abs();
            }
            if !end.is_finite() {
                // Not usable as a pivot: too small a fraction of the row.
                best += factor.abs() * REACH * if up { 1.0 } else { -1.0 };
                continue;
            }
            best += factor * end;
            size += (factor * end).abs();
        }
        let missing: f64 = rest[..self.count].iter().map(|x| x.abs()).sum::<f64>() * REACH;
        best += rest[self.count];
        size += sizes[self.count];
        let gap = if up { to - best } else { best - to };
        gap > ROUND_OFF * size + missing
    }

    /// An upper bound of a form (times `sign`) while all others are within their bounds; valid even if the maximum was not found.
    /// Requires a feasible point.
    pub fn most(&mut self, form: usize, sign: f64) -> f64 {
        let width = self.width();
        self.prices.fill(0.0);
        let mut best = f64::INFINITY;
        for _ in 0..3 * self.bounds.len() {
            // The form in terms of the columns.
            let mut line = vec![0.0; width];
            match self.rows.iter().position(|&f| f == form) {
                Some(row) => line.copy_from_slice(self.line(row)),
                None => {
                    if let Some(column) = self.columns.iter().position(|&f| f == form) {
                        line[column] = 1.0;
                    }
                }
            }
            let (mut bound, mut size) = (sign * line[self.count], line[self.count].abs());
            let (mut entering, mut most) = (None, 0.0);
            for (column, x) in line[..self.count].iter().enumerate() {
                let factor = sign * x;
                let [low, high] = self.bounds[self.columns[column]];
                let end = if factor > 0.0 { high } else { low };
                if factor != 0.0 {
                    bound += factor * end;
                    size += (factor * end).abs();
                }
                let room = (end - self.values[self.columns[column]]).abs();
                if factor.abs() > 1e-10 && room > self.slack && factor.abs() > most {
                    (entering, most) = (Some((column, factor > 0.0)), factor.abs());
                }
            }
            if bound.is_finite() {
                let mut rest: Vec<f64> = self.forms[form * width..(form + 1) * width].to_vec();
                for (x, &f) in line[..self.count].iter().zip(&self.columns) {
                    let other = &self.forms[f * width..(f + 1) * width];
                    rest.iter_mut().zip(other).for_each(|(r, o)| *r -= x * o);
                }
                let off = (rest[self.count] - line[self.count]).abs()
                    + REACH * rest[..self.count].iter().map(|r| r.abs()).sum::<f64>();
                best = f64::min(best, bound + 1e-9 * size + off);
            }
            let Some((column, up)) = entering else { break };
            // Maximum change of the column.
            let own = self.columns[column];
            let mut step = if up {
                self.bounds[own][1] - self.values[own]
            } else {
                self.values[own] - self.bounds[own][0]
            };
            let mut leaving = None;
            for (row, &other) in self.rows.iter().enumerate() {
                let factor = self.table[row * width + column] * if up { 1.0 } else { -1.0 };
                if factor.abs() < 1e-6 {
                    continue;
                }
                let [low, high] = self.bounds[other];
                let end = if factor > 0.0 { high } else { low };
                let room = ((end - self.values[other]) / factor).max(0.0);
                if room < step {
                    (step, leaving) = (room, Some((row, end)));
                }
            }
            if !step.is_finite() {
                return f64::INFINITY;
            }
            match leaving {
                Some((row, end)) => {
                    self.pivot(row, column, end);
                    if self.since > FRESH {
                        self.renew();
                    }
                }
                None => {
                    let to = if up {
                        self.bounds[own][1]
                    } else {
                        self.bounds[own][0]
                    };
                    self.values[own] = to;
                    self.evaluate();
                }
            }
        }
        best
    }
}

/// Cost of a form; all costs differ, so that no two steps tie.
fn own_price(form: usize) -> f64 {
    1.0 + (0.618_033_988_749_895 * form as f64).fract()
}

/// Exchanges a row and a column of a table of this width, whose last column contains constants.
fn exchange(table: &mut [f64], width: usize, row: usize, column: usize) {
    let pivot = table[row * width + column];
    let line = &mut table[row * width..(row + 1) * width];
    line.iter_mut().for_each(|x| *x /= -pivot);
    line[column] = 1.0 / pivot;
    let line = line.to_vec();
    for (other, own) in table.chunks_exact_mut(width).enumerate() {
        let factor = own[column];
        if other == row || factor == 0.0 {
            continue;
        }
        own[column] = 0.0;
        own.iter_mut()
            .zip(&line)
            .for_each(|(x, y)| *x += factor * y);
    }
}
