//! The interface alone: the bodies condensed to it (eqn 6), as the minor iterations see them.
//!
//! For springs of stiffness k between every slave node and its S*, the interface forces answer gaps z that the springs
//! are given by `ΔF = start + response z`, and the relative motion is `v = z + ΔF / k`. Table 1's equations in v and
//! ΔF are then a dense system for z, of two unknowns a slave node, whatever the size of the bodies.

use crate::contact::table1::{Equation, Motion};
use crate::linalg::{DenseFactors, SolveError};

/// The condensed interface of a major iteration, and the last minor iteration's answer.
pub struct Condensed {
    /// Whether `start` and `response` belong to the present linearisation.
    pub fresh: bool,
    /// Estimated norm of the inverse of what was factored to get there.
    pub norm: f64,
    /// Stiffness k of the springs.
    pub stiffness: f64,
    /// ΔF at z = 0: normal and tangential of each slave node in turn.
    pub start: Vec<f64>,
    /// Change of ΔF by z, column by column.
    pub response: Vec<f64>,
    /// Table 1's equations in z, column by column.
    pub matrix: Vec<f64>,
    /// Their right-hand sides.
    pub rhs: Vec<f64>,
    /// z of the last minor iteration.
    pub gaps: Vec<f64>,
    dense: Option<DenseFactors>,
    /// ΔF_n, ΔF_t of each slave node in the last minor iteration.
    pub forces: Vec<[f64; 2]>,
    /// Normal and tangential relative motion of each slave node in it, prescribed motion included.
    pub motions: Vec<[f64; 2]>,
}

impl Condensed {
    /// Room for the answers of this many slave nodes; for the condensed matrices once they are wanted.
    pub fn new(slaves: usize) -> Self {
        Condensed {
            fresh: false,
            norm: 0.0,
            stiffness: 1.0,
            start: Vec::new(),
            response: Vec::new(),
            matrix: Vec::new(),
            rhs: Vec::new(),
            gaps: Vec::new(),
            dense: None,
            forces: vec![[0.0; 2]; slaves],
            motions: vec![[0.0; 2]; slaves],
        }
    }

    /// Makes room for the condensed matrices.
    ///
    /// # Errors
    /// [`SolveError::OutOfMemory`].
    pub fn resize(&mut self, slaves: usize) -> Result<(), SolveError> {
        let count = 2 * slaves;
        if self.dense.is_some() {
            return Ok(());
        }
        for vector in [&mut self.start, &mut self.rhs, &mut self.gaps] {
            vector.resize(count, 0.0);
        }
        for matrix in [&mut self.response, &mut self.matrix] {
            matrix.resize(count * count, 0.0);
        }
        self.dense = Some(DenseFactors::new(count, 1)?);
        Ok(())
    }

    /// Solves the entered equations for z; returns an estimate of the norm of their matrix' inverse.
    ///
    /// # Errors
    /// [`SolveError::Singular`] where they have no solution.
    pub fn solve(&mut self) -> Result<f64, SolveError> {
        self.gaps.copy_from_slice(&self.rhs);
        let Some(dense) = &mut self.dense else {
            return Err(SolveError::Singular);
        };
        dense.factor(&self.matrix);
        dense.solve(&mut self.gaps)?;
        Ok(dense.inverse_norm())
    }

    /// Enters equation k (0 normal, 1 tangential) of the slave node whose first row is `first`; `prescribed` is the
    /// relative motion, along n and t, that no unknown takes part in.
    pub fn place_row(&mut self, first: usize, k: usize, row: &Equation, prescribed: [f64; 2]) {
        let count = self.rhs.len();
        let moving = match row.motion {
            Motion::None => None,
            Motion::Normal => Some(0),
            Motion::Tangential => Some(1),
        };
        // motion = z + ΔF / k, so that the factors of ΔF are these.
        let mut factor = [row.d_n, row.d_t];
        let mut value = row.value;
        if let Some(component) = moving {
            factor[component] += 1.0 / self.stiffness;
            value -= prescribed[component];
        }
        let (at, here) = (first + k, [first, first + 1]);
        for column in 0..count {
            let response = &self.response[column * count..(column + 1) * count];
            self.matrix[column * count + at] =
                factor[0] * response[here[0]] + factor[1] * response[here[1]];
        }
        if let Some(component) = moving {
            self.matrix[here[component] * count + at] += 1.0;
        }
        self.rhs[at] = value - factor[0] * self.start[here[0]] - factor[1] * self.start[here[1]];
    }

    /// Reads a slave node's force and motion off the solution z.
    pub fn read(&mut self, slave: usize, prescribed: [f64; 2]) {
        let count = self.rhs.len();
        for (component, prescribed) in prescribed.iter().enumerate() {
            let row = 2 * slave + component;
            let answer = self
                .gaps
                .iter()
                .enumerate()
                .map(|(column, z)| self.response[column * count + row] * z);
            let force = self.start[row] + answer.sum::<f64>();
            self.forces[slave][component] = force;
            self.motions[slave][component] = self.gaps[row] + force / self.stiffness + prescribed;
        }
    }
}
