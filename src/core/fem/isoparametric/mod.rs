//! The isoparametric continuum element, with finite rotations and strains: one formulation for every kind of
//! [`super::kinds`].
//!
//! The degrees of freedom are x, y of node 1, of node 2, … With H = ∂u/∂X, F = I + H and the rule of the kind,
//!
//! ```text
//! E = ½ (H + Hᵀ + Hᵀ H),      f_i = ∫ F S ∇N_i dV,
//! K_ij = ∫ B_iᵀ (dS/dE) B_j dV + I ∫ ∇N_i · S ∇N_j dV,      B_i = ∂E/∂u_i.
//! ```
//!
//! In axisymmetry (`HOOP`; x is the radius X) there is a hoop strain: F33 = 1 + h with h = u_x/X, E33 = h + h²/2. It adds P33
//! N_i/X to the force along x, with P33 = F33 S33, and dV = 2π X dA: forces refer to the whole circumference.
//!
//! The same formulas serve both stress updates, which differ in their reference configuration:
//!
//! - **Total Lagrangian**: the undeformed shape. A Gauss point has no history.
//! - **Updated Lagrangian**, as in the paper: the shape at the last accepted increment. The history of a Gauss point is its
//!   Cauchy stress σ_n (and in plane stress its thickness stretch). Within the increment f = ∂x/∂x_n, ε = ½ (fᵀ f − I), S = σ_n +
//!   c : ε with the moduli of the small-strain law, and on acceptance σ = f S fᵀ / det f. Rigid motions cause no strain here
//!   either, but the path is approximated by chords: the result depends on the increment size.
//!
//! In both cases force and tangent are pure functions of (shape, [`Previous`], current displacements), and the tangent is exact.

use crate::Material;
use crate::elements::kinds::continuum_kind::Parent;
use crate::fem::element::{self, Previous};
use crate::fem::material::Response;
use crate::linalg::vectorise;
use crate::model::{Law, Update};
use crate::plane::max_abs;
use nalgebra::{Matrix2, Vector3};
use ring::{Ring, RingTerms};
use std::f64::consts::PI;

mod ring;
#[cfg(test)]
mod tests;

/// Number of history variables of a Gauss point with the updated Lagrangian formulation: σ11, σ22, σ12, and the thickness stretch
/// minus one in plane stress, or σ33 in axisymmetry. All are zero before the first increment.
pub const MEMORY: usize = 4;

/// An element has no area at a point where det ∂X/∂ξ is below this fraction of the square of the largest ∂X/∂ξ.
const FLAT: f64 = 1e-9;

/// An element with N nodes and P points, of a plane body or (`HOOP`) a body of revolution: its undeformed shape and its material.
#[derive(Debug, Clone, PartialEq)]
pub struct ContinuumElement<const N: usize, const P: usize, const HOOP: bool> {
    at: [[f64; 2]; N],
    rule: &'static [Parent<N>; P],
    material: Material,
    update: Update,
    /// Gradients and areas at the Gauss points in the undeformed shape.
    points: Box<[Gradients<N>; P]>,
}

/// ∇N_i at a Gauss point in a given shape, and the point's area.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Gradients<const N: usize> {
    grad: [[f64; 2]; N],
    area: f64,
}

/// State of a Gauss point, for output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointState {
    /// F, in the plane.
    pub gradient: Matrix2<f64>,
    /// Cauchy stress σ11, σ22, σ12.
    pub cauchy: Vector3<f64>,
    /// σ33. In plane strain with the updated formulation, which does not store it, ν (σ11 + σ22); the error is of second order in
    /// the strain.
    pub across: f64,
}

