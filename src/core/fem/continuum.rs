//! Continuum elements of each kind ([`super::kinds`]).

use crate::elements::kinds::continuum_kind::{ContinuumKind, Parent};
use crate::elements::kinds::with_kind;
use crate::fem::element::{Element, Previous};
use crate::fem::isoparametric::ContinuumElement;
use crate::fem::isoparametric::{self, PointState};
use crate::fem::material::Material;
use crate::fem::small;
use crate::model::{ElementKind, Plane, Update};

/// Creates an element of a kind at these undeformed positions. With the wrong number of positions it never has a response, so no state of
/// it can be accepted.
pub fn element(
    kind: ElementKind,
    at: &[[f64; 2]],
    material: Material,
    update: Update,
) -> Box<dyn Element> {
    with_kind!(kind, made(at, material, update))
}

fn made<const N: usize, const P: usize>(
    kind: &'static ContinuumKind<N, P>,
    at: &[[f64; 2]],
    material: Material,
    update: Update,
) -> Box<dyn Element> {
    let Ok(at) = <[[f64; 2]; N]>::try_from(at) else {
        return Box::new(Malformed {
            dofs: 2 * at.len(),
            history: isoparametric::history_len(update, P),
        });
    };
    let made: Box<dyn Element> = if material.plane == Plane::Axisymmetric {
        Box::new(ContinuumElement::<N, P, true>::new(
            &kind.rule, at, material, update,
        ))
    } else {
        Box::new(ContinuumElement::<N, P, false>::new(
            &kind.rule, at, material, update,
        ))
    };
    match update {
        Update::Total | Update::Updated => made,
        Update::Small => Box::new(small::SmallStrainElement::new(&*made)),
    }
}

/// An element with the wrong number of nodes.
struct Malformed {
    dofs: usize,
    history: usize,
}

impl Element for Malformed {
    fn dofs(&self) -> usize {
        self.dofs
    }

    fn history_len(&self) -> usize {
        self.history
    }

    fn add(&self, _: &Previous<'_>, _: &[f64], _: &mut [f64], _: &mut [f64]) -> bool {
        false
    }
}

/// States of an element's integration points, in the order of its rule; `None` where the material has no response. Empty if the
/// number of nodes is wrong.
pub fn states(
    kind: ElementKind,
    at: &[[f64; 2]],
    (material, update): (Material, Update),
    past: &Previous<'_>,
    u: &[f64],
) -> Vec<Option<PointState>> {
    with_kind!(kind, states_by(at, (material, update), past, u))
}

fn states_by<const N: usize, const P: usize>(
    kind: &'static ContinuumKind<N, P>,
    at: &[[f64; 2]],
    (material, update): (Material, Update),
    past: &Previous<'_>,
    u: &[f64],
) -> Vec<Option<PointState>> {
    let Ok(at) = <[[f64; 2]; N]>::try_from(at) else {
        return Vec::new();
    };
    match material.plane {
        Plane::Axisymmetric => {
            ContinuumElement::<N, P, true>::new(&kind.rule, at, material, update)
                .point_states(past, u)
        }
        _ => ContinuumElement::<N, P, false>::new(&kind.rule, at, material, update)
            .point_states(past, u),
    }
}

/// ∂u/∂X at a point of an element.
#[derive(Debug, Clone, Copy)]
pub struct PointGradient {
    /// H, in the plane.
    pub h: [[f64; 2]; 2],
    /// Hoop strain u_x/X of a body of revolution; 0 on the axis.
    pub hoop: f64,
    /// Current position.
    pub at: [f64; 2],
    /// Whether the point is an integration point rather than a node.
    pub integrates: bool,
}

/// Calls a function with ∂u/∂X at the integration points and then at the nodes of an element. `node` returns position and
/// displacement of node k of `count`; if `count` does not match the element kind, there are no points. Nodes at which the
/// undeformed element has no area are skipped, for example the corner of a quadrilateral degenerated to a triangle.
pub fn sample(
    kind: ElementKind,
    count: usize,
    node: impl Fn(usize) -> ([f64; 2], [f64; 2]),
    see: impl FnMut(PointGradient),
) {
    with_kind!(kind, sample_by(count, node, see))
}

fn sample_by<const N: usize, const P: usize>(
    kind: &ContinuumKind<N, P>,
    count: usize,
    node: impl Fn(usize) -> ([f64; 2], [f64; 2]),
    mut see: impl FnMut(PointGradient),
) {
    if count != N {
        return;
    }
    let (mut at, mut u) = ([[0.0; 2]; N], [[0.0; 2]; N]);
    for (k, (at, u)) in at.iter_mut().zip(&mut u).enumerate() {
        (*at, *u) = node(k);
    }
    let points = kind.rule.iter().map(|parent| (parent, true));
    for (parent, integrates) in points.chain(kind.nodes.iter().map(|parent| (parent, false))) {
        if let Some(h) = isoparametric::slope_at(parent, &at, &u) {
            let mean = |of: &[[f64; 2]; N], k: usize| -> f64 {
                parent.n.iter().zip(of).map(|(n, x)| n * x[k]).sum()
            };
            let (x, moved) = (mean(&at, 0), [mean(&u, 0), mean(&u, 1)]);
            see(PointGradient {
                h,
                hoop: if x > 0.0 { moved[0] / x } else { 0.0 },
                at: [x + moved[0], mean(&at, 1) + moved[1]],
                integrates,
            });
        }
    }
}

/// Number of history variables of an element of this kind.
pub fn history_len(kind: ElementKind, update: Update) -> usize {
    isoparametric::history_len(update, kind.points())
}

/// Integration points and weights of a kind in its parent element, with the shape functions and their derivatives.
pub fn rule(kind: ElementKind) -> Vec<Sample> {
    with_kind!(kind, samples())
}

fn samples<const N: usize, const P: usize>(kind: &ContinuumKind<N, P>) -> Vec<Sample> {
    let sample = |parent: &Parent<N>| Sample {
        at: parent.at,
        n: parent.n.to_vec(),
        d: parent.d.to_vec(),
        weight: parent.weight,
    };
    kind.rule.iter().map(sample).collect()
}

/// An integration point.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// ξ and η.
    pub at: [f64; 2],
    /// The shape functions.
    pub n: Vec<f64>,
    /// ∂N/∂ξ, ∂N/∂η.
    pub d: Vec<[f64; 2]>,
    /// Weight of the point.
    pub weight: f64,
}

/// Shape functions of a kind and their derivatives with respect to ξ and η, at a point of the parent element.
pub fn shape(kind: ElementKind, xi: f64, eta: f64) -> (Vec<f64>, Vec<[f64; 2]>) {
    with_kind!(kind, shape_at(xi, eta))
}

fn shape_at<const N: usize, const P: usize>(
    kind: &ContinuumKind<N, P>,
    xi: f64,
    eta: f64,
) -> (Vec<f64>, Vec<[f64; 2]>) {
    let (n, d) = (kind.shape)(xi, eta);
    (n.to_vec(), d.to_vec())
}

/// Positions of a kind's nodes in its parent element.
pub fn places(kind: ElementKind) -> Vec<[f64; 2]> {
    fn places<const N: usize, const P: usize>(kind: &ContinuumKind<N, P>) -> Vec<[f64; 2]> {
        kind.places.to_vec()
    }
    with_kind!(kind, places())
}
