//! Following pressure on faces: force per current area, along the current normal.
//!
//! Along a face with nodes x_i, walked with the body on the left, and with the out-of-plane width w (the undeformed thickness, or
//! the circumference 2π x in axisymmetry), a pressure p into the body gives
//!
//! ```text
//! f_i = −p ∫ N_i w (y', −x') dξ,      x' = Σ N_j' x_j,
//! ```
//!
//! and its exact derivative, which is not symmetric, is subtracted from the tangent (Bathe 2014, section 6.7; Schweizerhof and
//! Ramm 1984). The integration rule is exact for it. The functions here compute the load, which is on the opposite side of the
//! equilibrium equation from internal forces.
//!
//! A thermal expansion of a solid is such a load too: S = C : (E − ε I) is linear in ε, so that f = ε ∫ p F ∇N dV with p of
//! [`Material::expanded`], computed by the elements themselves.

use crate::elements::lagrange::{self, MAX_NODES};
use crate::fem::continuum;
use crate::fem::element::{Element, Previous};
use crate::linalg::Pattern;
use crate::model::{BodyKind, Dofs, PressedFace, Update};
use crate::{Material, Model};
use std::cell::RefCell;
use std::f64::consts::TAU;

/// All pressures of a scene, face by face.
pub struct Pressures {
    faces: Vec<PressedElement>,
    expanding: Vec<ExpandingElement>,
    /// Displacements, force and tangent of an element that expands.
    work: RefCell<Vec<f64>>,
}

/// An element of a body that expands.
struct ExpandingElement {
    /// Has the negative load of an expansion of 1 as internal force.
    element: Box<dyn Element>,
    /// Whether its displacements are small, so that the load does not depend on them.
    small: bool,
    dofs: Vec<usize>,
    /// As for a face; empty if the load is dead.
    slots: Vec<Option<usize>>,
    /// Index of its expansion in the model.
    pressure: usize,
}

/// A face with its positions in the system.
struct PressedElement {
    /// Undeformed positions of its nodes.
    at: Vec<[f64; 2]>,
    /// Degrees of freedom, x and y of each node.
    dofs: Vec<usize>,
    thickness: Option<f64>,
    /// Index of each entry of its stiffness, row by row; `None` if a degree of freedom is restrained.
    slots: Vec<Option<usize>>,
    /// Index of its pressure in the model.
    pressure: usize,
    points: Vec<Sample>,
}

/// Weight, shape functions and their slopes at a point.
type Sample = (f64, [f64; MAX_NODES], [f64; MAX_NODES]);

impl Pressures {
    /// The pressures of a model.
    pub fn new(model: &Model) -> Self {
        let of = |(pressure, face): (usize, &PressedFace)| {
            let m = face.nodes.len();
            let xy = |&n: &usize| [model.dofs.first[n], model.dofs.first[n] + 1];
            PressedElement {
                at: face.nodes.iter().map(|&n| model.nodes[n].at).collect(),
                dofs: face.nodes.iter().flat_map(xy).collect(),
                thickness: face.thickness,
                slots: Vec::new(),
                pressure,
                points: samples(m),
            }
        };
        let all = model.pressures.iter().enumerate();
        let faces = all.flat_map(|(k, pressure)| pressure.faces.iter().map(move |face| (k, face)));
        Pressures {
            faces: faces.map(of).collect(),
            expanding: expanding(model),
            work: RefCell::default(),
        }
    }

