//! Static condensation: eliminates the unknowns that no contact involves.
//!
//! ```text
//! M v = H r + f,  u = Hᵀ v:              W = Hᵀ M⁻¹ H,  and  Hᵀ M⁻¹ f
//! K_cc u_c + K_ci u_i = f_c + r, ...:    S = K_cc − K_ci K_ii⁻¹ K_ic,  and  f_c − K_ci K_ii⁻¹ f_i
//! ```

use std::sync::Arc;
use stickslip_exchange::problem::Matrix;
use stickslip_linalg::{Factors, Pattern, SolveError};

/// Norm of the inverse (of the matrix scaled to entries of about 1) above which it counts as singular.
const SINGULAR: f64 = 1e12;

/// Why a matrix cannot be eliminated; the text continues a sentence that starts with the matrix's name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NotEliminated {
    /// The body moves freely, or the matrix is invalid.
    #[error(
        "is singular, so the problem cannot be condensed: the body is not sufficiently supported"
    )]
    Singular,
    /// Not enough memory for the factors.
    #[error("needs more memory to factor than is available")]
    Memory,
}

impl From<SolveError> for NotEliminated {
    fn from(error: SolveError) -> Self {
        match error {
            SolveError::Singular => NotEliminated::Singular,
            SolveError::OutOfMemory => NotEliminated::Memory,
        }
    }
}

/// W, row by row, and Hᵀ M⁻¹ f. For a symmetric M, W is exactly symmetric. `most` is the number of its entries for which memory
/// is available.
///
/// # Errors
/// If M is singular, or memory is insufficient.
pub fn condensed(
    m: &Matrix,
    h: &Matrix,
    f: &[f64],
    most: f64,
) -> Result<(Matrix, Vec<f64>), NotEliminated> {
    let mut solver = Inverse::new(m)?;
    let columns = by_column(h);
    let mut x = vec![0.0; m.rows];
    let onto = |x: &[f64]| -> Vec<f64> {
        columns
            .iter()
            .map(|column| column.iter().map(|&(i, v)| v * x[i]).sum())
            .collect()
    };
    solver.solve(f, &mut x)?;
    let q = onto(&x);
    let mut entries = Vec::new();
    let symmetric = solver.symmetric;
    solver.solve_each(&columns, |j, x| {
        for (i, value) in onto(x).into_iter().enumerate() {
            match (value == 0.0, symmetric) {
                (true, _) => {}
                (false, true) => entries.extend([(i, j, 0.5 * value), (j, i, 0.5 * value)]),
                (false, false) => entries.push((i, j, value)),
            }
        }
        if entries.len() as f64 > most {
            return Err(NotEliminated::Memory);
        }
        Ok(())
    })?;
    let w = Matrix {
        rows: columns.len(),
        columns: columns.len(),
        entries,
    };
    Ok((w.merged(), q))
}

/// The Schur complement S over the unknowns `kept`, row by row, and the condensed load.
///
/// # Errors
/// As [`condensed`].
pub fn reduced(
    k: &Matrix,
    f: &[f64],
    kept: &[usize],
) -> Result<(Vec<Vec<f64>>, Vec<f64>), NotEliminated> {
    let mut place = vec![None; k.rows];
    kept.iter()
        .enumerate()
        .for_each(|(new, &old)| place[old] = Some(new));
    let mut inner = vec![0; k.rows];
    let mut count = 0;
    for (old, kept) in place.iter().enumerate() {
        if kept.is_none() {
            inner[old] = count;
            count += 1;
        }
    }
    let part = |rows, columns| Matrix {
        rows,
        columns,
        entries: Vec::new(),
    };
    let mut whole = vec![vec![0.0; kept.len()]; kept.len()];
    let (mut ii, mut ic, mut ci) = (
        part(count, count),
        part(count, kept.len()),
        part(count, kept.len()),
    );
    for &(i, j, v) in &k.entries {
        match (place[i], place[j]) {
            (Some(i), Some(j)) => whole[i][j] += v,
            (None, None) => ii.entries.push((inner[i], inner[j], v)),
            (None, Some(j)) => ic.entries.push((inner[i], j, v)),
            (Some(i), None) => ci.entries.push((inner[j], i, v)),
        }
    }
    let mut load: Vec<f64> = kept.iter().map(|&old| f[old]).collect();
    if count == 0 {
        return Ok((whole, load));
    }
    let mut solver = Inverse::new(&ii)?;
    let rows = by_column(&ci);
    let mut x = vec![0.0; count];
    let right: Vec<f64> = (0..k.rows)
        .filter(|&old| place[old].is_none())
        .map(|old| f[old])
        .collect();
    let onto =
        |x: &[f64], row: &[(usize, f64)]| -> f64 { row.iter().map(|&(i, v)| v * x[i]).sum() };
    solver.solve(&right, &mut x)?;
    for (load, row) in load.iter_mut().zip(&rows) {
        *load -= onto(&x, row);
    }
    solver.solve_each(&by_column(&ic), |j, x| {
        for (whole, row) in whole.iter_mut().zip(&rows) {
            whole[j] -= onto(x, row);
        }
        Ok(())
    })?;
    let symmetric = is_symmetric(k);
    Ok((turned(turned(whole, false), symmetric), load))
}

