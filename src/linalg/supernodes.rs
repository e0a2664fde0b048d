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

/// The supernodes of L in elimination order.
pub(super) struct Supernodes {
    pub nodes: Vec<Supernode>,
    /// The supernode of each column.
    node_of: Vec<u32>,
    rows: Vec<u32>,
    /// The earlier supernodes with rows among the columns of each one, ascending: where each list starts, and the lists.
    starts: Vec<usize>,
    earlier: Vec<u32>,
}

/// A column of L and its pivot.
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
    pub fn from_symbolic(symbolic: &SymbolicSupernodalCholesky<u32>) -> Self {
        let count = symbolic.n_supernodes();
        let values = symbolic.col_ptr_for_val();
        let mut nodes = Vec::with_capacity(count);
        let mut node_of = vec![0; symbolic.nrows()];
        let mut rows: Vec<u32> = Vec::new();
        for s in 0..count {
            let node = symbolic.supernode(s);
            let columns = node.start()..symbolic.supernode_end()[s] as usize;
            node_of[columns.clone()].fill(s as u32);
            let first = rows.len();
            rows.extend(node.pattern());
            nodes.push(Supernode {
                columns,
                rows: first..rows.len(),
                values: values[s] as usize..values[s + 1] as usize,
            });
        }
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        for (d, node) in (0..).zip(&nodes) {
            let reached = rows[node.rows.clone()].iter();
            let reached = reached.map(|&row| node_of[row as usize]);
            pairs.extend(reached.map(|s| (s, d)));
        }
        pairs.dedup();
        let (starts, earlier) = lists(count, || pairs.iter().map(|&(s, d)| (s as usize, d)));
        Supernodes {
            nodes,
            node_of,
            rows,
            starts,
            earlier,
        }
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

    /// The supernodes that change a later one.
    pub fn earlier(&self, s: usize) -> &[u32] {
        &self.earlier[self.starts[s]..self.starts[s + 1]]
    }

    /// The first supernode that one changes.
    pub fn parent(&self, s: usize) -> Option<usize> {
        self.rows(s)
            .first()
            .map(|&row| self.node_of[row as usize] as usize)
    }

    /// The columns from `first` on, in elimination order.
    pub fn columns<'a>(
        &'a self,
        values: &'a [f64],
        first: usize,
    ) -> impl Iterator<Item = Column<'a>> {
        let nodes = self.nodes.partition_point(|node| node.columns.end <= first);
        (nodes..self.nodes.len()).flat_map(move |s| {
            let (node, rows) = (&self.nodes[s], self.rows(s));
            let start = node.columns.start;
            (first.saturating_sub(start)..node.width()).map(move |k| {
                let (own, below) = node.column(values, k).split_at(node.width());
                Column {
                    place: start + k,
                    pivot: own[k],
                    own: &own[k + 1..],
                    below,
                    rows,
                }
            })
        })
    }
}
