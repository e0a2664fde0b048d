//! Properties that every element must have, tested for a list of all elements.

use super::beam::{self, Section};
use super::continuum;
use super::element::{Element, Previous};
use super::material::Material;
use super::{small, truss};
use crate::elements::lagrange::MAX_NODES;
use crate::model::{Elastic, ElementKind, Law, Plane, Update};
use crate::plane::max_abs;

/// An element with a generic shape.
struct Specimen {
    name: String,
    element: Box<dyn Element>,
    /// Undeformed position of every node.
    at: Vec<[f64; 2]>,
    /// Degrees of freedom per node: x, y and, for a beam, the rotation.
    per_node: usize,
    /// Order of magnitude of its stiffness.
    stiffness: f64,
    /// Rigid motions without strain.
    free: Free,
}

/// Rigid motions without strain.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Free {
    /// All.
    Motions,
    /// Small displacements: translations, and rotations to first order.
    Small,
    /// Axisymmetry: translations along the axis.
    AlongAxis,
}

/// All elements with all options. Add new elements here.
fn specimens() -> Vec<Specimen> {
    let mut all = Vec::new();
    for m in 2..=MAX_NODES {
        for ga in [Some(30.0), None] {
            all.push(beam(m, ga));
        }
    }
    all.push(bar(false));
    all.push(bar(true));
    for kind in ElementKind::ALL {
        for (law, plane, update) in choices() {
            all.push(solid(kind, law, plane, update));
        }
    }
    all
}

/// The options of a continuum.
fn choices() -> Vec<(Law, Plane, Update)> {
    let planes = [Plane::Strain, Plane::Stress, Plane::Axisymmetric];
    let of_plane = |plane| {
        [
            (Law::Svk, plane, Update::Total),
            (Law::NeoHookean, plane, Update::Total),
            (Law::Svk, plane, Update::Updated),
            (Law::Svk, plane, Update::Small),
        ]
    };
    planes.into_iter().flat_map(of_plane).collect()
}

fn bar(small: bool) -> Specimen {
    let at = [[0.3, -0.2], [1.5, 0.7]];
    let element = truss::TrussElement::new(at, 100.0);
    Specimen {
        name: format!("bar, small: {small}"),
        element: if small {
            Box::new(small::SmallStrainElement::new(&element))
        } else {
            Box::new(element)
        },
        at: at.to_vec(),
        per_node: 2,
        stiffness: 100.0,
        free: if small { Free::Small } else { Free::Motions },
    }
}

fn beam(m: usize, ga: Option<f64>) -> Specimen {
    let along = |i: usize| 2.0 * i as f64 / (m - 1) as f64;
    let at: Vec<[f64; 2]> = (0..m).map(|i| [along(i), 0.5 * along(i).sin()]).collect();
    let section = Section {
        ea: 100.0,
        ei: 8.0,
        ga,
    };
    Specimen {
        name: format!("beam of {m} nodes, GA {ga:?}"),
        element: Box::new(beam::BeamElement::new(&at, section)),
        at,
        per_node: 3,
        stiffness: 100.0,
        free: Free::Motions,
    }
}

/// The parent element, stretched, sheared and bent; in axisymmetry at a distance from the axis.
fn solid(kind: ElementKind, law: Law, plane: Plane, update: Update) -> Specimen {
    let bent = |[x, y]: [f64; 2]| [1.2 * x + 0.2 * y + 0.1 * x * y, 0.8 * y - 0.1 * x * x];
    let away = if plane == Plane::Axisymmetric {
        2.5
    } else {
        0.0
    };
    let places = continuum::formulation(kind)
        .places()
        .iter()
        .copied()
        .map(bent);
    let at: Vec<[f64; 2]> = places.map(|[x, y]| [x + away, y]).collect();
    let elastic = elastic(law, plane, update);
    let element = continuum::formulation(kind).element(&at, Material::new(&elastic), update);
    Specimen {
        name: format!("{kind:?} {law:?} {plane:?} {update:?}"),
        element,
        at,
        per_node: 2,
        stiffness: 100.0,
        free: match (plane, update) {
            (Plane::Axisymmetric, _) => Free::AlongAxis,
            (_, Update::Small) => Free::Small,
            _ => Free::Motions,
        },
    }
}

