//! A bar between two nodes, hinged at both ends, with arbitrarily large rotations.
//!
//! With the undeformed length L, the current length l and the current direction t,
//!
//! ```text
//! N = EA (l − L) / L,      f = N (−t, t),      K = ± (EA/L t tᵀ + N/l (I − t tᵀ)).
//! ```

use super::element::{self, Previous};
use crate::plane::plus;

/// A bar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrussElement {
    at: [[f64; 2]; 2],
    ea: f64,
}

impl TrussElement {
    /// A bar between these undeformed positions, with the stiffness EA (force).
    pub fn new(at: [[f64; 2]; 2], ea: f64) -> Self {
        TrussElement { at, ea }
    }
}

impl element::Element for TrussElement {
    fn dofs(&self) -> usize {
        4
    }

    fn add(&self, _: &Previous<'_>, u: &[f64], force: &mut [f64], tangent: &mut [f64]) -> bool {
        let along = [0, 1].map(|k| self.at[1][k] - self.at[0][k]);
        let moved = [0, 1].map(|k| u[2 + k] - u[k]);
        let now = plus(along, moved);
        let (before, length) = (along[0].hypot(along[1]), now[0].hypot(now[1]));
        if length.is_nan() || length <= 0.0 {
            return false;
        }
        // l − L as (l² − L²) / (l + L), to avoid cancellation.
        let squares: f64 = (0..2).map(|k| moved[k] * (2.0 * along[k] + moved[k])).sum();
        let pull = self.ea * squares / ((length + before) * before);
        let t = now.map(|x| x / length);
        let (own, turned) = (self.ea / before, pull / length);
        for a in 0..2 {
            force[a] -= pull * t[a];
            force[2 + a] += pull * t[a];
            for b in 0..2 {
                let unit = if a == b { 1.0 } else { 0.0 };
                let value = own * t[a] * t[b] + turned * (unit - t[a] * t[b]);
                for (i, j, sign) in [(0, 0, 1.0), (0, 2, -1.0), (2, 0, -1.0), (2, 2, 1.0)] {
                    tangent[4 * (i + a) + j + b] += sign * value;
                }
            }
        }
        true
    }
}
