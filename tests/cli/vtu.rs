//! `run --vtu` and `export -o FILE.vtu`: which files there are, what stands in them, and that none is lost.

use crate::program::{code, err, names, out, ran, refused, rows, well, words};
use std::fs;
use std::ops::ControlFlow;
use std::sync::Arc;
use stickslip::contact::record::ContactRecord;
use stickslip::model::Mode;
use stickslip::record::export::grid::grid;
use stickslip::recorded::calculix::{self, switches};
use stickslip::scene::Scene;
use stickslip::step::drive::Until;
use stickslip::step::state::Status;
use stickslip::step::stepper::Stepper;
use stickslip_exchange::calculix::cel::Slave;
use stickslip_exchange::mesh::CellKind;
use stickslip_exchange::vtu::{self, Array, Grid, Values};

const BLOCK: &str = "osc-block-slide";
const ROUGH: &str = "02-two-cantilevers-rough";
const CYCLES: &str = "osc-two6";

/// Time and file of each entry of a collection.
fn collection(text: &str) -> Vec<(f64, String)> {
    let value = |line: &str, key: &str| {
        let (_, rest) = line.split_once(&format!("{key}=\"")).unwrap();
        rest.split_once('"').unwrap().0.to_owned()
    };
    let entries = text.lines().filter(|line| line.contains("<DataSet "));
    entries
        .map(|line| {
            (
                value(line, "timestep").parse().unwrap(),
                value(line, "file"),
            )
        })
        .collect()
}

#[test]
fn the_smallest_stretch_of_the_cells_is_the_last_column_of_the_table() {
    let scene = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/failures/minimal-collapse.ron"
    );
    let directory = tempfile::tempdir().unwrap();
    let run = ran(
        directory.path(),
        &["run", scene, "--csv", "-", "--stability"],
    );
    let told = err(&run);
    assert_eq!(
        told.matches("softens below 0.5774").count(),
        3,
        "check, once, and the cause: {told}"
    );
    assert!(told.contains("suggested, not tried: materials.rubber.law=neohookean"));
    let table = out(&run);
    assert!(
        table
            .lines()
            .next()
            .unwrap()
            .ends_with(",stability,worst_stretch")
    );
    let table = rows(&table);
    let mut stepper = Stepper::new(Arc::new(Scene::open(scene, &[]).unwrap().model));
    for row in &table {
        let _ = stepper.drive(Until::end(), |stepper| match stepper.event().outcome {
            stickslip::step::event::Outcome::Increment { .. } => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        });
        let (state, event) = (stepper.state(), stepper.event());
        let grid = grid(
            stepper.model(),
            state,
            Some(event),
            event.position,
            event.load_factor,
        )
        .unwrap();
        let least = |name: &str| {
            let array = grid
                .on_cells
                .iter()
                .find(|array| array.name == name)
                .unwrap();
            let Values::Numbers(values) = &array.values else {
                panic!("{name}");
            };
            values.iter().copied().fold(f64::INFINITY, f64::min)
        };
        assert_eq!(
            least("stretch"),
            row["worst_stretch"].parse::<f64>().unwrap()
        );
        assert!(least("det_F") > 0.0);
    }
    let audit = ran(directory.path(), &["audit", scene]);
    let told = out(&audit);
    let row = told
        .lines()
        .find(|line| line.trim_start().starts_with("stretch "))
        .unwrap();
    assert!(row.contains("element 14 of g"), "{told}");
    assert!(told.contains("from increment 6 (load 0.3) on"), "{told}");
}

#[test]
fn a_run_leaves_a_file_for_each_increment_and_a_collection_over_the_load() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let run = ran(here, &words(&format!("run {ROUGH} --vtu a/b --csv -")));
    well(&run);
    let table = rows(&out(&run));
    let folder = here.join("a/b");
    let found = collection(&fs::read_to_string(folder.join(format!("{ROUGH}.pvd"))).unwrap());
    // The start, and each accepted increment.
    assert_eq!(found.len(), table.len() + 1);
    assert_eq!(found[0], (0.0, format!("{ROUGH}-000000.vtu")));
    for ((time, file), row) in found[1..].iter().zip(&table) {
        assert_eq!(*time, row["load"].parse::<f64>().unwrap());
        let text = fs::read_to_string(folder.join(file)).unwrap();
        assert!(
            text.starts_with("<?xml") && text.ends_with("</VTKFile>\n"),
            "{file}"
        );
    }
    assert_eq!(names(&folder).len(), found.len() + 1);
}

