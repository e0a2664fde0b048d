//! 12-node quadrilateral: cubic along each side (serendipity); 4 × 4 Gauss points.
//!
//! ```text
//! corners      N = 1/32 (1 + ξ_i ξ) (1 + η_i η) (9 (ξ² + η²) − 10)
//! ξ_i = ±1/3   N = 9/32 (1 + η_i η) (1 − ξ²) (1 + 9 ξ_i ξ), and alike for η_i = ±1/3
//! ```

use std::sync::LazyLock;
use stickslip_core::elements::kinds::continuum_kind::{ContinuumKind, Shape};
use stickslip_core::elements::quadrature::square;
use stickslip_core::fem::continuum;
use stickslip_core::model::ElementKind;

const THIRD: f64 = 1.0 / 3.0;

const PLACES: [[f64; 2]; 12] = [
    [-1.0, -1.0],
    [1.0, -1.0],
    [1.0, 1.0],
    [-1.0, 1.0],
    [-THIRD, -1.0],
    [THIRD, -1.0],
    [1.0, -THIRD],
    [1.0, THIRD],
    [THIRD, 1.0],
    [-THIRD, 1.0],
    [-1.0, THIRD],
    [-1.0, -THIRD],
];

const FACES: &[&[usize]] = &[&[0, 4, 5, 1], &[1, 6, 7, 2], &[2, 8, 9, 3], &[3, 10, 11, 0]];

/// Type of a Lagrange quadrilateral in VTK files.
const VTK: u8 = 70;

static KIND: ContinuumKind<12, 16> = ContinuumKind::new(VTK, FACES, PLACES, || square(4), shape);

static REGISTERED: LazyLock<Option<ElementKind>> =
    LazyLock::new(|| continuum::register("quad12", &KIND).ok());

/// The kind, which scene files call `quad12` from the first call on; `None` if another kind has this name.
pub fn quad12() -> Option<ElementKind> {
    *REGISTERED
}