    /// Entries `(row, column)` of the tangent, in equations; may contain duplicates.
    pub fn entries<'a>(
        &'a self,
        dofs: &'a Dofs,
    ) -> impl Iterator<Item = (usize, usize)> + Clone + 'a {
        let faces = self.faces.iter().map(|face| &face.dofs);
        let following = self.expanding.iter().filter(|element| !element.small);
        let all = faces.chain(following.map(|element| &element.dofs));
        all.flat_map(move |own| {
            let equations = || own.iter().filter_map(|&d| dofs.equation[d]);
            equations().flat_map(move |i| equations().map(move |j| (i, j)))
        })
    }

    /// Looks up every entry in a pattern that contains them all.
    pub fn bind(&mut self, dofs: &Dofs, pattern: &Pattern) {
        let faces = self.faces.iter_mut().map(|f| (&f.dofs, &mut f.slots));
        let following = self.expanding.iter_mut().filter(|element| !element.small);
        for (own, slots) in faces.chain(following.map(|e| (&e.dofs, &mut e.slots))) {
            slots.clear();
            for &row in own {
                for &column in own {
                    let pair = dofs.equation[row].zip(dofs.equation[column]);
                    slots.push(pair.and_then(|(i, j)| pattern.slot(i, j)));
                }
            }
        }
    }

    /// Calls `add` with degree of freedom and force of every node of every face at displacements u; `size` returns the value of a
    /// pressure, by its number.
    pub fn each(&self, u: &[f64], size: impl Fn(usize) -> f64, mut add: impl FnMut(usize, f64)) {
        for face in &self.faces {
            let size = size(face.pressure);
            let now = face.now(u);
            for (weight, n, d) in &face.points {
                let at = face.along(&now, n, d);
                for (i, dofs) in face.dofs.chunks_exact(2).enumerate() {
                    let share = size * weight * n[i] * at.width;
                    add(dofs[0], -share * at.slope[1]);
                    add(dofs[1], share * at.slope[0]);
                }
            }
        }
        let work = &mut *self.work.borrow_mut();
        for element in &self.expanding {
            let size = size(element.pressure);
            let (force, _) = element.response(u, work);
            for (&dof, part) in element.dofs.iter().zip(force) {
                add(dof, -size * part);
            }
        }
    }

    /// Subtracts the derivative of the forces at displacements u from the tangent, and its product with `step` of the restrained
    /// degrees of freedom from the `coupling`.
    pub fn stiffen(
        &self,
        model: &Model,
        (u, load_factor): (&[f64], f64),
        step: &[f64],
        values: &mut [f64],
        coupling: &mut [f64],
    ) {
        for face in &self.faces {
            let size = model.pressure(face.pressure, load_factor);
            let count = face.dofs.len();
            face.each_entry(u, size, |row, column, value| {
                if let Some(slot) = face.slots[row * count + column] {
                    values[slot] -= value;
                } else if let Some(equation) = model.dofs.equation[face.dofs[row]] {
                    coupling[equation] -= value * step[face.dofs[column]];
                }
            });
        }
        let work = &mut *self.work.borrow_mut();
        for element in self.expanding.iter().filter(|element| !element.small) {
            let size = model.pressure(element.pressure, load_factor);
            let (_, tangent) = element.response(u, work);
            let entries = element.slots.iter().zip(tangent).enumerate();
            for (k, (slot, value)) in entries {
                let (row, column) = (k / element.dofs.len(), k % element.dofs.len());
                if let Some(slot) = slot {
                    values[*slot] += size * value;
                } else if let Some(equation) = model.dofs.equation[element.dofs[row]] {
                    coupling[equation] += size * value * step[element.dofs[column]];
                }
            }
        }
    }
}

/// The elements of all bodies that expand.
fn expanding(model: &Model) -> Vec<ExpandingElement> {
    let mut made = Vec::new();
    for (k, pressure) in model.pressures.iter().enumerate() {
        let body = pressure.expands.map(|body| &model.bodies[body].kind);
        let Some(BodyKind::Solid(solid)) = body else {
            continue;
        };
        for element in &solid.elements {
            let elastic = &solid.materials[element.material];
            let at: Vec<[f64; 2]> = element.nodes.iter().map(|&n| model.nodes[n].at).collect();
            let first = element.nodes.iter().map(|&n| model.dofs.first[n]);
            let formulation = continuum::formulation(element.kind);
            let material = Material::expansion_only(elastic);
            made.push(ExpandingElement {
                element: formulation.element(&at, material, Update::Total),
                small: elastic.update == Update::Small,
                dofs: first.flat_map(|d| [d, d + 1]).collect(),
                slots: Vec::new(),
                pressure: k,
            });
        }
    }
    made
}

