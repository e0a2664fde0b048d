//! The 8-node isoparametric quadrilateral of the serendipity family, with finite rotations and strains.
//!
//! Nodes 1 to 4 are the corners, anticlockwise; 5 to 8 the middles of the sides 1-2, 2-3, 3-4, 4-1. Degrees of freedom
//! are x, y of node 1, of node 2, … With H = ∂u/∂X, F = I + H and a 3 × 3 Gauss rule,
//!
//! ```text
//! E = ½ (H + Hᵀ + Hᵀ H),      f_i = ∫ F S ∇N_i dV,
//! K_ij = ∫ B_iᵀ (dS/dE) B_j dV + I ∫ ∇N_i · S ∇N_j dV,      B_i = ∂E/∂u_i.
//! ```
//!
//! The same formulas serve both stress updates; they differ in what they are referred to.
//!
//! - **Total Lagrangian**: to the undeformed shape. A Gauss point remembers nothing.
//! - **Updated Lagrangian**, as in the paper: to the shape at the last accepted increment. There the point keeps its
//!   Cauchy stress σ_n (and how much it has thickened, in plane stress); in the increment f = ∂x/∂x_n,
//!   ε = ½ (fᵀ f − I), S = σ_n + c : ε with the moduli of the small-strain law, and on acceptance
//!   σ = f S fᵀ / det f. Rigid motions strain nothing here either, but the path is followed by chords: the answer
//!   depends on the size of the increments.
//!
//! Either way force and tangent are a pure function of (shape, [`Past`], displacements now), and the tangent is exact.

use crate::fem::element::{self, Past};
use crate::fem::lagrange::gauss;
use crate::fem::material::{Material, Response};
use crate::model::{Law, Update};
use nalgebra::{Matrix2, Vector3};
use std::sync::LazyLock;

/// Nodes of an element.
pub const NODES: usize = 8;
/// Degrees of freedom of an element.
pub const DOFS: usize = 2 * NODES;
/// Gauss points of an element.
pub const POINTS: usize = 9;
/// Numbers that a Gauss point remembers under the updated-Lagrangian update: σ11, σ22, σ12, and the thickness as a
/// multiple of the first one, less one. All zero before the first increment.
pub const MEMORY: usize = 4;

/// An element: its undeformed shape and what it is made of.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    at: [[f64; 2]; NODES],
    material: Material,
    update: Update,
    /// Gradients and areas of the Gauss points in the undeformed shape.
    points: Box<[Gradients; POINTS]>,
}

/// ∇N_i at a Gauss point in a shape, and the area that belongs to it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Gradients {
    grad: [[f64; 2]; NODES],
    area: f64,
}

/// State of a Gauss point, to look at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointState {
    /// Position in the undeformed shape.
    pub at: [f64; 2],
    /// F, in the plane.
    pub gradient: Matrix2<f64>,
    /// Cauchy stress σ11, σ22, σ12.
    pub cauchy: Vector3<f64>,
}

/// Shape functions at a Gauss point of the parent element.
struct Parent {
    n: [f64; NODES],
    /// ∂N/∂ξ, ∂N/∂η.
    d: [[f64; 2]; NODES],
    weight: f64,
}

static RULE: LazyLock<Vec<Parent>> = LazyLock::new(|| {
    let line = gauss(3);
    let pairs = line
        .iter()
        .flat_map(|b| line.iter().map(move |a| (a.0, b.0, a.1 * b.1)));
    pairs
        .map(|(xi, eta, weight)| {
            let (n, d) = shape(xi, eta);
            Parent { n, d, weight }
        })
        .collect()
});

/// Places of the nodes in the parent square.
pub const PLACES: [[f64; 2]; NODES] = [
    [-1.0, -1.0],
    [1.0, -1.0],
    [1.0, 1.0],
    [-1.0, 1.0],
    [0.0, -1.0],
    [1.0, 0.0],
    [0.0, 1.0],
    [-1.0, 0.0],
];

