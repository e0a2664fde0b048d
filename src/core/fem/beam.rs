//! Geometrically exact planar beam (Reissner 1972) with m-node Lagrange interpolation.
//!
//! The paper's "structural elements of Surana" belong to this class: u, v and an arbitrarily large rotation at each of m nodes on
//! a curved axis, with plane sections. With the section's angle φ = φ_0 + θ (φ_0 that of the reference axis), its axes t = (cos
//! φ, sin φ) and n = (−sin φ, cos φ), and ' the derivative with respect to the reference arc length,
//!
//! ```text
//! ε = t · r' − 1,   γ = n · r',   κ = θ',        N = EA ε,   Q = GA γ,   M = EI κ.
//! ```
//!
//! Rigid motions leave all three strains unchanged. The m − 1 points of the reduced Gauss rule prevent locking. A shear-rigid
//! beam (no GA) has Q at each Gauss point as an additional unknown with the equation γ = 0: this is the exact limit, not a
//! penalty.
//!
//! The degrees of freedom of an element are ordered x, y, θ of node 1, of node 2, …, then Q at the Gauss points.

use crate::fem::element::{self, Element as _, Previous};
use crate::fem::lagrange::{MAX_NODES, gauss, shape};
use nalgebra::Vector3;

/// Section stiffnesses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// Axial stiffness (force).
    pub ea: f64,
    /// Bending stiffness (force · length²).
    pub ei: f64,
    /// Shear stiffness (force); `None` for shear-rigid.
    pub ga: Option<f64>,
}

/// Constant data of an element: shape functions and weights at its Gauss points.
#[derive(Debug, Clone)]
pub struct BeamElement {
    nodes: usize,
    section: Section,
    points: Vec<GaussPoint>,
}

#[derive(Debug, Clone)]
struct GaussPoint {
    /// N_i.
    n: [f64; MAX_NODES],
    /// dN_i/ds with the reference arc length s.
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

impl BeamElement {
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
        BeamElement {
            nodes: m,
            section,
            points,
        }
    }

    /// Number of Gauss points, m − 1.
    pub fn gauss_points(&self) -> usize {
        self.points.len()
    }

    /// Strains and forces at Gauss point p, for displacements `u` of the element, and t of the section.
    fn section(&self, p: usize, u: &[f64]) -> (SectionState, [f64; 2]) {
        let (point, m) = (&self.points[p], self.nodes);
        let (mut h, mut theta, mut kappa) = ([0.0, 0.0], 0.0, 0.0);
        let shares = point.n.iter().zip(&point.d).take(m);
        for (u, (n, d)) in u.chunks_exact(3).zip(shares) {
            h[0] += d * u[0];
            h[1] += d * u[1];
            theta += n * u[2];
            kappa += d * u[2];
        }
        let (s, c) = (point.angle + theta).sin_cos();
        let half = (0.5 * theta).sin();
        // With r' = axis + h, t · axis = cos θ and n · axis = −sin θ, small strains of a stiff beam are not differences of
        // numbers near one.
        let axial = c * h[0] + s * h[1] - 2.0 * half * half;
        let shear = c * h[1] - s * h[0] - theta.sin();
        let q = match self.section.ga {
            Some(ga) => ga * shear,
            None => u[3 * m + p],
        };
        let state = SectionState {
            strain: Vector3::new(axial, shear, kappa),
            force: Vector3::new(self.section.ea * axial, q, self.section.ei * kappa),
        };
        (state, [c, s])
    }

    /// The parts of the nodes' rows and columns that are common at a Gauss point. The strains' derivatives with respect to the
    /// motion of node i are d_i P + n_i Q with P = [t, n in the first two rows; κ in the third], and Q has entries in its third
    /// column only.
    fn moduli(&self, weight: f64, [c, s]: [f64; 2], state: &SectionState) -> Moduli {
        let (w, stretch, shear) = (weight, 1.0 + state.strain.x, state.strain.y);
        let (normal, transverse) = (state.force.x, state.force.y);
        let (ea, ei) = (self.section.ea, self.section.ei);
        let ga = self.section.ga.unwrap_or(0.0);
        let resultant = [
            w * (c * normal - s * transverse),
            w * (s * normal + c * transverse),
        ];
        // EA ε' and GA γ' for a unit rotation, plus the effect of rotating the section, from the second variations of ε and γ.
        let (axial, sheared) = (w * ea * shear, -w * ga * stretch);
        Moduli {
            resultant,
            moment: w * state.force.z,
            couple: w * (shear * normal - stretch * transverse),
            direct: [
                w * (c * c * ea + s * s * ga),
                w * c * s * (ea - ga),
                w * (s * s * ea + c * c * ga),
            ],
            mixed: [
                c * axial - s * sheared - resultant[1],
                s * axial + c * sheared + resultant[0],
            ],
            bending: w * ei,
            rotary: shear * axial - stretch * sheared - w * (normal * stretch + transverse * shear),
            constraint: [-w * s, w * c, -w * stretch],
        }
    }

