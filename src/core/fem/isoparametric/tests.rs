//! Properties of the isoparametric formulation, tested with one 8-node quadrilateral; [`crate::fem::tests`] tests the properties
//! of all kinds.

use super::*;
use crate::elements::kinds::quad8;
use crate::fem::element::Element as _;
use crate::fem::tests::elastic;
use crate::model::Elastic;
use crate::model::Plane;

const NODES: usize = 8;
const DOFS: usize = 2 * NODES;
const POINTS: usize = 9;
type Quad = ContinuumElement<NODES, POINTS, false>;

/// All combinations of options.
fn kinds() -> Vec<Elastic> {
    let mut kinds = Vec::new();
    for plane in [Plane::Strain, Plane::Stress] {
        kinds.push(elastic(Law::Svk, plane, Update::Total));
        kinds.push(elastic(Law::NeoHookean, plane, Update::Total));
        kinds.push(elastic(Law::Svk, plane, Update::Updated));
    }
    kinds
}

/// A distorted quadrilateral with curved sides.
const AT: [[f64; 2]; NODES] = [
    [0.0, 0.0],
    [2.0, -0.2],
    [2.3, 1.6],
    [-0.1, 1.3],
    [1.0, -0.2],
    [2.2, 0.7],
    [1.1, 1.4],
    [0.1, 0.6],
];

fn element(elastic: &Elastic) -> Quad {
    ContinuumElement::new(
        quad8::KIND.rule(),
        AT,
        Material::new(elastic),
        elastic.update,
    )
}

fn noise(k: usize, size: f64) -> f64 {
    size * ((k * 7 % 11) as f64 / 11.0 - 0.5)
}

/// A deformed last increment: displacements, stresses and thickness of moderate size.
fn past() -> (Vec<f64>, Vec<f64>) {
    let u = (0..DOFS).map(|k| noise(k + 3, 0.2)).collect();
    let history = (0..MEMORY * POINTS)
        .map(|k| noise(k, if k % MEMORY == 3 { 0.1 } else { 20.0 }))
        .collect();
    (u, history)
}

fn evaluate(element: &Quad, past: &Previous<'_>, u: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (mut f, mut k) = (vec![0.0; DOFS], vec![0.0; DOFS * DOFS]);
    assert!(element.add(past, u, &mut f, &mut k));
    element.mirror(&mut k);
    (f, k)
}

/// x' = R x + (3, −1) as displacements.
fn rigid(angle: f64) -> Vec<f64> {
    let (s, c) = angle.sin_cos();
    AT.iter()
        .flat_map(|p| {
            [
                c * p[0] - s * p[1] - p[0] + 3.0,
                s * p[0] + c * p[1] - p[1] - 1.0,
            ]
        })
        .collect()
}

#[test]
fn a_rigid_motion_causes_no_strain_and_rotates_the_stress() {
    let (rest, none) = ([0.0; DOFS], [0.0; MEMORY * POINTS]);
    for kind in kinds() {
        for angle in [0.3_f64, 2.5, -7.0] {
            let element = element(&kind);
            let past = Previous {
                u: &rest,
                history: &none,
            };
            let (f, _) = evaluate(&element, &past, &rigid(angle));
            assert!(f.iter().all(|f| f.abs() < 1e-12 * kind.young), "{f:?}");
        }
    }
    let (_, history) = past();
    let element = element(&elastic(Law::Svk, Plane::Stress, Update::Updated));
    let past = Previous {
        u: &rest,
        history: &history,
    };
    let mut turned = vec![0.0; element.history_len()];
    element.advance(&past, &rigid(std::f64::consts::FRAC_PI_2), &mut turned);
    for (old, new) in history.chunks(MEMORY).zip(turned.chunks(MEMORY)) {
        let expected = [old[1], old[0], -old[2], old[3]];
        for (a, b) in new.iter().zip(expected) {
            assert!((a - b).abs() < 1e-12 * kind_scale(old));
        }
    }
}

fn kind_scale(history: &[f64]) -> f64 {
    history.iter().fold(100.0_f64, |m, x| m.max(x.abs()))
}

#[test]
fn a_small_updated_step_equals_a_total_one() {
    let (rest, none) = ([0.0; DOFS], [0.0; MEMORY * POINTS]);
    let past = Previous {
        u: &rest,
        history: &none,
    };
    let u: Vec<f64> = (0..DOFS).map(|k| noise(k, 0.1)).collect();
    for plane in [Plane::Strain, Plane::Stress] {
        let [total, updated] = [Update::Total, Update::Updated]
            .map(|update| evaluate(&element(&elastic(Law::Svk, plane, update)), &past, &u).0);
        // Before the first increment, both use the undeformed shape as reference.
        for (a, b) in total.iter().zip(&updated) {
            assert!((a - b).abs() < 1e-13 * 100.0);
        }
    }
}

#[test]
fn cauchy_stress_is_in_balance_with_the_force() {
    // Virtual power of a uniform velocity gradient: Σ f_i · v_i = ∫ σ : grad v dv, for a homogeneous state.
    let (rest, none) = ([0.0; DOFS], [0.0; MEMORY * POINTS]);
    let past = Previous {
        u: &rest,
        history: &none,
    };
    let g = Matrix2::new(0.3, -0.2, 0.1, -0.25);
    let u: Vec<f64> = AT
        .iter()
        .flat_map(|x| {
            [
                g[(0, 0)] * x[0] + g[(0, 1)] * x[1],
                g[(1, 0)] * x[0] + g[(1, 1)] * x[1],
            ]
        })
        .collect();
    for kind in kinds().into_iter().filter(|k| k.update == Update::Total) {
        let element = element(&kind);
        let (f, _) = evaluate(&element, &past, &u);
        let states: Vec<PointState> = (0..POINTS)
            .map(|p| element.point_state(&past, &u, p).unwrap())
            .collect();
        let sigma = states[0].cauchy;
        for s in &states {
            assert!((s.cauchy - sigma).amax() < 1e-12 * 100.0);
            assert!((s.gradient - Matrix2::identity() - g).amax() < 1e-14);
        }
        let now: Vec<f64> = (0..DOFS).map(|k| AT[k / 2][k % 2] + u[k]).collect();
        let volume: f64 = (0..POINTS)
            .map(|p| {
                let point = element
                    .point(&element.reference(&past, &u), &past, p)
                    .unwrap();
                point.volume * states[p].gradient.determinant() * point.stretch()
            })
            .sum();
        for (a, b, component) in [(0, 0, 0), (1, 1, 1), (0, 1, 2)] {
            let power: f64 = (0..NODES).map(|i| f[2 * i + a] * now[2 * i + b]).sum();
            assert!(
                (power - volume * sigma[component]).abs() < 1e-12 * 100.0,
                "{kind:?}"
            );
        }
    }
}

#[test]
fn an_inverted_element_has_no_response_where_the_law_excludes_inversion() {
    let past = Previous {
        u: &[0.0; DOFS],
        history: &[],
    };
    let flipped: Vec<f64> = AT.iter().flat_map(|x| [-2.0 * x[0], 0.0]).collect();
    let (mut f, mut k) = ([0.0; DOFS], [0.0; DOFS * DOFS]);
    let neo = element(&elastic(Law::NeoHookean, Plane::Strain, Update::Total));
    assert!(!neo.add(&past, &flipped, &mut f, &mut k));
}
