//! Multifrontal LU for small systems: an order found once, dense fronts, and no work repeated where nothing changed.
//!
//! Unknowns come in groups (a node's displacements with the interface forces on it); groups that see the same others are
//! one. Groups are eliminated by least degree. A front holds the rows and columns of a group's unknowns and of the later
//! ones that they see, assembled from the matrix' own entries and what earlier fronts leave of theirs:
//!
//! ```text
//! F = [F_11 F_12; F_21 F_22],      P F_11 Q = L_11 U_11,      F_22 − F_21 F_11⁻¹ F_12  goes to the parent.
//! ```
//!
//! Pivots are sought inside F_11 only; a saddle point whose unknowns are in one group finds its pivots there. A pivot must
//! not be much smaller than what it eliminates; if there is none, the general method of [`super::Factors`] takes over.
//!
//! A front is factored again only if its own entries, or a child's remainder, have changed since the last time. So the
//! minor iterations of a major one repeat only what depends on the modes that changed, with the same bits as a full
//! factorization.

use super::check::SolveError;
use super::pattern::Pattern;
use std::collections::{BTreeMap, BTreeSet};

/// A pivot must be larger than this part of the largest entry below in its column.
const THRESHOLD: f64 = 1e-6;
/// Largest size of a front for which these plain loops are fast enough.
const LARGEST: usize = 160;
/// Largest number of unknowns for which this plain way of finding an order is fast enough.
const MOST: usize = 4000;

/// A front; its matrix is stored column by column.
struct Front {
    /// The unknowns eliminated here, then those that come later.
    unknowns: Vec<usize>,
    /// How many are eliminated here.
    pivots: usize,
    /// Entries of the matrix that are assembled here: place among its values, and in the front.
    entries: Vec<(usize, usize)>,
    children: Vec<Child>,
    /// Where its matrix begins.
    start: usize,
    /// Row and column that each step eliminated, as steps of exchange.
    rows: Vec<usize>,
    columns: Vec<usize>,
    changed: bool,
}

/// An earlier front whose remainder is assembled in a later one.
struct Child {
    front: usize,
    /// Place of its later unknowns in the parent.
    places: Vec<usize>,
}

/// The fronts of a pattern, with their factors.
pub struct Fronts {
    /// Children before parents.
    fronts: Vec<Front>,
    store: Vec<f64>,
    /// The values that were factored last; only meaningful if `ready`.
    values: Vec<f64>,
    ready: bool,
    work: Vec<f64>,
}

impl Fronts {
    /// Finds an order for a pattern with a symmetric structure; `groups` is the number of each unknown's group.
    /// `None` if the fronts would be too large for this method.
    pub fn new(pattern: &Pattern, groups: &[usize]) -> Option<Self> {
        if groups.len() > MOST {
            return None;
        }
        let clusters = clusters(pattern, groups);
        let order = order(&clusters)?;
        let mut fronts = lay_out(&clusters, &order)?;
        assign(pattern, &mut fronts);
        let mut length = 0;
        for front in &mut fronts {
            front.start = length;
            length += front.unknowns.len().pow(2);
        }
        let largest = fronts.iter().map(|f| f.unknowns.len()).max().unwrap_or(0);
        Some(Fronts {
            fronts,
            store: vec![0.0; length],
            values: vec![0.0; pattern.entries()],
            ready: false,
            work: vec![0.0; largest],
        })
    }

    /// Factors the matrix with these values, in the order of the pattern.
    ///
    /// # Errors
    /// [`SolveError::Singular`] where a front has no pivot that is large enough.
    pub fn factor(&mut self, values: &[f64]) -> Result<(), SolveError> {
        let all = !std::mem::replace(&mut self.ready, false);
        for k in 0..self.fronts.len() {
            let (done, rest) = self.fronts.split_at_mut(k);
            let Some(front) = rest.first_mut() else { break };
            let old = &self.values;
            front.changed = all
                || front.children.iter().any(|c| done[c.front].changed)
                || front.entries.iter().any(|&(e, _)| values[e] != old[e]);
            if !front.changed {
                continue;
            }
            let size = front.unknowns.len();
            let (before, own) = self.store.split_at_mut(front.start);
            let matrix = &mut own[..size * size];
            matrix.fill(0.0);
            for &(entry, place) in &front.entries {
                matrix[place] += values[entry];
            }
            for child in &front.children {
                add_remainder(&done[child.front], before, &child.places, size, matrix);
            }
            front.eliminate(matrix)?;
        }
        self.values.copy_from_slice(values);
        self.ready = true;
        Ok(())
    }

