//! Interface problems of other programs: read from every form with the same answer, condensed right, refused with a place.

use crate::common::{finished, run};
use crate::siconos::{answer, assert_solved, in_blocks};
use proptest::prelude::*;
use std::fs;
use std::path::Path;
use std::sync::Arc;
use stickslip::format::Spec;
use stickslip::linear::estimate::GIGABYTE;
use stickslip::model::Mode;
use stickslip::scene::Scene;
use stickslip::scene::problems::market;
use stickslip::scene::siconos::read;
use stickslip::scene::solver::any_solver;
use stickslip_exchange::problem::{Local, Matrix};
use stickslip_exchange::siconos::write;
use stickslip_exchange::{fclib, matrix_market};
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn put(folder: &TempDir, name: &str, text: impl AsRef<[u8]>) -> String {
    let path = folder.path().join(name);
    fs::write(&path, text).unwrap();
    path.display().to_string()
}

fn open(file: &str) -> Scene {
    Scene::open(file, &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// What is wrong with a file, without the folder that it lies in.
fn refusal(folder: &TempDir, file: &str) -> String {
    let error = Scene::open(file, &[]).unwrap_err().to_string();
    let folder = format!("{}/", folder.path().display());
    error.replace(&folder, "")
}

/// One contact on springs: 2 along the normal, 4 along the tangent, and 1 between both, over one unknown more.
const GLOBAL: &str = "2\n1\n0\n3\n3\n3 3\n2 1 0 1 4 0 0 0 9\n0\n3\n2\n3 2\n1 0 0 0 1 0\n-6.0 1.0 5.0\n0.5 0.25\n0.3\n";

#[test]
fn a_global_problem_is_condensed_to_its_contacts() {
    let found = read(GLOBAL, None).unwrap();
    // The inverse of [[2, 1], [1, 4]] is [[4, -1], [-1, 2]] / 7.
    let wanted = [[4.0 / 7.0, -1.0 / 7.0], [-1.0 / 7.0, 2.0 / 7.0]];
    for (row, wanted) in found.w.dense().iter().zip(wanted) {
        for (value, wanted) in row.iter().zip(wanted) {
            assert!((value - wanted).abs() < 1e-15, "{found:?}");
        }
    }
    let q = [0.5 + (-24.0 - 1.0) / 7.0, 0.25 + (6.0 + 2.0) / 7.0];
    assert!((found.q[0] - q[0]).abs() < 1e-14 && (found.q[1] - q[1]).abs() < 1e-14);
    let run = finished(&Scene::from_text("global.dat", GLOBAL, &[]).unwrap());
    assert_solved(&found, &run);
}

#[test]
fn what_nothing_holds_cannot_be_condensed_and_is_said_to_be_singular() {
    let loose = GLOBAL.replace("2 1 0 1 4 0 0 0 9", "2 1 0 1 4 0 0 0 0");
    let error = Scene::from_text("loose.dat", &loose, &[]).unwrap_err();
    assert!(error.to_string().contains("M is singular"), "{error}");
    let twice = GLOBAL.replace("2 1 0 1 4 0 0 0 9", "2 4 0 4 8 0 0 0 9");
    assert!(
        read(&twice, None)
            .unwrap_err()
            .message
            .contains("M is singular")
    );
}

fn problem() -> Local {
    Local {
        w: Matrix::from_rows(&[
            vec![2.0, 0.1 + 0.2, 0.0, 0.25],
            vec![0.3, 3.0, 0.4, 0.0],
            vec![0.0, 0.4, 2.0, 1.0 / 3.0],
            vec![0.25, 0.0, 1.0 / 3.0, 2.0],
        ]),
        q: vec![-1.0, 0.1, -2.0, 0.7],
        mu: vec![0.5, 0.1],
    }
}

/// The problem in every form, each in a file.
fn files(folder: &TempDir, problem: &Local) -> Vec<String> {
    let matrix = folder.path().join("p_W.mtx");
    let parts = market::parts(&matrix).unwrap();
    for (part, text) in parts.iter().zip(market::texts(problem, "of a test")) {
        fs::write(part, text).unwrap();
    }
    let mut files = vec![
        put(folder, "p.dat", write(problem)),
        put(folder, "b.dat", in_blocks(problem)),
        matrix.display().to_string(),
    ];
    if fclib::ready().is_ok() {
        let bytes = fclib::write(problem, "of a test").unwrap();
        files.push(put(folder, "p.h5", bytes));
    }
    files
}

/// A scene without its words.
fn bare(file: &str) -> Spec {
    let mut spec = open(file).spec;
    (spec.title, spec.about) = (String::new(), String::new());
    spec
}

#[test]
fn a_problem_is_the_same_scene_from_every_file() {
    let folder = folder();
    let files = files(&folder, &problem());
    for file in &files[1..] {
        assert_eq!(bare(file), bare(&files[0]), "{file}");
    }
    let run = run(&open(&files[2]));
    assert_solved(&problem(), &run);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]
    #[test]
    fn every_form_keeps_every_bit(
        w in prop::collection::vec(prop::collection::vec(-1e9..1e9_f64, 4), 4),
        q in prop::collection::vec(-1e9..1e9_f64, 4),
    ) {
        let folder = folder();
        let files = files(&folder, &Local { w: Matrix::from_rows(&w), q, mu: vec![0.1, 0.7] });
        for file in &files[1..] {
            prop_assert_eq!(bare(file), bare(&files[0]));
        }
    }
}

#[test]
fn a_stiffness_is_marked_by_its_name_and_may_come_with_loads() {
    let folder = folder();
    let head = "%%MatrixMarket matrix";
    let matrix = put(
        &folder,
        "s_K.mtx",
        format!("{head} coordinate real symmetric\n2 2 3\n1 1 2.0\n2 1 1.0\n2 2 4.0\n"),
    );
    put(
        &folder,
        "s_mu.mtx",
        format!("{head} array real general\n1 1\n0.3\n"),
    );
    put(
        &folder,
        "s_f.mtx",
        format!("{head} array real general\n2 1\n-6.0\n1.0\n"),
    );
    put(
        &folder,
        "s_q.mtx",
        format!("{head} array real general\n2 1\n0.5\n0.25\n"),
    );
    // The same as the global problem: u = q + K⁻¹ (f + r).
    let run = finished(&open(&matrix));
    assert_solved(&read(GLOBAL, None).unwrap(), &run);
}

#[test]
fn what_is_missing_or_wrong_beside_a_matrix_is_named() {
    let folder = folder();
    let files = files(&folder, &problem());
    let matrix = &files[2];
    let beside = |part: &str| folder.path().join(format!("p_{part}.mtx"));
    let head = "%%MatrixMarket matrix array real general\n";
    for (part, text, told) in [
        (
            "mu",
            Some(format!("{head}2 1\n0.5\n-0.1\n")),
            "p_mu.mtx: the friction coefficient is -0.1",
        ),
        (
            "mu",
            Some(format!("{head}3 1\n0.5\n0.1\n0.1\n")),
            "p_mu.mtx: mu has 3 rows",
        ),
        ("mu", Some(format!("{head}2 1\n0.5\nx\n")), "p_mu.mtx:4:1: "),
        (
            "mu",
            None,
            "p_W.mtx: p_mu.mtx, a column of mu, is missing next to it",
        ),
        (
            "q",
            None,
            "p_W.mtx: p_q.mtx, a column of q, is missing next to it",
        ),
    ] {
        let kept = fs::read(beside(part)).unwrap();
        match text {
            Some(text) => fs::write(beside(part), text).unwrap(),
            None => fs::remove_file(beside(part)).unwrap(),
        }
        let error = refusal(&folder, matrix);
        assert!(error.starts_with(told), "{error}");
        fs::write(beside(part), kept).unwrap();
    }
    let error = refusal(&folder, &beside("q").display().to_string());
    assert!(
        error.contains("name its matrix instead: p_W.mtx"),
        "{error}"
    );
    let odd = put(
        &folder,
        "odd.mtx",
        "%%MatrixMarket matrix array real general\n1 1\n2.0\n",
    );
    assert!(refusal(&folder, &odd).contains("two rows per contact"));
}

#[test]
fn a_matrix_that_does_not_fit_into_memory_is_refused_before_it_is_made() {
    let set = [("settings.memory".to_owned(), (1e4 / GIGABYTE).to_string())];
    let folder = folder();
    let sparse = "2\n200\n1\n400\n400\n0\n".to_owned() + &"0.0 ".repeat(400) + &"0.1 ".repeat(200);
    let sparse = put(&folder, "sparse.dat", sparse);
    let error = Scene::open(&sparse, &set).unwrap_err().to_string();
    assert!(
        error.contains("200 contacts") && error.contains("memory"),
        "{error}"
    );
    let matrix = "%%MatrixMarket matrix coordinate real general\n4000000 4000000 0\n";
    let matrix = put(&folder, "m.mtx", matrix);
    let set = [("settings.memory".to_owned(), "5".to_owned())];
    let error = Scene::open(&matrix, &set).unwrap_err().to_string();
    assert!(error.contains("2000000 contacts"), "{error}");
}

#[test]
fn a_problem_in_space_is_the_same_from_every_file_and_obeys_the_laws() {
    let folder = folder();
    let local = in_space();
    let mut files = vec![
        put(&folder, "p.dat", write(&local)),
        put(&folder, "b.dat", in_blocks(&local)),
        put(&folder, "p_W.mtx", matrix_market::write(&local.w, &[])),
    ];
    put(
        &folder,
        "p_q.mtx",
        matrix_market::write_column(&local.q, &[]),
    );
    put(
        &folder,
        "p_mu.mtx",
        matrix_market::write_column(&local.mu, &[]),
    );
    if fclib::ready().is_ok() {
        files.push(put(
            &folder,
            "p.h5",
            fclib::write(&local, "of a test").unwrap(),
        ));
    }
    let open = |file: &String| Scene::open_any(file, &[]).unwrap();
    let whole = open(&files[0]);
    for file in &files {
        assert_eq!(open(file).spec.in_space, whole.spec.in_space, "{file}");
        assert!(
            refusal(&folder, file).contains("problem in space"),
            "{file}"
        );
    }
    let mut solver = any_solver(Arc::new(whole.model.clone()));
    while solver.step().unwrap() {}
    let nodes = &solver.event().nodes;
    let forces: Vec<f64> = nodes
        .iter()
        .flat_map(|node| {
            let (sin, cos) = node.directions.unwrap()[0].sin_cos();
            [node.f_n, node.f_t * cos, node.f_t * sin]
        })
        .collect();
    let mut motion = local.q.clone();
    for &(i, j, w) in &local.w.entries {
        motion[i] += w * forces[j];
    }
    for (k, mu) in local.mu.iter().enumerate() {
        let (f, u) = (&forces[3 * k..], &motion[3 * k..]);
        let (shear, slip) = (f[1].hypot(f[2]), u[1].hypot(u[2]));
        assert!(
            f[0] >= 0.0 && u[0] > -1e-8 && (f[0] * u[0]).abs() < 1e-8,
            "{k}"
        );
        assert!(shear <= mu * f[0] + 1e-8, "{k}");
        assert!(
            (f[1] * u[1] + f[2] * u[2] + mu * f[0] * slip).abs() < 1e-8,
            "{k}"
        );
    }
    let modes: Vec<Mode> = nodes.iter().map(|node| node.decision.next).collect();
    assert_eq!(modes, [Mode::Sliding, Mode::Fixed, Mode::Free]);
    for (text, told) in [
        (
            "3\n1\n0\n3\n3\n3 3\n1 0 0 0 1 0 0 0 1\n-1 0 0\n",
            "a friction coefficient was expected",
        ),
        ("3\n1\n0\n3\n3\n2 3\n1 0 0 0 1 0\n", "it must be 3"),
        ("4\n1\n", "begins with its dimension, 2 or 3"),
    ] {
        let file = put(&folder, "wrong.dat", text);
        assert!(
            refusal(&folder, &file).contains(told),
            "{}",
            refusal(&folder, &file)
        );
    }
}

#[test]
fn contacts_in_space_are_read_and_what_they_cannot_have_is_refused() {
    let text = |change: (&str, &str)| {
        "Contacts(title: \"t\", tangents: 2, contacts: [(id: \"a\", gap: 0.5, friction: (angle: 20))],
          matrix: Compliance([[1, 0, 0], [0, 1, 0], [0, 0, 1]]), free: [-1, 0.25, 0])"
            .replacen(change.0, change.1, 1)
    };
    let scene = Scene::from_text("a.ron", &text(("", "")), &[]).unwrap();
    for path in ["friction.angle", "history.increment"] {
        let error = scene.with(path, "1").unwrap_err().to_string();
        assert!(
            error.contains("has no effect in space; set settings.*"),
            "{error}"
        );
    }
    let problem = scene.spec.in_space.unwrap();
    assert_eq!(problem.free, [-0.5, 0.25, 0.0]);
    assert_eq!(problem.compliance, [(0, 0, 1.0), (1, 1, 1.0), (2, 2, 1.0)]);
    for (change, told) in [
        (("tangents: 2", "tangents: 3"), "tangents is 3"),
        (("Compliance", "Stiffness"), "needs a compliance"),
        (("gap: 0.5", "load: (0, 1)"), "no loads"),
        (("[-1, 0.25, 0]", "[-1, 0.25, 0, 1]"), "it has 4 numbers"),
        (
            ("[0, 0, 1]]", "[0, 0, 1], [1, 0, 0]]"),
            "a.ron:2:19: matrix: it has 4 rows; 3 are needed",
        ),
        (("[0, 0, 1]]", "]"), "it has 2 rows; 3 are needed"),
        (
            ("[0, 0, 1]]", "[0, 1]]"),
            "row 3 has 2 numbers; 3 are needed",
        ),
        (("gap: 0.5", "start: sliding"), "a contact starts free"),
        (("gap: 0.5", "state: (f_n: 1)"), "a contact starts free"),
        (
            ("free: ", "history: (path: [0, 2], increment: 1), free: "),
            "solved in one increment",
        ),
        (("free: ", "spacing: 2, free: "), "nor spacing"),
        (("\"a\"", "\"floor\""), "already used"),
        (("angle: 20", "angle: 90"), "below 90"),
        (("[[1", "[[1e13"), "1e12"),
    ] {
        let error = Scene::from_text("a.ron", &text(change), &[]).unwrap_err();
        assert!(error.to_string().contains(told), "{error}");
    }
}

