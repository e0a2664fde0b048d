//! How the interaction force turns and travels with the surface: the geometric part of the contact tangent.
//!
//! The paper freezes normal, projection and gap during a major iteration, and its tangent leaves out how they change. This
//! module adds that part: the second variation of gap and slip at the closest point S*, for force components F_n and F_t
//! that are constant in the frame that turns with the surface. With τ = dx/dξ, m = τ·τ, k = n · d²x/dξ², and for the motion of
//! one degree of freedom
//!
//! ```text
//! D = its part in u_S − u_S*                      (a vector)
//! L = n · its part in du_S*/dξ                    how it tilts the surface
//! X = (τ·D + g L) / (m − g k)                     how it moves S* along the surface
//! Δδg   = −(m−gk)/m (L_j X_i + L_i X_j) + g/m L_i L_j − k (m−gk)/m X_i X_j
//! Δδg_t = 1/√m (L_j + k X_j) n·D_i − t·(du_S*/dξ)_i X_j
//! ```
//!
//! (standard node-to-curve kinematics, for example Wriggers, *Computational Contact Mechanics*). At a node where two
//! elements meet, S* and the normal are held by both of them and none of this applies.

use crate::contact::projection::{Curve, Projection, tangent};

/// What the motion of one degree of freedom does at S*.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Variation {
    /// n · D: what it opens.
    normal: f64,
    /// L.
    tilt: f64,
    /// t · (du_S*/dξ).
    stretch: f64,
    /// X.
    travel: f64,
}

impl Variation {
    /// The variation for the displacement along `axis` (0 x, 1 y) of a node. `weight` is the node's share in u_S* − u_S (−1
    /// for the slave, N_i for master nodes), and `slope` the derivative of that share by ξ (0 for the slave).
    pub fn new(
        projection: &Projection,
        curve: &Curve,
        axis: usize,
        weight: f64,
        slope: f64,
    ) -> Self {
        let (n, t) = (projection.normal, tangent(projection.normal));
        let tilt = n[axis] * slope;
        Variation {
            normal: -weight * n[axis],
            tilt,
            stretch: t[axis] * slope,
            travel: (-weight * curve.slope[axis] + projection.gap * tilt)
                / stiffness(projection, curve),
        }
    }
}

/// m − g k: vanishes where S* is no longer unique.
fn stiffness(projection: &Projection, curve: &Curve) -> f64 {
    squared(curve) - projection.gap * bend(projection, curve)
}

fn squared(curve: &Curve) -> f64 {
    curve.slope[0] * curve.slope[0] + curve.slope[1] * curve.slope[1]
}

fn bend(projection: &Projection, curve: &Curve) -> f64 {
    projection.normal[0] * curve.bend[0] + projection.normal[1] * curve.bend[1]
}

/// Derivative of the interaction force at degree of freedom i by degree of freedom j, with constant components F_n and F_t
/// (`force`): F_n Δδg + F_t Δδg_t.
pub fn geometric_tangent(
    projection: &Projection,
    curve: &Curve,
    force: [f64; 2],
    i: &Variation,
    j: &Variation,
) -> f64 {
    let (m, k, a) = (
        squared(curve),
        bend(projection, curve),
        stiffness(projection, curve),
    );
    let gap = -a / m * (j.tilt * i.travel + i.tilt * j.travel)
        + projection.gap / m * i.tilt * j.tilt
        - k * a / m * i.travel * j.travel;
    let slip = (j.tilt + k * j.travel) * i.normal / m.sqrt() - i.stretch * j.travel;
    force[0] * gap + force[1] * slip
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::projection::{project, projection_at};
    use crate::fem::lagrange::shape;
    use crate::model::Surface;

    /// Force on every degree of freedom (slave first) for constant components, about a projection made anew.
    fn forces(m: usize, positions: &[[f64; 2]], f: [f64; 2]) -> Vec<f64> {
        let surfaces = surface(m);
        let spot = project(positions[0], &surfaces, &[0], positions, None).unwrap();
        let at = projection_at(&surfaces, spot, positions, positions[0]);
        let t = tangent(at.normal);
        let force = [0, 1].map(|a| f[0] * at.normal[a] + f[1] * t[a]);
        let mut all = force.to_vec();
        (0..m).for_each(|i| all.extend(force.map(|f| -at.shape[i] * f)));
        all
    }

    fn surface(m: usize) -> Vec<Surface> {
        vec![Surface {
            name: "s".into(),
            elements: vec![(1..=m).collect()],
            rigid: false,
            endless: false,
            smooth: Vec::new(),
        }]
    }

    #[test]
    fn the_geometric_tangent_is_the_derivative_of_the_force_with_the_projection_made_anew() {
        for m in 2..=5 {
            for gap in [-0.1, 0.0, 0.15] {
                let arc = |k: usize| 2.2 * k as f64 / (m - 1) as f64;
                let mut x = vec![[1.1 + 0.2 * gap, 0.9 - gap]];
                x.extend((0..m).map(|k| [arc(k), 0.8 * (0.7 * arc(k)).sin() + 0.1 * arc(k)]));
                let f = [2.0, -0.7];
                let surfaces = surface(m);
                let spot = project(x[0], &surfaces, &[0], &x, None).unwrap();
                let at = projection_at(&surfaces, spot, &x, x[0]);
                let curve = at.curve.unwrap();
                let d = shape(m, spot.xi).d;
                let variation = |dof: usize| {
                    let (weight, slope) = if dof < 2 {
                        (-1.0, 0.0)
                    } else {
                        (at.shape[dof / 2 - 1], d[dof / 2 - 1])
                    };
                    Variation::new(&at, &curve, dof % 2, weight, slope)
                };
                for j in 0..2 * (m + 1) {
                    let h = 1e-6;
                    let mut moved = x.clone();
                    moved[j / 2][j % 2] += h;
                    let plus = forces(m, &moved, f);
                    moved[j / 2][j % 2] -= 2.0 * h;
                    let minus = forces(m, &moved, f);
                    for i in 0..2 * (m + 1) {
                        let difference = (plus[i] - minus[i]) / (2.0 * h);
                        let exact = geometric_tangent(&at, &curve, f, &variation(i), &variation(j));
                        assert!(
                            (difference - exact).abs() < 1e-7,
                            "m {m} gap {gap} ({i}, {j}): {difference} {exact}"
                        );
                    }
                }
            }
        }
    }
}
