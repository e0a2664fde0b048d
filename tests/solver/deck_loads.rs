//! Loads of decks over several steps, and supports by name: closed forms, and values of CalculiX 2.20 where named.

use crate::common::run;
use stickslip::scene::Scene;

/// Displacement of a node at the end of each step; all steps have a length of 1.
fn ends(text: &str, node: &str) -> Vec<[f64; 2]> {
    let scene = Scene::from_text("job.inp", text, &[]).unwrap_or_else(|error| panic!("{error}"));
    let node = scene.node(node).expect("a node");
    let run = run(&scene);
    assert!(run.failure.is_none(), "{:?}", run.failure);
    let ends = run.accepted.iter().filter(|own| own.load.fract() == 0.0);
    let first = scene.model.dofs.first[node];
    ends.map(|own| [own.state.u[first], own.state.u[first + 1]])
        .collect()
}

/// A square of 1 by 1, held at its bottom, with a density of 1; these loads act in its steps.
fn square(steps: &[&str]) -> Vec<[f64; 2]> {
    let mut text = "*NODE\n1, 0., 0.\n2, 1., 0.\n3, 1., 1.\n4, 0., 1.\n5, .5, 0.\n6, 1., .5\n7, .5, 1.\n8, 0., .5\n\
        *ELEMENT, TYPE=CPE8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*SURFACE, NAME=RIGHT\nE, S2\n\
        *MATERIAL, NAME=M\n*ELASTIC\n1000., 0.\n*DENSITY\n1.\n*SOLID SECTION, ELSET=E, MATERIAL=M\n\
        *BOUNDARY\n1, 1, 2\n2, 1, 2\n5, 1, 2\n"
        .to_owned();
    for loads in steps {
        text.push_str(&format!("*STEP\n*STATIC\n1., 1.\n{loads}\n*END STEP\n"));
    }
    ends(&text, "n.3")
}

fn near(found: &[[f64; 2]], expected: &[[f64; 2]], off: f64) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!((a - b).abs() < off, "{found:?} is not {expected:?}");
    }
}

/// A column of height h under its weight becomes shorter by ρ g h² / (2 E).
#[test]
fn gravity_replaces_gravity_in_the_same_direction_and_adds_to_others() {
    let down = "*DLOAD\nE, GRAV, 10., 0., -1., 0.";
    let under = [0.0, -0.005];
    let off = "*DLOAD\nE, GRAV, 0., 0., -1.";
    near(&square(&[down, off]), &[under, [0.0; 2]], 1e-14);
    let less = "*DLOAD\nE, GRAV, 4., 0., -2.";
    near(&square(&[down, less]), &[under, [0.0, -0.002]], 1e-14);
    let up = "*DLOAD\nE, GRAV, 10., 0., 1.";
    near(&square(&[down, up]), &[under, [0.0; 2]], 1e-14);
    // CalculiX.
    let oblique = "*DLOAD\nE, GRAV, 10., 1., -1., 0.";
    let expected = [[1.735626e-2, -1.060660e-2], [1.735626e-2, -1.560660e-2]];
    near(&square(&[oblique, down]), &expected, 1e-8);
}

#[test]
fn a_force_per_volume_of_zero_removes_that_of_an_earlier_step() {
    let found = square(&["*DLOAD\nE, BX, 10.", "*DLOAD\nE, BX, 0."]);
    // CalculiX.
    near(&found, &[[2.454545e-2, -1.0e-2], [0.0; 2]], 1e-8);
}

/// The displacements are those of CalculiX; *DLOAD, OP=NEW removes both.
#[test]
fn op_new_of_a_surface_load_removes_pressures_only() {
    let first = "*DLOAD\nE, P3, 10.\nE, BX, 5.";
    let found = square(&[first, "*DSLOAD, OP=NEW\nRIGHT, P, 1."]);
    let expected = [[1.227273e-2, -1.5e-2], [9.449785e-3, -3.976303e-3]];
    near(&found, &expected, 1e-8);
    let pressure = square(&["*DSLOAD\nRIGHT, P, 1."]);
    let both = square(&[first, "*DLOAD, OP=NEW\nE, P2, 1."]);
    near(&both[1..], &pressure, 1e-14);
}

/// A beam of length L whose end at the plane of symmetry slides along it without turning, and whose other end turns no more:
/// P L³ / (12 E I) + P L / (G A k). If the end at the plane could turn, it would be P L³ / (3 E I) + P L / (G A k).
#[test]
fn symmetry_prevents_the_rotation_of_beams() {
    let deck = |is_upright: bool, symmetry: &str| {
        let nodes: String = (0..5)
            .map(|k| match is_upright {
                false => format!("{}, {:?}, 0.\n", k + 1, 0.5 * f64::from(k)),
                true => format!("{}, 0., {:?}\n", k + 1, 0.5 * f64::from(k)),
            })
            .collect();
        let across = if is_upright { 1 } else { 2 };
        format!(
            "*NODE\n{nodes}11, 10., 0.\n12, 11., 0.\n13, 11., 1.\n14, 10., 1.\n\
             *ELEMENT, TYPE=B32, ELSET=B\n1, 1, 2, 3\n2, 3, 4, 5\n*ELEMENT, TYPE=CPE4, ELSET=E\n3, 11, 12, 13, 14\n\
             *MATERIAL, NAME=M\n*ELASTIC\n1.E6, 0.\n*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=RECT\n1., .1\n0., 0., -1.\n\
             *SOLID SECTION, ELSET=E, MATERIAL=M\n*BOUNDARY\n1, {symmetry}\n5, {across}\n5, 6\n\
             11, {symmetry}\n11, PINNED\n12, 2\n*STEP\n*STATIC\n1., 1.\n*CLOAD\n1, {across}, -.01\n*END STEP\n"
        )
    };
    let (force, length, e, inertia, area) = (0.01, 2.0, 1e6, 1e-3 / 12.0, 0.1);
    let bending = |part: f64| force * length * length * length / (part * e * inertia);
    let shear = force * length / (0.5 * e * area * 5.0 / 6.0);
    for (is_upright, named, free) in [(false, "XSYMM", "1"), (true, "YSYMM", "2")] {
        for (support, part) in [(named, 12.0), (free, 3.0)] {
            let end = ends(&deck(is_upright, support), "n.1")[0];
            let across = end[usize::from(!is_upright)];
            let exact = -(bending(part) + shear);
            assert!((across / exact - 1.0).abs() < 1e-6, "{across:e} {exact:e}");
        }
    }
}