/// The transpose of a matrix.
pub fn transposed(matrix: &Matrix) -> Matrix {
    let entries = matrix.entries.iter().map(|&(i, j, v)| (j, i, v));
    Matrix {
        rows: matrix.columns,
        columns: matrix.rows,
        entries: entries.collect(),
    }
}

/// The entries of each column.
fn by_column(matrix: &Matrix) -> Vec<Vec<(usize, f64)>> {
    let mut columns = vec![Vec::new(); matrix.columns];
    for &(i, j, v) in &matrix.entries {
        columns[j].push((i, v));
    }
    columns
}

/// The transpose; for a matrix that should be symmetric, the mean of both.
fn turned(columns: Vec<Vec<f64>>, symmetric: bool) -> Vec<Vec<f64>> {
    let entry = |i: usize, j: usize| {
        if symmetric {
            0.5 * (columns[i][j] + columns[j][i])
        } else {
            columns[j][i]
        }
    };
    let size = 0..columns.len();
    size.clone()
        .map(|i| size.clone().map(|j| entry(i, j)).collect())
        .collect()
}

/// Whether a matrix is exactly symmetric.
fn is_symmetric(matrix: &Matrix) -> bool {
    let sorted = |turn: bool| {
        let mut entries: Vec<_> = matrix
            .entries
            .iter()
            .map(|&(i, j, v)| if turn { (j, i, v) } else { (i, j, v) })
            .collect();
        entries.sort_by(|a, b| (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)));
        entries
    };
    sorted(false) == sorted(true)
}

/// A factored matrix.
struct Inverse {
    rows: usize,
    factors: Factors,
    symmetric: bool,
}

impl Inverse {
    fn new(matrix: &Matrix) -> Result<Self, NotEliminated> {
        let n = matrix.rows;
        let places = matrix.entries.iter().map(|&(i, j, _)| (i, j));
        let pattern = Arc::new(Pattern::new(n, places)?);
        let mut values = vec![0.0; pattern.entries()];
        for &(i, j, v) in &matrix.entries {
            if let Some(slot) = pattern.slot(i, j) {
                values[slot] += v;
            }
        }
        let mut factors = Factors::new(pattern)?;
        factors.scale(&values, n, &vec![1.0; n]);
        factors.factor(&values)?;
        let norm = factors.inverse_norm();
        if norm.is_nan() || norm > SINGULAR {
            return Err(NotEliminated::Singular);
        }
        Ok(Inverse {
            rows: n,
            factors,
            symmetric: is_symmetric(matrix),
        })
    }

    fn solve(&mut self, right: &[f64], x: &mut [f64]) -> Result<(), NotEliminated> {
        Ok(self.factors.solve(right, x)?)
    }