/// Three contacts: one slides, one sticks, one is open.
fn in_space() -> Local {
    let size = 9;
    let rows = (0..size).map(|i| {
        let entry = |j: usize| match i == j {
            true => 2.0,
            false => 0.1 / (1.0 + (i as f64 - j as f64).abs()),
        };
        (0..size).map(entry).collect()
    });
    Local {
        w: Matrix::from_rows(&rows.collect::<Vec<Vec<f64>>>()),
        q: vec![-1.0, 0.8, -0.3, -2.0, 0.1, 0.1, 1.0, 0.2, 0.3],
        mu: vec![0.3, 0.5, 0.2],
    }
}

#[test]
fn what_is_no_problem_is_refused_with_a_sentence() {
    let folder = folder();
    let no_hdf = put(&folder, "text.h5", b"HDF\n\xff");
    let told = "text.h5: invalid HDF5 file: it does not begin with the signature of one";
    assert_eq!(refusal(&folder, &no_hdf), told);
    let hdf = put(&folder, "broken.h5", b"\x89HDF\r\n\x1a\nnothing more");
    let told = match fclib::ready() {
        Ok(()) => "invalid HDF5 file",
        Err(_) => "this build has no fclib (HDF5) support; cargo install --path . --features fclib",
    };
    let refusal = refusal(&folder, &hdf);
    assert!(
        refusal.starts_with(&format!("broken.h5: {told}")),
        "{refusal}"
    );
}