/// The shape functions and their derivatives by ξ and η.
pub fn shape(xi: f64, eta: f64) -> ([f64; NODES], [[f64; 2]; NODES]) {
    let (mut n, mut d) = ([0.0; NODES], [[0.0; 2]; NODES]);
    for (i, [a, b]) in PLACES.into_iter().enumerate() {
        let (p, q) = (1.0 + a * xi, 1.0 + b * eta);
        if a == 0.0 {
            let bubble = 1.0 - xi * xi;
            n[i] = 0.5 * bubble * q;
            d[i] = [-xi * q, 0.5 * bubble * b];
        } else if b == 0.0 {
            let bubble = 1.0 - eta * eta;
            n[i] = 0.5 * bubble * p;
            d[i] = [0.5 * bubble * a, -eta * p];
        } else {
            let rest = a * xi + b * eta - 1.0;
            n[i] = 0.25 * p * q * rest;
            d[i] = [0.25 * a * q * (rest + p), 0.25 * b * p * (rest + q)];
        }
    }
    (n, d)
}

/// Those of a Gauss point in a shape.
fn gradients(parent: &Parent, at: &[[f64; 2]; NODES]) -> Gradients {
    let mut j = [[0.0; 2]; 2];
    for (x, d) in at.iter().zip(&parent.d) {
        for a in 0..2 {
            for b in 0..2 {
                j[a][b] += d[a] * x[b];
            }
        }
    }
    let det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
    let inverse = [
        [j[1][1] / det, -j[0][1] / det],
        [-j[1][0] / det, j[0][0] / det],
    ];
    let turned = |d: [f64; 2]| {
        [
            inverse[0][0] * d[0] + inverse[0][1] * d[1],
            inverse[1][0] * d[0] + inverse[1][1] * d[1],
        ]
    };
    Gradients {
        grad: parent.d.map(turned),
        area: det * parent.weight,
    }
}

/// H = ∂u/∂X.
fn slope(grad: &[[f64; 2]; NODES], u: &[f64]) -> [[f64; 2]; 2] {
    let mut h = [[0.0; 2]; 2];
    for (i, g) in grad.iter().enumerate() {
        for a in 0..2 {
            for b in 0..2 {
                h[a][b] += u[2 * i + a] * g[b];
            }
        }
    }
    h
}

/// Green-Lagrange strain E11, E22, 2 E12.
fn strain(h: &[[f64; 2]; 2]) -> Vector3<f64> {
    Vector3::new(
        h[0][0] + 0.5 * (h[0][0] * h[0][0] + h[1][0] * h[1][0]),
        h[1][1] + 0.5 * (h[0][1] * h[0][1] + h[1][1] * h[1][1]),
        h[0][1] + h[1][0] + h[0][0] * h[0][1] + h[1][0] * h[1][1],
    )
}

fn plus_identity(h: &[[f64; 2]; 2]) -> Matrix2<f64> {
    Matrix2::new(1.0 + h[0][0], h[0][1], h[1][0], 1.0 + h[1][1])
}

/// What the formulas are referred to, and the displacements from there.
struct Reference {
    at: [[f64; 2]; NODES],
    u: [f64; DOFS],
}

/// A Gauss point's part of the integrals.
struct Point {
    grad: [[f64; 2]; NODES],
    h: [[f64; 2]; 2],
    /// Volume in the reference.
    volume: f64,
    response: Response,
}

impl Element {
    /// An element on these undeformed positions.
    pub fn new(at: [[f64; 2]; NODES], material: Material, update: Update) -> Self {
        Element {
            points: Box::new(std::array::from_fn(|p| gradients(&RULE[p], &at))),
            at,
            material,
            update,
        }
    }

    fn reference(&self, past: &Past<'_>, u: &[f64]) -> Reference {
        let mut reference = Reference {
            at: self.at,
            u: [0.0; DOFS],
        };
        reference.u.copy_from_slice(u);
        if self.update == Update::Updated {
            for k in 0..DOFS {
                reference.at[k / 2][k % 2] += past.u[k];
                reference.u[k] -= past.u[k];
            }
        }
        reference
    }

