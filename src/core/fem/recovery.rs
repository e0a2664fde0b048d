//! Stresses for output: Cauchy stress at the nodes of solid elements.
//!
//! Stresses are `[σ11, σ22, σ33, σ12]`. They are extrapolated from the integration points of an element to its nodes by a
//! least-squares polynomial: constant for one point, linear for three, bilinear (1, ξ, η, ξη) for four or nine. A node gets the
//! mean of the adjacent elements of its body, regardless of their materials. With `update: small` it is the stress of linear
//! elasticity.

use super::continuum;
use super::element::Previous;
use super::material::Material;
use crate::Model;
use crate::fem::isoparametric::{self, PointState};
use crate::model::{Body, BodyKind, ElementKind, SolidElement};
use nalgebra::DMatrix;
use std::collections::HashMap;

/// σ11, σ22, σ33, σ12.
pub type Stress = [f64; 4];

/// Displacements and history variables of a state.
#[derive(Debug, Clone, Copy)]
pub struct Configuration<'a> {
    /// Displacements at each degree of freedom.
    pub u: &'a [f64],
    /// Displacements at the last accepted increment; equal to `u` in an accepted state.
    pub before: &'a [f64],
    /// History variables at that increment ([`super::assembly::history_len`] numbers).
    pub history: &'a [f64],
    /// Load factor, on which thermal expansions depend.
    pub load_factor: f64,
}

/// Stresses at the nodes of each body, in the order of [`Body::nodes`]; `None` if no adjacent solid element has a response, and
/// for all nodes of bodies that are not solids.
pub fn nodal_stresses(model: &Model, at: Configuration<'_>) -> Vec<Vec<Option<Stress>>> {
    let mut fits: HashMap<ElementKind, DMatrix<f64>> = HashMap::new();
    let mut sums = vec![([0.0; 4], 0_usize); model.nodes.len()];
    let mut found: Vec<Vec<Option<Stress>>> = Vec::with_capacity(model.bodies.len());
    let mut body_of = 0;
    let mut finish = |body: &Body, sums: &mut [(Stress, usize)]| {
        let of = |&node: &usize| {
            let (sum, count) = std::mem::take(&mut sums[node]);
            (count > 0).then(|| sum.map(|s| s / count as f64))
        };
        found.push(body.nodes.iter().map(of).collect());
    };
    each_element(model, at, |body, element, stresses| {
        while body_of < body {
            finish(&model.bodies[body_of], &mut sums);
            body_of += 1;
        }
        let Some(stresses) = stresses else {
            return;
        };
        let kind = element.kind;
        let fit = fits.entry(kind).or_insert_with(|| fit(kind));
        for (i, &node) in element.nodes.iter().enumerate() {
            let (sum, count) = &mut sums[node];
            for (p, stress) in stresses.iter().enumerate() {
                for (sum, stress) in sum.iter_mut().zip(stress) {
                    *sum += fit[(i, p)] * stress;
                }
            }
            *count += 1;
        }
    });
    while body_of < model.bodies.len() {
        finish(&model.bodies[body_of], &mut sums);
        body_of += 1;
    }
    found
}

/// Calls a function with each solid element, the number of its body, and the stresses at its integration points; `None` if the
/// material has no response at one of them.
fn each_element(
    model: &Model,
    at: Configuration<'_>,
    mut with: impl FnMut(usize, &SolidElement, Option<Vec<Stress>>),
) {
    let mut remembered = 0;
    for (b, body) in model.bodies.iter().enumerate() {
        let BodyKind::Solid(solid) = &body.kind else {
            continue;
        };
        let expansions = model.pressures.iter().enumerate();
        let expansion = expansions
            .filter(|(_, p)| p.expands == Some(b))
            .map(|(k, _)| model.pressure(k, at.load_factor))
            .sum();
        for element in &solid.elements {
            let elastic = &solid.materials[element.material];
            let places: Vec<[f64; 2]> = element.nodes.iter().map(|&n| model.nodes[n].at).collect();
            let own = |u: &[f64]| -> Vec<f64> {
                let first = element.nodes.iter().map(|&n| model.dofs.first[n]);
                first.flat_map(|d| [u[d], u[d + 1]]).collect()
            };
            let count = isoparametric::history_len(elastic.update, element.kind.points());
            let (u, before) = (own(at.u), own(at.before));
            let past = Previous {
                u: &before,
                history: &at.history[remembered..remembered + count],
            };
            remembered += count;
            let made_of = (Material::expanded(elastic, expansion), elastic.update);
            let states = continuum::formulation(element.kind).states(&places, made_of, &past, &u);
            let stress =
                |s: Option<PointState>| s.map(|s| [s.cauchy.x, s.cauchy.y, s.across, s.cauchy.z]);
            with(b, element, states.into_iter().map(stress).collect());
        }
    }
}

/// Least-squares weights of the values at the points in the value at each node.
fn fit(kind: ElementKind) -> DMatrix<f64> {
    let formulation = continuum::formulation(kind);
    let (rule, places) = (formulation.rule(), formulation.places());
    let terms = rule.len().min(4);
    let term = |[xi, eta]: [f64; 2], k: usize| [1.0, xi, eta, xi * eta][k];
    let at_points = DMatrix::from_fn(rule.len(), terms, |p, k| term(rule[p].at, k));
    let at_nodes = DMatrix::from_fn(places.len(), terms, |i, k| term(places[i], k));
    // The points of every rule make the polynomial's terms independent.
    let normal = at_points.transpose() * &at_points;
    let inverse = normal
        .try_inverse()
        .unwrap_or_else(|| DMatrix::zeros(terms, terms));
    at_nodes * inverse * at_points.transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_fields_are_extrapolated_exactly_and_constant_ones_by_every_kind() {
        for kind in ElementKind::ALL {
            let formulation = continuum::formulation(kind);
            let (fit, rule, places) = (fit(kind), formulation.rule(), formulation.places());
            for (i, place) in places.iter().enumerate() {
                let of = |field: &dyn Fn([f64; 2]) -> f64| -> f64 {
                    rule.iter()
                        .enumerate()
                        .map(|(p, point)| fit[(i, p)] * field(point.at))
                        .sum()
                };
                assert!((of(&|_| 1.0) - 1.0).abs() < 1e-14, "{kind:?}");
                if kind != ElementKind::Triangle3 {
                    let linear = |[x, y]: [f64; 2]| 0.3 + 2.0 * x - y;
                    assert!((of(&linear) - linear(*place)).abs() < 1e-13, "{kind:?}");
                }
            }
        }
    }
}