/// Three nodes above one another, joined by springs of stiffness 100 along y and 40 along x; 1 is the lowest. As CalculiX stores
/// it, but in no order.
const DOF: &str = "1.1\n1.2\n3.1\n2.1\n2.2\n3.2\n";
const STI: &str = "1 1  4.0000000000000e+01\n1 4 -4.0000000000000e+01\n2 2  1.0000000000000e+02\n\
                   2 5 -1.0000000000000e+02\n3 3  4.0000000000000e+01\n3 4 -4.0000000000000e+01\n\
                   4 4  8.0000000000000e+01\n5 5  2.0000000000000e+02\n5 6 -1.0000000000000e+02\n\
                   6 6  1.0000000000000e+02\n";

fn stored(folder: &TempDir, rest: &str) -> String {
    put(folder, "job.sti", STI);
    put(folder, "job.dof", DOF);
    let text = format!("Stored(\n    title: \"Springs\",\n    stiffness: \"job.sti\",\n{rest})\n");
    put(folder, "job.ron", text)
}

/// u and r of the one contact.
fn solved(file: &str) -> ([f64; 2], [f64; 2], Mode) {
    let run = finished(&open(file));
    let (u, r) = answer(&run);
    let mode = run.stepper.state().nodes[0].mode;
    ([u[0], u[1]], [r[0], r[1]], mode)
}

