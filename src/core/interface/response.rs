//! Response of the condensed bodies' interface (eqn 6).
//!
//! With a spring of stiffness k between every slave node and its S*, and gaps z imposed on the springs, the interface forces are
//!
//! ```text
//! ΔF = start + response z,        relative motion v = z + ΔF / k
//! ```
//!
//! For infinite k, z is the motion itself. Springs with finite k make the response exist if only contact supports a body.

use crate::linalg::DenseFactors;
use crate::{Equation, RelativeMotion};
use serde::{Deserialize, Serialize};

/// Response of the condensed bodies' interface; normal and tangential components of each slave node in turn.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct InterfaceResponse {
    /// Stiffness k of the springs (force per length); may be infinite.
    pub stiffness: f64,
    /// ΔF at z = 0: 2 entries per slave node, normal and tangential.
    pub start: Vec<f64>,
    /// Derivative of ΔF with respect to z (force per length), column-major.
    pub response: Vec<f64>,
}

/// Motions of the bodies without the springs, for given forces: −v = still + W ΔF with W = −(R⁻¹ + 1/k), still = R⁻¹ start.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeMotion {
    /// W (length per force), column-major.
    pub w: Vec<f64>,
    /// −v without changes of forces (length).
    pub still: Vec<f64>,
    /// Estimated norm of the inverse of the scaled R; if it is large, W is inaccurate.
    pub inverse_norm: f64,
}

impl InterfaceResponse {
    /// The compliance. `None` if the bodies are unsupported without contact, or memory is insufficient.
    pub fn compliance(&self) -> Option<FreeMotion> {
        let count = self.count();
        let mut w = vec![0.0; count * count];
        w.iter_mut().step_by(count + 1).for_each(|x| *x = 1.0);
        w.extend(&self.start);
        let mut dense = DenseFactors::new(count, count + 1).ok()?;
        dense.factor(&self.response);
        let inverse_norm = dense.inverse_norm();
        dense.solve(&mut w).ok()?;
        let still = w.split_off(count * count);
        w.iter_mut().for_each(|x| *x = -*x);
        for x in w.iter_mut().step_by(count + 1) {
            *x -= 1.0 / self.stiffness;
        }
        Some(FreeMotion {
            w,
            still,
            inverse_norm,
        })
    }

    /// Number of entries of z: 2 per slave node.
    pub fn count(&self) -> usize {
        self.start.len()
    }

    /// Writes an equation (k: 0 normal, 1 tangential) of a slave node as row `2 slave + k` of the matrix in z, and returns its
    /// right-hand side; `prescribed` is the prescribed part of the relative motion, along n and t. The column-major matrix has
    /// the size [`InterfaceResponse::count`].
    pub fn place_row(
        &self,
        slave: usize,
        k: usize,
        row: &Equation,
        prescribed: [f64; 2],
        matrix: &mut [f64],
    ) -> f64 {
        let count = self.count();
        let moving = match row.motion {
            RelativeMotion::None => None,
            RelativeMotion::Normal => Some(0),
            RelativeMotion::Tangential => Some(1),
        };
        // Substituting motion = z + ΔF / k gives these factors of ΔF.
        let mut factor = [row.d_n, row.d_t];
        let mut value = row.value;
        if let Some(component) = moving {
            factor[component] += 1.0 / self.stiffness;
            value -= prescribed[component];
        }
        let here = 2 * slave;
        let columns = matrix.chunks_exact_mut(count);
        for (column, response) in columns.zip(self.response.chunks_exact(count)) {
            column[here + k] = factor[0] * response[here] + factor[1] * response[here + 1];
        }
        if let Some(component) = moving {
            matrix[(here + component) * count + here + k] += 1.0;
        }
        value - factor[0] * self.start[here] - factor[1] * self.start[here + 1]
    }

    /// Derivatives of a slave node's ΔF_n, ΔF_t, normal and tangential relative motion with respect to z.
    pub fn rows(&self, slave: usize) -> [Vec<f64>; 4] {
        std::array::from_fn(|k| {
            let row = 2 * slave + k % 2;
            let force = self.response.iter().skip(row).step_by(self.count());
            if k < 2 {
                force.copied().collect()
            } else {
                let mut motion: Vec<f64> = force.map(|force| force / self.stiffness).collect();
                motion[row] += 1.0;
                motion
            }
        })
    }

    /// ΔF_n, ΔF_t of a slave node, and its normal and tangential relative motion, for given z.
    pub fn answer(&self, z: &[f64], slave: usize, prescribed: [f64; 2]) -> [[f64; 2]; 2] {
        let [mut force, mut motion] = self.change(z, slave);
        for component in 0..2 {
            let start = self.start[2 * slave + component];
            force[component] += start;
            motion[component] += start / self.stiffness + prescribed[component];
        }
        [force, motion]
    }

    /// Change of [`InterfaceResponse::answer`] for given z: the same without `start` and `prescribed`.
    pub fn change(&self, z: &[f64], slave: usize) -> [[f64; 2]; 2] {
        let (mut force, mut motion) = ([0.0; 2], [0.0; 2]);
        for component in 0..2 {
            let row = 2 * slave + component;
            let answers = self.response.iter().skip(row).step_by(self.count());
            force[component] = answers.zip(z).map(|(response, z)| response * z).sum();
            motion[component] = z[row] + force[component] / self.stiffness;
        }
        [force, motion]
    }
}