pub(super) fn elastic(law: Law, plane: Plane, update: Update) -> Elastic {
    Elastic {
        young: 100.0,
        poisson: 0.3,
        law,
        plane,
        thickness: 0.7,
        update,
    }
}

fn noise(k: usize, size: f64) -> f64 {
    size * ((k * 7 % 11) as f64 / 11.0 - 0.5)
}

impl Specimen {
    /// Displacements of its nodes, followed by zeros for internal unknowns.
    fn displaced(&self, of: impl Fn(usize, [f64; 2]) -> Vec<f64>) -> Vec<f64> {
        let nodes = self.at.iter().enumerate();
        let mut u: Vec<f64> = nodes.flat_map(|(i, &at)| of(i, at)).collect();
        u.resize(self.element.dofs(), 0.0);
        u
    }

    /// A strain-free rigid motion: rotation, then translation.
    fn rigid(&self, angle: f64) -> Vec<f64> {
        let (s, c) = match self.free {
            Free::Motions => angle.sin_cos(),
            Free::Small => (angle, 1.0),
            Free::AlongAxis => return self.displaced(|_, _| vec![0.0, angle]),
        };
        self.displaced(|_, [x, y]| {
            let moved = [c * x - s * y - x + 3.0, s * x + c * y - y - 1.0, angle];
            moved[..self.per_node].to_vec()
        })
    }

    fn evaluate(&self, past: &Previous<'_>, u: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let n = self.element.dofs();
        let (mut force, mut tangent) = (vec![0.0; n], vec![0.0; n * n]);
        let answers = self.element.add(past, u, &mut force, &mut tangent);
        assert!(answers, "{}", self.name);
        self.element.mirror(&mut tangent);
        (force, tangent)
    }

    fn at_rest(&self) -> (Vec<f64>, Vec<f64>) {
        let history = vec![0.0; self.element.history_len()];
        (vec![0.0; self.element.dofs()], history)
    }
}

#[test]
fn a_rigid_motion_strains_no_element() {
    for specimen in specimens() {
        let (u, history) = specimen.at_rest();
        let past = Previous {
            u: &u,
            history: &history,
        };
        for angle in [0.3, 2.5, -7.0] {
            let (force, _) = specimen.evaluate(&past, &specimen.rigid(angle));
            let most = max_abs(&force);
            assert!(
                most < 1e-12 * specimen.stiffness,
                "{}: {most}",
                specimen.name
            );
        }
    }
}

#[test]
fn the_tangent_of_every_element_is_the_derivative_of_its_force_and_symmetric() {
    for specimen in specimens() {
        let n = specimen.element.dofs();
        let before: Vec<f64> = (0..n).map(|k| noise(k + 3, 0.1)).collect();
        let history: Vec<f64> = (0..specimen.element.history_len())
            .map(|k| noise(k, 0.1))
            .collect();
        let past = Previous {
            u: &before,
            history: &history,
        };
        let u: Vec<f64> = (0..n).map(|k| noise(k, 0.3)).collect();
        let (_, tangent) = specimen.evaluate(&past, &u);
        let scale = max_abs(&tangent);
        let h = 1e-5;
        for j in 0..n {
            let moved = |by: f64| {
                let mut u = u.clone();
                u[j] += by;
                specimen.evaluate(&past, &u).0
            };
            let (plus, minus) = (moved(h), moved(-h));
            for i in 0..n {
                let error = (plus[i] - minus[i]) / (2.0 * h) - tangent[i * n + j];
                assert!(
                    error.abs() < 1e-8 * scale,
                    "{} {i} {j}: {error:e}",
                    specimen.name
                );
                let skew = tangent[i * n + j] - tangent[j * n + i];
                assert!(skew.abs() < 1e-13 * scale, "{} {i} {j}", specimen.name);
            }
        }
    }
}