fn near(found: [f64; 2], wanted: [f64; 2]) {
    let apart = (found[0] - wanted[0])
        .abs()
        .max((found[1] - wanted[1]).abs());
    assert!(apart < 1e-9, "{found:?}, not {wanted:?}");
}

#[test]
fn a_stored_stiffness_pressed_and_sheared_sticks_or_slides_as_its_springs_say() {
    let folder = folder();
    let contact =
        "    contacts: [(nodes: [1], gap: 0.01, friction: (angle: 16.69924423399362))],\n";
    let moved = |x: f64| format!("    moved: [(nodes: [3], x: Some({x:?}), y: Some(-0.02))],\n");
    // Two springs in a row are half as stiff: 50 along y, 20 along x. u_t is against x.
    let (u, r, mode) = solved(&stored(&folder, &format!("{contact}{}", moved(0.004))));
    near(u, [-0.01, 0.0]);
    near(r, [50.0 * 0.01, 20.0 * 0.004]);
    assert_eq!(mode, Mode::Fixed);
    let (u, r, mode) = solved(&stored(&folder, &format!("{contact}{}", moved(0.02))));
    near(r, [0.5, 0.3 * 0.5]);
    near(u, [-0.01, -(0.02 - 0.15 / 20.0)]);
    assert_eq!(mode, Mode::Sliding);
}

