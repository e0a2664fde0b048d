//! Continuum elements of each kind ([`super::kinds`]).

use crate::Material;
use crate::elements::kinds::continuum_kind::{ContinuumKind, Parent};
use crate::elements::kinds::custom::{CustomKind, KindError};
use crate::elements::kinds::data_of;
use crate::fem::element::{Element, Previous};
use crate::fem::isoparametric::ContinuumElement;
use crate::fem::isoparametric::{self, PointState};
use crate::fem::small;
use crate::model::{ElementKind, Plane, Update};

/// What is computed of a kind of element.
pub trait Formulation: Sync {
    /// Creates an element at these undeformed positions. With the wrong number of positions it never has a response, so no state
    /// of it can be accepted.
    fn element(
        &'static self,
        at: &[[f64; 2]],
        material: Material,
        update: Update,
    ) -> Box<dyn Element>;

    /// States of an element's integration points, in the order of its rule; `None` where the material has no response. Empty if
    /// the number of nodes is wrong.
    fn states(
        &'static self,
        at: &[[f64; 2]],
        made_of: (Material, Update),
        past: &Previous<'_>,
        u: &[f64],
    ) -> Vec<Option<PointState>>;

    /// Calls a function with ∂u/∂X at the integration points and then at the nodes of an element. `node` returns position and
    /// displacement of node k of `count`; if `count` does not match the element kind, there are no points. Nodes at which the
    /// undeformed element has no area are skipped, for example the corner of a quadrilateral degenerated to a triangle.
    fn sample(
        &self,
        count: usize,
        node: &dyn Fn(usize) -> ([f64; 2], [f64; 2]),
        see: &mut dyn FnMut(&PointGradient<'_>),
    );

    /// Integration points and weights in the parent element, with the shape functions and their derivatives.
    fn rule(&self) -> Vec<Sample>;

    /// The shape functions and their derivatives with respect to ξ and η, at a point of the parent element.
    fn shape(&self, xi: f64, eta: f64) -> (Vec<f64>, Vec<[f64; 2]>);

    /// Positions of the nodes in the parent element.
    fn places(&self) -> &[[f64; 2]];
}

/// The formulation of a kind.
pub fn formulation(kind: ElementKind) -> &'static dyn Formulation {
    let custom = |kind: &'static CustomKind| -> &'static dyn Formulation {
        let formulation = kind.formulation.downcast_ref::<&'static dyn Formulation>();
        *formulation.expect("only `register` adds kinds")
    };
    data_of!(kind, custom)
}

/// Adds a kind of element, which files can then use under this name.
///
/// # Errors
/// If another kind has this name, or the faces are not those of a triangle or a quadrilateral.
pub fn register<const N: usize, const P: usize>(
    name: &'static str,
    kind: &'static ContinuumKind<N, P>,
) -> Result<ElementKind, KindError> {
    let formulation: &'static dyn Formulation = kind;
    ElementKind::register(name, kind.outline, Box::new(formulation))
}

impl<const N: usize, const P: usize> Formulation for ContinuumKind<N, P> {
    fn element(
        &'static self,
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
        let rule = self.rule();
        let made: Box<dyn Element> = match material.plane {
            Plane::Axisymmetric => Box::new(ContinuumElement::<N, P, true>::new(
                rule, at, material, update,
            )),
            _ => Box::new(ContinuumElement::<N, P, false>::new(
                rule, at, material, update,
            )),
        };
        match update {
            Update::Total | Update::Updated => made,
            Update::Small => Box::new(small::SmallStrainElement::new(&*made)),
        }
    }

    fn states(
        &'static self,
        at: &[[f64; 2]],
        (material, update): (Material, Update),
        past: &Previous<'_>,
        u: &[f64],
    ) -> Vec<Option<PointState>> {
        let Ok(at) = <[[f64; 2]; N]>::try_from(at) else {
            return Vec::new();
        };
        let rule = self.rule();
        match material.plane {
            Plane::Axisymmetric => ContinuumElement::<N, P, true>::new(rule, at, material, update)
                .point_states(past, u),
            _ => ContinuumElement::<N, P, false>::new(rule, at, material, update)
                .point_states(past, u),
        }
    }

    fn sample(
        &self,
        count: usize,
        node: &dyn Fn(usize) -> ([f64; 2], [f64; 2]),
        see: &mut dyn FnMut(&PointGradient<'_>),
    ) {
        if count != N {
            return;
        }
        let own: [_; N] = std::array::from_fn(|k| {
            let ([x, y], [u, v]) = node(k);
            [x, y, u, v]
        });
        let points = self.rule().iter().map(|parent| (parent, true));
        let nodes = self.at_nodes().iter().map(|parent| (parent, false));
        for (parent, integrates) in points.chain(nodes) {
            if let Some(h) = isoparametric::slope_at(parent, &own) {
                let mean = |k: usize| -> f64 {
                    let shares = parent.n.iter().zip(&own);
                    shares.map(|(n, node)| n * node[k]).sum()
                };
                see(&PointGradient {
                    h,
                    hoop: &|| {
                        let x = mean(0);
                        if x > 0.0 { mean(2) / x } else { 0.0 }
                    },
                    at: &|| [0, 1].map(|k| mean(k) + mean(2 + k)),
                    integrates,
                });
            }
        }
    }

    fn rule(&self) -> Vec<Sample> {
        let sample = |parent: &Parent<N>| Sample {
            at: parent.at,
            n: parent.n.to_vec(),
            d: parent.d.to_vec(),
            weight: parent.weight,
        };
        self.rule().iter().map(sample).collect()
    }

    fn shape(&self, xi: f64, eta: f64) -> (Vec<f64>, Vec<[f64; 2]>) {
        let (n, d) = self.shape(xi, eta);
        (n.to_vec(), d.to_vec())
    }

    fn places(&self) -> &[[f64; 2]] {
        self.places()
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

/// ∂u/∂X at a point of an element.
pub struct PointGradient<'a> {
    /// H, in the plane.
    pub h: [[f64; 2]; 2],
    /// Computes the hoop strain u_x/X of a body of revolution; 0 on the axis.
    pub hoop: &'a dyn Fn() -> f64,
    /// Computes the current position.
    pub at: &'a dyn Fn() -> [f64; 2],
    /// Whether the point is an integration point rather than a node.
    pub integrates: bool,
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
