//! One state of an interface problem in space, found by block Gauss-Seidel sweeps.
//!
//! With (gap, u) = W f + q and three rows per contact, a contact is open (f = 0, gap >= 0), sticks (gap = 0, u = 0, |f_t| <= mu f_n
//! + c) or slides (gap = 0, f_t = -(mu f_n + c) u / |u|).

use super::blocks::Blocks;
use super::sweep::Sweep;
use crate::{Friction, Mode};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Maximum number of sweeps.
const SWEEPS: usize = 20_000;
/// Relative change of the forces at which the sweeps end.
const SETTLED: f64 = 1e-13;
/// Relative violation of the laws at which a result counts as a solution.
const SOUND: f64 = 1e-8;

/// A contact in a solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConeContact {
    /// Its mode.
    pub mode: Mode,
    /// Forces (f_n, f_1, f_2).
    pub force: [f64; 3],
    /// Gap and motion of the node (gap, u_1, u_2).
    pub motion: [f64; 3],
}

/// A state that obeys all laws, found by sweeps from zero forces; `None` if 20,000 of them do not converge. `w` and `q`
/// have three rows per contact.
pub fn solve(
    w: &DMatrix<f64>,
    q: &DVector<f64>,
    friction: &[Friction],
) -> Option<Vec<ConeContact>> {
    let blocks = Blocks::from_dense(friction.len(), w.as_slice());
    let mut sweeps = Sweep::in_space(Arc::new(blocks), q.as_slice().to_vec(), friction);
    for _ in 0..SWEEPS {
        if sweeps.sweep() <= SETTLED {
            break;
        }
    }
    let f = DVector::from_column_slice(sweeps.forces());
    let motion = w * &f + q;
    let (force, length) = (f.amax(), motion.amax().max(q.amax()));
    friction
        .iter()
        .enumerate()
        .map(|(k, friction)| {
            let of = |all: &DVector<f64>| [all[3 * k], all[3 * k + 1], all[3 * k + 2]];
            lawful(of(&f), of(&motion), friction, [force, length])
        })
        .collect()
}

/// The contact with its mode; `None` if it violates a law.
pub(super) fn lawful(
    force: [f64; 3],
    motion: [f64; 3],
    friction: &Friction,
    [largest, length]: [f64; 2],
) -> Option<ConeContact> {
    let ([f_n, f_1, f_2], [gap, u_1, u_2]) = (force, motion);
    let (shear, slip) = (f_1.hypot(f_2), u_1.hypot(u_2));
    let limit = friction.limit(f_n);
    let touches = f_n > 0.0;
    let slides = slip > SOUND * length;
    let unlawful = match (touches, slides) {
        (false, _) => (-gap / length).max(shear / largest.max(f64::MIN_POSITIVE)),
        (true, false) => (gap.abs() / length).max((shear - limit) / largest),
        // The friction that the slip demands.
        (true, true) => {
            let off = (f_1 + limit * u_1 / slip).hypot(f_2 + limit * u_2 / slip);
            (gap.abs() / length).max(off / largest)
        }
    };
    let mode = match (touches, slides) {
        (false, _) => Mode::Free,
        (true, false) => Mode::Fixed,
        (true, true) => Mode::Sliding,
    };
    (unlawful <= SOUND).then_some(ConeContact {
        mode,
        force,
        motion,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn one(q: [f64; 3]) -> ConeContact {
        let w = DMatrix::from_row_slice(3, 3, &[2.0, 0.3, 0.0, 0.3, 1.0, 0.2, 0.0, 0.2, 1.5]);
        let friction = [Friction::from_coefficient(0.5, 0.0)];
        let found = solve(&w, &DVector::from_row_slice(&q), &friction);
        found.expect("a single contact has a solution")[0]
    }

    #[test]
    fn a_contact_opens_sticks_or_slides_against_its_motion() {
        assert_eq!(one([0.1, 5.0, 5.0]).mode, Mode::Free);
        assert_eq!(one([-1.0, 0.0, 0.0]).mode, Mode::Fixed);
        for turn in 0..8 {
            let (y, x) = (TAU * f64::from(turn) / 8.0).sin_cos();
            let found = one([-1.0, 3.0 * x, 3.0 * y]);
            assert_eq!(found.mode, Mode::Sliding);
            let [f_n, f_1, f_2] = found.force;
            let [_, u_1, u_2] = found.motion;
            assert!((f_1.hypot(f_2) - 0.5 * f_n).abs() < 1e-9);
            assert!(f_1 * u_1 + f_2 * u_2 < 0.0 && (f_1 * u_2 - f_2 * u_1).abs() < 1e-9);
        }
    }

    #[test]
    fn a_mirrored_problem_has_the_mirrored_solution() {
        // The second contact is the mirror image of the first in the plane of n and t.
        let block = [[2.0, 0.1, 0.2], [0.1, 1.0, 0.1], [0.2, 0.1, 1.2]];
        let mirror = [1.0, 1.0, -1.0];
        let w = DMatrix::from_fn(6, 6, |i, j| match (i / 3, j / 3) {
            (0, 0) => block[i][j],
            (1, 1) => block[i - 3][j - 3] * mirror[i - 3] * mirror[j - 3],
            _ if i % 3 == j % 3 => 0.2 * mirror[i % 3],
            _ => 0.0,
        });
        let q = DVector::from_row_slice(&[-1.0, 0.8, 1.1, -1.0, 0.8, -1.1]);
        let friction = [Friction::from_coefficient(0.4, 0.0); 2];
        let found = solve(&w, &q, &friction).expect("it converges");
        for (k, sign) in mirror.into_iter().enumerate() {
            let (a, b) = (found[0].force[k], found[1].force[k]);
            assert!((a - sign * b).abs() < 1e-9, "{found:?}");
        }
    }
}