/// The gradients at a Gauss point in a given shape.
#[inline(always)]
fn gradients<const N: usize>(parent: &Parent<N>, at: &[[f64; 2]; N]) -> Gradients<N> {
    let (inverse, det) = inverse(slope(at, &parent.d));
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

/// The inverse of a matrix, and its determinant.
#[inline(always)]
fn inverse(m: [[f64; 2]; 2]) -> ([[f64; 2]; 2], f64) {
    let det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    let inverse = [
        [m[1][1] / det, -m[0][1] / det],
        [-m[1][0] / det, m[0][0] / det],
    ];
    (inverse, det)
}

/// H = ∂u/∂X.
#[inline(always)]
fn slope<const N: usize>(grad: &[[f64; 2]; N], u: &[[f64; 2]; N]) -> [[f64; 2]; 2] {
    let mut h = [[0.0; 2]; 2];
    for (u, g) in u.iter().zip(grad) {
        for a in 0..2 {
            for b in 0..2 {
                h[a][b] += u[a] * g[b];
            }
        }
    }
    h
}

/// H at a point of the parent element, from the undeformed positions of the nodes and their displacements. `None` if the undeformed
/// element has no area.
pub(super) fn slope_at<const N: usize>(
    parent: &Parent<N>,
    nodes: &[[f64; 4]; N],
) -> Option<[[f64; 2]; 2]> {
    let mut by = [[0.0; 4]; 2];
    for (node, d) in nodes.iter().zip(&parent.d) {
        for (sums, d) in by.iter_mut().zip(d) {
            for (sum, x) in sums.iter_mut().zip(node) {
                *sum += d * x;
            }
        }
    }
    let rows = |first: usize| [first, first + 1].map(|k| [by[0][k], by[1][k]]);
    let (by_x, by_u) = (rows(0), rows(2));
    let (inverse, det) = inverse(by_x);
    let size = max_abs(by_x.iter().flatten());
    let row = |by_u: [f64; 2]| [0, 1].map(|b| by_u[0] * inverse[0][b] + by_u[1] * inverse[1][b]);
    (det > FLAT * size * size).then(|| by_u.map(row))
}

/// Green-Lagrange strain E11, E22, 2 E12.
#[inline(always)]
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

/// The reference configuration of the formulas, and the displacements from it.
struct Reference<const N: usize> {
    at: [[f64; 2]; N],
    u: [[f64; 2]; N],
}

/// The contribution of a Gauss point to the integrals.
struct Point<const N: usize> {
    grad: [[f64; 2]; N],
    h: [[f64; 2]; 2],
    /// Reference volume.
    volume: f64,
    response: Response,
    /// The hoop direction; `None` in the plane.
    ring: Option<Ring<N>>,
}

/// x and y of each of N nodes.
#[inline(always)]
fn pairs<const N: usize>(u: &[f64]) -> [[f64; 2]; N] {
    let mut pairs = [[0.0; 2]; N];
    for (pair, u) in pairs.iter_mut().zip(u.chunks_exact(2)) {
        *pair = [u[0], u[1]];
    }
    pairs
}

impl<const N: usize, const P: usize, const HOOP: bool> ContinuumElement<N, P, HOOP> {
    /// An element on these undeformed positions, integrated by this rule.
    pub fn new(
        rule: &'static [Parent<N>; P],
        at: [[f64; 2]; N],
        material: Material,
        update: Update,
    ) -> Self {
        ContinuumElement {
            points: Box::new(std::array::from_fn(|p| gradients(&rule[p], &at))),
            at,
            rule,
            material,
            update,
        }
    }

    #[inline(always)]
    fn reference(&self, past: &Previous<'_>, u: &[f64]) -> Reference<N> {
        let mut reference = Reference {
            at: self.at,
            u: pairs(u),
        };
        if self.update == Update::Updated {
            let before: [[f64; 2]; N] = pairs(past.u);
            for (i, before) in before.into_iter().enumerate() {
                for (a, before) in before.into_iter().enumerate() {
                    reference.at[i][a] += before;
                    reference.u[i][a] -= before;
                }
            }
        }
        reference
    }

    /// Gauss point p; `None` if the material has no response, or the reference shape is folded.
    #[inline(always)]
    fn point(&self, reference: &Reference<N>, past: &Previous<'_>, p: usize) -> Option<Point<N>> {
        let Gradients { grad, area } = match self.update {
            Update::Total | Update::Small => self.points[p],
            Update::Updated => gradients(&self.rule[p], &reference.at),
        };
        let h = slope(&grad, &reference.u);
        if HOOP {
            let ring = Ring::new(&self.rule[p], &reference.at, &reference.u);
            return self.point_of_revolution(past, p, (grad, area), h, ring);
        }
        let strain = strain(&h);
        let (thickness, response) = match self.update {
            Update::Total | Update::Small => {
                // C is the same for an inverted element; only J shows the inversion.
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
            ring: None,
        })
    }

    /// The same in axisymmetry.
    fn point_of_revolution(
        &self,
        past: &Previous<'_>,
        p: usize,
        (grad, area): ([[f64; 2]; N], f64),
        h: [[f64; 2]; 2],
        mut ring: Ring<N>,
    ) -> Option<Point<N>> {
        let strain = strain(&h);
        let growth = ring.h + 0.5 * ring.h * ring.h;
        let (response, hoop) = match self.update {
            Update::Total | Update::Small => {
                let inside_out = plus_identity(&h).determinant() <= 0.0 || ring.h <= -1.0;
                if self.material.law == Law::NeoHookean && inside_out {
                    return None;
                }
                self.material.response_around(&strain, growth)?
            }
            Update::Updated => {
                let memory = &past.history[MEMORY * p..MEMORY * (p + 1)];
                let (mut response, mut hoop) = self.material.linear_around(&strain, growth);
                response.stress += Vector3::new(memory[0], memory[1], memory[2]);
                hoop.stress += memory[3];
                (response, hoop)
            }
        };
        ring.hoop = hoop;
        let volume = area * 2.0 * PI * ring.radius;
        (area > 0.0 && volume > 0.0).then_some(Point {
            grad,
            h,
            volume,
            response,
            ring: Some(ring),
        })
    }

    /// States of all Gauss points.
    pub fn point_states(&self, past: &Previous<'_>, u: &[f64]) -> Vec<Option<PointState>> {
        (0..P).map(|p| self.point_state(past, u, p)).collect()
    }

    /// State of Gauss point p; `None` if the material has no response.
    pub fn point_state(&self, past: &Previous<'_>, u: &[f64], p: usize) -> Option<PointState> {
        let h = slope(&self.points[p].grad, &pairs(u));
        let gradient = plus_identity(&h);
        let (cauchy, across) = if self.update == Update::Small {
            self.linear_stress(&h, &self.reference(past, u), p)
        } else {
            let point = self.point(&self.reference(past, u), past, p)?;
            (point.cauchy(), self.across(&point))
        };
        Some(PointState {
            gradient,
            cauchy,
            across,
        })
    }

    /// In-plane and out-of-plane stress for strains that are linear in the displacements.
    fn linear_stress(
        &self,
        h: &[[f64; 2]; 2],
        reference: &Reference<N>,
        p: usize,
    ) -> (Vector3<f64>, f64) {
        let strain = Vector3::new(h[0][0], h[1][1], h[0][1] + h[1][0]);
        if HOOP {
            let ring = Ring::new(&self.rule[p], &reference.at, &reference.u);
            let (response, hoop) = self.material.linear_around(&strain, ring.h);
            return (response.stress, hoop.stress);
        }
        let stress = self.material.linear(&strain).stress;
        (stress, self.material.linear_across(&strain))
    }

    /// σ33.
    fn across(&self, point: &Point<N>) -> f64 {
        let swelling = plus_identity(&point.h).determinant();
        match (&point.ring, self.update) {
            (Some(ring), _) => (1.0 + ring.h) * ring.hoop.stress / swelling,
            (None, Update::Updated) => self.material.across_of(&point.cauchy()),
            (None, _) => self.material.across(&strain(&point.h)) / swelling,
        }
    }

    /// Force, and the upper half of the tangent.
    #[inline(always)]
    fn add_all(
        &self,
        past: &Previous<'_>,
        u: &[f64],
        force: &mut [f64],
        tangent: &mut [f64],
    ) -> bool {
        let dofs = 2 * N;
        let reference = self.reference(past, u);
        let mut terms = [Terms::default(); P];
        let mut rings = [const { None::<RingTerms<N>> }; P];
        // ∇N of all nodes, one direction after the other, because contiguous numbers vectorise.
        let mut grad = [[[0.0; N]; 2]; P];
        for p in 0..P {
            let Some(point) = self.point(&reference, past, p) else {
                return false;
            };
            for (i, [x, y]) in point.grad.into_iter().enumerate() {
                (grad[p][0][i], grad[p][1][i]) = (x, y);
            }
            terms[p] = point.terms();
            if HOOP {
                rings[p] = point.ring_terms();
            }
        }
        for i in 0..N {
            // K_ij, by the components of i and of j.
            let mut sums = [[[0.0; N]; 2]; 2];
            for (p, (terms, grad)) in terms.iter().zip(&grad).enumerate() {
                let [x, y] = [grad[0][i], grad[1][i]];
                for a in 0..2 {
                    force[2 * i + a] += terms.stress[a][0] * x + terms.stress[a][1] * y;
                }
                terms.add_rows([x, y], grad, &mut sums);
                if HOOP && let Some(ring) = &rings[p] {
                    force[2 * i] += ring.stress * ring.share[i];
                    ring.add_rows(i, grad, &mut sums);
                }
            }
            for (a, sums) in sums.iter().enumerate() {
                let row = (2 * i + a) * dofs;
                for j in i..N {
                    tangent[row + 2 * j] += sums[0][j];
                    tangent[row + 2 * j + 1] += sums[1][j];
                }
            }
        }
        true
    }

    /// The force alone, with the same bits.
    #[inline(always)]
    fn add_forces(&self, past: &Previous<'_>, u: &[f64], force: &mut [f64]) -> bool {
        let reference = self.reference(past, u);
        for p in 0..P {
            let Some(point) = self.point(&reference, past, p) else {
                return false;
            };
            let stress = point.nominal();
            let ring = if HOOP { point.ring_terms() } else { None };
            for (i, [x, y]) in point.grad.into_iter().enumerate() {
                for a in 0..2 {
                    force[2 * i + a] += stress[a][0] * x + stress[a][1] * y;
                }
                if HOOP && let Some(ring) = &ring {
                    force[2 * i] += ring.stress * ring.share[i];
                }
            }
        }
        true
    }
}

impl<const N: usize, const P: usize, const HOOP: bool> element::Element
    for ContinuumElement<N, P, HOOP>
{
    fn dofs(&self) -> usize {
        2 * N
    }

    fn history_len(&self) -> usize {
        history_len(self.update, P)
    }

    fn add(&self, past: &Previous<'_>, u: &[f64], force: &mut [f64], tangent: &mut [f64]) -> bool {
        vectorise(
            #[inline(always)]
            || self.add_all(past, u, force, tangent),
        )
    }

    fn resist(&self, past: &Previous<'_>, u: &[f64], force: &mut [f64], _: &mut [f64]) -> bool {
        vectorise(
            #[inline(always)]
            || self.add_forces(past, u, force),
        )
    }

    fn advance(&self, past: &Previous<'_>, u: &[f64], history: &mut [f64]) {
        if self.update != Update::Updated {
            return;
        }
        let reference = self.reference(past, u);
        for p in 0..P {
            let (old, new) = (
                &past.history[MEMORY * p..MEMORY * (p + 1)],
                &mut history[MEMORY * p..MEMORY * (p + 1)],
            );
            // Without a response the increment cannot have been accepted.
            let Some(point) = self.point(&reference, past, p) else {
                continue;
            };
            new[..3].copy_from_slice(point.cauchy().as_slice());
            new[3] = if HOOP {
                self.across(&point)
            } else {
                (1.0 + old[3]) * point.stretch() - 1.0
            };
        }
    }

    fn mirror(&self, tangent: &mut [f64]) {
        let dofs = 2 * N;
        for i in 2..dofs {
            for j in 0..i & !1 {
                tangent[i * dofs + j] = tangent[j * dofs + i];
            }
        }
    }
}

/// Number of history variables of an element with this number of points.
pub fn history_len(update: Update, points: usize) -> usize {
    match update {
        Update::Total | Update::Small => 0,
        Update::Updated => MEMORY * points,
    }
}

/// P = F S and its derivative with respect to H, times the volume of a Gauss point.
#[derive(Clone, Copy, Default)]
struct Terms {
    stress: [[f64; 2]; 2],
    /// ∂P_aJ/∂H_cL at [a][J][L][c].
    moduli: [[[[f64; 2]; 2]; 2]; 2],
}

impl Terms {
    /// Adds Σ_JL N_i,J ∂P_aJ/∂H_cL N_j,L to [a][c][j], where x and y are N_i,J.
    #[inline(always)]
    fn add_rows<const N: usize>(
        &self,
        [x, y]: [f64; 2],
        grad: &[[f64; N]; 2],
        sums: &mut [[[f64; N]; 2]; 2],
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

impl<const N: usize> Point<N> {
    /// F.
    #[inline(always)]
    fn deformation(&self) -> [[f64; 2]; 2] {
        let h = &self.h;
        [[1.0 + h[0][0], h[0][1]], [h[1][0], 1.0 + h[1][1]]]
    }

    /// S, times the volume.
    #[inline(always)]
    fn stress(&self) -> [[f64; 2]; 2] {
        let (v, s) = (self.volume, &self.response.stress);
        [[v * s.x, v * s.z], [v * s.z, v * s.y]]
    }

    /// P = F S, times the volume.
    #[inline(always)]
    fn nominal(&self) -> [[f64; 2]; 2] {
        let s = self.stress();
        self.deformation().map(|f| {
            [
                f[0] * s[0][0] + f[1] * s[1][0],
                f[0] * s[0][1] + f[1] * s[1][1],
            ]
        })
    }

    #[inline(always)]
    fn terms(&self) -> Terms {
        let (f, s) = (self.deformation(), self.stress());
        let (v, d) = (self.volume, &self.response.tangent);
        let mut terms = Terms {
            stress: self.nominal(),
            ..Terms::default()
        };
        for l in 0..2 {
            for c in 0..2 {
                // ∂E/∂H_cL contains F_cL in its component L and the other entry of F as shear; multiply by D.
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

    /// The contribution of the hoop direction; `None` in the plane.
    fn ring_terms(&self) -> Option<RingTerms<N>> {
        let terms = |ring: &Ring<N>| ring.terms(self.volume, self.deformation());
        self.ring.as_ref().map(terms)
    }

    /// Out-of-plane stretch.
    fn stretch(&self) -> f64 {
        match &self.ring {
            Some(ring) => 1.0 + ring.h,
            None => (1.0 + 2.0 * self.response.thickening).max(0.0).sqrt(),
        }
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
