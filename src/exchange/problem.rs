//! Friction problems, the common data of readers and writers of interface problems.
//!
//! Components are normal and tangential for each contact in turn, in space with two tangential ones; with m contacts in the plane:
//!
//! ```text
//! local:   u = W r + q                          W: 2m x 2m
//! mixed:   u = W r + V l + q,    Vᵀ r + R l + s = 0
//! global:  M v = H r + f,    u = Hᵀ v + b       M: n x n,  H: n x 2m
//! all:     0 <= u_n ⊥ r_n >= 0,    |r_t| <= mu r_n, against u_t
//! ```

/// A matrix given by its entries.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Matrix {
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// Row and column, both from 0, and value; duplicate entries are added.
    pub entries: Vec<(usize, usize, f64)>,
}

impl Local {
    /// Number of components per contact: 2, or 3 in space.
    pub fn dimension(&self) -> usize {
        self.q.len() / self.mu.len().max(1)
    }
}

impl Matrix {
    /// The matrix with these rows, which have equal length.
    pub fn from_rows(rows: &[Vec<f64>]) -> Matrix {
        let entries = rows.iter().enumerate().flat_map(|(i, row)| {
            row.iter()
                .enumerate()
                .filter(|(_, v)| is_there(**v))
                .map(move |(j, &v)| (i, j, v))
        });
        Matrix {
            rows: rows.len(),
            columns: rows.first().map_or(0, Vec::len),
            entries: entries.collect(),
        }
    }

    /// The same matrix with its entries row by row, each once.
    pub fn merged(mut self) -> Matrix {
        self.entries.sort_by_key(|&(i, j, _)| (i, j));
        self.entries.dedup_by(|next, kept| {
            let same = (next.0, next.1) == (kept.0, kept.1);
            if same {
                kept.2 += next.2;
            }
            same
        });
        self
    }

    /// All entries, row by row. The caller must check that they fit into memory.
    pub fn dense(&self) -> Vec<Vec<f64>> {
        let mut rows = vec![vec![0.0; self.columns]; self.rows];
        for &(i, j, value) in &self.entries {
            rows[i][j] += value;
        }
        rows
    }
}

/// Whether an entry must be stored.
pub(crate) fn is_there(value: f64) -> bool {
    value != 0.0
}

/// A problem condensed to its contacts.
#[derive(Debug, Clone, PartialEq)]
pub struct Local {
    /// W.
    pub w: Matrix,
    /// Displacements without contact forces.
    pub q: Vec<f64>,
    /// Friction coefficients.
    pub mu: Vec<f64>,
}

/// Bilateral constraints that a local problem may have in addition to its contacts.
#[derive(Debug, Clone, PartialEq)]
pub struct Bilateral {
    /// V.
    pub v: Matrix,
    /// R.
    pub r: Matrix,
    /// s.
    pub s: Vec<f64>,
}

/// A problem in all unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct Global {
    /// M.
    pub m: Matrix,
    /// H.
    pub h: Matrix,
    /// Load on the unknowns; Siconos calls it q.
    pub f: Vec<f64>,
    /// Displacements of the contacts for zero unknowns; fclib calls it w.
    pub b: Vec<f64>,
    /// Friction coefficients.
    pub mu: Vec<f64>,
}

/// A problem of any kind.
#[derive(Debug, Clone, PartialEq)]
pub enum Problem {
    /// A problem condensed to its contacts.
    Local(Local),
    /// A local problem with bilateral constraints.
    Mixed(Local, Bilateral),
    /// A problem in all unknowns.
    Global(Global),
}