    /// Gauss point p; none where the material has no answer, or the reference shape is folded.
    fn point(&self, reference: &Reference, past: &Past<'_>, p: usize) -> Option<Point> {
        let Gradients { grad, area } = match self.update {
            Update::Total => self.points[p],
            Update::Updated => gradients(&RULE[p], &reference.at),
        };
        let h = slope(&grad, &reference.u);
        let strain = strain(&h);
        let (thickness, response) = match self.update {
            Update::Total => {
                // C does not know whether an element is turned inside out; J does.
                if self.material.law == Law::NeoHookean && plus_identity(&h).determinant() <= 0.0 {
                    return None;
                }
                (self.material.thickness, self.material.response(&strain)?)
            }
            Update::Updated => {
                let memory = &past.history[MEMORY * p..MEMORY * (p + 1)];
                let mut response = self.material.linear(&strain);
                response.stress += Vector3::new(memory[0], memory[1], memory[2]);
                (self.material.thickness * (1.0 + memory[3]), response)
            }
        };
        (area > 0.0).then_some(Point {
            grad,
            h,
            volume: area * thickness,
            response,
        })
    }

    /// State of Gauss point p; none where the material has no answer.
    pub fn point_state(&self, past: &Past<'_>, u: &[f64], p: usize) -> Option<PointState> {
        let point = self.point(&self.reference(past, u), past, p)?;
        let mut at = [0.0; 2];
        for (n, x) in RULE[p].n.iter().zip(&self.at) {
            at = [at[0] + n * x[0], at[1] + n * x[1]];
        }
        Some(PointState {
            at,
            gradient: plus_identity(&slope(&self.points[p].grad, u)),
            cauchy: point.cauchy(),
        })
    }
}

impl element::Element for Element {
    fn dofs(&self) -> usize {
        DOFS
    }

    fn history_len(&self) -> usize {
        history_len(self.update)
    }

    fn add(&self, past: &Past<'_>, u: &[f64], force: &mut [f64], tangent: &mut [f64]) -> bool {
        let reference = self.reference(past, u);
        let mut terms = [Terms::default(); POINTS];
        // ∇N of all nodes, one direction after the other: eight numbers side by side are what a processor is fast at.
        let mut grad = [[[0.0; NODES]; 2]; POINTS];
        for p in 0..POINTS {
            let Some(point) = self.point(&reference, past, p) else {
                return false;
            };
            for (i, [x, y]) in point.grad.into_iter().enumerate() {
                (grad[p][0][i], grad[p][1][i]) = (x, y);
            }
            terms[p] = point.terms();
        }
        for i in 0..NODES {
            // K_ij by the components of i and of j.
            let mut sums = [[[0.0; NODES]; 2]; 2];
            for (terms, grad) in terms.iter().zip(&grad) {
                let [x, y] = [grad[0][i], grad[1][i]];
                for a in 0..2 {
                    force[2 * i + a] += terms.stress[a][0] * x + terms.stress[a][1] * y;
                }
                terms.add_rows([x, y], grad, &mut sums);
            }
            for (a, sums) in sums.iter().enumerate() {
                let row = (2 * i + a) * DOFS;
                for j in i..NODES {
                    tangent[row + 2 * j] += sums[0][j];
                    tangent[row + 2 * j + 1] += sums[1][j];
                }
            }
        }
        true
    }

    fn resist(&self, past: &Past<'_>, u: &[f64], force: &mut [f64], _: &mut [f64]) -> bool {
        let reference = self.reference(past, u);
        for p in 0..POINTS {
            let Some(point) = self.point(&reference, past, p) else {
                return false;
            };
            let stress = point.nominal();
            for (i, [x, y]) in point.grad.into_iter().enumerate() {
                for a in 0..2 {
                    force[2 * i + a] += stress[a][0] * x + stress[a][1] * y;
                }
            }
        }
        true
    }

    fn advance(&self, past: &Past<'_>, u: &[f64], history: &mut [f64]) {
        if self.update == Update::Total {
            return;
        }
        let reference = self.reference(past, u);
        for p in 0..POINTS {
            let (old, new) = (
                &past.history[MEMORY * p..MEMORY * (p + 1)],
                &mut history[MEMORY * p..MEMORY * (p + 1)],
            );
            // Where there is no answer the increment cannot have been accepted.
            let Some(point) = self.point(&reference, past, p) else {
                continue;
            };
            new[..3].copy_from_slice(point.cauchy().as_slice());
            new[3] = (1.0 + old[3]) * point.stretch() - 1.0;
        }
    }

