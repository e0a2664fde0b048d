//! Multifrontal LU: a fixed elimination order, dense fronts, and no repeated work where nothing changed.
//!
//! Unknowns are grouped (a node's displacements with its interface forces), and [`super::tree`] orders the groups. A front
//! contains the rows and columns of the unknowns that it eliminates and of the later unknowns coupled to them, assembled from the
//! matrix's entries and the remainders of earlier fronts:
//!
//! ```text
//! F = [F_11 F_12; F_21 F_22],      P F_11 Q = L_11 U_11,      R = F_22 − F_21 F_11⁻¹ F_12  goes to the parent.
//! ```
//!
//! Pivots are only searched inside F_11 ([`super::front`]); a saddle point within one group finds its pivots there. Rows and
//! columns without a pivot are delayed: they are passed to the parent with R, where more pivots are available. So only a singular
//! matrix is rejected.
//!
//! A front is factored again only if its entries or a child's remainder have changed. The minor iterations of a major iteration
//! therefore repeat only the parts that depend on changed modes, with the same bits as a full factorization. Remainders are
//! stored if changing rows may need them again, otherwise only until the parent has used them.
//!
//! In the forward substitution, too, a front is repeated only if its factors or the right-hand side of its rows have changed.

use super::check::SolveError;
use super::front::{Front, STEPS, substitute, substitute_back, subtract, subtract_all};
use super::pattern::{Pattern, narrow};
use super::tree::{Node, Tree};

/// A node of the tree, with its factors.
struct FactoredNode {
    node: Node,
    /// Its range of [`Fronts::entries`].
    entries: std::ops::Range<usize>,
    children: Vec<usize>,
    /// Equation and unknown of each pivot, then of the delayed and the later ones.
    rows: Vec<usize>,
    columns: Vec<usize>,
    done: usize,
    /// L with the diagonal of U, and to its right the rest of U; column-major.
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// The remainder for the parent, if stored.
    remainder: Vec<f64>,
    kept: bool,
    changed: bool,
    /// Magnitude of its smallest pivot.
    smallest: f64,
    /// The right-hand side of its rows in the last solve before and after its forward substitution; `solved` if they belong to
    /// its factors.
    before: Vec<f64>,
    after: Vec<f64>,
    solved: bool,
}

/// The fronts of a pattern, with their factors.
pub struct Fronts {
    /// Children before parents.
    fronts: Vec<FactoredNode>,
    /// Entries of the matrix by front: index of the value, and index in the front without delayed unknowns.
    entries: Vec<(u32, u32)>,
    /// The front in which each value is assembled.
    owners: Vec<u32>,
    /// The values factored last; only meaningful if `ready`.
    values: Vec<f64>,
    ready: bool,
    front: Front,
    /// Temporary remainders, the last one on top.
    stack: Vec<f64>,
    /// Workspace for solves: the right-hand side by equation, and that of a front.
    forward: Vec<f64>,
    own: Vec<f64>,
}

impl Fronts {
    /// Computes an elimination order for a pattern; `groups` is the group of each unknown, and rows from `first` on may change
    /// between factorizations.
    ///
    /// # Errors
    /// [`SolveError::OutOfMemory`].
    pub fn new(pattern: &Pattern, groups: &[usize], first: usize) -> Result<Self, SolveError> {
        let tree = Tree::new(pattern, groups, first)?;
        let count = tree.nodes.len();
        let mut children = vec![Vec::new(); count];
        for (k, node) in tree.nodes.iter().enumerate() {
            if let Some(parent) = node.parent {
                children[parent].push(k);
            }
        }
        let changing: Vec<bool> = tree.nodes.iter().map(|node| node.changing).collect();
        let is_kept = |node: &Node| node.parent.is_some_and(|parent| changing[parent]);
        let assigned = assign(pattern, &tree)?;
        let fronts = tree.nodes.into_iter().zip(children).zip(assigned.ranges);
        let fronts = fronts.map(|((node, children), entries)| FactoredNode {
            kept: is_kept(&node),
            node,
            entries,
            children,
            rows: Vec::new(),
            columns: Vec::new(),
            done: 0,
            lower: Vec::new(),
            upper: Vec::new(),
            remainder: Vec::new(),
            changed: true,
            smallest: 0.0,
            before: Vec::new(),
            after: Vec::new(),
            solved: false,
        });
        Ok(Fronts {
            fronts: fronts.collect(),
            entries: assigned.entries,
            owners: assigned.owners,
            values: vec![0.0; pattern.entries()],
            ready: false,
            front: Front::default(),
            stack: Vec::new(),
            forward: vec![0.0; pattern.size()],
            own: Vec::new(),
        })
    }