impl ExpandingElement {
    /// Internal force for an expansion of 1 at displacements u of the scene, in `work`, and its tangent.
    fn response<'a>(&self, u: &[f64], work: &'a mut Vec<f64>) -> (&'a [f64], &'a [f64]) {
        let count = self.dofs.len();
        work.clear();
        work.extend(
            self.dofs
                .iter()
                .map(|&dof| if self.small { 0.0 } else { u[dof] }),
        );
        work.resize(count * (count + 2), 0.0);
        let (own, rest) = work.split_at_mut(count);
        let (force, tangent) = rest.split_at_mut(count);
        let past = Previous {
            u: own,
            history: &[],
        };
        self.element.add(&past, own, force, tangent);
        self.element.mirror(tangent);
        (force, tangent)
    }
}

/// Geometry of a face at a point.
struct FaceDerivative {
    slope: [f64; 2],
    width: f64,
}

impl PressedElement {
    /// Positions of the nodes at displacements u.
    fn now(&self, u: &[f64]) -> [[f64; 2]; MAX_NODES] {
        let mut now = [[0.0; 2]; MAX_NODES];
        for ((now, at), dofs) in now.iter_mut().zip(&self.at).zip(self.dofs.chunks_exact(2)) {
            *now = [at[0] + u[dofs[0]], at[1] + u[dofs[1]]];
        }
        now
    }

    fn along(
        &self,
        now: &[[f64; 2]; MAX_NODES],
        n: &[f64; MAX_NODES],
        d: &[f64; MAX_NODES],
    ) -> FaceDerivative {
        let sum = |w: &[f64; MAX_NODES], k: usize| -> f64 {
            w.iter().zip(now).map(|(w, x)| w * x[k]).sum()
        };
        FaceDerivative {
            slope: [sum(d, 0), sum(d, 1)],
            width: self.thickness.unwrap_or_else(|| TAU * sum(n, 0)),
        }
    }

    /// Calls `add` with row, column (in the face's own order) and contribution to the derivative of a pressure's forces.
    fn each_entry(&self, u: &[f64], size: f64, mut add: impl FnMut(usize, usize, f64)) {
        let (now, m) = (self.now(u), self.at.len());
        let widening = if self.thickness.is_some() { 0.0 } else { TAU };
        for (weight, n, d) in &self.points {
            let FaceDerivative { slope, width } = self.along(&now, n, d);
            for i in 0..m {
                let share = size * weight * n[i];
                for j in 0..m {
                    let (turned, wider) = (share * width * d[j], share * widening * n[j]);
                    add(2 * i, 2 * j, -wider * slope[1]);
                    add(2 * i, 2 * j + 1, -turned);
                    add(2 * i + 1, 2 * j, turned + wider * slope[0]);
                }
            }
        }
    }
}