    /// Q at Gauss point p as an unknown, and γ = 0 as its equation.
    fn add_constraint(
        &self,
        p: usize,
        moduli: &Moduli,
        shear: f64,
        force: &mut [f64],
        tangent: &mut [f64],
    ) {
        let (m, size, point) = (self.nodes, self.dofs(), &self.points[p]);
        let q = 3 * m + p;
        let [x, y, turn] = moduli.constraint;
        for i in 0..m {
            let row = [point.d[i] * x, point.d[i] * y, point.n[i] * turn];
            for (a, value) in row.into_iter().enumerate() {
                tangent[(3 * i + a) * size + q] += value;
                tangent[q * size + 3 * i + a] += value;
            }
        }
        force[q] += point.weight * shear;
    }
}

impl element::Element for BeamElement {
    fn dofs(&self) -> usize {
        3 * self.nodes
            + if self.section.ga.is_none() {
                self.points.len()
            } else {
                0
            }
    }

    fn add(&self, _past: &Previous<'_>, u: &[f64], force: &mut [f64], tangent: &mut [f64]) -> bool {
        let (m, size) = (self.nodes, self.dofs());
        for (p, point) in self.points.iter().enumerate() {
            let (state, along) = self.section(p, u);
            let moduli = self.moduli(point.weight, along, &state);
            let (n, d) = (&point.n[..m], &point.d[..m]);
            for i in 0..m {
                let (n_i, d_i) = (n[i], d[i]);
                let [x, y, turn] = &mut force[3 * i..3 * i + 3] else {
                    continue;
                };
                *x += d_i * moduli.resultant[0];
                *y += d_i * moduli.resultant[1];
                *turn += d_i * moduli.moment + n_i * moduli.couple;
                let rows = &mut tangent[3 * i * size..(3 * i + 3) * size];
                moduli.add_rows(n_i, d_i, (n, d), rows);
            }
            if self.section.ga.is_none() {
                self.add_constraint(p, &moduli, state.strain.y, force, tangent);
            }
        }
        true
    }
}

/// Force and tangent of a Gauss point without the shape functions.
struct Moduli {
    /// N t + Q n (force).
    resultant: [f64; 2],
    moment: f64,
    /// Derivative of ε and γ with respect to the rotation.
    couple: f64,
    /// xx, xy, yy of d_i d_j.
    direct: [f64; 3],
    /// Of d_i n_j between a displacement and a rotation.
    mixed: [f64; 2],
    /// Of d_i d_j and of n_i n_j between rotations.
    bending: f64,
    rotary: f64,
    /// Derivative of γ: with respect to displacements (times d_i), and to the rotation (times n_i).
    constraint: [f64; 3],
}

impl Moduli {
    /// Adds the three rows of a node with n_i, d_i.
    fn add_rows(&self, n_i: f64, d_i: f64, (n, d): (&[f64], &[f64]), rows: &mut [f64]) {
        let size = rows.len() / 3;
        let (row_x, rest) = rows.split_at_mut(size);
        let (row_y, row_turn) = rest.split_at_mut(size);
        let [xx, xy, yy] = self.direct.map(|v| d_i * v);
        let [x_turn, y_turn] = self.mixed.map(|v| d_i * v);
        let [turn_x, turn_y] = self.mixed.map(|v| n_i * v);
        let (bending, rotary) = (d_i * self.bending, n_i * self.rotary);
        let columns = row_x
            .chunks_exact_mut(3)
            .zip(row_y.chunks_exact_mut(3))
            .zip(row_turn.chunks_exact_mut(3));
        for (((x, y), turn), (n_j, d_j)) in columns.zip(n.iter().zip(d)) {
            x[0] += xx * d_j;
            x[1] += xy * d_j;
            x[2] += x_turn * n_j;
            y[0] += xy * d_j;
            y[1] += yy * d_j;
            y[2] += y_turn * n_j;
            turn[0] += turn_x * d_j;
            turn[1] += turn_y * d_j;
            turn[2] += bending * d_j + rotary * n_j;
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

    #[test]
    fn small_strains_of_a_stiff_beam_are_free_of_cancellation() {
        let element = BeamElement::new(&[[0.0, 0.0], [1.0, 0.0]], SECTION);
        let (state, _) = element.section(0, &[0.0, 0.0, 0.0, 1e-18, 0.0, 0.0]);
        assert_eq!(state.strain.x, 1e-18);
    }
}