    /// Factors the matrix with these values, in pattern order. If only some may differ from those of the last call, `only` lists
    /// their indices.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if no pivot is left.
    pub fn factor(&mut self, values: &[f64], only: Option<&[usize]>) -> Result<(), SolveError> {
        self.find_changes(values, only);
        self.ready = false;
        self.stack.clear();
        for k in 0..self.fronts.len() {
            let (done, rest) = self.fronts.split_at_mut(k);
            let Some(own) = rest.first_mut() else { break };
            own.changed |= own.children.iter().any(|&c| done[c].changed);
            if !own.changed {
                continue;
            }
            let entries = &self.entries[own.entries.clone()];
            let assemble = |front: &mut Front, stack: &[f64]| {
                let delayed = own.assemble(done, stack, front);
                own.add_entries(entries, &self.values, delayed, front);
                delayed + own.node.pivots
            };
            let most = assemble(&mut self.front, &self.stack);
            let eliminated = match self.front.eliminate_in_order(most) {
                Some(()) => most,
                None => {
                    assemble(&mut self.front, &self.stack);
                    self.front.eliminate_in_any_order(most)
                }
            };
            if eliminated < most && own.node.parent.is_none() {
                return Err(SolveError::Singular);
            }
            let left: usize = own.children.iter().map(|&c| done[c].on_stack()).sum();
            self.stack.truncate(self.stack.len() - left);
            own.keep(&self.front, eliminated, &mut self.stack);
        }
        self.ready = true;
        Ok(())
    }

    /// Finds the fronts whose own entries have changed. If a changed front's children have no stored remainders, all fronts are
    /// factored.
    fn find_changes(&mut self, values: &[f64], only: Option<&[usize]>) {
        let mut all = !self.ready;
        self.fronts
            .iter_mut()
            .for_each(|front| front.changed = false);
        let mut compare = |k: usize| {
            if self.values[k] != values[k] {
                self.values[k] = values[k];
                let front = &mut self.fronts[self.owners[k] as usize];
                front.changed = true;
                all |= !front.node.changing;
            }
        };
        match only {
            Some(only) => only.iter().for_each(|&k| compare(k)),
            None => (0..values.len()).for_each(compare),
        }
        if all {
            self.fronts
                .iter_mut()
                .for_each(|front| front.changed = true);
        }
    }

    /// Magnitude of the smallest pivot.
    pub fn smallest_pivot(&self) -> f64 {
        let pivots = self.fronts.iter().map(|front| front.smallest);
        pivots.fold(f64::INFINITY, f64::min)
    }

    /// Solves A x = b; `x` contains b on entry.
    pub fn solve(&mut self, x: &mut [f64]) {
        self.forward.copy_from_slice(x);
        for front in &mut self.fronts {
            front.substitute(&mut self.own, &mut self.forward);
        }
        for front in self.fronts.iter().rev() {
            front.backward(&mut self.own, x);
        }
    }
}

impl FactoredNode {
    /// Number of rows, and of columns, passed to its parent.
    fn left(&self) -> usize {
        self.rows.len() - self.done
    }

    fn delayed(&self) -> usize {
        self.left() - self.node.places.len()
    }

