//! The structure of L in the sparse LDLᵀ: its supernodes, columns with the same rows below them, found by faer.

use super::pattern::lists;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use std::ops::Range;

/// Columns of L with the same rows below them.
pub(super) struct Supernode {
    /// Its columns.
    pub columns: Range<usize>,
    /// Where the rows below them are, in [`Supernodes::rows`].
    rows: Range<usize>,
    /// Its range of the values: column by column, the rows of the columns themselves, valid from the diagonal on, then those below.
    pub values: Range<usize>,
}

/// The supernodes of L in elimination order. Those from `tail` on contain the unknowns that are not eliminated.
pub(super) struct Supernodes {
    pub nodes: Vec<Supernode>,
    pub tail: usize,
    /// Number of unknowns that are eliminated.
    pub inner: usize,
    /// The supernode of each column.
    node_of: Vec<u32>,
    rows: Vec<u32>,
    /// The eliminated supernodes with rows among the columns of each one, ascending: where each list starts, and the lists.
    starts: Vec<usize>,
    earlier: Vec<u32>,
}

/// A column of L and its pivot, or of S and its diagonal.
pub(super) struct Column<'a> {
    pub place: usize,
    pub pivot: f64,
    /// Entries of the supernode's own rows below the diagonal, and of `rows`.
    pub own: &'a [f64],
    pub below: &'a [f64],
    pub rows: &'a [u32],
}

impl Supernode {
    pub fn width(&self) -> usize {
        self.columns.len()
    }

    /// Number of rows, its own included.
    pub fn height(&self) -> usize {
        self.columns.len() + self.rows.len()
    }

    /// A column of the supernode's values.
    pub fn column<'a>(&self, values: &'a [f64], k: usize) -> &'a [f64] {
        let first = self.values.start + k * self.height();
        &values[first..first + self.height()]
    }
}

impl Supernodes {
    /// From those of `groups` of unknowns ([`super::pattern::Pattern::groups`]). The first `inner` unknowns are eliminated; a
    /// supernode that contains some of them is split there.
    pub fn from_symbolic(
        symbolic: &SymbolicSupernodalCholesky<u32>,
        groups: &[usize],
        inner: usize,
    ) -> Self {
        let mut nodes: Vec<Supernode> = Vec::with_capacity(symbolic.n_supernodes() + 1);
        let mut node_of = vec![0; groups[symbolic.nrows()]];
        let mut rows: Vec<u32> = Vec::new();
        for s in 0..symbolic.n_supernodes() {
            let node = symbolic.supernode(s);
            let end = symbolic.supernode_end()[s] as usize;
            let (start, end) = (groups[node.start()], groups[end]);
            let middle = inner.clamp(start, end);
            for columns in [start..middle, middle..end] {
                if columns.is_empty() {
                    continue;
                }
                let first = rows.len();
                rows.extend(columns.end as u32..end as u32);
                for &group in node.pattern() {
                    let group = group as usize;
                    rows.extend(groups[group] as u32..groups[group + 1] as u32);
                }
                node_of[columns.clone()].fill(nodes.len() as u32);
                let values = nodes.last().map_or(0, |node| node.values.end);
                let height = columns.len() + rows.len() - first;
                nodes.push(Supernode {
                    values: values..values + columns.len() * height,
                    columns,
                    rows: first..rows.len(),
                });
            }
        }
        let tail = nodes.partition_point(|node| node.columns.start < inner);
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        for (d, node) in (0..).zip(&nodes[..tail]) {
            let reached = rows[node.rows.clone()].iter();
            let reached = reached.map(|&row| node_of[row as usize]);
            pairs.extend(reached.map(|s| (s, d)));
        }
        pairs.dedup();
        let (starts, earlier) = lists(nodes.len(), || pairs.iter().map(|&(s, d)| (s as usize, d)));
        Supernodes {
            nodes,
            tail,
            inner,
            node_of,
            rows,
            starts,
            earlier,
        }
    }

    /// The supernodes that are not eliminated.
    pub fn left(&self) -> Range<usize> {
        self.tail..self.nodes.len()
    }

    /// The range of the values of consecutive supernodes.
    pub fn values(&self, nodes: &Range<usize>) -> Range<usize> {
        let all = &self.nodes[nodes.clone()];
        all.first().map_or(0, |node| node.values.start)
            ..all.last().map_or(0, |node| node.values.end)
    }

    /// The rows below a supernode's columns.
    pub fn rows(&self, s: usize) -> &[u32] {
        &self.rows[self.nodes[s].rows.clone()]
    }

    /// The rows of a supernode from the first of these columns on, and how many are among the columns.
    pub fn shared(&self, d: usize, columns: &Range<usize>) -> (&[u32], usize) {
        let rows = self.rows(d);
        let rows = &rows[rows.partition_point(|&row| (row as usize) < columns.start)..];
        (
            rows,
            rows.partition_point(|&row| (row as usize) < columns.end),
        )
    }

    /// The eliminated supernodes that change a later one.
    pub fn earlier(&self, s: usize) -> &[u32] {
        &self.earlier[self.starts[s]..self.starts[s + 1]]
    }

    /// The first supernode that one changes.
    pub fn parent(&self, s: usize) -> Option<usize> {
        self.rows(s)
            .first()
            .map(|&row| self.node_of[row as usize] as usize)
    }

    /// The columns of consecutive supernodes.
    pub fn columns<'a>(
        &'a self,
        values: &'a [f64],
        nodes: Range<usize>,
    ) -> impl Iterator<Item = Column<'a>> {
        nodes.flat_map(move |s| {
            let (node, rows) = (&self.nodes[s], self.rows(s));
            (0..node.width()).map(move |k| {
                let (own, below) = node.column(values, k).split_at(node.width());
                Column {
                    place: node.columns.start + k,
                    pivot: own[k],
                    own: &own[k + 1..],
                    below,
                    rows,
                }
            })
        })
    }
}