fn shape(xi: f64, eta: f64) -> Shape<12> {
    let (mut n, mut d) = ([0.0; 12], [[0.0; 2]; 12]);
    for (i, [a, b]) in PLACES.into_iter().enumerate() {
        if a.abs() == b.abs() {
            let (p, q) = (1.0 + a * xi, 1.0 + b * eta);
            let rest = 9.0 * (xi * xi + eta * eta) - 10.0;
            n[i] = p * q * rest / 32.0;
            d[i] = [
                q * (a * rest + 18.0 * xi * p) / 32.0,
                p * (b * rest + 18.0 * eta * q) / 32.0,
            ];
            continue;
        }
        let across = b.abs() == 1.0;
        let (along, other, a, b) = match across {
            true => (xi, eta, a, b),
            false => (eta, xi, b, a),
        };
        let (bubble, tilt, linear) = (1.0 - along * along, 1.0 + 9.0 * a * along, 1.0 + b * other);
        n[i] = 9.0 / 32.0 * linear * bubble * tilt;
        let by_along = 9.0 / 32.0 * linear * (9.0 * a * bubble - 2.0 * along * tilt);
        let by_other = 9.0 / 32.0 * b * bubble * tilt;
        d[i] = match across {
            true => [by_along, by_other],
            false => [by_other, by_along],
        };
    }
    (n, d)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use stickslip_core::model::BodyKind;
    use stickslip_core::{Outcome, Stepper};
    use stickslip_scene::Scene;

    /// An element of 3 by 3 on a rigid floor, pressed by a pressure of 2; `order` is that of its nodes.
    fn pressed(order: [usize; 12]) -> Scene {
        quad12().unwrap();
        let nodes: Vec<String> = PLACES
            .iter()
            .enumerate()
            .map(|(k, [x, y])| format!("({}, {:?}, {:?})", k + 1, 1.5 * x, 1.5 * y))
            .collect();
        let text = format!(
            "(title: \"pressed\", nodes: [
                Given(id: \"m\", nodes: [{}], elements: [(part: \"p\", kind: quad12, nodes: [{:?}])],
                    sides: [(name: \"low\", sides: [[1, 5, 6, 2]]), (name: \"high\", sides: [[3, 9, 10, 4]])]),
                Line(id: \"floor\", from: (5, -1.5), to: (-5, -1.5), elements: 1, per_element: 2),
            ],
            materials: [Elastic(id: \"e\", E: 1000, nu: 0)],
            bodies: [Solid(id: \"block\", mesh: \"m\", material: \"e\")],
            surfaces: [(id: \"floor\", along: \"floor\")],
            slaves: [(nodes: [\"m.low\"], on: [\"floor\"], start: sliding)],
            supports: [(node: \"m.1\", fix: [x]), (node: \"m.2\", fix: [x])],
            loads: [Pressure(along: \"m.high\", value: 2)],
            history: (path: [0, 1], increment: 1))",
            nodes.join(", "),
            order.map(|k| k + 1)
        );
        Scene::from_text("pressed.ron", &text, &[]).unwrap_or_else(|why| panic!("{why}"))
    }

    const AROUND: [usize; 12] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11];
    const CLOCKWISE: [usize; 12] = [0, 3, 2, 1, 11, 10, 9, 8, 7, 6, 5, 4];

    #[test]
    fn its_slopes_are_those_of_its_shape_functions_which_reproduce_cubics() {
        let (xi, eta, h) = (0.3, -0.7, 1e-6);
        let (n, d) = shape(xi, eta);
        let ([(right, _), (left, _)], [(up, _), (down, _)]) = (
            [h, -h].map(|h| shape(xi + h, eta)),
            [h, -h].map(|h| shape(xi, eta + h)),
        );
        for i in 0..12 {
            let slopes = [
                (right[i] - left[i]) / (2.0 * h),
                (up[i] - down[i]) / (2.0 * h),
            ];
            assert!((slopes[0] - d[i][0]).abs() < 1e-8 && (slopes[1] - d[i][1]).abs() < 1e-8);
        }
        for (i, j) in [(0, 0), (3, 0), (0, 3), (2, 1), (1, 2), (3, 1), (1, 3)] {
            let value = |[x, y]: [f64; 2]| x.powi(i) * y.powi(j);
            let sum: f64 = n.iter().zip(PLACES).map(|(n, at)| n * value(at)).sum();
            assert!((sum - value([xi, eta])).abs() < 1e-14, "{i} {j}");
        }
    }

    #[test]
    fn a_scene_names_it_and_its_sides_touch() {
        for order in [AROUND, CLOCKWISE] {
            let scene = pressed(order);
            let mut stepper = Stepper::new(Arc::new(scene.model.clone()));
            while let Some(event) = stepper.step() {
                assert!(!matches!(event.outcome, Outcome::Failed(_)), "{event:?}");
            }
            // A pressure of 2 on a side of 3, as nodal forces of a cubic side: 1/8, 3/8, 3/8, 1/8.
            let forces: Vec<f64> = stepper.state().nodes.iter().map(|node| node.f_n).collect();
            for (force, part) in forces.iter().zip([1.0, 3.0, 3.0, 1.0]) {
                assert!((force - 6.0 * part / 8.0).abs() < 1e-9, "{forces:?}");
            }
            assert_eq!(forces.len(), 4);
            let BodyKind::Solid(solid) = &scene.model.bodies[0].kind else {
                panic!("{:?}", scene.model.bodies);
            };
            assert_eq!(Some(solid.elements[0].kind), quad12());
        }
    }

    #[test]
    fn a_block_of_it_is_refused_and_other_names_are_unknown() {
        quad12().unwrap();
        let block = |kind: &str| {
            let text = format!(
                "(title: \"t\", nodes: [Block(id: \"b\", corners: [(0, 0), (1, 1)], elements: (1, 1), element: {kind})], materials: [], bodies: [],
                history: (path: [0, 1], increment: 1))"
            );
            Scene::from_text("t.ron", &text, &[])
                .unwrap_err()
                .to_string()
        };
        let refused = block("quad12");
        assert!(
            refused.contains("a block cannot be meshed with elements of kind quad12"),
            "{refused}"
        );
        let unknown = block("quad13");
        assert!(
            unknown.contains("choices") && unknown.contains("quad8"),
            "{unknown}"
        );
    }

    #[test]
    fn kinds_with_a_known_name_or_wrong_faces_are_refused() {
        static WRONG: ContinuumKind<12, 16> = ContinuumKind::new(
            VTK,
            &[&[0, 1], &[1, 2], &[2, 12]],
            PLACES,
            || square(4),
            shape,
        );
        quad12().unwrap();
        for (name, kind, why) in [
            ("quad8", &KIND, "already"),
            ("quad12", &KIND, "already"),
            ("quad12-wrong", &WRONG, "cannot have the faces"),
        ] {
            let refused = continuum::register(name, kind).unwrap_err().to_string();
            assert!(refused.contains(why), "{refused}");
        }
    }
}
