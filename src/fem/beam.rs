//! Geometrically exact planar beam (Reissner 1972) with m-node Lagrange interpolation.
//!
//! The paper's "structural elements of Surana" are of this class: u, v and a rotation of any size at each of m nodes
//! on a curved axis, plane sections. With the section's angle φ = φ_0 + θ (φ_0 that of the reference axis), its axes
//! t = (cos φ, sin φ) and n = (−sin φ, cos φ), and ' the derivative by reference arc length,
//!
//! ```text
//! ε = t · r' − 1,   γ = n · r',   κ = θ',        N = EA ε,   Q = GA γ,   M = EI κ.
//! ```
//!
//! Rigid motions leave all three strains unchanged. The m − 1 points of the reduced Gauss rule avoid locking. A
//! shear-rigid beam (no GA) has Q at each Gauss point as an unknown of its own and γ = 0 as its equation: the limit
//! itself, not a penalty.
//!
//! The degrees of freedom of an element are ordered x, y, θ of node 1, of node 2, …, then Q at the Gauss points.

use crate::fem::lagrange::{MAX_NODES, gauss, shape};
use nalgebra::{Matrix3, Vector3};

/// Most degrees of freedom of one element: 3 per node, and a shear force per Gauss point.
pub const MAX_DOFS: usize = 3 * MAX_NODES + MAX_NODES - 1;

/// Section stiffnesses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// Axial stiffness (force).
    pub ea: f64,
    /// Bending stiffness (force · length²).
    pub ei: f64,
    /// Shear stiffness (force); none is shear-rigid.
    pub ga: Option<f64>,
}

/// What of an element does not change: shape functions and weights at its Gauss points.
#[derive(Debug, Clone)]
pub struct Element {
    nodes: usize,
    section: Section,
    points: Vec<GaussPoint>,
}

#[derive(Debug, Clone)]
struct GaussPoint {
    /// N_i.
    n: [f64; MAX_NODES],
    /// dN_i/ds, s the reference arc length.
    d: [f64; MAX_NODES],
    /// Weight times ds/dξ (length).
    weight: f64,
    /// Angle of the reference axis.
    angle: f64,
}

/// Strains and forces of a cross section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SectionState {
    /// ε, γ, κ.
    pub strain: Vector3<f64>,
    /// N, Q, M.
    pub force: Vector3<f64>,
}

impl Element {
    /// An element on these reference positions (2 to 9 of them).
    pub fn new(positions: &[[f64; 2]], section: Section) -> Self {
        let m = positions.len();
        let points = gauss(m - 1)
            .into_iter()
            .map(|(xi, weight)| {
                let s = shape(m, xi);
                let dx: f64 = (0..m).map(|i| s.d[i] * positions[i][0]).sum();
                let dy: f64 = (0..m).map(|i| s.d[i] * positions[i][1]).sum();
                let stretch = dx.hypot(dy);
                GaussPoint {
                    n: s.n,
                    d: s.d.map(|d| d / stretch),
                    weight: weight * stretch,
                    angle: dy.atan2(dx),
                }
            })
            .collect();
        Element {
            nodes: m,
            section,
            points,
        }
    }

    /// Number of Gauss points, m − 1.
    pub fn gauss_points(&self) -> usize {
        self.points.len()
    }

    /// Number of degrees of freedom.
    pub fn dofs(&self) -> usize {
        3 * self.nodes
            + if self.section.ga.is_none() {
                self.points.len()
            } else {
                0
            }
    }

    /// Strains and forces at Gauss point p, for displacements `u` of the element.
    pub fn section_state(&self, p: usize, u: &[f64]) -> SectionState {
        let (point, m) = (&self.points[p], self.nodes);
        let (mut h, mut theta, mut kappa) = ([0.0, 0.0], 0.0, 0.0);
        for i in 0..m {
            h[0] += point.d[i] * u[3 * i];
            h[1] += point.d[i] * u[3 * i + 1];
            theta += point.n[i] * u[3 * i + 2];
            kappa += point.d[i] * u[3 * i + 2];
        }
        let (s, c) = (point.angle + theta).sin_cos();
        let half = (0.5 * theta).sin();
        // With r' = axis + h, t · axis = cos θ and n · axis = −sin θ: so small strains of a stiff beam are not
        // differences of numbers near one.
        let axial = c * h[0] + s * h[1] - 2.0 * half * half;
        let shear = c * h[1] - s * h[0] - theta.sin();
        let q = match self.section.ga {
            Some(ga) => ga * shear,
            None => u[3 * m + p],
        };
        SectionState {
            strain: Vector3::new(axial, shear, kappa),
            force: Vector3::new(self.section.ea * axial, q, self.section.ei * kappa),
        }
    }

