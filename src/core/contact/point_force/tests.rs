//! Checks the closed forms against quadrature, and the linearised contact against finite differences.

use super::judged::quadrature;
use super::pair::Coefficients;
use super::*;
use crate::contact::projection::{project, projection_at};
use crate::fem::lagrange::MAX_NODES;

const GIVE: PointGive = PointGive {
    shear: 0.7,
    bending: 0.4,
};

#[test]
fn closed_forms_agree_with_quadrature() {
    for degree in 1..MAX_NODES {
        for xi in [-1.0, -0.8, -0.1, 0.0, 0.37, 0.9, 1.0] {
            for other in [-1.0, -0.3, 0.37, 0.9, 1.0] {
                let closed = Pair::new(&GIVE, degree, xi, other);
                let (give, slope) = quadrature(&GIVE, degree, xi, other);
                let what = format!("degree {degree}: {xi} {other}");
                assert!(
                    (closed.give - give).abs() < 1e-13,
                    "{what}: {} {give}",
                    closed.give
                );
                assert!(
                    (closed.slope - slope).abs() < 1e-12,
                    "{what}: {} {slope}",
                    closed.slope
                );
                let h = 1e-5;
                let at = |a: f64, b: f64| Pair::new(&GIVE, degree, xi + a, other + b).slope;
                if (xi - other).abs() > h {
                    let bend = (at(h, 0.0) - at(-h, 0.0)) / (2.0 * h);
                    let cross = (at(0.0, h) - at(0.0, -h)) / (2.0 * h);
                    assert!(
                        (closed.bend - bend).abs() < 1e-6,
                        "{what}: {} {bend}",
                        closed.bend
                    );
                    assert!(
                        (closed.cross - cross).abs() < 1e-6,
                        "{what}: {} {cross}",
                        closed.cross
                    );
                }
            }
        }
    }
}

/// (L/2GA)(1 − ξ²) for a straight 2-node element, and the rotation proportional to P_{p−1} P_p for all degrees.
#[test]
fn shear_alone_has_the_short_forms() {
    let shear = PointGive {
        bending: 0.0,
        ..GIVE
    };
    for xi in [-1.0, -0.6, 0.0, 0.25, 1.0] {
        let line = Pair::new(&shear, 1, xi, xi).give;
        assert!((line - 2.0 * shear.shear * (1.0 - xi * xi)).abs() < 1e-15);
        for degree in 1..MAX_NODES {
            let at = Coefficients::new(xi);
            let short = -2.0 * shear.shear * at.p[degree - 1] * at.p[degree];
            assert!((Pair::new(&shear, degree, xi, xi).slope - short).abs() < 1e-14);
        }
    }
}

#[test]
fn the_compliance_is_zero_at_the_ends_and_positive_between() {
    for degree in 1..MAX_NODES {
        for xi in [-1.0, 1.0] {
            let end = Pair::new(&GIVE, degree, xi, xi);
            assert!(end.give.abs() < 1e-14, "degree {degree}: {}", end.give);
            let with = Pair::new(&GIVE, degree, 0.3, xi);
            assert!(with.give.abs() < 1e-14 && with.slope.abs() < 1e-13);
        }
        let shear = PointGive {
            bending: 0.0,
            ..GIVE
        };
        assert!(Pair::new(&shear, degree, 0.3, 0.3).give > 0.0);
    }
}

/// A slave node over a bent element; the contribution of the other forces is constant.
fn over<'a>(x: &'a [[f64; 2]], force: [f64; 2], others: OtherForces) -> NodeOverElement<'a> {
    let surface = Surface::new("s", vec![(1..x.len()).collect()], false);
    let surfaces = [surface];
    let spot = project(x[0], &surfaces, &[0], x, None).unwrap();
    let found = projection_at(&surfaces, spot, x, x[0]);
    assert!(found.curve.is_some());
    NodeOverElement {
        slave: x[0],
        nodes: &x[1..],
        xi: spot.xi,
        force,
        give: &GIVE,
        others,
    }
}

