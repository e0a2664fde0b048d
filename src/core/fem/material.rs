//! Plane elastic materials: stress and its exact derivative for a given Green-Lagrange strain.
//!
//! Strains and stresses are triples (11, 22, 12) with the shear *strain* doubled, so that S · δE is the work. With Lamé's λ = E ν
//! / ((1 + ν)(1 − 2ν)), μ = E / (2 (1 + ν)), C = I + 2E and the three-dimensional J = det F:
//!
//! ```text
//! St Venant-Kirchhoff   S = λ tr(E) I + 2μ E
//! neo-Hookean           W = μ/2 (I1 − 3 − 2 ln J) + λ/2 (ln J)²,   S = μ (I − C⁻¹) + λ ln J C⁻¹
//! ```
//!
//! Plane strain has E33 = 0; in axisymmetry E33 is given and causes a stress ([`Hoop`]). Plane stress has S33 = 0, and E33 is
//! eliminated exactly: with λ' = 2λμ/(λ + 2μ) instead of λ in the first law, by a scalar Newton iteration in the second.

use crate::model::Elastic;
use crate::model::{Law, Plane};
use nalgebra::{Matrix2, Matrix3, Vector3};

/// Maximum number of steps of the scalar iteration in plane stress; it converges monotonically in five or six.
const MOST_STEPS: usize = 50;

/// An elastic material with derived constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Lamé's first constant.
    pub lambda: f64,
    /// Shear modulus.
    pub mu: f64,
    /// The law.
    pub law: Law,
    /// Assumption about the out-of-plane direction.
    pub plane: Plane,
    /// Reference thickness.
    pub thickness: f64,
    /// Pressure of a thermal expansion that is fully restrained; 0 without expansion. Only with law svk.
    pub pressure: f64,
}

/// Response of a material to a strain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Second Piola-Kirchhoff stress S11, S22, S12.
    pub stress: Vector3<f64>,
    /// dS/dE with doubled shear strain; symmetric.
    pub tangent: Matrix3<f64>,
    /// E33, zero in plane strain.
    pub thickening: f64,
}

/// Response in the hoop direction, if the hoop strain is not zero.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Hoop {
    /// S33.
    pub stress: f64,
    /// ∂S33/∂E11, ∂S33/∂E22, ∂S33/∂(2 E12), which are ∂S11/∂E33, ∂S22/∂E33, ∂S12/∂E33.
    pub coupling: Vector3<f64>,
    /// ∂S33/∂E33.
    pub modulus: f64,
}

