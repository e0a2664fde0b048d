//! Eigenvalues of the compliance W of a frozen problem, and a modified problem whose W is semidefinite.
//!
//! The compliance of elastic bodies in a stable state is positive definite, or semidefinite if some forces cause no motion. A
//! matrix written with few digits may have small negative eigenvalues instead: forces whose points move against them. Then a
//! solvable problem may become unsolvable, and pivoting may end on a ray.
//!
//! W = −(R⁻¹ + 1/k) for the components that can vary: those that contain an unknown, tangential ones only for nodes with
//! friction. Only its symmetric part is examined and changed; the rest of W, and the motions without forces, stay.

use crate::{InterfaceProblem, InterfaceResponse};
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Eigenvalues below this fraction of the largest, times the matrix size, are round-off.
const ROUND_OFF: f64 = 1e-12;

/// The compliance of a problem.
#[derive(Debug, Clone)]
pub struct Compliance<'a> {
    problem: &'a InterfaceProblem,
    /// W of all components (length per force).
    whole: DMatrix<f64>,
    /// Motions without changes of forces (length).
    still: DVector<f64>,
    /// Numbers of the examined components.
    kept: Vec<usize>,
    /// Eigenvalues and eigenvectors of the symmetric part.
    parts: SymmetricEigen<f64, nalgebra::Dyn>,
}

impl<'a> Compliance<'a> {
    /// The compliance. `None` if it does not exist because a body is loose, or if no component can vary.
    pub fn from_problem(problem: &'a InterfaceProblem) -> Option<Self> {
        let count = problem.relation.count();
        let bodies = problem.relation.compliance()?;
        let whole = DMatrix::from_vec(count, count, bodies.w);
        let mut kept = Vec::new();
        for (place, node) in problem.nodes.iter().enumerate() {
            let [normal, tangential] = node.moves();
            if normal {
                kept.push(2 * place);
            }
            if tangential && !node.friction.is_smooth() {
                kept.push(2 * place + 1);
            }
        }
        if kept.is_empty() {
            return None;
        }
        let both =
            |i: usize, j: usize| (whole[(kept[i], kept[j])] + whole[(kept[j], kept[i])]) / 2.0;
        let symmetric = DMatrix::from_fn(kept.len(), kept.len(), both);
        let parts = SymmetricEigen::try_new(symmetric, f64::EPSILON, 0)?;
        Some(Compliance {
            problem,
            whole,
            still: bodies.still.into(),
            kept,
            parts,
        })
    }

    /// Smallest and largest eigenvalue of the symmetric part (length per force).
    pub fn ends(&self) -> [f64; 2] {
        let values = &self.parts.eigenvalues;
        [values.min(), values.max()]
    }

    /// Magnitude below which an eigenvalue is round-off (length per force).
    pub fn round_off(&self) -> f64 {
        let spring = 1.0 / self.problem.relation.stiffness;
        let largest = self.parts.eigenvalues.amax().max(spring);
        ROUND_OFF * self.kept.len() as f64 * largest
    }

    /// Number of eigenvalues of the symmetric part with a magnitude of at most `size`.
    pub fn within(&self, size: f64) -> usize {
        self.parts
            .eigenvalues
            .iter()
            .filter(|value| value.abs() <= size)
            .count()
    }

    /// The problem with all eigenvalues below `below` replaced by `to` (length per force). `None` if W + 1/k becomes singular.
    pub fn raised(&self, below: f64, to: f64) -> Option<InterfaceProblem> {
        let relation = &self.problem.relation;
        let values = self
            .parts
            .eigenvalues
            .map(|x| if x < below { to - x } else { 0.0 });
        let vectors = &self.parts.eigenvectors;
        let change = vectors * DMatrix::from_diagonal(&values) * vectors.transpose();
        let mut whole = self.whole.clone();
        for (i, &row) in self.kept.iter().enumerate() {
            for (j, &column) in self.kept.iter().enumerate() {
                whole[(row, column)] += change[(i, j)];
            }
        }
        // Without springs, a singular W has no response.
        let stiffness = if relation.stiffness.is_finite() {
            relation.stiffness
        } else {
            self.problem.spring
        };
        let count = relation.count();
        for k in 0..count {
            whole[(k, k)] += 1.0 / stiffness;
        }
        let response = -whole.try_inverse()?;
        let start = &response * &self.still;
        if response.iter().chain(&start).any(|x| !x.is_finite()) {
            return None;
        }
        Some(InterfaceProblem {
            relation: InterfaceResponse {
                stiffness,
                start: start.iter().copied().collect(),
                response: response.iter().copied().collect(),
            },
            ..self.problem.clone()
        })
    }
}