    /// Solves A x = b, b given in `x`.
    pub fn solve(&mut self, x: &mut [f64]) {
        for front in &self.fronts {
            front.forward(&self.store[front.start..], &mut self.work, x);
        }
        for front in self.fronts.iter().rev() {
            front.backward(&self.store[front.start..], &mut self.work, x);
        }
    }
}

/// Adds what a front left of its later unknowns.
fn add_remainder(child: &Front, store: &[f64], places: &[usize], size: usize, matrix: &mut [f64]) {
    let (own, pivots) = (child.unknowns.len(), child.pivots);
    let remainder = &store[child.start + pivots * own..child.start + own * own];
    for (column, &to) in remainder.chunks_exact(own).zip(places) {
        let to = &mut matrix[to * size..(to + 1) * size];
        for (value, &row) in column[pivots..].iter().zip(places) {
            to[row] += value;
        }
    }
}

impl Front {
    fn eliminate(&mut self, matrix: &mut [f64]) -> Result<(), SolveError> {
        let size = self.unknowns.len();
        for k in 0..self.pivots {
            let (row, column) = pivot(matrix, size, k, self.pivots).ok_or(SolveError::Singular)?;
            (self.rows[k], self.columns[k]) = (row, column);
            if column != k {
                let (first, second) = matrix.split_at_mut(column * size);
                first[k * size..(k + 1) * size].swap_with_slice(&mut second[..size]);
            }
            if row != k {
                for column in matrix.chunks_exact_mut(size) {
                    column.swap(k, row);
                }
            }
            let (done, rest) = matrix.split_at_mut((k + 1) * size);
            let factors = &mut done[k * size + k..];
            let (head, lower) = factors.split_at_mut(1);
            let inverse = 1.0 / head[0];
            for value in lower.iter_mut() {
                *value *= inverse;
            }
            for column in rest.chunks_exact_mut(size) {
                let factor = column[k];
                if factor != 0.0 {
                    for (value, lower) in column[k + 1..].iter_mut().zip(lower.iter()) {
                        *value -= factor * lower;
                    }
                }
            }
        }
        Ok(())
    }

    fn forward(&self, matrix: &[f64], work: &mut [f64], x: &mut [f64]) {
        let (size, pivots) = (self.unknowns.len(), self.pivots);
        let own = &mut work[..size];
        for (own, &unknown) in own.iter_mut().zip(&self.unknowns) {
            *own = x[unknown];
        }
        // The rows below were exchanged after their part of L was made.
        for (k, &row) in self.rows.iter().enumerate() {
            own.swap(k, row);
        }
        for (k, column) in matrix.chunks_exact(size).take(pivots).enumerate() {
            let value = own[k];
            if value != 0.0 {
                for (own, lower) in own[k + 1..].iter_mut().zip(&column[k + 1..]) {
                    *own -= value * lower;
                }
            }
        }
        for (own, &unknown) in own.iter().zip(&self.unknowns) {
            x[unknown] = *own;
        }
    }

    fn backward(&self, matrix: &[f64], work: &mut [f64], x: &mut [f64]) {
        let (size, pivots) = (self.unknowns.len(), self.pivots);
        let own = &mut work[..size];
        for (own, &unknown) in own.iter_mut().zip(&self.unknowns) {
            *own = x[unknown];
        }
        for k in (0..size).rev() {
            let column = &matrix[k * size..(k + 1) * size];
            let above = k.min(pivots);
            if k < pivots {
                own[k] /= column[k];
            }
            let value = own[k];
            if value != 0.0 {
                for (own, upper) in own[..above].iter_mut().zip(column) {
                    *own -= value * upper;
                }
            }
        }
        for (k, &column) in self.columns.iter().enumerate().rev() {
            own.swap(k, column);
        }
        for (own, &unknown) in own.iter().zip(&self.unknowns).take(pivots) {
            x[unknown] = *own;
        }
    }
}

/// The pivot of step k: in the first column that has one, the largest entry of the rows that may be taken.
fn pivot(matrix: &[f64], size: usize, k: usize, pivots: usize) -> Option<(usize, usize)> {
    (k..pivots).find_map(|c| {
        let column = &matrix[c * size..(c + 1) * size];
        let largest = |mut best: (usize, f64), (row, value): (usize, &f64)| {
            if value.abs() > best.1 {
                best = (row, value.abs());
            }
            best
        };
        let own = column[k..pivots].iter().enumerate().fold((0, 0.0), largest);
        let rest = column[pivots..].iter().enumerate().fold((0, 0.0), largest);
        (own.1 > THRESHOLD * rest.1 && own.1.is_finite()).then_some((k + own.0, c))
    })
}