    /// Internal forces f = ∂Π/∂u, added to `force`, and the exact tangent ∂f/∂u, added to `tangent` (row by row,
    /// [`Element::dofs`] squared entries), for displacements `u` of the element.
    pub fn add(&self, u: &[f64], force: &mut [f64], tangent: &mut [f64]) {
        let (m, size) = (self.nodes, self.dofs());
        for p in 0..self.points.len() {
            let point = &self.points[p];
            let state = self.section_state(p, u);
            let theta: f64 = (0..m).map(|i| point.n[i] * u[3 * i + 2]).sum();
            let (s, c) = (point.angle + theta).sin_cos();
            let (w, stretch, shear) = (point.weight, 1.0 + state.strain.x, state.strain.y);
            let b = |i: usize| {
                let (n, d) = (point.n[i], point.d[i]);
                Matrix3::new(
                    c * d,
                    s * d,
                    shear * n,
                    -s * d,
                    c * d,
                    -stretch * n,
                    0.0,
                    0.0,
                    d,
                )
            };
            let stiffness = Matrix3::from_diagonal(&Vector3::new(
                self.section.ea,
                self.section.ga.unwrap_or(0.0),
                self.section.ei,
            ));
            let (normal, transverse) = (state.force.x, state.force.y);
            for i in 0..m {
                let bi = b(i);
                let f = bi.transpose() * state.force * w;
                for a in 0..3 {
                    force[3 * i + a] += f[a];
                }
                let left = bi.transpose() * stiffness * w;
                for j in 0..m {
                    let mut k = left * b(j);
                    let (ni, nj, di, dj) = (point.n[i], point.n[j], point.d[i], point.d[j]);
                    // Second variations of ε and γ: what turning the section does to a displaced axis.
                    let turn = [-normal * s - transverse * c, normal * c - transverse * s];
                    for a in 0..2 {
                        k[(a, 2)] += w * turn[a] * di * nj;
                        k[(2, a)] += w * turn[a] * ni * dj;
                    }
                    k[(2, 2)] -= w * (normal * stretch + transverse * shear) * ni * nj;
                    for a in 0..3 {
                        for e in 0..3 {
                            tangent[(3 * i + a) * size + 3 * j + e] += k[(a, e)];
                        }
                    }
                }
                if self.section.ga.is_none() {
                    let q = 3 * m + p;
                    for a in 0..3 {
                        tangent[(3 * i + a) * size + q] += w * bi[(1, a)];
                        tangent[q * size + 3 * i + a] += w * bi[(1, a)];
                    }
                }
            }
            if self.section.ga.is_none() {
                force[3 * m + p] += w * shear;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECTION: Section = Section {
        ea: 100.0,
        ei: 8.0,
        ga: Some(30.0),
    };

    fn curved(m: usize) -> Vec<[f64; 2]> {
        (0..m)
            .map(|i| i as f64 / (m - 1) as f64)
            .map(|t| [2.0 * t, 0.5 * (2.0 * t).sin()])
            .collect()
    }

    fn displaced(element: &Element, m: usize) -> Vec<f64> {
        (0..element.dofs())
            .map(|k| {
                if k < 3 * m {
                    0.4 * ((k * 7 % 11) as f64 / 11.0 - 0.5)
                } else {
                    3.0 - k as f64 % 5.0
                }
            })
            .collect()
    }

    fn evaluate(element: &Element, u: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let n = element.dofs();
        let (mut f, mut k) = (vec![0.0; n], vec![0.0; n * n]);
        element.add(u, &mut f, &mut k);
        (f, k)
    }

    #[test]
    fn the_tangent_is_the_derivative_of_the_force_and_symmetric() {
        for m in 2..=MAX_NODES {
            for ga in [Some(30.0), None] {
                let element = Element::new(&curved(m), Section { ga, ..SECTION });
                let u = displaced(&element, m);
                let (_, k) = evaluate(&element, &u);
                let n = element.dofs();
                let scale = k.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
                for j in 0..n {
                    let h = 1e-5;
                    let mut moved = u.clone();
                    moved[j] += h;
                    let (plus, _) = evaluate(&element, &moved);
                    moved[j] -= 2.0 * h;
                    let (minus, _) = evaluate(&element, &moved);
                    for i in 0..n {
                        let difference = (plus[i] - minus[i]) / (2.0 * h);
                        assert!(
                            (difference - k[i * n + j]).abs() < 1e-8 * scale,
                            "m {m} entry {i} {j}"
                        );
                        assert!((k[i * n + j] - k[j * n + i]).abs() < 1e-13 * scale);
                    }
                }
            }
        }
    }

    #[test]
    fn a_rigid_motion_strains_nothing() {
        for m in 2..=MAX_NODES {
            let x = curved(m);
            let element = Element::new(&x, SECTION);
            for angle in [0.3_f64, 2.5, -7.0] {
                let (s, c) = angle.sin_cos();
                let u: Vec<f64> = x
                    .iter()
                    .flat_map(|p| {
                        [
                            c * p[0] - s * p[1] - p[0] + 3.0,
                            s * p[0] + c * p[1] - p[1] - 1.0,
                            angle,
                        ]
                    })
                    .collect();
                let (f, _) = evaluate(&element, &u);
                assert!(
                    f.iter().all(|f| f.abs() < 1e-12 * SECTION.ea),
                    "m {m} angle {angle}: {f:?}"
                );
            }
        }
    }

    #[test]
    fn small_strains_of_a_stiff_beam_are_free_of_cancellation() {
        let element = Element::new(&[[0.0, 0.0], [1.0, 0.0]], SECTION);
        let state = element.section_state(0, &[0.0, 0.0, 0.0, 1e-18, 0.0, 0.0]);
        assert_eq!(state.strain.x, 1e-18);
    }
}
