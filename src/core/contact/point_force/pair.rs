//! c_ij in closed form ([`super`]).

use crate::fem::lagrange::MAX_NODES;
use crate::model::PointGive;

/// c_ij of two points of an element, with its derivatives (length per force).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pair {
    /// c_ij.
    pub give: f64,
    /// ∂c_ij/∂ξ_i; half of dc/dξ if both points coincide.
    pub slope: f64,
    /// ∂²c_ij/∂ξ_i².
    pub bend: f64,
    /// ∂²c_ij/∂ξ_i ∂ξ_j.
    pub cross: f64,
}

impl Pair {
    /// Evaluates c_ij at the points ξ_i and ξ_j of an element of this degree.
    pub fn new(give: &PointGive, degree: usize, xi: f64, other: f64) -> Pair {
        let (one, two) = (Coefficients::new(xi), Coefficients::new(other));
        let apart = xi - other;
        let side = if apart == 0.0 { 0.0 } else { apart.signum() };
        let mut shear = Pair {
            give: 2.0 - 2.0 * apart.abs(),
            slope: -2.0 * side,
            ..Pair::default()
        };
        for k in 0..degree {
            let [one, two] = [&one, &two].map(|at| at.step(k));
            shear.take_off(weight(k), one, two);
        }
        let mut all = shear.times(give.shear);
        if degree >= 3 && give.bending > 0.0 {
            let mut bending = Pair {
                give: 2.0 / 3.0 + 2.0 * xi * other + apart.abs().powi(3) / 3.0,
                slope: 2.0 * other + apart * apart.abs(),
                bend: 2.0 * apart.abs(),
                cross: 2.0 - 2.0 * apart.abs(),
            };
            for k in 0..degree - 1 {
                let [one, two] = [&one, &two].map(|at| at.hat(k));
                bending.take_off(weight(k), one, two);
            }
            let [one, two] = [&one, &two].map(|at| at.last_hat(degree));
            bending.take_off(weight(degree - 1), one, two);
            all.add(bending.times(give.bending));
        }
        all
    }

    /// Subtracts a product of two coefficients; `one` and `two` contain the value and the first two derivatives.
    fn take_off(&mut self, weight: f64, one: [f64; 3], two: [f64; 3]) {
        self.give -= weight * one[0] * two[0];
        self.slope -= weight * one[1] * two[0];
        self.bend -= weight * one[2] * two[0];
        self.cross -= weight * one[1] * two[1];
    }

    fn times(self, factor: f64) -> Pair {
        Pair {
            give: factor * self.give,
            slope: factor * self.slope,
            bend: factor * self.bend,
            cross: factor * self.cross,
        }
    }

    fn add(&mut self, other: Pair) {
        self.give += other.give;
        self.slope += other.slope;
        self.bend += other.bend;
        self.cross += other.cross;
    }
}

/// ∫ P_k².
fn weight(k: usize) -> f64 {
    2.0 / (2 * k + 1) as f64
}

/// Legendre polynomials at ξ, from which all coefficients follow.
pub(super) struct Coefficients {
    xi: f64,
    /// P_k.
    pub p: [f64; MAX_NODES + 1],
    /// dP_k/dξ.
    d: [f64; MAX_NODES + 1],
}

impl Coefficients {
    pub fn new(xi: f64) -> Self {
        let (mut p, mut d) = ([1.0; MAX_NODES + 1], [0.0; MAX_NODES + 1]);
        (p[1], d[1]) = (xi, 1.0);
        for k in 1..MAX_NODES {
            let n = (2 * k + 1) as f64;
            p[k + 1] = (n * xi * p[k] - k as f64 * p[k - 1]) / (k + 1) as f64;
            d[k + 1] = d[k - 1] + n * p[k];
        }
        Coefficients { xi, p, d }
    }

    /// a_k with its first two derivatives.
    fn step(&self, k: usize) -> [f64; 3] {
        let value = match k {
            0 => -self.xi,
            k => self.p[k - 1] - self.p[k + 1],
        };
        let n = (2 * k + 1) as f64;
        [value, -n * self.p[k], -n * self.d[k]]
    }

    /// b_k with its first two derivatives.
    fn hat(&self, k: usize) -> [f64; 3] {
        let value = match k {
            0 => 0.5 * (1.0 + self.xi * self.xi),
            k => {
                self.step(k - 1)[0] / (2 * k - 1) as f64 - self.step(k + 1)[0] / (2 * k + 3) as f64
            }
        };
        [value, -self.step(k)[0], (2 * k + 1) as f64 * self.p[k]]
    }

    /// m with its first two derivatives, for degree >= 3.
    fn last_hat(&self, degree: usize) -> [f64; 3] {
        let part = 1.0 / (2 * degree - 3) as f64;
        self.step(degree - 2).map(|a| part * a)
    }
}