    /// Length of its remainder on the stack.
    fn on_stack(&self) -> usize {
        if self.kept { 0 } else { self.left().pow(2) }
    }

    /// Assembles its children's remainders; returns the number of their delayed unknowns, which come first.
    fn assemble(&self, done: &[FactoredNode], stack: &[f64], front: &mut Front) -> usize {
        front.rows.clear();
        front.columns.clear();
        for child in self.children.iter().map(|&c| &done[c]) {
            let delayed = child.done..child.done + child.delayed();
            front.rows.extend(&child.rows[delayed.clone()]);
            front.columns.extend(&child.columns[delayed]);
        }
        let delayed = front.rows.len();
        front.rows.extend(&self.node.unknowns);
        front.columns.extend(&self.node.unknowns);
        front.clear();
        let (mut top, mut first) = (stack.len(), delayed);
        for child in self.children.iter().rev().map(|&c| &done[c]) {
            top -= child.on_stack();
            first -= child.delayed();
            let remainder = match child.kept {
                true => &child.remainder[..],
                false => &stack[top..top + child.on_stack()],
            };
            child.add_remainder(remainder, first, delayed, front);
        }
        delayed
    }

    /// Adds its remainder to the parent's front, where its delayed unknowns start at `first` and the others at `start`.
    fn add_remainder(&self, remainder: &[f64], first: usize, start: usize, front: &mut Front) {
        let (size, left, delayed) = (front.rows.len(), self.left(), self.delayed());
        let later = &self.node.places;
        for (k, column) in remainder.chunks_exact(left.max(1)).enumerate() {
            let to = match k.checked_sub(delayed) {
                Some(k) => start + later[k],
                None => first + k,
            };
            let to = &mut front.matrix[to * size..(to + 1) * size];
            let (head, column) = column.split_at(delayed);
            for (to, value) in to[first..].iter_mut().zip(head) {
                *to += value;
            }
            let to = &mut to[start..];
            for (value, &row) in column.iter().zip(later) {
                to[row] += value;
            }
        }
    }

    fn add_entries(
        &self,
        entries: &[(u32, u32)],
        values: &[f64],
        delayed: usize,
        front: &mut Front,
    ) {
        let (size, plain) = (front.rows.len(), self.node.unknowns.len());
        for &(entry, place) in entries {
            let place = match delayed {
                0 => place as usize,
                _ => (place as usize / plain + delayed) * size + place as usize % plain + delayed,
            };
            front.matrix[place] += values[entry as usize];
        }
    }

    /// Stores the factors of a front with `done` eliminated unknowns, and passes on the remainder.
    fn keep(&mut self, front: &Front, done: usize, stack: &mut Vec<f64>) {
        let size = front.rows.len();
        self.done = done;
        self.solved = false;
        self.rows.clone_from(&front.rows);
        self.columns.clone_from(&front.columns);
        let (own, rest) = front.matrix.split_at(done * size);
        self.lower.clear();
        self.lower.extend_from_slice(own);
        self.upper.clear();
        self.remainder.clear();
        let to = if self.kept {
            &mut self.remainder
        } else {
            stack
        };
        for column in rest.chunks_exact(size.max(1)) {
            let (upper, remainder) = column.split_at(done);
            self.upper.extend_from_slice(upper);
            to.extend_from_slice(remainder);
        }
        let pivots = self.lower.iter().step_by(size + 1);
        self.smallest = pivots.fold(f64::INFINITY, |least, pivot| least.min(pivot.abs()));
    }

    /// Forward substitution of its columns in b, the right-hand side by equation.
    fn substitute(&mut self, own: &mut Vec<f64>, b: &mut [f64]) {
        own.clear();
        own.extend(self.rows.iter().map(|&row| b[row]));
        // The sign of a zero counts, too.
        let pairs = self.before.iter().zip(own.iter());
        let changed = pairs.fold(0, |changed, (a, b)| changed | (a.to_bits() ^ b.to_bits()));
        if !self.solved || changed != 0 {
            self.before.clone_from(own);
            self.after.clone_from(own);
            substitute(&self.lower, &mut self.after);
            self.solved = true;
        }
        for (after, &row) in self.after.iter().zip(&self.rows) {
            b[row] = *after;
        }
    }

