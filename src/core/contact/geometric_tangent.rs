//! Effect of rotation and motion of the interaction force with the surface: the geometric part of the contact tangent.
//!
//! The paper freezes normal, projection and gap during a major iteration, and its tangent omits their change. This module adds
//! that part: the second variation of gap and slip at the closest point S*, for force components F_n and F_t that are constant in
//! the frame that rotates with the surface. With τ = dx/dξ, m = τ·τ, k = n · d²x/dξ², and for the motion of one degree of freedom
//!
//! ```text
//! D = its part in u_S − u_S*                      (a vector)
//! L = n · its part in du_S*/dξ                    how it tilts the surface
//! X = (τ·D + g L) / (m − g k)                     how it moves S* along the surface
//! Δδg   = −(m−gk)/m (L_j X_i + L_i X_j) + g/m L_i L_j − k (m−gk)/m X_i X_j
//! Δδg_t = 1/√m (L_j + k X_j) n·D_i − t·(du_S*/dξ)_i X_j
//! ```
//!
//! (standard node-to-curve kinematics, for example Wriggers, *Computational Contact Mechanics*). At a node between two elements,
//! S* and the normal are determined by both elements, and none of this applies.

use crate::contact::projection::{Curve, Projection, tangent};
use crate::plane::dot;

/// Effect of the motion of one degree of freedom at S*.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Variation {
    /// n · D: change of the gap.
    normal: f64,
    /// L.
    tilt: f64,
    /// t · (du_S*/dξ).
    stretch: f64,
    /// X.
    travel: f64,
}

impl Variation {
    /// The variation for the displacement along `axis` (0 x, 1 y) of a node. `weight` is the node's weight in u_S* − u_S (−1 for
    /// the slave, N_i for master nodes), and `slope` the derivative of that weight with respect to ξ (0 for the slave).
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

/// m − g k: vanishes if S* is not unique.
fn stiffness(projection: &Projection, curve: &Curve) -> f64 {
    squared(curve) - projection.gap * bend(projection, curve)
}

fn squared(curve: &Curve) -> f64 {
    dot(curve.slope, curve.slope)
}

fn bend(projection: &Projection, curve: &Curve) -> f64 {
    dot(projection.normal, curve.bend)
}

/// Derivative of the interaction force at degree of freedom i with respect to degree of freedom j, with constant components F_n
/// and F_t (`force`): F_n Δδg + F_t Δδg_t.
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
    use crate::contact::projection::{project, projection_apart};
    use crate::contact::smooth::smooth;
    use crate::model::{Node, Surface};

    /// Nodes of a slave point with their weights.
    type Carriers<'a> = &'a [(usize, f64)];

    fn place(carriers: Carriers<'_>, x: &[[f64; 2]]) -> [f64; 2] {
        [0, 1].map(|axis| carriers.iter().map(|(n, w)| w * x[*n][axis]).sum())
    }

    /// Force on every degree of freedom for constant components, from a new projection.
    fn forces(
        surfaces: &[Surface],
        positions: &[[f64; 2]],
        carriers: Carriers<'_>,
        f: [f64; 2],
    ) -> Vec<f64> {
        let slave = place(carriers, positions);
        let spot = project(slave, surfaces, &[0], positions, None).unwrap();
        let at = projection_apart(true, surfaces, spot, positions, slave);
        let t = tangent(at.normal);
        let force = [0, 1].map(|a| f[0] * at.normal[a] + f[1] * t[a]);
        let mut all = vec![0.0; 2 * positions.len()];
        for (n, weight) in carriers {
            (0..2).for_each(|a| all[2 * n + a] += weight * force[a]);
        }
        for (&n, share) in surfaces[0].elements[spot.element].iter().zip(at.shape) {
            (0..2).for_each(|a| all[2 * n + a] -= share * force[a]);
        }
        all
    }

    fn surface(m: usize) -> Surface {
        Surface::new("s", vec![(1..=m).collect()], false)
    }