#[test]
fn every_minor_iteration_has_a_file_where_that_is_asked_for_and_the_time_is_its_number() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let arguments = format!("run {CYCLES} --vtu v --each minor --trace -");
    let arguments = words(&arguments);
    let run = ran(here, &arguments);
    assert_eq!(code(&run), 3, "it cycles: {}", err(&run));
    let mut minors: Vec<_> = rows(&out(&run))
        .iter()
        .map(|row| ["increment", "attempt", "major", "minor"].map(|key| row[key].clone()))
        .collect();
    minors.dedup();
    let found =
        collection(&fs::read_to_string(here.join("v").join(format!("{CYCLES}.pvd"))).unwrap());
    assert_eq!(found.len(), minors.len() + 1);
    let times: Vec<f64> = found.iter().map(|(time, _)| *time).collect();
    assert_eq!(
        times,
        (0..found.len()).map(|k| k as f64).collect::<Vec<_>>()
    );
}

#[test]
fn no_file_is_overwritten_unasked_and_nothing_is_solved_before_that_is_seen() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    well(&ran(here, &["run", ROUGH, "--vtu", "v", "-q"]));
    let file = here.join("v").join(format!("{ROUGH}.pvd"));
    fs::write(&file, "mine").unwrap();
    let again = ran(here, &words(&format!("run {ROUGH} --vtu v --csv -")));
    assert_eq!((code(&again), out(&again)), (2, String::new()));
    assert!(err(&again).contains("--force"), "{}", err(&again));
    assert_eq!(fs::read_to_string(&file).unwrap(), "mine");
    well(&ran(
        here,
        &words(&format!("run {ROUGH} --vtu v -q --force")),
    ));
    assert!(fs::read_to_string(&file).unwrap().contains("DataSet"));
    let lonely = ran(here, &["run", ROUGH, "--each", "minor"]);
    assert_eq!(code(&lonely), 2, "{}", err(&lonely));
}

#[test]
fn a_state_is_exported_as_the_run_writes_it() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    well(&ran(here, &["run", ROUGH, "--vtu", "v", "-q"]));
    well(&ran(here, &["export", ROUGH, "-o", "end.vtu"]));
    well(&ran(
        here,
        &words(&format!("export {ROUGH} -o third.vtu --at 3")),
    ));
    let text = |name: &str| fs::read_to_string(here.join(name)).unwrap();
    let files = collection(&text(&format!("v/{ROUGH}.pvd")));
    let of_run = |k: usize| text(&format!("v/{}", files[k].1));
    assert!(text("end.vtu") == of_run(files.len() - 1));
    assert!(text("third.vtu") == of_run(3));
}

#[test]
fn a_frozen_problem_goes_into_files_for_every_solver_and_says_the_same_in_all() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let export = |file| {
        ran(
            here,
            &[
                "export", "osc-zig3", "--at", "1.1.1", "--frozen", "-o", file,
            ],
        )
    };
    for file in ["p.dat", "p_W.mtx"] {
        well(&export(file));
    }
    assert_eq!(names(here), ["p.dat", "p_W.mtx", "p_mu.mtx", "p_q.mtx"]);
    let spec = |file: &str| {
        let mut spec = Scene::open(&here.join(file).display().to_string(), &[])
            .unwrap()
            .spec;
        (spec.title, spec.about) = (String::new(), String::new());
        spec
    };
    let hdf = export("p.h5");
    if cfg!(feature = "fclib") {
        well(&hdf);
        assert_eq!(spec("p.h5"), spec("p.dat"));
    } else {
        refused(&hdf, "cargo install --path . --features fclib");
        assert!(!here.join("p.h5").exists());
    }
    assert_eq!(spec("p_W.mtx"), spec("p.dat"));
    // The files beside the matrix are as safe as the matrix.
    fs::remove_file(here.join("p_W.mtx")).unwrap();
    let again = ran(here, &words("export osc-zig3 --at 1.1.1 -o p_W.mtx"));
    assert_eq!(code(&again), 2, "{}", err(&again));
    assert!(!here.join("p_W.mtx").exists());
    let stiff = ran(here, &["export", "osc-zig3", "-o", "p_K.mtx"]);
    refused(&stiff, "_W.mtx");
}

