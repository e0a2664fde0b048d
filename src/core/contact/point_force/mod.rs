//! Local deflection and rotation under a point force that the polynomials of a beam element do not represent.
//!
//! A force F on a beam with shear stiffness GA causes a step F/GA in the shear strain γ, hence a kink in the axis where it acts,
//! and a kink in the bending moment. An element of degree p with the reduced Gauss rule represents the projections of both onto
//! polynomials of degree p − 1. With P_k the Legendre polynomials, L the undeformed length, ξ in [−1, 1] and Π the projection,
//!
//! ```text
//! sgn(η−ξ) = Σ a_k(ξ) P_k(η),   a_0 = −ξ,        a_k = P_{k−1} − P_{k+1}
//! |η−ξ|    = Σ b_k(ξ) P_k(η),   b_0 = (1+ξ²)/2,  b_k = a_{k−1}/(2k−1) − a_{k+1}/(2k+3)
//! Q = F/2 sgn:      GA γ = Π Q
//! M' + Q = 0:       EI κ = Π ∫Π Q:  b_k up to k = p − 2, then  m = a_{p−2}/(2p−3) instead of b_{p−1}
//! ```
//!
//! The energy that the mesh omits is ½ c F²; for forces F_i at several points of an element it is ½ Σ c_ij F_i F_j with
//!
//! ```text
//! c_ij = L/(8 GA)  [∫ sgn(η−ξ_i) sgn(η−ξ_j) dη − Σ_{k<p}    2/(2k+1) a_k(ξ_i) a_k(ξ_j)]
//!      + L³/(32 EI) [∫ |η−ξ_i| |η−ξ_j| dη       − Σ_{k<p−1} 2/(2k+1) b_k(ξ_i) b_k(ξ_j) − 2/(2p−1) m(ξ_i) m(ξ_j)]
//! ```
//!
//! The second line applies for p >= 3, where the end displacements of the element are exact for any load between the ends; it is
//! dropped for p < 3. Both contact terms follow from this potential: the surface lies c F deeper (g_i + Σ c_ij F_j = 0), and the
//! force rotates by tan α = F_i⁻¹ ∂/∂s (its energy). For shear alone α = −(F/2GA) P_{p−1} P_p: the force is perpendicular to the
//! mean of the two tangents at the kink. At ξ = ±1 c vanishes. The derivation is on the manual's page `theory`.

mod dual;
pub mod judged;
mod linearised;
mod pair;
#[cfg(test)]
mod tests;

pub use linearised::{LinearisedForce, NodeOverElement, OtherForces, linearise, tilt, turned};
pub use pair::Pair;

use crate::contact::projection::{Projection, tangent};
use crate::model::{PointGive, Surface};
use crate::plane::length;
use crate::{SurfaceElement, SurfacePoint};

/// Local flexibilities of the element at a surface point. `None` if the element has none.
pub fn of(surface: &Surface, spot: SurfacePoint) -> Option<PointGive> {
    let give = surface.gives.get(spot.element).copied()?;
    (give.shear > 0.0).then_some(give)
}

/// n (unit) at a node whose F_n is the only force on its element, rotated if the element has local flexibility.
pub fn normal(surface: &Surface, spot: SurfacePoint, over: &Projection, f_n: f64) -> [f64; 2] {
    let (Some(give), Some(lever)) = (of(surface, spot), over.lever()) else {
        return over.normal;
    };
    let degree = SurfaceElement::from_surface(surface, spot.element).degree();
    let own = Pair::new(&give, degree, spot.xi, spot.xi);
    turned(over.normal, tilt(&own, lever, f_n, &OtherForces::default()))
}

/// dx/dξ at an end of an element under a force there, rotated to the direction of the line on that side of the kink.
pub fn turned_end(surface: &Surface, end: SurfacePoint, slope: [f64; 2], f_n: f64) -> [f64; 2] {
    let Some(give) = of(surface, end).filter(|_| f_n > 0.0) else {
        return slope;
    };
    let degree = SurfaceElement::from_surface(surface, end.element).degree();
    let size = length(slope);
    let own = Pair::new(&give, degree, end.xi, end.xi);
    let a = tilt(&own, 1.0 / size, f_n, &OtherForces::default());
    let across = tangent(slope);
    [0, 1].map(|k| slope[k] + a * across[k])
}