/// Groups of unknowns that are eliminated together, and what they see.
struct Clusters {
    members: Vec<Vec<usize>>,
    /// Other clusters.
    neighbours: Vec<BTreeSet<usize>>,
}

/// The groups, those that see the same being one.
fn clusters(pattern: &Pattern, groups: &[usize]) -> Clusters {
    let count = groups.iter().max().map_or(0, |most| most + 1);
    let mut sees = vec![BTreeSet::new(); count];
    for (row, column) in pattern.iter() {
        sees[groups[row]].insert(groups[column]);
        sees[groups[column]].insert(groups[row]);
    }
    let mut alike: BTreeMap<&BTreeSet<usize>, usize> = BTreeMap::new();
    let mut cluster = vec![0; count];
    for (group, seen) in sees.iter().enumerate().filter(|(_, seen)| !seen.is_empty()) {
        let next = alike.len();
        cluster[group] = *alike.entry(seen).or_insert(next);
    }
    let mut members = vec![Vec::new(); alike.len()];
    for (unknown, &group) in groups.iter().enumerate() {
        members[cluster[group]].push(unknown);
    }
    let mut neighbours = vec![BTreeSet::new(); alike.len()];
    for (seen, &own) in &alike {
        neighbours[own].extend(seen.iter().map(|&g| cluster[g]).filter(|&c| c != own));
    }
    Clusters {
        members,
        neighbours,
    }
}

/// Clusters in the order of their elimination, each with those that it sees then.
fn order(clusters: &Clusters) -> Option<Vec<(usize, Vec<usize>)>> {
    let mut graph = clusters.neighbours.clone();
    let weight = |c: usize| clusters.members[c].len();
    let degree = |seen: &BTreeSet<usize>| seen.iter().map(|&c| weight(c)).sum::<usize>();
    let mut queue: BTreeSet<(usize, usize)> =
        (0..graph.len()).map(|c| (degree(&graph[c]), c)).collect();
    let mut order = Vec::with_capacity(graph.len());
    while let Some((seen_by, cluster)) = queue.pop_first() {
        if seen_by + weight(cluster) > LARGEST {
            return None;
        }
        let seen: Vec<usize> = std::mem::take(&mut graph[cluster]).into_iter().collect();
        for &other in &seen {
            queue.remove(&(degree(&graph[other]), other));
            graph[other].remove(&cluster);
            graph[other].extend(seen.iter().filter(|&&c| c != other));
            queue.insert((degree(&graph[other]), other));
        }
        order.push((cluster, seen));
    }
    Some(order)
}

/// Fronts of the clusters; one that only hands on what its one child leaves is joined with it.
fn lay_out(clusters: &Clusters, order: &[(usize, Vec<usize>)]) -> Option<Vec<Front>> {
    let mut step = vec![0; order.len()];
    for (k, (cluster, _)) in order.iter().enumerate() {
        step[*cluster] = k;
    }
    let mut fronts: Vec<Front> = Vec::new();
    // The fronts whose remainder each step takes.
    let mut waiting: Vec<Vec<usize>> = vec![Vec::new(); order.len()];
    for (k, (cluster, seen)) in order.iter().enumerate() {
        let mut later = seen.clone();
        later.sort_unstable_by_key(|&c| step[c]);
        let own = &clusters.members[*cluster];
        let width = own.len()
            + later
                .iter()
                .map(|&c| clusters.members[c].len())
                .sum::<usize>();
        let children = std::mem::take(&mut waiting[k]);
        let next = later.first().map(|&c| step[c]);
        if let [only] = children[..] {
            let child = &mut fronts[only];
            if child.unknowns.len() - child.pivots == width {
                child.pivots += own.len();
                next.into_iter().for_each(|next| waiting[next].push(only));
                continue;
            }
        }
        next.into_iter()
            .for_each(|next| waiting[next].push(fronts.len()));
        let unknowns = own
            .iter()
            .chain(later.iter().flat_map(|&c| &clusters.members[c]));
        fronts.push(Front {
            unknowns: unknowns.copied().collect(),
            pivots: own.len(),
            entries: Vec::new(),
            children: children
                .into_iter()
                .map(|front| Child {
                    front,
                    places: Vec::new(),
                })
                .collect(),
            start: 0,
            rows: Vec::new(),
            columns: Vec::new(),
            changed: true,
        });
    }
    for k in 0..fronts.len() {
        let mut children = std::mem::take(&mut fronts[k].children);
        for child in &mut children {
            let from = &fronts[child.front];
            let later = &from.unknowns[from.pivots..];
            let place = |unknown| fronts[k].unknowns.iter().position(|u| u == unknown);
            child.places = later.iter().map(place).collect::<Option<_>>()?;
        }
        let front = &mut fronts[k];
        front.children = children;
        (front.rows, front.columns) = (vec![0; front.pivots], vec![0; front.pivots]);
    }
    Some(fronts)
}