fn numbers<'g>(arrays: &'g [Array], name: &str) -> &'g [f64] {
    match &arrays
        .iter()
        .find(|array| array.name == name)
        .unwrap()
        .values
    {
        Values::Numbers(values) => values,
        other => panic!("{name}: {other:?}"),
    }
}

fn wholes<'g>(arrays: &'g [Array], name: &str) -> &'g [i32] {
    match &arrays
        .iter()
        .find(|array| array.name == name)
        .unwrap()
        .values
    {
        Values::Wholes(values) => values,
        other => panic!("{name}: {other:?}"),
    }
}

/// The grid at the end of a scene, with what the last minor iteration found.
fn at_the_end(name: &str, set: &[(&str, &str)]) -> (Stepper, Grid, Vec<ContactRecord>) {
    let set: Vec<_> = set
        .iter()
        .map(|(p, v)| ((*p).to_owned(), (*v).to_owned()))
        .collect();
    let scene = Scene::open(name, &set).unwrap();
    let mut stepper = Stepper::new(Arc::new(scene.model));
    stepper.drive(Until::end(), |_| ControlFlow::<()>::Continue(()));
    let event = stepper.event().clone();
    let grid = grid(
        stepper.model(),
        stepper.state(),
        Some(&event),
        event.position,
        event.load_factor,
    )
    .unwrap();
    (stepper, grid, event.nodes)
}

#[test]
fn nodes_are_where_the_state_has_them_and_slave_nodes_say_what_was_found() {
    let (stepper, grid, found) = at_the_end(BLOCK, &[]);
    let model = stepper.model();
    let moved = numbers(&grid.on_points, "displacement");
    for (node, at) in grid.points.iter().enumerate() {
        let now = model.place(&stepper.state().u, node);
        let there = [at[0] + moved[3 * node], at[1] + moved[3 * node + 1]];
        assert_eq!(there, now);
    }
    let (modes, force) = (
        wholes(&grid.on_points, "contact_mode"),
        numbers(&grid.on_points, "contact_force"),
    );
    let mut slaves = 0;
    for (contact, record) in model.contacts.iter().zip(&found) {
        let node = contact.node;
        slaves += 1;
        let mode = [Mode::Free, Mode::Sliding, Mode::Fixed][modes[node] as usize];
        assert_eq!(mode, record.decision.before);
        assert_eq!(numbers(&grid.on_points, "gap")[node], record.gap);
        // The floor is level: n is up, and t against x.
        assert_eq!(force[3 * node + 1], record.f_n);
        assert_eq!(force[3 * node], -record.f_t);
        let pressure = numbers(&grid.on_points, "pressure")[node];
        assert!(
            contact.area.is_none() && pressure.is_nan()
                || pressure == record.f_n / contact.area.unwrap()
        );
    }
    let others = modes.iter().filter(|mode| **mode == -1).count();
    assert_eq!(slaves + others, model.nodes.len());
}

/// A loose tolerance leaves a last correction in which the surface still turns.
#[test]
fn contact_forces_of_an_accepted_state_are_along_its_own_directions() {
    let loose = [("settings.tolerance", "1e-3")];
    let (stepper, grid, found) = at_the_end("05-cantilever-elastic-block", &loose);
    assert_eq!(stepper.state().status, Status::Finished);
    let force = numbers(&grid.on_points, "contact_force");
    let mut turned = 0;
    for (slave, record) in found.iter().enumerate() {
        let (node, state) = (
            stepper.model().contacts[slave].node,
            &stepper.state().nodes[slave],
        );
        let ([c, s], f_n, f_t) = (state.normal, record.f_n, record.f_t);
        let expected = [c * f_n - s * f_t, s * f_n + c * f_t];
        assert_eq!(force[3 * node..3 * node + 2], expected);
        turned += usize::from(f_n > 0.0 && record.normal != state.normal);
    }
    assert!(turned > 0);
}