fn bent(count: usize, gap: f64) -> Vec<[f64; 2]> {
    let place = |k: usize| 2.2 * k as f64 / (count - 1) as f64;
    let arc = (0..count).map(|k| [place(k), 0.3 * (0.7 * place(k)).sin() + 0.1 * place(k)]);
    let slave = [1.3 + 0.2 * gap, 0.32 - gap];
    std::iter::once(slave).chain(arc).collect()
}

/// Contribution of another force at ξ = −0.6, as a function of ξ.
fn others_at(xi: f64) -> OtherForces {
    let mut others = OtherForces::default();
    others.add(&Pair::new(&GIVE, 4, xi, -0.6), 0.05);
    others
}

#[test]
fn the_linearised_contact_is_the_derivative_of_its_gap_and_forces() {
    for gap in [-0.04, 0.01] {
        for f in [[0.2, 0.0], [0.15, -0.07]] {
            let x = bent(5, gap);
            let linearised = |x: &[[f64; 2]], f: [f64; 2]| {
                let bare = over(x, f, OtherForces::default());
                let others = others_at(bare.xi);
                linearise(&NodeOverElement { others, ..bare })
            };
            let at = linearised(&x, f);
            let h = 1e-6;
            for j in 0..2 * x.len() {
                let moved = |by: f64| {
                    let mut x = x.clone();
                    x[j / 2][j % 2] += by;
                    (linearised(&x, f), over(&x, f, OtherForces::default()).xi)
                };
                let ((plus, xi_plus), (minus, xi_minus)) = (moved(h), moved(-h));
                let by = |plus: f64, minus: f64| (plus - minus) / (2.0 * h);
                let close = |a: f64, b: f64, what: &str| {
                    assert!((a - b).abs() < 1e-7, "{what} {j}: {a} {b}");
                };
                close(-by(plus.gap, minus.gap), at.rows[0][j], "gap");
                close(by(xi_plus, xi_minus), at.travel[j], "travel");
                for i in 0..2 * x.len() {
                    let difference = by(plus.forces[i], minus.forces[i]);
                    close(difference, at.stiffness[i][j], &format!("force {i}"));
                }
            }
            for k in 0..2 {
                let moved = |by: f64| {
                    let mut f = f;
                    f[k] += by;
                    linearised(&x, f)
                };
                let (plus, minus) = (moved(h), moved(-h));
                for i in 0..2 * x.len() {
                    let difference = (plus.forces[i] - minus.forces[i]) / (2.0 * h);
                    assert!((difference - at.columns[k][i]).abs() < 1e-8, "{k} {i}");
                }
                let give = (plus.gap - minus.gap) / (2.0 * h);
                assert!((give - [at.give, 0.0][k]).abs() < 1e-8);
            }
        }
    }
}

/// With F instead of F_n as the unknown, the matrix derives from a potential: the force column equals the gap row, and the
/// stiffness is symmetric.
#[test]
fn without_friction_there_is_one_potential() {
    let x = bent(5, -0.03);
    let (f_n, n) = (0.2, 2 * x.len());
    let at = linearise(&over(&x, [f_n, 0.0], OtherForces::default()));
    for i in 0..n {
        let by_force = |i: usize| at.columns[0][i] / at.force_slope;
        let row = -at.rows[0][i] - at.compliance * at.force_by[i];
        assert!(
            (by_force(i) - row).abs() < 1e-12,
            "{i}: {} {row}",
            by_force(i)
        );
        for j in 0..n {
            let fixed = |i: usize, j: usize| at.stiffness[i][j] - by_force(i) * at.force_by[j];
            assert!((fixed(i, j) - fixed(j, i)).abs() < 1e-12, "{i} {j}");
        }
    }
    // The forces do no work under rigid motions: two translations and a rotation about the origin.
    for (a, b) in [(1.0, 0.0), (0.0, 1.0)] {
        let work: f64 = (0..n).map(|i| at.forces[i] * [a, b][i % 2]).sum();
        assert!(work.abs() < 1e-15);
    }
    let turn = |i: usize| [-x[i / 2][1], x[i / 2][0]][i % 2];
    let work: f64 = (0..n).map(|i| at.forces[i] * turn(i)).sum();
    assert!(work.abs() < 1e-15, "{work}");
}
