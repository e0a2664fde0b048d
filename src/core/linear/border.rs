//! The load factor's column and the constraint's row about a linearisation, as plain data (`bordered` fills and uses them).

/// The last equation and the last column, in the linearisation at hand.
#[derive(Default)]
pub struct Border {
    /// Whether the relation at hand is bordered.
    pub active: bool,
    /// Change of each prescribed displacement by the load factor; zero at other degrees of freedom.
    pub rates: Vec<f64>,
    /// q, by equation.
    pub rate: Vec<f64>,
    /// Right-hand side of a solve.
    pub rhs: Vec<f64>,
    /// c, by equation.
    pub row: Vec<f64>,
    /// What prescribed motions put into the constraint: at the load factor of the linearisation, and by its change.
    pub given: [f64; 2],
    /// x1 with the forces f1 after the displacements.
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
    /// Notes what z of one more component puts into the constraint; `column` is a column of X.
    pub fn extend(&mut self, column: &[f64]) {
        let share = self.row.iter().zip(column).map(|(c, x)| c * x).sum();
        self.share.push(share);
    }
}
