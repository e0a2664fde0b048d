//! The column of the load factor and the row of the constraint in a linearisation, as plain data (`bordered` fills and uses
//! them).

/// The last equation and the last column in the current linearisation.
#[derive(Default)]
pub struct Border {
    /// Whether the current relation is bordered.
    pub active: bool,
    /// Derivative of each prescribed displacement with respect to the load factor; zero at other degrees of freedom.
    pub rates: Vec<f64>,
    /// q, by equation.
    pub rate: Vec<f64>,
    /// Right-hand side of a solve.
    pub rhs: Vec<f64>,
    /// c, by equation.
    pub row: Vec<f64>,
    /// Contribution of prescribed displacements to the constraint: at the load factor of the linearisation, and per unit of its
    /// change.
    pub given: [f64; 2],
    /// x1, followed by the forces f1.
    pub moved: Vec<f64>,
    /// p of each contact, along n and t.
    pub carried: Vec<[f64; 2]>,
    /// Xᵀ c, then a.
    pub share: Vec<f64>,
    /// a0.
    pub start: f64,
    /// dλ of the last solve.
    pub load_step: f64,
}

impl Border {
    /// Records the contribution of z to the constraint for one more component; `column` is a column of X.
    pub fn extend(&mut self, column: &[f64]) {
        let share = self.row.iter().zip(column).map(|(c, x)| c * x).sum();
        self.share.push(share);
    }
}