    fn mirror(&self, tangent: &mut [f64]) {
        for i in 2..DOFS {
            for j in 0..i & !1 {
                tangent[i * DOFS + j] = tangent[j * DOFS + i];
            }
        }
    }
}

/// How many numbers an element remembers from increment to increment.
pub fn history_len(update: Update) -> usize {
    match update {
        Update::Total => 0,
        Update::Updated => MEMORY * POINTS,
    }
}

/// P = F S, and its derivative by H, times the volume of a Gauss point.
#[derive(Clone, Copy, Default)]
struct Terms {
    stress: [[f64; 2]; 2],
    /// ∂P_aJ/∂H_cL at [a][J][L][c].
    moduli: [[[[f64; 2]; 2]; 2]; 2],
}

impl Terms {
    /// Adds Σ_JL N_i,J ∂P_aJ/∂H_cL N_j,L to [a][c][j], where N_i,J are x and y.
    fn add_rows(
        &self,
        [x, y]: [f64; 2],
        grad: &[[f64; NODES]; 2],
        sums: &mut [[[f64; NODES]; 2]; 2],
    ) {
        for (moduli, sums) in self.moduli.iter().zip(sums) {
            for (c, sums) in sums.iter_mut().enumerate() {
                let by_x = moduli[0][0][c] * x + moduli[1][0][c] * y;
                let by_y = moduli[0][1][c] * x + moduli[1][1][c] * y;
                for (sum, (x, y)) in sums.iter_mut().zip(grad[0].iter().zip(&grad[1])) {
                    *sum += by_x * x + by_y * y;
                }
            }
        }
    }
}

impl Point {
    /// F.
    fn deformation(&self) -> [[f64; 2]; 2] {
        let h = &self.h;
        [[1.0 + h[0][0], h[0][1]], [h[1][0], 1.0 + h[1][1]]]
    }

    /// S, times the volume.
    fn stress(&self) -> [[f64; 2]; 2] {
        let (v, s) = (self.volume, &self.response.stress);
        [[v * s.x, v * s.z], [v * s.z, v * s.y]]
    }

    /// P = F S, times the volume.
    fn nominal(&self) -> [[f64; 2]; 2] {
        let s = self.stress();
        self.deformation().map(|f| {
            [
                f[0] * s[0][0] + f[1] * s[1][0],
                f[0] * s[0][1] + f[1] * s[1][1],
            ]
        })
    }

    fn terms(&self) -> Terms {
        let (f, s) = (self.deformation(), self.stress());
        let (v, d) = (self.volume, &self.response.tangent);
        let mut terms = Terms {
            stress: self.nominal(),
            ..Terms::default()
        };
        for l in 0..2 {
            for c in 0..2 {
                // ∂E/∂H_cL has F_cL in its component L and, as shear, the other one of F; and D times it.
                let [own, shear] = [f[c][l], f[c][1 - l]];
                let answer = [0, 1, 2].map(|k| v * (d[(k, l)] * own + d[(k, 2)] * shear));
                for (a, (f, moduli)) in f.iter().zip(&mut terms.moduli).enumerate() {
                    for j in 0..2 {
                        let geometric = if a == c { s[j][l] } else { 0.0 };
                        moduli[j][l][c] = f[j] * answer[j] + f[1 - j] * answer[2] + geometric;
                    }
                }
            }
        }
        terms
    }

    /// Stretch across the plane.
    fn stretch(&self) -> f64 {
        (1.0 + 2.0 * self.response.thickening).max(0.0).sqrt()
    }

