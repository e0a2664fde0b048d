//! Solids alone, against closed forms and beam theory.

use crate::blocks::block;
use crate::common::{Run, finished, last, order, run};
use stickslip::format::spec::LoadSpec;
use stickslip::model::Component;
use stickslip::scene::Scene;

/// A clamped bar of length 10 with a shear force, that of its end face times `shear`.
fn cantilever(depth: f64, material: &str, elements: &str, shear: f64, increment: f64) -> Run {
    let half = depth / 2.0;
    finished(&block(
        &format!("(0, {}), (10, {half})", -half),
        elements,
        material,
        &format!(
            "supports: [(node: \"k.left\", fix: [x]), (node: \"k.left@0.5\", fix: [y])],
             loads: [Traction(along: \"k.right\", y: {shear})],
             history: (path: [0, 1], increment: {increment}),
             monitors: [(name: \"x\", of: Displacement(node: \"k.right@0.5\", component: x)),
                        (name: \"y\", of: Displacement(node: \"k.right@0.5\", component: y)),
                        (name: \"m\", of: Reaction(node: \"k.left@0.5\", component: y))]"
        ),
    ))
}

#[test]
fn a_slender_cantilever_bends_as_a_timoshenko_beam() {
    let (e, nu, p) = (1e4, 0.3, 1e-4);
    for (plane, modulus) in [("stress", e), ("strain", e / (1.0 - nu * nu))] {
        for law in ["svk", "neohookean"] {
            let material = format!("E: {e}, nu: {nu}, plane: {plane}, law: {law}");
            let run = cantilever(1.0, &material, "(20, 2)", p, 1.0);
            let (length, inertia) = (10.0_f64, 1.0 / 12.0);
            let shear = e / (2.0 * (1.0 + nu)) * 5.0 / 6.0;
            let expected = p * length.powi(3) / (3.0 * modulus * inertia) + p * length / shear;
            let ratio = last(&run, "y") / expected;
            assert!((ratio - 1.0).abs() < 2e-3, "{plane} {law}: {ratio}");
            assert!((last(&run, "m") + p).abs() < 1e-12);
        }
    }
}

#[test]
fn a_slender_block_turns_as_far_as_the_beam_of_its_section() {
    // The load brings the end two thirds of the length up. The surface strains by half of depth times curvature, 2 %,
    // which is what the two bodies may differ by in their stiffness.
    let (depth, p) = (0.1_f64, 400.0);
    let e = 1.2e5 / depth.powi(3);
    let text = format!(
        "(title: \"t\", nodes: [Line(id: \"b\", from: (0, 0), to: (10, 0), elements: 10, per_element: 5)],
          materials: [Section(id: \"m\", EA: {}, EI: 1e4, GA: {})],
          bodies: [Beam(id: \"b\", along: \"b\", material: \"m\")],
          supports: [(node: \"b.start\", fix: [x, y, rotation])], loads: [Force(node: \"b.end\", y: {p})],
          history: (path: [0, 1], increment: 0.1),
          monitors: [(name: \"x\", of: Displacement(node: \"b.end\", component: x)),
                     (name: \"y\", of: Displacement(node: \"b.end\", component: y))])",
        e * depth,
        e * depth / 2.0 * 5.0 / 6.0
    );
    let beam = finished(&Scene::from_text("beam", &text, &[]).unwrap());
    let material = format!("E: {e}, nu: 0, plane: stress");
    let solid = cantilever(depth, &material, "(40, 1)", p / depth, 0.1);
    assert!(last(&beam, "y") > 6.5);
    for axis in ["x", "y"] {
        let error = (last(&solid, axis) - last(&beam, axis)) / last(&beam, "y");
        assert!(error.abs() < 4e-4, "{axis}: {error:e}");
    }
}

/// A unit square pulled to the stretch 1 + u along x, free to contract along y unless that is held.
fn pulled(material: &str, u: f64) -> Run {
    finished(&block(
        "(0, 0), (1, 1)",
        "(2, 2)",
        material,
        &format!(
            "supports: [(node: \"k.left\", fix: [x]), (node: \"k.bottom\", fix: [y])],
             loads: [Displacement(node: \"k.right.all\", component: x, value: {u})],
             history: (path: [0, 1], increment: 0.1),
             monitors: [(name: \"y\", of: Displacement(node: \"k.top.start\", component: y)),
                        (name: \"a\", of: Reaction(node: \"k.right.1\", component: x)),
                        (name: \"b\", of: Reaction(node: \"k.right.2\", component: x)),
                        (name: \"c\", of: Reaction(node: \"k.right.3\", component: x)),
                        (name: \"d\", of: Reaction(node: \"k.right.4\", component: x)),
                        (name: \"e\", of: Reaction(node: \"k.right.5\", component: x))]"
        ),
    ))
}

fn pull(run: &Run) -> f64 {
    ["a", "b", "c", "d", "e"].iter().map(|m| last(run, m)).sum()
}

#[test]
fn uniaxial_stress_follows_its_closed_form_for_both_laws_at_large_strain() {
    let (e, nu) = (100.0, 0.3);
    let (lambda, mu) = (
        e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        e / (2.0 * (1.0 + nu)),
    );
    for u in [0.5, 0.2, -0.3] {
        let stretch: f64 = 1.0 + u;
        // Plane stress, St Venant-Kirchhoff: S11 = E E11, E22 = −ν E11.
        let e11 = 0.5 * (stretch * stretch - 1.0);
        let run = pulled(&format!("E: {e}, nu: {nu}, plane: stress, thickness: 2"), u);
        assert!((pull(&run) - 2.0 * stretch * e * e11).abs() < 1e-9 * e);
        let across = (1.0 - 2.0 * nu * e11).sqrt() - 1.0;
        assert!((last(&run, "y") - across).abs() < 1e-10, "{u}");
        // Plane strain: S11 = E / (1 − ν²) E11, E22 = −ν / (1 − ν) E11.
        let run = pulled(&format!("E: {e}, nu: {nu}"), u);
        assert!((pull(&run) - stretch * e / (1.0 - nu * nu) * e11).abs() < 1e-9 * e);
        let across = (1.0 - 2.0 * nu / (1.0 - nu) * e11).sqrt() - 1.0;
        assert!((last(&run, "y") - across).abs() < 1e-10);
        // Neo-Hookean: μ (c − 1) + λ ln J = 0 for the free directions, c their squared stretch, by bisection.
        for (plane, free) in [("stress", 2), ("strain", 1)] {
            let (mut low, mut high) = (1e-6_f64, 100.0_f64);
            for _ in 0..200 {
                let c = 0.5 * (low + high);
                let log_j = stretch.ln() + 0.5 * f64::from(free) * c.ln();
                if mu * (c - 1.0) + lambda * log_j > 0.0 {
                    high = c;
                } else {
                    low = c;
                }
            }
            let log_j = stretch.ln() + 0.5 * f64::from(free) * low.ln();
            let force = mu * (stretch - 1.0 / stretch) + lambda * log_j / stretch;
            let run = pulled(
                &format!("E: {e}, nu: {nu}, plane: {plane}, law: neohookean"),
                u,
            );
            assert!((pull(&run) - force).abs() < 1e-9 * e, "{plane} {u}");
            assert!(
                (last(&run, "y") - (low.sqrt() - 1.0)).abs() < 1e-10,
                "{plane} {u}"
            );
        }
    }
}

#[test]
fn a_distorted_patch_reproduces_a_homogeneous_deformation_exactly() {
    // x' = F x is prescribed on the whole boundary of a distorted block; every node inside must follow.
    let f = [[0.3, -0.2], [0.15, -0.25]];
    for scale in [1e-9, 1.0] {
        for material in [
            "E: 100, nu: 0.3",
            "E: 100, nu: 0.3, law: neohookean",
            "E: 100, nu: 0.3, law: neohookean, plane: stress",
            "E: 100, nu: 0.3, update: updated",
        ] {
            let scene = block(
                "(0, 0), (2, -0.3), (2.4, 1.9), (-0.3, 1.1)",
                "(3, 3)",
                material,
                "history: (path: [0, 1], increment: 0.25)",
            );
            let at: Vec<[f64; 2]> = scene.model.nodes.iter().map(|n| n.at).collect();
            let mut spec = scene.spec.clone();
            let edges = ["bottom", "right", "top", "left"];
            let f = f.map(|row| row.map(|f: f64| scale * f));
            for n in edges.iter().flat_map(|e| {
                let nodes = scene.names().nodes(&format!("k.{e}")).unwrap();
                nodes[1..].to_vec()
            }) {
                for component in 0..2 {
                    let name = scene.model.nodes[n].name.clone();
                    spec.loads.push(moved(name, component, f, at[n]));
                }
            }
            let run = finished(&Scene::from_spec("patch", spec).unwrap());
            follows(&run, &at, f, 1e-11 * scale, material);
        }
    }
}

/// A prescribed displacement F x of a node.
pub fn moved(node: String, component: usize, f: [[f64; 2]; 2], x: [f64; 2]) -> LoadSpec {
    LoadSpec::Displacement {
        node,
        component: [Component::X, Component::Y][component],
        value: f[component][0] * x[0] + f[component][1] * x[1],
        scale: Vec::new(),
    }
}

/// Fails unless all nodes have the displacements F x.
pub fn follows(run: &Run, at: &[[f64; 2]], f: [[f64; 2]; 2], tolerance: f64, what: &str) {
    let (u, first) = (&run.stepper.state().u, &run.stepper.model().dofs.first);
    for (n, x) in at.iter().enumerate() {
        for (k, row) in f.iter().enumerate() {
            let error = u[first[n] + k] - (row[0] * x[0] + row[1] * x[1]);
            assert!(error.abs() < tolerance, "{what}: {error:e}");
        }
    }
}

#[test]
fn a_traction_is_spread_as_the_patch_test_wants() {
    // Uniform stress 1 along x; on the sloping top its traction is n_x = sin(atan 0.2) per length.
    let run = finished(&block(
        "(0, 0), (2, 0), (2, 1), (0, 1.4)",
        "(2, 3)",
        "E: 1e6, nu: 0, plane: stress",
        "supports: [(node: \"k.left\", fix: [x]), (node: \"k.left.end\", fix: [y])],
         loads: [Traction(along: \"k.right\", normal: 1), Traction(along: \"k.top\", x: 0.19611613513818404)],
         history: (path: [0, 1], increment: 1),
         monitors: [(name: \"x\", of: Displacement(node: \"k.right@0.5\", component: x)),
                    (name: \"y\", of: Displacement(node: \"k.top.start\", component: y))]",
    ));
    assert!(
        (last(&run, "x") - 2e-6).abs() < 1e-11,
        "{}",
        last(&run, "x")
    );
    assert!(last(&run, "y").abs() < 1e-11);
}

#[test]
fn the_updated_update_depends_on_the_increments_and_comes_to_the_rate_law() {
    // Uniaxial strain: dσ = (λ + 2μ) d ln λ − … of the chords; with ever smaller increments the answers settle at
    // first order, and the total update does not know the increments at all.
    let force = |update: &str, increment: &str| {
        let scene = block(
            "(0, 0), (1, 1)",
            "(1, 1)",
            &format!("E: 100, nu: 0.3, update: {update}"),
            &format!(
                "supports: [(node: \"k.left\", fix: [x, y]), (node: \"k.right\", fix: [y]), (node: \"k.top@0.5\", fix: [y]),
                            (node: \"k.bottom@0.5\", fix: [y])],
                 loads: [Displacement(node: \"k.right.all\", component: x, value: 1)],
                 history: (path: [0, 0.5], increment: {increment}),
                 monitors: [(name: \"a\", of: Reaction(node: \"k.right.1\", component: x)),
                            (name: \"b\", of: Reaction(node: \"k.right.2\", component: x)),
                            (name: \"c\", of: Reaction(node: \"k.right.3\", component: x))]"
            ),
        );
        let run = finished(&scene);
        ["a", "b", "c"].iter().map(|m| last(&run, m)).sum::<f64>()
    };
    let total = [force("total", "0.5"), force("total", "0.05")];
    assert!((total[0] - total[1]).abs() < 1e-10);
    // The Cauchy stress, here the force, by the recursion of the update done by hand.
    let modulus = 100.0 * 0.7 / (1.3 * 0.4);
    let by_hand = |steps: usize| {
        let (mut sigma, mut length) = (0.0_f64, 1.0_f64);
        for _ in 0..steps {
            let f = (length + 0.5 / steps as f64) / length;
            sigma = (sigma + modulus * 0.5 * (f * f - 1.0)) * f;
            length *= f;
        }
        sigma
    };
    // The rate law is dσ / d ln l = σ + modulus, so that σ = modulus (l − 1).
    let rate_law = 0.5 * modulus;
    let mut errors = Vec::new();
    for (increment, steps) in [("0.5", 1), ("0.1", 5), ("0.05", 10), ("0.025", 20)] {
        let (found, expected) = (force("updated", increment), by_hand(steps));
        assert!(
            (found - expected).abs() < 1e-9,
            "{increment}: {found} {expected}"
        );
        errors.push((found - rate_law).abs());
    }
    let rates = [1, 2].map(|k| order(errors[k], errors[k + 1], 2.0));
    assert!(
        rates.iter().all(|rate| (0.9..1.1).contains(rate)),
        "{rates:?} {errors:?}"
    );
    assert!((by_hand(1) - total[0]).abs() < 1e-9 * modulus);
    assert!((by_hand(10) - by_hand(1)).abs() > 0.05 * by_hand(1));
}

#[test]
fn two_materials_in_one_block_share_the_load_in_series() {
    let text = "(title: \"t\", nodes: [Block(id: \"k\", corners: [(0, 0), (2, 1)], elements: (2, 1))],
        materials: [Elastic(id: \"a\", E: 1e6, nu: 0), Elastic(id: \"b\", E: 3e6, nu: 0)],
        bodies: [Solid(id: \"k\", mesh: \"k\", material: \"a\", regions: [(from: (1, 0), to: (2, 1), material: \"b\")])],
        supports: [(node: \"k.left\", fix: [x]), (node: \"k.left.end\", fix: [y])],
        loads: [Traction(along: \"k.right\", normal: 3)], history: (path: [0, 1], increment: 1),
        monitors: [(name: \"x\", of: Displacement(node: \"k.right.2\", component: x))])";
    for refine in ["1", "3"] {
        let set = [("refine".to_owned(), refine.to_owned())];
        let run = finished(&Scene::from_text("test.ron", text, &set).unwrap());
        assert!((last(&run, "x") - 4e-6).abs() < 1e-10);
    }
}

#[test]
fn a_block_that_is_pressed_through_itself_diverges_and_does_not_pretend() {
    let scene = block(
        "(0, 0), (1, 1)",
        "(2, 2)",
        "E: 100, nu: 0.3, law: neohookean",
        "supports: [(node: \"k.bottom\", fix: [x, y])],
         loads: [Displacement(node: \"k.top.all\", component: y, value: -1.5)],
         history: (path: [0, 1], increment: 1)",
    );
    let cut = run(&scene);
    assert!(cut.failure.is_some() && cut.accepted.iter().all(|a| a.load < 2.0 / 3.0));
    let run = run(&scene.with("history.least", "1").unwrap());
    assert!(run.failure.is_some() && run.accepted.is_empty());
}