    fn backward(&self, own: &mut Vec<f64>, x: &mut [f64]) {
        let (size, done) = (self.rows.len(), self.done);
        own.clear();
        own.extend_from_slice(&self.after[..done]);
        let mut columns = self.upper.chunks_exact(done.max(1));
        let mut later = self.columns[done..].chunks_exact(STEPS);
        for later in &mut later {
            let four: [&[f64]; STEPS] = std::array::from_fn(|_| columns.next().unwrap_or_default());
            subtract_all(own, four, std::array::from_fn(|k| x[later[k]]));
        }
        for (column, &later) in columns.zip(later.remainder()) {
            subtract(own, column, x[later]);
        }
        substitute_back(&self.lower, size, own);
        for (own, &column) in own.iter().zip(&self.columns) {
            x[column] = *own;
        }
    }
}

/// Assignment of the matrix's entries to fronts.
struct EntryMap {
    entries: Vec<(u32, u32)>,
    ranges: Vec<std::ops::Range<usize>>,
    owners: Vec<u32>,
}

/// Assigns every entry of the matrix to the front that eliminates the first of its two unknowns.
fn assign(pattern: &Pattern, tree: &Tree) -> Result<EntryMap, SolveError> {
    let mut eliminated = vec![0; pattern.size()];
    for (k, node) in tree.nodes.iter().enumerate() {
        node.unknowns[..node.pivots]
            .iter()
            .for_each(|&unknown| eliminated[unknown] = k);
    }
    let owner = |row: usize, column: usize| eliminated[row].min(eliminated[column]);
    // Grouped by front, so that one index list serves all entries of a front.
    let mut starts = vec![0; tree.nodes.len() + 1];
    let mut owners = Vec::with_capacity(pattern.entries());
    for (row, column) in pattern.iter() {
        starts[owner(row, column) + 1] += 1;
        owners.push(narrow(owner(row, column))?);
    }
    for k in 0..tree.nodes.len() {
        starts[k + 1] += starts[k];
    }
    let mut next = starts.clone();
    let mut entries = vec![(0, 0, 0); pattern.entries()];
    for (entry, (row, column)) in pattern.iter().enumerate() {
        let next = &mut next[owner(row, column)];
        entries[*next] = (narrow(entry)?, row, column);
        *next += 1;
    }
    let mut place = vec![0; pattern.size()];
    let mut placed = Vec::with_capacity(entries.len());
    let mut ranges = Vec::with_capacity(tree.nodes.len());
    for (k, node) in tree.nodes.iter().enumerate() {
        for (at, &unknown) in node.unknowns.iter().enumerate() {
            place[unknown] = at;
        }
        let range = starts[k]..starts[k + 1];
        for &(entry, row, column) in &entries[range.clone()] {
            placed.push((
                entry,
                narrow(place[column] * node.unknowns.len() + place[row])?,
            ));
        }
        ranges.push(range);
    }
    Ok(EntryMap {
        entries: placed,
        ranges,
        owners,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// A grouped matrix; rows from `first` on are the constraints.
    struct Case {
        pattern: Pattern,
        groups: Vec<usize>,
        first: usize,
        values: Vec<f64>,
    }

    impl Case {
        /// A grid of `across` by `up` nodes with two displacements each, fixed at one side, with a constraint on both
        /// displacements of each lower node; `lean` makes it unsymmetric. With `apart`, constraints have separate groups.
        fn grid(across: usize, up: usize, lean: f64, apart: bool) -> Case {
            let (nodes, first) = (across * up, 2 * across * up);
            let n = first + 2 * across;
            let mut a = std::collections::BTreeMap::new();
            let mut add = |i: usize, j: usize, value: f64| *a.entry((i, j)).or_insert(0.0) += value;
            let near = |i: usize, j: usize| {
                i != j
                    && (i % across).abs_diff(j % across) <= 1
                    && (i / across).abs_diff(j / across) <= 1
            };
            for i in 0..nodes {
                for j in (0..nodes).filter(|&j| near(i, j)) {
                    for (p, q) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                        let part = 0.1 * ((3 * (i + j) + p + q) % 7) as f64 - 0.4;
                        add(2 * i + p, 2 * j + q, part);
                        add(2 * i + p, 2 * i + p, 0.5);
                    }
                }
                add(2 * i, 2 * i, if i % across == 0 { 1.0 } else { 1e-3 });
            }
            for s in 0..across {
                for (k, rows) in [[0.6, -0.8], [0.8, 0.6]].iter().enumerate() {
                    for (axis, &share) in rows.iter().enumerate() {
                        let force = first + 2 * s + k;
                        add(force, 2 * s + axis, share);
                        add(2 * s + axis, force, share * (1.0 + lean * k as f64));
                        add(force, first + 2 * s + axis, 0.0);
                    }
                }
            }
            let pattern = Pattern::new(n, a.keys().copied()).unwrap();
            let group = |i: usize| match i.checked_sub(first) {
                Some(force) if apart => nodes + force,
                Some(force) => force / 2,
                None => i / 2,
            };
            Case {
                values: pattern.iter().map(|place| a[&place]).collect(),
                groups: (0..n).map(group).collect(),
                pattern,
                first,
            }
        }

        fn fronts(&self) -> Fronts {
            Fronts::new(&self.pattern, &self.groups, self.first).unwrap()
        }

        /// Releases a constraint: its force vanishes instead.
        fn release(&mut self, constraint: usize) {
            let own = self.first + constraint;
            for (value, (i, j)) in self.values.iter_mut().zip(self.pattern.iter()) {
                if i == own {
                    *value = if i == j { 1.0 } else { 0.0 };
                }
            }
        }

        /// The solution for a fixed right-hand side.
        fn solution(&self, fronts: &mut Fronts) -> Vec<f64> {
            fronts.factor(&self.values, None).unwrap();
            let mut x: Vec<f64> = (0..self.pattern.size()).map(|i| (i as f64).cos()).collect();
            fronts.solve(&mut x);
            x
        }

        /// Difference from the solution of a dense LU.
        fn error(&self, fronts: &mut Fronts) -> f64 {
            let x = DVector::from_vec(self.solution(fronts));
            let n = self.pattern.size();
            let mut dense = DMatrix::zeros(n, n);
            for (value, place) in self.values.iter().zip(self.pattern.iter()) {
                dense[place] = *value;
            }
            let b = DVector::from_fn(n, |i, _| (i as f64).cos());
            let exact = dense.lu().solve(&b).unwrap();
            (x - &exact).amax() / exact.amax()
        }

        /// Number of delayed unknowns.
        fn delayed(fronts: &Fronts) -> usize {
            fronts.fronts.iter().map(FactoredNode::delayed).sum()
        }
    }

    #[test]
    fn saddle_points_small_and_large_are_solved_as_a_dense_lu_solves_them() {
        for (across, up, lean) in [(1, 1, 0.0), (4, 2, 0.3), (30, 4, 0.0), (25, 12, -0.7)] {
            let case = Case::grid(across, up, lean, false);
            let mut fronts = case.fronts();
            let apart = case.error(&mut fronts);
            assert!(apart < 1e-10, "{across} by {up}: {apart}");
            assert_eq!(Case::delayed(&fronts), 0, "a group has its own pivots");
        }
    }

    #[test]
    fn constraints_without_a_pivot_in_their_group_are_delayed() {
        let case = Case::grid(20, 4, 0.2, true);
        let mut fronts = case.fronts();
        let apart = case.error(&mut fronts);
        assert!(apart < 1e-10, "{apart}");
        // Every group of the front is a single constraint.
        let pattern = Pattern::new(4, (0..16).map(|k| (k / 4, k % 4))).unwrap();
        let a = [
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 2.0, 1.0],
            [1.0, 0.0, 3.0, 1.0],
            [0.0, 1.0, 1.0, 2.0],
        ];
        let case = Case {
            values: pattern.iter().map(|(i, j)| a[i][j]).collect(),
            pattern,
            groups: vec![0, 1, 2, 3],
            first: 4,
        };
        assert!(case.error(&mut case.fronts()) < 1e-14);
    }

    #[test]
    fn delayed_unknowns_are_eliminated_where_there_is_a_pivot() {
        // A dense body with 30 of its 100 displacements held by forces that form a group without a pivot.
        let (first, n) = (100, 130);
        let value = |i: usize, j: usize| match (i.checked_sub(first), j.checked_sub(first)) {
            (None, None) if i == j => 60.0,
            (None, None) => 0.1 * ((7 * i + 3 * j) % 10) as f64,
            (Some(force), None) => f64::from(u8::from(force == j)),
            (None, Some(force)) => 0.5 * f64::from(u8::from(force == i)),
            _ => 0.0,
        };
        let places = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        let pairs = |i: usize, j: usize| i >= first && i - first == j;
        let has =
            |&(i, j): &(usize, usize)| (i < first) == (j < first) || pairs(i, j) || pairs(j, i);
        let pattern = Pattern::new(n, places.filter(has)).unwrap();
        let mut case = Case {
            values: pattern.iter().map(|(i, j)| value(i, j)).collect(),
            pattern,
            groups: (0..n).map(|i| i.min(first)).collect(),
            first,
        };
        let mut fronts = case.fronts();
        let apart = case.error(&mut fronts);
        assert!(apart < 1e-12, "{apart}");
        assert_eq!(Case::delayed(&fronts), 30);
        // A released force has its pivot; the others are delayed as before.
        case.release(7);
        let apart = case.error(&mut fronts);
        assert!(apart < 1e-12, "{apart}");
        assert_eq!(Case::delayed(&fronts), 29);
        assert_eq!(
            case.solution(&mut fronts),
            case.solution(&mut case.fronts())
        );
    }

    #[test]
    fn unchanged_parts_keep_their_bits() {
        for apart in [false, true] {
            let mut case = Case::grid(300, 6, 0.1, apart);
            let mut fronts = case.fronts();
            case.solution(&mut fronts);
            for released in [[17, 90], [18, 33], [0, 599]] {
                released.into_iter().for_each(|k| case.release(k));
                let again = case.solution(&mut fronts);
                let few = fronts.fronts.iter().filter(|front| front.changed).count();
                assert!(few > 0 && 3 * few < fronts.fronts.len(), "{few}");
                let mut anew = case.fronts();
                assert_eq!(again, case.solution(&mut anew));
                for (one, other) in fronts.fronts.iter().zip(&anew.fronts) {
                    assert_eq!((&one.lower, &one.upper), (&other.lower, &other.upper));
                }
            }
            // An entry that no constraint row involves.
            let place = case.pattern.slot(case.first - 1, case.first - 1).unwrap();
            case.values[place] *= 1.5;
            let again = case.solution(&mut fronts);
            assert_eq!(again, case.solution(&mut case.fronts()));
        }
    }

    #[test]
    fn a_singular_matrix_is_rejected() {
        let mut case = Case::grid(3, 2, 0.0, false);
        for (value, (i, j)) in case.values.iter_mut().zip(case.pattern.iter()) {
            if i == 5 || j == 5 {
                *value = 0.0;
            }
        }
        let mut fronts = case.fronts();
        assert_eq!(fronts.factor(&case.values, None), Err(SolveError::Singular));
        let case = Case::grid(3, 2, 0.0, false);
        assert!(case.error(&mut fronts) < 1e-10, "and the next one is not");
    }
}
