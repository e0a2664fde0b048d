//! Friction problems as the readers of interface problems give them and the writers take them.
//!
//! Components come in pairs, along the normal and along the tangent of each contact in turn; with the number of contacts m:
//!
//! ```text
//! local:   u = W r + q                          W: 2m x 2m
//! mixed:   u = W r + V l + q,    Vᵀ r + R l + s = 0
//! global:  M v = H r + f,    u = Hᵀ v + b       M: n x n,  H: n x 2m
//! all:     0 <= u_n ⊥ r_n >= 0,    |r_t| <= mu r_n, against u_t
//! ```

/// A matrix by its entries.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Matrix {
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// Row and column, both from 0, and value; those at the same place add up.
    pub entries: Vec<(usize, usize, f64)>,
}

impl Matrix {
    /// The matrix of these rows, which are all as long.
    pub fn from_rows(rows: &[Vec<f64>]) -> Matrix {
        let entries = rows.iter().enumerate().flat_map(|(i, row)| {
            let entries = row.iter().enumerate().filter(|(_, v)| is_there(**v));
            entries.map(move |(j, &v)| (i, j, v))
        });
        Matrix {
            rows: rows.len(),
            columns: rows.first().map_or(0, Vec::len),
            entries: entries.collect(),
        }
    }

    /// All its entries, row by row. Who calls this has seen to it that there is memory for them.
    pub fn dense(&self) -> Vec<Vec<f64>> {
        let mut rows = vec![vec![0.0; self.columns]; self.rows];
        for &(i, j, value) in &self.entries {
            rows[i][j] += value;
        }
        rows
    }
}

/// Whether an entry has to be kept.
pub(crate) fn is_there(value: f64) -> bool {
    value != 0.0
}

/// A problem condensed to its contacts.
#[derive(Debug, Clone, PartialEq)]
pub struct Local {
    /// W.
    pub w: Matrix,
    /// Displacements under no force.
    pub q: Vec<f64>,
    /// Friction coefficients.
    pub mu: Vec<f64>,
}

/// What a local problem has besides its contacts: bilateral constraints.
#[derive(Debug, Clone, PartialEq)]
pub struct Bilateral {
    /// V.
    pub v: Matrix,
    /// R.
    pub r: Matrix,
    /// s.
    pub s: Vec<f64>,
}

/// A problem of all unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct Global {
    /// M.
    pub m: Matrix,
    /// H.
    pub h: Matrix,
    /// What acts on the unknowns; Siconos calls it q.
    pub f: Vec<f64>,
    /// Displacements of the contacts where the unknowns are 0; fclib calls it w.
    pub b: Vec<f64>,
    /// Friction coefficients.
    pub mu: Vec<f64>,
}

/// Any of them.
#[derive(Debug, Clone, PartialEq)]
pub enum Problem {
    /// A problem condensed to its contacts.
    Local(Local),
    /// One that has bilateral constraints, too.
    Mixed(Local, Bilateral),
    /// A problem of all unknowns.
    Global(Global),
}
