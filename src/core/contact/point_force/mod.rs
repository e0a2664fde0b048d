//! What a polynomial beam element leaves out under a point force: how much more the beam gives there, and how its line turns.
//!
//! A force F on a beam with shear stiffness GA makes a step F/GA in the shear strain γ, so a kink in the axis, wherever it acts, and a kink in
//! the moment's line. An element of degree p with the reduced Gauss rule has the projections of both on polynomials of degree p − 1. With
//! P_k Legendre's polynomials, L the undeformed length, ξ in [−1, 1] and Π the projection,
//!
//! ```text
//! sgn(η−ξ) = Σ a_k(ξ) P_k(η),   a_0 = −ξ,        a_k = P_{k−1} − P_{k+1}
//! |η−ξ|    = Σ b_k(ξ) P_k(η),   b_0 = (1+ξ²)/2,  b_k = a_{k−1}/(2k−1) − a_{k+1}/(2k+3)
//! Q = F/2 sgn:      GA γ = Π Q
//! M' + Q = 0:       EI κ = Π ∫Π Q:  b_k up to k = p − 2, and then  m = a_{p−2}/(2p−3) in place of b_{p−1}
//! ```
//!
//! The energy that the mesh leaves out is ½ c F², or with forces F_i at several places of one element ½ Σ c_ij F_i F_j,
//!
//! ```text
//! c_ij = L/(8 GA)  [∫ sgn(η−ξ_i) sgn(η−ξ_j) dη − Σ_{k<p}    2/(2k+1) a_k(ξ_i) a_k(ξ_j)]
//!      + L³/(32 EI) [∫ |η−ξ_i| |η−ξ_j| dη       − Σ_{k<p−1} 2/(2k+1) b_k(ξ_i) b_k(ξ_j) − 2/(2p−1) m(ξ_i) m(ξ_j)]
//! ```
//!
//! The second line holds for p >= 3, whose elements have exact ends whatever acts between them; below it is left out. One potential gives
//! all that contact needs: the surface lies c F deeper (g_i + Σ c_ij F_j = 0), and the force turns by tan α = F_i⁻¹ ∂/∂s (its energy),
//! which for shear alone is α = −(F/2GA) P_{p−1} P_p: then it stands on the mean of the two tangents at the kink. At ξ = ±1 c vanishes.
//! The derivation is on the manual's page `theory`.

mod dual;
pub mod judged;
mod linearised;
mod pair;
#[cfg(test)]
mod tests;

pub use linearised::{Linearised, Others, Over, linearise, tilt, turned};
pub use pair::Pair;

use crate::contact::element::Element;
use crate::contact::projection::{Projection, SurfacePoint, tangent};
use crate::model::{PointGive, Surface};

/// What an element of a surface gives at a place, where it leaves anything out.
pub fn of(surface: &Surface, spot: SurfacePoint) -> Option<PointGive> {
    let give = surface.gives.get(spot.element).copied()?;
    (give.shear > 0.0).then_some(give)
}

/// n of a node that bears F_n alone on its element, turned where that gives.
pub fn normal(surface: &Surface, spot: SurfacePoint, over: &Projection, f_n: f64) -> [f64; 2] {
    let (Some(give), Some(lever)) = (of(surface, spot), over.lever()) else {
        return over.normal;
    };
    let degree = Element::of(surface, spot.element).degree();
    let own = Pair::new(&give, degree, spot.xi, spot.xi);
    turned(over.normal, tilt(&own, lever, f_n, &Others::default()))
}

/// dx/dξ at an end of an element under a force there: turned, as the line on that side of the kink is.
pub fn turned_end(surface: &Surface, end: SurfacePoint, slope: [f64; 2], f_n: f64) -> [f64; 2] {
    let Some(give) = of(surface, end).filter(|_| f_n > 0.0) else {
        return slope;
    };
    let degree = Element::of(surface, end.element).degree();
    let size = (slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
    let own = Pair::new(&give, degree, end.xi, end.xi);
    let a = tilt(&own, 1.0 / size, f_n, &Others::default());
    let across = tangent(slope);
    [0, 1].map(|k| slope[k] + a * across[k])
}
