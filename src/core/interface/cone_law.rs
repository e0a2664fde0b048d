//! Coulomb's law at one contact in space with the forces of all others fixed: a step of block Gauss-Seidel (Jourdan, Alart and Jean
//! 1998). The direction of sliding is bracketed around the circle, then bisected.

use super::problem::AssumedMode;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::TAU;

/// Number of directions of sliding between which the direction is bracketed.
const DIRECTIONS: u32 = 72;
/// Halvings of a bracket.
const HALVINGS: u32 = 60;

/// The mode and the force of one contact with the columns `own` of its compliance, whose motion without its force is `free`.
pub(super) fn local(
    own: &[[f64; 3]; 3],
    free: [f64; 3],
    mu: f64,
    cohesion: f64,
) -> (AssumedMode, [f64; 3]) {
    let (w, b) = (
        Matrix3::from_columns(&own.map(Vector3::from)),
        Vector3::from(free),
    );
    if b[0] >= 0.0 {
        return (AssumedMode::Free, [0.0; 3]);
    }
    let stick = w.lu().solve(&b).map(|f| -f);
    if let Some(f) = stick
        && f[0] >= 0.0
        && f[1].hypot(f[2]) <= mu * f[0] + cohesion
    {
        return (AssumedMode::Fixed, f.into());
    }
    // In a direction: the force, and the motion along and across.
    let slide = |angle: f64| {
        let (sin, cos) = angle.sin_cos();
        let along = w[(0, 1)] * cos + w[(0, 2)] * sin;
        let f_n = (-b[0] - cohesion * along) / (w[(0, 0)] + mu * along);
        let limit = mu * f_n + cohesion;
        let f = Vector3::new(f_n, limit * cos, limit * sin);
        let u = w * f + b;
        (f, cos * u[1] + sin * u[2], cos * u[2] - sin * u[1])
    };
    let step = TAU / f64::from(DIRECTIONS);
    for k in 0..DIRECTIONS {
        let (mut low, mut high) = (step * f64::from(k), step * f64::from(k + 1));
        let below = slide(low).2 < 0.0;
        if (slide(high).2 < 0.0) == below {
            continue;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if (slide(middle).2 < 0.0) == below {
                low = middle
            } else {
                high = middle
            }
        }
        let (f, along, _) = slide(low);
        if f[0] >= 0.0 && along <= 0.0 {
            return (AssumedMode::Plus, f.into());
        }
    }
    let f_n = -b[0] / w[(0, 0)];
    (AssumedMode::Plus, [f_n.max(0.0), 0.0, 0.0])
}