    /// Compares with central differences, at a point over the surface.
    fn check(surface: Surface, x: &[[f64; 2]], carriers: Carriers<'_>, what: &str) {
        let (surfaces, f) = ([surface], [2.0, -0.7]);
        let slave = place(carriers, x);
        let spot = project(slave, &surfaces, &[0], x, None).unwrap();
        let at = projection_apart(true, &surfaces, spot, x, slave);
        let curve = at.curve.unwrap();
        let nodes = &surfaces[0].elements[spot.element];
        let variation = |dof: usize| {
            let place = nodes.iter().position(|&n| n == dof / 2);
            let carrier = carriers.iter().find(|(n, _)| *n == dof / 2);
            let (weight, slope) = match (place, carrier) {
                (Some(i), _) => (at.shape[i], at.shape_slope[i]),
                (None, Some((_, weight))) => (-weight, 0.0),
                (None, None) => (0.0, 0.0),
            };
            Variation::new(&at, &curve, dof % 2, weight, slope)
        };
        for j in 0..2 * x.len() {
            let h = 1e-6;
            let mut moved = x.to_vec();
            moved[j / 2][j % 2] += h;
            let plus = forces(&surfaces, &moved, carriers, f);
            moved[j / 2][j % 2] -= 2.0 * h;
            let minus = forces(&surfaces, &moved, carriers, f);
            for i in 0..2 * x.len() {
                let difference = (plus[i] - minus[i]) / (2.0 * h);
                let exact = geometric_tangent(&at, &curve, f, &variation(i), &variation(j));
                assert!(
                    (difference - exact).abs() < 1e-7,
                    "{what} ({i}, {j}): {difference} {exact}"
                );
            }
        }
    }

    fn arc(count: usize) -> impl Iterator<Item = [f64; 2]> {
        let place = move |k: usize| 2.2 * k as f64 / (count - 1) as f64;
        (0..count).map(move |k| [place(k), 0.8 * (0.7 * place(k)).sin() + 0.1 * place(k)])
    }

    #[test]
    fn the_geometric_tangent_is_the_derivative_of_the_force_with_a_new_projection() {
        for m in 2..=5 {
            for gap in [-0.1, 0.0, 0.15] {
                let mut x = vec![[1.1 + 0.2 * gap, 0.9 - gap]];
                x.extend(arc(m));
                check(surface(m), &x, &[(0, 1.0)], &format!("m {m} gap {gap}"));
            }
        }
    }

    #[test]
    fn the_geometric_tangent_of_a_node_that_turns_around_a_vertex_is_exact() {
        let valley = Surface::new("s", vec![vec![1, 2], vec![2, 3]], false);
        for at in [[0.02, -0.3], [-0.05, -0.8]] {
            let x = [at, [1.0, 0.2], [0.0, 0.0], [-1.0, 0.1]];
            check(valley.clone(), &x, &[(0, 1.0)], &format!("{at:?}"));
        }
    }

    #[test]
    fn the_geometric_tangent_of_a_point_of_a_face_is_exact() {
        for m in 2..=5 {
            for gap in [-0.1, 0.0, 0.15] {
                let mut x = vec![[0.5 + 0.2 * gap, 0.8 - gap]];
                x.extend(arc(m));
                x.extend([[1.4, 0.9 - gap], [2.0, 1.2 - gap]]);
                // The functions of a side of three nodes at a Gauss point; one of them is negative.
                let carriers = [(0, 0.5), (m + 1, 0.65), (m + 2, -0.15)];
                check(surface(m), &x, &carriers, &format!("m {m} gap {gap}"));
            }
        }
    }

    #[test]
    fn the_geometric_tangent_is_exact_on_every_piece_of_a_smooth_chain() {
        let even: Vec<[f64; 2]> = [[0.0; 2]].into_iter().chain(arc(6)).collect();
        let nodes: Vec<Node> = even
            .iter()
            .map(|&at| Node {
                name: String::new(),
                at,
            })
            .collect();
        let mut chain = surface(6);
        smooth(&mut chain, &nodes);
        for (k, over) in [0.2, 0.75, 1.1, 1.5, 2.05].into_iter().enumerate() {
            for gap in [-0.1, 0.0, 0.15] {
                let mut x: Vec<[f64; 2]> = even.iter().map(|[x, y]| [*x, 1.1 * y]).collect();
                x[0] = [
                    over + 0.2 * gap,
                    1.1 * (0.8 * (0.7 * over).sin() + 0.1 * over) - gap,
                ];
                let spot = project(x[0], &[chain.clone()], &[0], &x, None).unwrap();
                assert_eq!(spot.element, k);
                check(
                    chain.clone(),
                    &x,
                    &[(0, 1.0)],
                    &format!("piece {k} gap {gap}"),
                );
            }
        }
    }
}