/// A rule that is exact for the derivative: the product of two shape functions, a slope and, in axisymmetry, the radius has
/// degree 3 m − 4.
fn samples(m: usize) -> Vec<Sample> {
    let rule = lagrange::gauss((3 * m - 3).div_ceil(2).max(1));
    let sample = |(xi, weight): (f64, f64)| {
        let shape = lagrange::shape(m, xi);
        (weight, shape.n, shape.d)
    };
    rule.into_iter().map(sample).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::max_abs;

    /// A single curved face with m nodes.
    fn face(m: usize, thickness: Option<f64>) -> Pressures {
        let at = (0..m).map(|i| [2.0 + 0.7 * i as f64, 0.1 * (i * i) as f64 - 0.3]);
        Pressures {
            faces: vec![PressedElement {
                at: at.collect(),
                dofs: (0..2 * m).collect(),
                thickness,
                slots: vec![None; 4 * m * m],
                pressure: 0,
                points: samples(m),
            }],
            expanding: Vec::new(),
            work: RefCell::default(),
        }
    }

    fn forces(all: &Pressures, u: &[f64], size: f64) -> Vec<f64> {
        let face = &all.faces[0];
        let (mut force, now) = (vec![0.0; u.len()], face.now(u));
        for (weight, n, d) in &face.points {
            let at = face.along(&now, n, d);
            for i in 0..u.len() / 2 {
                force[2 * i] -= size * weight * n[i] * at.width * at.slope[1];
                force[2 * i + 1] += size * weight * n[i] * at.width * at.slope[0];
            }
        }
        force
    }

    #[test]
    fn the_derivative_of_a_following_pressure_is_that_of_its_forces() {
        for m in 2..=3 {
            for thickness in [Some(0.7), None] {
                let all = face(m, thickness);
                let u: Vec<f64> = (0..2 * m)
                    .map(|k| 0.05 * ((k * 7 % 5) as f64 - 2.0))
                    .collect();
                let mut tangent = vec![0.0; 4 * m * m];
                all.faces[0].each_entry(&u, 3.0, |i, j, v| tangent[i * 2 * m + j] += v);
                let h = 1e-5;
                for j in 0..2 * m {
                    let moved = |by: f64| {
                        let mut u = u.clone();
                        u[j] += by;
                        forces(&all, &u, 3.0)
                    };
                    let (plus, minus) = (moved(h), moved(-h));
                    for i in 0..2 * m {
                        let error = (plus[i] - minus[i]) / (2.0 * h) - tangent[i * 2 * m + j];
                        assert!(error.abs() < 1e-8, "{m} {thickness:?} {i} {j}: {error:e}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_tangent_of_an_expansion_is_the_derivative_of_its_load() {
        use crate::model::{Elastic, ElementKind, Law, Plane};
        let at = [[2.0, 0.1], [3.1, 0.0], [3.3, 1.2], [1.9, 0.9]];
        for plane in [Plane::Strain, Plane::Stress, Plane::Axisymmetric] {
            let elastic = Elastic {
                young: 100.0,
                poisson: 0.3,
                law: Law::Svk,
                plane,
                thickness: 0.7,
                update: Update::Total,
            };
            let formulation = continuum::formulation(ElementKind::Quad4);
            let material = Material::expansion_only(&elastic);
            let whole = |u: &[f64], material: Material| {
                let element = ExpandingElement {
                    element: formulation.element(&at, material, Update::Total),
                    small: false,
                    dofs: (0..8).collect(),
                    slots: Vec::new(),
                    pressure: 0,
                };
                let mut work = Vec::new();
                let (force, tangent) = element.response(u, &mut work);
                (force.to_vec(), tangent.to_vec())
            };
            let u: Vec<f64> = (0..8).map(|k| 0.05 * ((k * 7 % 5) as f64 - 2.0)).collect();
            let (force, tangent) = whole(&u, material);
            let (scale, h) = (max_abs(&tangent), 1e-5);
            assert!(scale > 1.0);
            for j in 0..8 {
                let moved = |by: f64| {
                    let mut u = u.clone();
                    u[j] += by;
                    whole(&u, material).0
                };
                let (plus, minus) = (moved(h), moved(-h));
                for i in 0..8 {
                    let error = (plus[i] - minus[i]) / (2.0 * h) - tangent[i * 8 + j];
                    assert!(error.abs() < 1e-8 * scale, "{plane:?} {i} {j}: {error:e}");
                }
            }
            // It is what the expansion changes in the whole element.
            let (bare, warm) = (Material::new(&elastic), Material::expanded(&elastic, 0.01));
            let (bare, warm) = (whole(&u, bare).0, whole(&u, warm).0);
            for i in 0..8 {
                let error = warm[i] - bare[i] - 0.01 * force[i];
                assert!(error.abs() < 1e-12 * scale, "{plane:?} {i}: {error:e}");
            }
        }
    }

    #[test]
    fn the_resultant_of_a_pressure_depends_only_on_the_ends_of_the_face() {
        let all = face(3, Some(0.5));
        let force = forces(&all, &[0.0; 6], 2.0);
        let at = &all.faces[0].at;
        let (dx, dy) = (at[2][0] - at[0][0], at[2][1] - at[0][1]);
        let sum = |k: usize| force.iter().skip(k).step_by(2).sum::<f64>();
        assert!((sum(0) + 2.0 * 0.5 * dy).abs() < 1e-14);
        assert!((sum(1) - 2.0 * 0.5 * dx).abs() < 1e-14);
    }
}