#[test]
fn a_surface_may_look_anywhere() {
    let folder = folder();
    // A wall on the left: its normal is x, and t is y.
    let rest = "    contacts: [(nodes: [1], normal: (3.0, 0.0), gap: 0.01)],\n    loads: [(nodes: [1], y: 5.0)],\n    \
                moved: [(nodes: [3], x: Some(-0.02), y: Some(0.0))],\n";
    let (u, r, _) = solved(&stored(&folder, rest));
    near(r, [20.0 * 0.01, 0.0]);
    near(u, [-0.01, 5.0 / 50.0]);
}

#[test]
fn a_body_that_the_contacts_alone_hold_has_its_loads_carried_by_them() {
    let folder = folder();
    let rest = "    contacts: [(nodes: [1], friction: (angle: 45.0), start: fixed)],\n    \
                loads: [(nodes: [3], x: 2.0, y: -5.0), (nodes: [2], y: -1.0)],\n";
    let (_, r, mode) = solved(&stored(&folder, rest));
    near(r, [6.0, 2.0]);
    assert_eq!(mode, Mode::Fixed);
}

#[test]
fn what_a_stored_stiffness_cannot_mean_is_refused_with_its_place() {
    let folder = folder();
    let good =
        "    contacts: [(nodes: [1])],\n    moved: [(nodes: [3], x: Some(0.0), y: Some(-0.02))],\n";
    open(&stored(&folder, good));
    let cases = [
        (
            good.replace("[1]", "[1, 7]"),
            "job.ron:4:28: contacts[0].nodes[1]: node 7 is not in",
        ),
        (
            good.replace("[1]", "[1, 1]"),
            "job.ron:4:28: contacts[0].nodes[1]: node 1 is already a contact",
        ),
        (
            good.replace("[1]", "[]"),
            "job.ron:4:15: contacts: no contacts; name at least one",
        ),
        (
            good.replace("nodes: [1]", "nodes: [1], normal: (0.0, 0.0)"),
            "job.ron:4:37: contacts[0].normal: ",
        ),
        (
            good.replace("nodes: [3]", "nodes: [3, 3]"),
            "job.ron:5:25: moved[0].nodes[1]: node 3 is moved twice",
        ),
        (good.replace("contacts", "contracts"), "job.ron:4:5: "),
    ];
    for (rest, told) in cases {
        let error = refusal(&folder, &stored(&folder, &rest));
        assert!(error.starts_with(told), "{error}");
    }
    let file = stored(&folder, good);
    for (name, text, told) in [
        ("job.sti", "1 1 1.0\n7 1 2.0\n", "job.sti:2:1: a row is 7"),
        (
            "job.dof",
            "1.1\n1.3\n",
            "job.dof:2:1: node 1 has a displacement along z",
        ),
    ] {
        let kept = fs::read(folder.path().join(name)).unwrap();
        put(&folder, name, text);
        let error = refusal(&folder, &file);
        assert!(error.starts_with(told), "{error}");
        put(&folder, name, kept);
    }
    fs::remove_file(folder.path().join("job.dof")).unwrap();
    let error = refusal(&folder, &file);
    let told = "job.ron:3:16: stiffness: \"job.dof\": the file cannot be read";
    assert!(error.starts_with(told), "{error}");
    for outside in ["../job.sti", "/etc/passwd", ""] {
        let text = fs::read_to_string(&file)
            .unwrap()
            .replace("job.sti", outside);
        fs::write(&file, text).unwrap();
        let error = refusal(&folder, &file);
        assert!(error.contains("must be in the same folder"), "{error}");
        stored(&folder, good);
    }
    assert!(Path::new(&file).exists());
}