impl Material {
    /// The material of a scene.
    pub fn new(elastic: &Elastic) -> Self {
        let Elastic { young, poisson, .. } = *elastic;
        Material {
            lambda: young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)),
            mu: young / (2.0 * (1.0 + poisson)),
            law: elastic.law,
            plane: elastic.plane,
            thickness: elastic.thickness,
            pressure: 0.0,
        }
    }

    /// The same with a thermal expansion: stresses belong to the strain minus `strain` in all directions.
    pub fn expanded(elastic: &Elastic, strain: f64) -> Self {
        let free = match elastic.plane {
            Plane::Strain | Plane::Axisymmetric => 1.0 - 2.0 * elastic.poisson,
            Plane::Stress => 1.0 - elastic.poisson,
        };
        Material {
            pressure: elastic.young / free * strain,
            ..Material::new(elastic)
        }
    }

    /// The part of the stress due to an expansion of 1, as a material whose stiffness vanishes next to it.
    pub fn expansion_only(elastic: &Elastic) -> Self {
        Material {
            lambda: 0.0,
            mu: 1e-200,
            ..Material::expanded(elastic, 1.0)
        }
    }

    /// Stress and tangent at a strain E11, E22, 2 E12; `None` if the law has no response, because a neo-Hookean material cannot
    /// be inverted.
    #[inline(always)]
    pub fn response(&self, strain: &Vector3<f64>) -> Option<Response> {
        match self.law {
            Law::Svk => Some(self.linear(strain)),
            Law::NeoHookean => self.neo_hookean(strain),
        }
    }

    /// S = C : E with constant plane moduli, which the updated Lagrangian formulation uses for every increment.
    #[inline(always)]
    pub fn linear(&self, strain: &Vector3<f64>) -> Response {
        let (mu, trace) = (self.mu, strain.x + strain.y);
        // λ / (λ + 2μ) = ν / (1 − ν).
        let share = self.lambda / (self.lambda + 2.0 * mu);
        let (lambda, thickening) = match self.plane {
            Plane::Strain | Plane::Axisymmetric => (self.lambda, 0.0),
            Plane::Stress => (2.0 * mu * share, self.pressure / (2.0 * mu) - share * trace),
        };
        let direct = lambda + 2.0 * mu;
        let tangent = Matrix3::new(direct, lambda, 0.0, lambda, direct, 0.0, 0.0, 0.0, mu);
        let stress = Vector3::new(
            direct * strain.x + lambda * strain.y - self.pressure,
            lambda * strain.x + direct * strain.y - self.pressure,
            mu * strain.z,
        );
        Response {
            stress,
            tangent,
            thickening,
        }
    }

    fn neo_hookean(&self, strain: &Vector3<f64>) -> Option<Response> {
        let (lambda, mu) = (self.lambda, self.mu);
        let e = tensor(strain);
        let swelling = swelling(&e);
        if swelling.is_nan() || swelling <= -1.0 {
            return None;
        }
        let inverse = (Matrix2::identity() + 2.0 * e).try_inverse()?;
        let log = swelling.ln_1p();
        // Stress and tangent contain μ − λ ln J; in plane stress it is μ C33.
        let (pressure, direct, thickening) = match self.plane {
            Plane::Strain | Plane::Axisymmetric => (0.5 * lambda * log, lambda, 0.0),
            Plane::Stress => {
                let x = self.log_of_c33(log)?;
                let c33 = x.exp();
                let direct = 2.0 * lambda * mu * c33 / (lambda + 2.0 * mu * c33);
                (-mu * x.exp_m1(), direct, 0.5 * x.exp_m1())
            }
        };
        Some(self.answer(&e, &inverse, (pressure, direct, thickening)))
    }

    /// S = C⁻¹ (2μ E + p I) and its derivative in the plane, where p is λ ln J or its substitute, and `direct` its derivative.
    fn answer(
        &self,
        e: &Matrix2<f64>,
        inverse: &Matrix2<f64>,
        (pressure, direct, thickening): (f64, f64, f64),
    ) -> Response {
        let mu = self.mu;
        let s = inverse * (2.0 * mu * *e + Matrix2::identity() * pressure);
        let (a, b, c) = (inverse[(0, 0)], inverse[(1, 1)], inverse[(0, 1)]);
        let v = Vector3::new(a, b, c);
        let both = Matrix3::new(
            a * a,
            c * c,
            a * c,
            c * c,
            b * b,
            b * c,
            a * c,
            b * c,
            0.5 * (a * b + c * c),
        );
        Response {
            stress: Vector3::new(s[(0, 0)], s[(1, 1)], 0.5 * (s[(0, 1)] + s[(1, 0)])),
            tangent: direct * v * v.transpose() + 2.0 * (mu - pressure) * both,
            thickening,
        }
    }

    /// Stress and tangent with the hoop strain `hoop` = E33; `None` if the law has no response.
    pub fn response_around(&self, strain: &Vector3<f64>, hoop: f64) -> Option<(Response, Hoop)> {
        match self.law {
            Law::Svk => Some(self.linear_around(strain, hoop)),
            Law::NeoHookean => self.neo_hookean_around(strain, hoop),
        }
    }

    /// S = C : E with E33 = `hoop`.
    pub fn linear_around(&self, strain: &Vector3<f64>, hoop: f64) -> (Response, Hoop) {
        let (lambda, direct) = (self.lambda, self.lambda + 2.0 * self.mu);
        let mut response = self.linear(strain);
        response.stress += Vector3::new(lambda * hoop, lambda * hoop, 0.0);
        let hoop = Hoop {
            stress: direct * hoop + lambda * (strain.x + strain.y) - self.pressure,
            coupling: Vector3::new(lambda, lambda, 0.0),
            modulus: direct,
        };
        (response, hoop)
    }

    fn neo_hookean_around(&self, strain: &Vector3<f64>, hoop: f64) -> Option<(Response, Hoop)> {
        let (lambda, mu) = (self.lambda, self.mu);
        let e = tensor(strain);
        let (swelling, around) = (swelling(&e), 2.0 * hoop);
        if !(swelling > -1.0 && around > -1.0) {
            return None;
        }
        let inverse = (Matrix2::identity() + 2.0 * e).try_inverse()?;
        let pressure = 0.5 * lambda * (swelling.ln_1p() + around.ln_1p());
        let response = self.answer(&e, &inverse, (pressure, lambda, hoop));
        let c = 1.0 / (1.0 + around);
        let hoop = Hoop {
            stress: c * (2.0 * mu * hoop + pressure),
            coupling: lambda * c * Vector3::new(inverse[(0, 0)], inverse[(1, 1)], inverse[(0, 1)]),
            modulus: c * c * (lambda + 2.0 * (mu - pressure)),
        };
        Some((response, hoop))
    }

    /// S33 for a plane strain: zero in plane stress.
    pub fn across(&self, strain: &Vector3<f64>) -> f64 {
        match (self.plane, self.law) {
            (Plane::Stress, _) => 0.0,
            (_, Law::Svk) => self.linear_across(strain),
            (_, Law::NeoHookean) => 0.5 * self.lambda * swelling(&tensor(strain)).ln_1p(),
        }
    }

    /// The same for constant moduli.
    pub fn linear_across(&self, strain: &Vector3<f64>) -> f64 {
        match self.plane {
            Plane::Stress => 0.0,
            _ => self.lambda * (strain.x + strain.y) - self.pressure,
        }
    }

    /// The same from the in-plane stress: ν (σ11 + σ22).
    pub fn across_of(&self, stress: &Vector3<f64>) -> f64 {
        match self.plane {
            Plane::Stress => 0.0,
            _ => self.lambda / (2.0 * (self.lambda + self.mu)) * (stress.x + stress.y),
        }
    }

    /// x = ln C33 in plane stress, where `log` is ln det C of the plane: μ (eˣ − 1) + λ/2 (log + x) = 0.
    ///
    /// The function is convex and increasing, so all Newton iterates after the first step are above the root.
    fn log_of_c33(&self, log: f64) -> Option<f64> {
        let (half, mu) = (0.5 * self.lambda, self.mu);
        let mut x = -half * log / (mu + half);
        for _ in 0..MOST_STEPS {
            let step = (mu * x.exp_m1() + half * (log + x)) / (mu * x.exp() + half);
            x -= step;
            if step.abs() <= 4.0 * f64::EPSILON * x.abs() {
                return Some(x);
            }
        }
        x.is_finite().then_some(x)
    }
}