    /// Solves for each of these sparse right-hand sides, and hands on its number and its solution.
    fn solve_each(
        &mut self,
        columns: &[Vec<(usize, f64)>],
        mut hand_on: impl FnMut(usize, &[f64]) -> Result<(), NotEliminated>,
    ) -> Result<(), NotEliminated> {
        let mut right = vec![0.0; self.rows];
        let mut x = vec![0.0; self.rows];
        for (j, column) in columns.iter().enumerate() {
            column.iter().for_each(|&(i, v)| right[i] += v);
            self.solve(&right, &mut x)?;
            column.iter().for_each(|&(i, _)| right[i] = 0.0);
            hand_on(j, &x)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of five springs of stiffness 1 between six nodes along a line, with the first node on a spring of stiffness
    /// `ground`.
    fn chain(ground: f64) -> Matrix {
        let mut rows = vec![vec![0.0; 6]; 6];
        rows[0][0] = ground;
        for k in 0..5 {
            for (i, j, v) in [
                (k, k, 1.0),
                (k + 1, k + 1, 1.0),
                (k, k + 1, -1.0),
                (k + 1, k, -1.0),
            ] {
                rows[i][j] += v;
            }
        }
        Matrix::from_rows(&rows)
    }

    #[test]
    fn springs_in_a_row_add_their_compliances() {
        let h = Matrix {
            rows: 6,
            columns: 2,
            entries: vec![(5, 0, 1.0), (2, 1, -1.0)],
        };
        let f = [0.0, 0.0, 0.0, 0.0, 0.0, 3.0];
        let (w, q) = condensed(&chain(0.5), &h, &f, 4.0 * 2.0).unwrap();
        let w = w.dense();
        // The compliance is 1/0.5 + 5 at the end and 1/0.5 + 2 in the middle.
        let wanted = [[7.0, -4.0], [-4.0, 4.0]];
        for (row, wanted) in w.iter().zip(wanted) {
            for (value, wanted) in row.iter().zip(wanted) {
                assert!((value - wanted).abs() < 1e-12, "{w:?}");
            }
        }
        assert_eq!(w[0][1].to_bits(), w[1][0].to_bits());
        assert!(
            (q[0] - 21.0).abs() < 1e-11 && (q[1] + 12.0).abs() < 1e-11,
            "{q:?}"
        );
    }

    #[test]
    fn a_compliance_that_does_not_fit_is_refused() {
        let h = Matrix {
            rows: 6,
            columns: 2,
            entries: vec![(5, 0, 1.0), (2, 1, -1.0)],
        };
        let refused = condensed(&chain(0.5), &h, &[0.0; 6], 3.0);
        assert_eq!(refused, Err(NotEliminated::Memory));
    }

    #[test]
    fn an_unsupported_chain_has_a_stiffness_but_no_compliance() {
        let h = Matrix {
            rows: 6,
            columns: 1,
            entries: vec![(5, 0, 1.0)],
        };
        assert_eq!(
            condensed(&chain(0.0), &h, &[0.0; 6], f64::INFINITY),
            Err(NotEliminated::Singular)
        );
        let (s, load) = reduced(&chain(0.0), &[0.0, 0.0, 0.0, 0.0, 1.0, 0.0], &[5, 0]).unwrap();
        let wanted = [[0.2, -0.2], [-0.2, 0.2]];
        for (row, wanted) in s.iter().zip(wanted) {
            for (value, wanted) in row.iter().zip(wanted) {
                assert!((value - wanted).abs() < 1e-14, "{s:?}");
            }
        }
        assert!(
            (load[0] - 0.8).abs() < 1e-14 && (load[1] - 0.2).abs() < 1e-14,
            "{load:?}"
        );
    }

    #[test]
    fn stiffness_and_compliance_of_the_same_nodes_are_inverse() {
        let (f, kept) = ([1.0, 2.0, 0.0, -1.0, 0.5, 3.0], [3, 1]);
        let h = Matrix {
            rows: 6,
            columns: 2,
            entries: vec![(3, 0, 1.0), (1, 1, 1.0)],
        };
        let (w, q) = condensed(&chain(2.0), &h, &f, f64::INFINITY).unwrap();
        let w = w.dense();
        let (s, g) = reduced(&chain(2.0), &f, &kept).unwrap();
        for (i, (row, own)) in w.iter().zip(&q).enumerate() {
            for j in 0..2 {
                let product: f64 = row.iter().zip(&s).map(|(w, s)| w * s[j]).sum();
                assert!((product - f64::from(u8::from(i == j))).abs() < 1e-12);
            }
            let under_load: f64 = row.iter().zip(&g).map(|(w, g)| w * g).sum();
            assert!((under_load - own).abs() < 1e-11);
        }
    }
}