/// Gives every entry of the matrix to the front that eliminates the first of its two unknowns.
fn assign(pattern: &Pattern, fronts: &mut [Front]) {
    let mut eliminated = vec![(0, 0); pattern.size()];
    for (f, front) in fronts.iter().enumerate() {
        for (place, &unknown) in front.unknowns[..front.pivots].iter().enumerate() {
            eliminated[unknown] = (f, place);
        }
    }
    for (entry, (row, column)) in pattern.iter().enumerate() {
        let front = &mut fronts[eliminated[row].0.min(eliminated[column].0)];
        let place = |unknown| front.unknowns.iter().position(|&u| u == unknown);
        if let (Some(i), Some(j)) = (place(row), place(column)) {
            front.entries.push((entry, j * front.unknowns.len() + i));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of saddle points: two stiff displacements and a constraint force a group.
    fn chain(count: usize) -> (Pattern, Vec<usize>, Vec<f64>) {
        let n = 3 * count;
        let mut entries = Vec::new();
        for i in 0..n {
            for j in 0..n {
                let (a, b) = (i / 3, j / 3);
                let force = i % 3 == 2 || j % 3 == 2;
                if a == b || (a.abs_diff(b) <= 1 && !force) {
                    entries.push((i, j));
                }
            }
        }
        let pattern = Pattern::new(n, entries);
        let value = |i: usize, j: usize| match (i % 3, j % 3) {
            (2, 2) => 0.0,
            (2, k) | (k, 2) => [0.6, -0.8][k],
            _ if i == j => 3.0,
            _ => -0.5 + 0.01 * ((7 * i + 3 * j) % 11) as f64,
        };
        let values = pattern.iter().map(|(i, j)| value(i, j)).collect();
        (pattern, (0..n).map(|i| i / 3).collect(), values)
    }

    fn solve(fronts: &mut Fronts, pattern: &Pattern, values: &[f64]) -> (Vec<f64>, f64) {
        fronts.factor(values).unwrap();
        let exact: Vec<f64> = (0..pattern.size()).map(|i| (i as f64).cos()).collect();
        let mut x = vec![0.0; exact.len()];
        pattern.multiply(values, &exact, &mut x);
        fronts.solve(&mut x);
        let apart = x.iter().zip(&exact).map(|(x, e)| (x - e).abs());
        let worst = apart.fold(0.0, f64::max);
        (x, worst)
    }

    #[test]
    fn saddle_points_are_solved_and_what_did_not_change_keeps_its_bits() {
        let (pattern, groups, mut values) = chain(40);
        let mut fronts = Fronts::new(&pattern, &groups).unwrap();
        assert!(solve(&mut fronts, &pattern, &values).1 < 1e-12);
        // One constraint gives way: its force vanishes instead.
        for (value, (i, j)) in values.iter_mut().zip(pattern.iter()) {
            if i == 62 {
                *value = if j == 62 { 1.0 } else { 0.0 };
            }
        }
        let (again, worst) = solve(&mut fronts, &pattern, &values);
        assert!(worst < 1e-12);
        assert!(
            fronts.fronts.iter().any(|f| !f.changed) && fronts.fronts.iter().any(|f| f.changed)
        );
        let (anew, _) = solve(
            &mut Fronts::new(&pattern, &groups).unwrap(),
            &pattern,
            &values,
        );
        assert_eq!(again, anew);
    }

    #[test]
    fn a_matrix_without_pivots_in_its_groups_is_refused() {
        let (pattern, groups, mut values) = chain(3);
        for (value, (i, j)) in values.iter_mut().zip(pattern.iter()) {
            if i == 5 || j == 5 {
                *value = 0.0;
            }
        }
        let mut fronts = Fronts::new(&pattern, &groups).unwrap();
        assert_eq!(fronts.factor(&values), Err(SolveError::Singular));
    }
}