/// E as a matrix.
fn tensor(strain: &Vector3<f64>) -> Matrix2<f64> {
    Matrix2::new(strain.x, 0.5 * strain.z, 0.5 * strain.z, strain.y)
}

/// det C − 1 of the plane, computed without cancellation.
fn swelling(e: &Matrix2<f64>) -> f64 {
    2.0 * e.trace() + 4.0 * e.determinant()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Update;

    fn material(law: Law, plane: Plane, nu: f64) -> Material {
        Material::new(&Elastic {
            young: 100.0,
            poisson: nu,
            law,
            plane,
            thickness: 1.0,
            update: Update::Total,
        })
    }

    fn all() -> impl Iterator<Item = Material> {
        let laws = [Law::Svk, Law::NeoHookean];
        let pairs = laws
            .into_iter()
            .flat_map(|law| [(law, Plane::Strain), (law, Plane::Stress)]);
        pairs.flat_map(|(law, plane)| [0.0, 0.3, 0.49].map(|nu| material(law, plane, nu)))
    }

    const STRAINS: [[f64; 3]; 5] = [
        [0.0, 0.0, 0.0],
        [0.3, -0.2, 0.25],
        [-0.35, 0.6, -0.3],
        [-0.4, -0.3, 0.1],
        [2.0, 1.5, 1.0],
    ];

    #[test]
    fn the_tangent_is_the_derivative_of_the_stress() {
        for m in all() {
            for strain in STRAINS.map(Vector3::from) {
                let at = m.response(&strain).unwrap();
                let scale = at.tangent.amax();
                for k in 0..3 {
                    let mut h = Vector3::zeros();
                    h[k] = 1e-5;
                    let plus = m.response(&(strain + h)).unwrap().stress;
                    let minus = m.response(&(strain - h)).unwrap().stress;
                    let difference = (plus - minus) / 2e-5;
                    let error = (difference - at.tangent.column(k)).amax();
                    assert!(error < 1e-7 * scale, "{m:?} {strain:?}: {error:e}");
                }
                assert!((at.tangent - at.tangent.transpose()).amax() < 1e-15 * scale);
            }
        }
    }

    #[test]
    fn the_axisymmetric_tangent_is_the_derivative_of_the_stress() {
        for law in [Law::Svk, Law::NeoHookean] {
            let m = material(law, Plane::Axisymmetric, 0.3);
            for (strain, hoop) in STRAINS
                .map(Vector3::from)
                .into_iter()
                .zip([0.0, 0.4, -0.3, 0.2, 1.0])
            {
                let all = |strain: &Vector3<f64>, hoop: f64| {
                    let (plane, around) = m.response_around(strain, hoop).unwrap();
                    (plane.stress, around.stress)
                };
                let (plane, around) = m.response_around(&strain, hoop).unwrap();
                let (scale, h) = (plane.tangent.amax().max(around.modulus), 1e-5);
                for k in 0..3 {
                    let mut step = Vector3::zeros();
                    step[k] = h;
                    let (plus, minus) = (all(&(strain + step), hoop), all(&(strain - step), hoop));
                    let error = (plus.0 - minus.0) / (2.0 * h) - plane.tangent.column(k);
                    assert!(error.amax() < 1e-7 * scale, "{law:?} {strain:?}");
                    let error = (plus.1 - minus.1) / (2.0 * h) - around.coupling[k];
                    assert!(error.abs() < 1e-7 * scale, "{law:?} {strain:?}");
                }
                let (plus, minus) = (all(&strain, hoop + h), all(&strain, hoop - h));
                let error = (plus.0 - minus.0) / (2.0 * h) - around.coupling;
                assert!(error.amax() < 1e-7 * scale, "{law:?} {strain:?}");
                let error = (plus.1 - minus.1) / (2.0 * h) - around.modulus;
                assert!(error.abs() < 1e-7 * scale, "{law:?} {strain:?}");
            }
        }
    }

    #[test]
    fn without_hoop_strain_the_response_is_that_of_plane_strain() {
        for law in [Law::Svk, Law::NeoHookean] {
            let [flat, round] =
                [Plane::Strain, Plane::Axisymmetric].map(|plane| material(law, plane, 0.3));
            for strain in STRAINS.map(Vector3::from) {
                let expected = flat.response(&strain).unwrap();
                let (response, hoop) = round.response_around(&strain, 0.0).unwrap();
                assert!((response.stress - expected.stress).amax() < 1e-12 * 100.0);
                assert!((hoop.stress - flat.across(&strain)).abs() < 1e-12 * 100.0);
            }
        }
    }

    #[test]
    fn the_laws_agree_for_small_strains_to_the_last_digits() {
        for plane in [Plane::Strain, Plane::Stress] {
            let [svk, neo] = [Law::Svk, Law::NeoHookean].map(|law| material(law, plane, 0.3));
            let strain = Vector3::new(3e-14, -1e-14, 2e-14);
            let (a, b) = (
                svk.response(&strain).unwrap().stress,
                neo.response(&strain).unwrap().stress,
            );
            assert!((a - b).amax() < 1e-12 * a.amax(), "{a} {b}");
        }
    }

    #[test]
    fn plane_stress_has_no_stress_across_the_plane() {
        for nu in [0.0, 0.3, 0.49] {
            for strain in STRAINS.map(Vector3::from) {
                let e = Matrix2::new(strain.x, 0.5 * strain.z, 0.5 * strain.z, strain.y);
                let svk = material(Law::Svk, Plane::Stress, nu);
                let e33 = svk.response(&strain).unwrap().thickening;
                let s33 = svk.lambda * (e.trace() + e33) + 2.0 * svk.mu * e33;
                assert!(s33.abs() < 1e-13 * svk.lambda.max(1.0));
                let neo = material(Law::NeoHookean, Plane::Stress, nu);
                let c33 = 1.0 + 2.0 * neo.response(&strain).unwrap().thickening;
                let log_j = 0.5 * ((Matrix2::identity() + 2.0 * e).determinant() * c33).ln();
                let s33 = neo.mu * (1.0 - 1.0 / c33) + neo.lambda * log_j / c33;
                assert!(s33.abs() < 1e-12 * neo.lambda.max(neo.mu), "{nu} {s33:e}");
            }
        }
    }

    #[test]
    fn a_neo_hookean_material_cannot_be_compressed_to_zero_volume() {
        let m = material(Law::NeoHookean, Plane::Strain, 0.3);
        assert!(m.response(&Vector3::new(-0.5, 0.0, 0.0)).is_none());
        assert!(m.response(&Vector3::new(f64::NAN, 0.0, 0.0)).is_none());
        let near = m.response(&Vector3::new(-0.499_999, 0.0, 0.0)).unwrap();
        assert!(near.stress.x < -1e6);
    }
}