#[test]
fn the_shape_functions_of_every_kind_are_one_at_their_node_and_sum_to_one() {
    for kind in ElementKind::ALL {
        let places = continuum::formulation(kind).places();
        assert_eq!(places.len(), kind.nodes(), "{kind:?}");
        for (i, [xi, eta]) in places.iter().enumerate() {
            let (n, _) = continuum::formulation(kind).shape(*xi, *eta);
            for (j, n) in n.iter().enumerate() {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((n - expected).abs() < 1e-15, "{kind:?} {i} {j}");
            }
        }
        for (xi, eta) in [(0.3, -0.8), (-0.5, 0.1), (0.2, 0.2)] {
            let (n, d) = continuum::formulation(kind).shape(xi, eta);
            assert!((n.iter().sum::<f64>() - 1.0).abs() < 1e-15, "{kind:?}");
            for k in 0..2 {
                let sum: f64 = d.iter().map(|d| d[k]).sum();
                assert!(sum.abs() < 1e-15, "{kind:?}");
            }
        }
    }
}

#[test]
fn the_shape_functions_of_every_kind_reproduce_its_polynomials() {
    const QUAD9: [(i32, i32); 9] = [
        (0, 0),
        (1, 0),
        (0, 1),
        (1, 1),
        (2, 0),
        (0, 2),
        (2, 1),
        (1, 2),
        (2, 2),
    ];
    for kind in ElementKind::ALL {
        // Powers of ξ and η in the kind's shape functions.
        let powers: &[(i32, i32)] = match kind {
            ElementKind::Triangle3 => &[(0, 0), (1, 0), (0, 1)],
            ElementKind::Quad4 | ElementKind::Quad4Reduced => &[(0, 0), (1, 0), (0, 1), (1, 1)],
            ElementKind::Triangle6 => &[(0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2)],
            ElementKind::Quad8 | ElementKind::Quad8Reduced => &QUAD9[..8],
            ElementKind::Quad9 => &QUAD9,
            ElementKind::Custom(_) => continue,
        };
        assert_eq!(powers.len(), kind.nodes());
        let places = continuum::formulation(kind).places();
        for (xi, eta) in [(0.3, -0.8), (1.0, 1.0), (-0.5, 0.1)] {
            let (n, d) = continuum::formulation(kind).shape(xi, eta);
            for &(i, j) in powers {
                let term = |k: i32, x: f64| if k < 0 { 0.0 } else { x.powi(k) };
                let value = |[x, y]: [f64; 2]| term(i, x) * term(j, y);
                let slopes = [
                    f64::from(i) * term(i - 1, xi) * term(j, eta),
                    f64::from(j) * term(i, xi) * term(j - 1, eta),
                ];
                let sum: f64 = n.iter().zip(places).map(|(n, at)| n * value(*at)).sum();
                assert!((sum - value([xi, eta])).abs() < 1e-14, "{kind:?} {i} {j}");
                for (k, slope) in slopes.into_iter().enumerate() {
                    let sum: f64 = d.iter().zip(places).map(|(d, at)| d[k] * value(*at)).sum();
                    assert!((sum - slope).abs() < 1e-14, "{kind:?} {i} {j}");
                }
            }
        }
    }
}

#[test]
fn the_nodes_of_every_face_lie_on_the_boundary_of_the_parent_element_in_order() {
    for kind in ElementKind::ALL {
        let places = continuum::formulation(kind).places();
        for face in kind.faces() {
            let (first, last) = (places[face[0]], places[face[face.len() - 1]]);
            for (k, &node) in face.iter().enumerate() {
                let part = k as f64 / (face.len() - 1) as f64;
                for axis in 0..2 {
                    let expected = first[axis] + part * (last[axis] - first[axis]);
                    assert!(
                        (places[node][axis] - expected).abs() < 1e-15,
                        "{kind:?} {face:?}"
                    );
                }
            }
        }
    }
}

