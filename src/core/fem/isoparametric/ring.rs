//! The hoop direction of a Gauss point in axisymmetry.
//!
//! With b_i = N_i / X, h = Σ b_i u_xi and F33 = 1 + h, P33 = F33 S33 adds b_i P33 to the force along x. Its derivatives with
//! respect to H and h,
//!
//! ```text
//! ∂P_aJ/∂h = F_aK (∂S_KJ/∂E33) F33 = ∂P33/∂H_aJ,      ∂P33/∂h = S33 + F33² ∂S33/∂E33,
//! ```
//!
//! are added to the tangent, which remains symmetric.

use crate::elements::kinds::continuum_kind::Parent;
use crate::fem::material::Hoop;

/// The hoop direction of a Gauss point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ring<const N: usize> {
    /// b_i.
    pub share: [f64; N],
    /// Reference radius X.
    pub radius: f64,
    /// h.
    pub h: f64,
    /// Hoop stress, once it is known.
    pub hoop: Hoop,
}

/// P33 and its derivatives, times the volume of the point.
#[derive(Debug, Clone, Copy)]
pub(super) struct RingTerms<const N: usize> {
    pub share: [f64; N],
    pub stress: f64,
    /// ∂P_aJ/∂h.
    coupling: [[f64; 2]; 2],
    /// ∂P33/∂h.
    modulus: f64,
}

impl<const N: usize> Ring<N> {
    /// The hoop direction at a point of the parent element, whose nodes have the reference positions `at` and the displacements
    /// `u`.
    pub fn new(parent: &Parent<N>, at: &[[f64; 2]; N], u: &[[f64; 2]; N]) -> Self {
        let radius: f64 = parent.n.iter().zip(at).map(|(n, x)| n * x[0]).sum();
        let share = parent.n.map(|n| n / radius);
        let h = share.iter().zip(u).map(|(b, u)| b * u[0]).sum();
        Ring {
            share,
            radius,
            h,
            hoop: Hoop::default(),
        }
    }
}

impl<const N: usize> Ring<N> {
    /// Its contribution for a point with this volume and in-plane F.
    pub fn terms(&self, volume: f64, deformation: [[f64; 2]; 2]) -> RingTerms<N> {
        let (v, hoop, f33) = (volume, &self.hoop, 1.0 + self.h);
        let [xx, yy, xy] = [0, 1, 2].map(|k| v * f33 * hoop.coupling[k]);
        RingTerms {
            share: self.share,
            stress: v * f33 * hoop.stress,
            coupling: deformation.map(|f| [f[0] * xx + f[1] * xy, f[0] * xy + f[1] * yy]),
            modulus: v * (hoop.stress + f33 * f33 * hoop.modulus),
        }
    }
}

impl<const N: usize> RingTerms<N> {
    /// Adds the contribution of the hoop strain to K_ij, at [a][c][j].
    pub fn add_rows(&self, i: usize, grad: &[[f64; N]; 2], sums: &mut [[[f64; N]; 2]; 2]) {
        let [x, y] = [grad[0][i], grad[1][i]];
        let own = self.share[i];
        for (a, row) in self.coupling.iter().enumerate() {
            let by_gradient = row[0] * x + row[1] * y;
            for (sum, share) in sums[a][0].iter_mut().zip(&self.share) {
                *sum += by_gradient * share;
            }
            let slopes = grad[0].iter().zip(&grad[1]);
            for (sum, (x, y)) in sums[0][a].iter_mut().zip(slopes) {
                *sum += own * (row[0] * x + row[1] * y);
            }
        }
        for (sum, share) in sums[0][0].iter_mut().zip(&self.share) {
            *sum += own * self.modulus * share;
        }
    }
}