#[test]
fn bodies_and_surfaces_are_cells_that_say_whose_they_are() {
    let (stepper, grid, _) = at_the_end(BLOCK, &[]);
    let (body, surface, rigid) = (
        wholes(&grid.on_cells, "body"),
        wholes(&grid.on_cells, "surface"),
        wholes(&grid.on_cells, "rigid"),
    );
    assert_eq!(body.len(), grid.cells.len());
    for (k, cell) in grid.cells.iter().enumerate() {
        assert_eq!(cell.nodes.len(), cell.kind.nodes());
        assert!(cell.nodes.iter().all(|node| *node < grid.points.len()));
        let line = matches!(cell.kind, CellKind::Line2 | CellKind::Line3);
        assert_eq!((body[k] == 0, surface[k] > 0), (line, line));
        assert_eq!(
            rigid[k] == 1,
            line && stepper.model().surfaces[surface[k] as usize - 1].rigid
        );
    }
    // Beams are lines, and say how they turn.
    let (stepper, grid, _) = at_the_end(ROUGH, &[]);
    let turned = numbers(&grid.on_points, "rotation");
    let first = &stepper.model().dofs.first;
    assert!(
        turned
            .iter()
            .enumerate()
            .any(|(k, angle)| *angle == stepper.state().u[first[k] + 2] && *angle != 0.0)
    );
    assert!(wholes(&grid.on_cells, "body").contains(&1));
}

#[test]
fn a_stress_in_balance_with_a_pressed_face_is_on_its_nodes() {
    // A block that does not widen is pressed alike everywhere: the stress across the floor is the pressure on it.
    let pressed = [("loads[0].x", "0.0"), ("materials.rubber.nu", "0.0")];
    let (stepper, grid, _) = at_the_end(BLOCK, &pressed);
    assert_eq!(stepper.state().status, Status::Finished);
    let stress = numbers(&grid.on_points, "stress");
    assert_eq!(stress.len(), 6 * grid.points.len());
    let of_body: Vec<bool> = (0..grid.points.len())
        .map(|k| !stress[6 * k].is_nan())
        .collect();
    let cells = grid.cells.iter().zip(wholes(&grid.on_cells, "body"));
    let mut on_body = vec![false; grid.points.len()];
    for (cell, _) in cells.filter(|(_, body)| **body > 0) {
        cell.nodes.iter().for_each(|node| on_body[*node] = true);
    }
    assert_eq!(of_body, on_body);
    for stress in stress.chunks(6).filter(|stress| !stress[0].is_nan()) {
        let exact = [0.0, -1.0, 0.0, 0.0, 0.0, 0.0];
        let off = stress.iter().zip(exact).map(|(s, e)| (s - e).abs());
        assert!(off.fold(0.0, f64::max) < 1e-9, "{stress:?}");
    }
}

#[test]
fn switches_of_a_finished_run_are_on_the_nodes_of_its_deck() {
    let directory = tempfile::tempdir().unwrap();
    let cel = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/calculix/two-blocks.cel");
    well(&ran(
        directory.path(),
        &["export", cel, "-o", "switches.vtu"],
    ));
    let written = fs::read_to_string(directory.path().join("switches.vtu")).unwrap();
    let run = calculix::file(cel).unwrap().unwrap().run;
    let (grid, lost) = switches::grid(&run, &[]).unwrap();
    assert_eq!((written, lost), (vtu::write(&grid), 0));
    let column = |name: &str| -> Vec<i32> {
        let array = grid.on_points.iter().find(|array| array.name == name);
        match &array.unwrap().values {
            Values::Wholes(values) => values.clone(),
            other => panic!("{name}: {other:?}"),
        }
    };
    let (nodes, counts, status) = (column("node"), column("switches"), column("status"));
    let mut compared = 0;
    for (slave, of) in run.files.slaves.iter().enumerate() {
        let Slave::Node(node) = of else {
            panic!("{of:?}");
        };
        let at = nodes
            .iter()
            .position(|n| u32::try_from(*n) == Ok(*node))
            .unwrap();
        let total = run.switching_of(slave).map_or(0, |found| found.total());
        assert_eq!(usize::try_from(counts[at]), Ok(total), "node {node}");
        assert!((0..=1).contains(&status[at]));
        compared += total;
    }
    assert!(compared > 0);
    // Nodes that never touched.
    assert!(counts.contains(&-1) && status.contains(&-1));
}