    /// σ = F S Fᵀ / J.
    fn cauchy(&self) -> Vector3<f64> {
        let (f, s) = (plus_identity(&self.h), self.response.stress);
        let sigma = f * Matrix2::new(s.x, s.z, s.z, s.y) * f.transpose()
            / (f.determinant() * self.stretch());
        Vector3::new(
            sigma[(0, 0)],
            sigma[(1, 1)],
            0.5 * (sigma[(0, 1)] + sigma[(1, 0)]),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::element::Element as _;
    use crate::model::Elastic;
    use crate::model::Plane;

    fn elastic(law: Law, plane: Plane, update: Update) -> Elastic {
        Elastic {
            young: 100.0,
            poisson: 0.3,
            law,
            plane,
            thickness: 0.7,
            update,
        }
    }

    /// Every choice that there is.
    fn kinds() -> Vec<Elastic> {
        let mut kinds = Vec::new();
        for plane in [Plane::Strain, Plane::Stress] {
            kinds.push(elastic(Law::Svk, plane, Update::Total));
            kinds.push(elastic(Law::NeoHookean, plane, Update::Total));
            kinds.push(elastic(Law::Svk, plane, Update::Updated));
        }
        kinds
    }

    /// A distorted quadrilateral with bent sides.
    const AT: [[f64; 2]; NODES] = [
        [0.0, 0.0],
        [2.0, -0.2],
        [2.3, 1.6],
        [-0.1, 1.3],
        [1.0, -0.2],
        [2.2, 0.7],
        [1.1, 1.4],
        [0.1, 0.6],
    ];

    fn element(elastic: &Elastic) -> Element {
        Element::new(AT, Material::new(elastic), elastic.update)
    }

    fn noise(k: usize, size: f64) -> f64 {
        size * ((k * 7 % 11) as f64 / 11.0 - 0.5)
    }

    /// A past that is no rest: displacements, stresses and thickness of some size.
    fn past() -> (Vec<f64>, Vec<f64>) {
        let u = (0..DOFS).map(|k| noise(k + 3, 0.2)).collect();
        let history = (0..MEMORY * POINTS)
            .map(|k| noise(k, if k % MEMORY == 3 { 0.1 } else { 20.0 }))
            .collect();
        (u, history)
    }

    fn evaluate(element: &Element, past: &Past<'_>, u: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (mut f, mut k) = (vec![0.0; DOFS], vec![0.0; DOFS * DOFS]);
        assert!(element.add(past, u, &mut f, &mut k));
        element.mirror(&mut k);
        (f, k)
    }

    #[test]
    fn shape_functions_reproduce_what_eight_nodes_can() {
        let powers: [fn(f64, f64) -> f64; 8] = [
            |_, _| 1.0,
            |x, _| x,
            |_, y| y,
            |x, y| x * y,
            |x, _| x * x,
            |_, y| y * y,
            |x, y| x * x * y,
            |x, y| x * y * y,
        ];
        for (xi, eta) in [(0.3, -0.8), (1.0, 1.0), (-0.5, 0.1)] {
            let (n, d) = shape(xi, eta);
            for f in powers {
                let sum = |w: &dyn Fn(usize) -> f64| -> f64 {
                    (0..NODES)
                        .map(|i| w(i) * f(PLACES[i][0], PLACES[i][1]))
                        .sum()
                };
                assert!((sum(&|i| n[i]) - f(xi, eta)).abs() < 1e-15);
                let h = 1e-5;
                let by_xi = (f(xi + h, eta) - f(xi - h, eta)) / (2.0 * h);
                let by_eta = (f(xi, eta + h) - f(xi, eta - h)) / (2.0 * h);
                assert!((sum(&|i| d[i][0]) - by_xi).abs() < 1e-9);
                assert!((sum(&|i| d[i][1]) - by_eta).abs() < 1e-9);
            }
        }
    }

    /// x' = R x + (3, −1) as displacements.
    fn rigid(angle: f64) -> Vec<f64> {
        let (s, c) = angle.sin_cos();
        AT.iter()
            .flat_map(|p| {
                [
                    c * p[0] - s * p[1] - p[0] + 3.0,
                    s * p[0] + c * p[1] - p[1] - 1.0,
                ]
            })
            .collect()
    }

    #[test]
    fn a_rigid_motion_strains_nothing_and_turns_the_stress_that_is_there() {
        let (rest, none) = ([0.0; DOFS], [0.0; MEMORY * POINTS]);
        for kind in kinds() {
            for angle in [0.3_f64, 2.5, -7.0] {
                let element = element(&kind);
                let past = Past {
                    u: &rest,
                    history: &none,
                };
                let (f, _) = evaluate(&element, &past, &rigid(angle));
                assert!(f.iter().all(|f| f.abs() < 1e-12 * kind.young), "{f:?}");
            }
        }
        let (_, history) = past();
        let element = element(&elastic(Law::Svk, Plane::Stress, Update::Updated));
        let past = Past {
            u: &rest,
            history: &history,
        };
        let mut turned = vec![0.0; element.history_len()];
        element.advance(&past, &rigid(std::f64::consts::FRAC_PI_2), &mut turned);
        for (old, new) in history.chunks(MEMORY).zip(turned.chunks(MEMORY)) {
            let expected = [old[1], old[0], -old[2], old[3]];
            for (a, b) in new.iter().zip(expected) {
                assert!((a - b).abs() < 1e-12 * kind_scale(old));
            }
        }
    }

    fn kind_scale(history: &[f64]) -> f64 {
        history.iter().fold(100.0_f64, |m, x| m.max(x.abs()))
    }

    #[test]
    fn one_small_updated_step_is_the_total_one() {
        let (rest, none) = ([0.0; DOFS], [0.0; MEMORY * POINTS]);
        let past = Past {
            u: &rest,
            history: &none,
        };
        let u: Vec<f64> = (0..DOFS).map(|k| noise(k, 0.1)).collect();
        for plane in [Plane::Strain, Plane::Stress] {
            let [total, updated] = [Update::Total, Update::Updated]
                .map(|update| evaluate(&element(&elastic(Law::Svk, plane, update)), &past, &u).0);
            // From rest both are referred to the undeformed shape.
            for (a, b) in total.iter().zip(&updated) {
                assert!((a - b).abs() < 1e-13 * 100.0);
            }
        }
    }

    #[test]
    fn cauchy_stress_is_in_balance_with_the_force() {
        // Virtual power of a uniform velocity gradient: Σ f_i · v_i = ∫ σ : grad v dv, for one homogeneous state.
        let (rest, none) = ([0.0; DOFS], [0.0; MEMORY * POINTS]);
        let past = Past {
            u: &rest,
            history: &none,
        };
        let g = Matrix2::new(0.3, -0.2, 0.1, -0.25);
        let u: Vec<f64> = AT
            .iter()
            .flat_map(|x| {
                [
                    g[(0, 0)] * x[0] + g[(0, 1)] * x[1],
                    g[(1, 0)] * x[0] + g[(1, 1)] * x[1],
                ]
            })
            .collect();
        for kind in kinds().into_iter().filter(|k| k.update == Update::Total) {
            let element = element(&kind);
            let (f, _) = evaluate(&element, &past, &u);
            let states: Vec<PointState> = (0..POINTS)
                .map(|p| element.point_state(&past, &u, p).unwrap())
                .collect();
            let sigma = states[0].cauchy;
            for s in &states {
                assert!((s.cauchy - sigma).amax() < 1e-12 * 100.0);
                assert!((s.gradient - Matrix2::identity() - g).amax() < 1e-14);
            }
            let now: Vec<f64> = (0..DOFS).map(|k| AT[k / 2][k % 2] + u[k]).collect();
            let volume: f64 = (0..POINTS)
                .map(|p| {
                    let point = element
                        .point(&element.reference(&past, &u), &past, p)
                        .unwrap();
                    point.volume * states[p].gradient.determinant() * point.stretch()
                })
                .sum();
            for (a, b, component) in [(0, 0, 0), (1, 1, 1), (0, 1, 2)] {
                let power: f64 = (0..NODES).map(|i| f[2 * i + a] * now[2 * i + b]).sum();
                assert!(
                    (power - volume * sigma[component]).abs() < 1e-12 * 100.0,
                    "{kind:?}"
                );
            }
        }
    }

    #[test]
    fn an_element_turned_inside_out_is_refused_by_the_law_that_cannot_bear_it() {
        let past = Past {
            u: &[0.0; DOFS],
            history: &[],
        };
        let flipped: Vec<f64> = AT.iter().flat_map(|x| [-2.0 * x[0], 0.0]).collect();
        let (mut f, mut k) = ([0.0; DOFS], [0.0; DOFS * DOFS]);
        let neo = element(&elastic(Law::NeoHookean, Plane::Strain, Update::Total));
        assert!(!neo.add(&past, &flipped, &mut f, &mut k));
    }
}