/// The patch test: if displacements are linear in the position, the forces of every distorted element of a kind follow from a
/// single stress, which gives the tractions on its faces: Σ f_i = 0, and Σ f_i ⊗ X_i is the stress times the volume, for every
/// shape.
#[test]
fn every_kind_of_continuum_element_passes_the_patch_test() {
    for kind in ElementKind::ALL {
        let of_plane = |plane| [(plane, Update::Total), (plane, Update::Small)];
        for (plane, update) in [Plane::Strain, Plane::Stress]
            .into_iter()
            .flat_map(of_plane)
        {
            let per_volume = |stretch: f64| -> [[f64; 2]; 2] {
                let mut specimen = solid(kind, Law::Svk, plane, update);
                let distort = |[x, y]: [f64; 2]| [stretch * x + 0.1 * y, y - 0.1 * stretch * x];
                specimen.at = specimen.at.iter().map(|&at| distort(at)).collect();
                let material = Material::new(&elastic(Law::Svk, plane, update));
                let element = continuum::formulation(kind).element(&specimen.at, material, update);
                specimen.element = element;
                let u =
                    specimen.displaced(|_, [x, y]| vec![0.03 * x - 0.02 * y, 0.01 * x - 0.025 * y]);
                let (rest, history) = specimen.at_rest();
                let past = Previous {
                    u: &rest,
                    history: &history,
                };
                let (force, _) = specimen.evaluate(&past, &u);
                let mut moment = [[0.0; 2]; 2];
                for axis in 0..2 {
                    let total: f64 = force.iter().skip(axis).step_by(2).sum();
                    assert!(total.abs() < 1e-13 * specimen.stiffness, "{kind:?}");
                }
                for (f, at) in force.chunks_exact(2).zip(&specimen.at) {
                    for a in 0..2 {
                        for b in 0..2 {
                            moment[a][b] += f[a] * at[b];
                        }
                    }
                }
                moment.map(|row| row.map(|m| m / area(kind, &specimen.at)))
            };
            let (one, other) = (per_volume(1.0), per_volume(1.7));
            for a in 0..2 {
                for b in 0..2 {
                    assert!(
                        (one[a][b] - other[a][b]).abs() < 1e-12 * 100.0,
                        "{kind:?} {plane:?}"
                    );
                    assert!(one[a][b].abs() > 1e-3, "the patch is under stress");
                }
            }
        }
    }
}

/// Area of an element by Green's theorem over its faces, independent of its quadrature.
fn area(kind: ElementKind, at: &[[f64; 2]]) -> f64 {
    let face = |places: &&[usize]| -> f64 {
        let m = places.len();
        super::lagrange::gauss(m)
            .into_iter()
            .map(|(xi, weight)| {
                let s = super::lagrange::shape(m, xi);
                let of = |w: &[f64], k: usize| -> f64 {
                    places.iter().zip(w).map(|(&p, w)| w * at[p][k]).sum()
                };
                let (x, dy) = (of(&s.n, 0), of(&s.d, 1));
                weight * x * dy
            })
            .sum()
    };
    kind.faces().iter().map(face).sum()
}

#[test]
fn an_element_with_too_few_nodes_has_no_response() {
    for kind in ElementKind::ALL {
        let whole = solid(kind, Law::Svk, Plane::Strain, Update::Updated);
        let elastic = elastic(Law::Svk, Plane::Strain, Update::Updated);
        let (at, material) = (&whole.at[1..], Material::new(&elastic));
        let cut = continuum::formulation(kind).element(at, material, Update::Updated);
        assert_eq!(cut.dofs(), whole.element.dofs() - 2);
        assert_eq!(cut.history_len(), whole.element.history_len());
        let (n, history) = (cut.dofs(), vec![0.0; cut.history_len()]);
        let (u, mut force, mut tangent) = (vec![0.0; n], vec![0.0; n], vec![0.0; n * n]);
        let past = Previous {
            u: &u,
            history: &history,
        };
        assert!(!cut.add(&past, &u, &mut force, &mut tangent));
    }
}
