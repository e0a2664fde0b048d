//! The program from outside: exit codes, what goes to which stream, and what happens to files.

use crate::program::{
    code, err, interrupted, names, out, program, read_first_line, refused, rows, well, words,
};
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::Arc;
use stickslip::model::Touch;
use stickslip::scene::Scene;
use stickslip::step::event::Outcome;
use stickslip::step::intervene::Intervention;
use stickslip::step::stepper::Stepper;

const BEAM: &str = "01-pinned-beam-rough-floor";
const ROUGH: &str = "02-two-cantilevers-rough";
const OSC: &str = "osc-inclined-cantilever";
/// Makes a run so long that it cannot end before it is stopped.
const LONG: [&str; 2] = ["--set", "history.increment=5e-6"];

/// Runs in a directory of its own.
fn ran(arguments: &[&str]) -> Output {
    crate::program::ran(&std::env::current_dir().unwrap(), arguments)
}

/// A table is whole if it ends with a line end and all its rows have as many fields as its header.
fn whole_rows(table: &str) -> usize {
    assert!(table.ends_with('\n'), "cut off: {table:?}");
    let fields: Vec<usize> = table.lines().map(|l| l.split(',').count()).collect();
    assert!(fields.iter().all(|n| *n == fields[0]), "{table}");
    fields.len() - 1
}

#[test]
fn a_run_that_converges_ends_with_0_and_writes_only_data_to_standard_output() {
    let output = ran(&["run", BEAM, "--csv", "-"]);
    assert_eq!(code(&output), 0, "{}", err(&output));
    let table = out(&output);
    assert_eq!(whole_rows(&table), 50);
    let header = "increment,load,majors,minors,u_x,u_y,rotation,contact_x,contact_y,jumped";
    assert_eq!(table.lines().next(), Some(header));
    for (k, row) in table.lines().skip(1).enumerate() {
        let fields: Vec<f64> = row.split(',').map(|f| f.parse().unwrap()).collect();
        assert_eq!(fields[0], k as f64 + 1.0);
        assert!(fields[3] >= fields[2], "a major iteration has a minor one");
    }
    assert!(err(&output).contains("50 increments accepted"));
    let quiet = ran(&["run", BEAM, "--csv", "-", "--quiet"]);
    assert_eq!((out(&quiet), err(&quiet)), (table, String::new()));
}

#[test]
fn without_csv_a_run_prints_a_summary_with_the_monitors_to_standard_error() {
    let output = ran(&["run", ROUGH]);
    assert_eq!(code(&output), 0);
    assert_eq!(out(&output), "");
    assert!(err(&output).contains("up to load 2.5"), "{}", err(&output));
    assert!(err(&output).contains("contact_y"), "{}", err(&output));
}

#[test]
fn a_trace_has_a_row_for_every_minor_iteration_and_agrees_with_the_csv() {
    let directory = tempfile::tempdir().unwrap();
    let arguments = format!("run {BEAM} --csv a.csv --trace - -q");
    let arguments = words(&arguments);
    let output = crate::program::ran(directory.path(), &arguments);
    assert_eq!(code(&output), 0, "{}", err(&output));
    let trace = out(&output);
    assert!(trace.starts_with(
        "increment,attempt,major,minor,node,mode,next,rule,gap,f_n,f_t,t_max,slip,margin,residual,contact\n"
    ));
    let csv = std::fs::read_to_string(directory.path().join("a.csv")).unwrap();
    let minors = csv
        .lines()
        .skip(1)
        .map(|row| row.split(',').nth(3).unwrap());
    let minors: usize = minors.map(|n| n.parse::<usize>().unwrap()).sum();
    assert_eq!(whole_rows(&trace), minors, "one slave node");
    for word in ["sliding-sticks", "fixed-slides", "beam.5"] {
        assert!(trace.contains(word), "{word}");
    }
    let rows = trace.lines().skip(1);
    let last = rows.last().unwrap().rsplit(',').nth(1).unwrap();
    let last: f64 = last.parse().unwrap();
    assert!(last < 1e-10, "the residual at the end of a major: {last}");
}

#[test]
fn numbers_of_the_csv_read_back_to_the_bits_of_the_solver() {
    let csv = well(&ran(&["run", BEAM, "--csv", "-", "-q"]));
    let mut table = rows(&csv).into_iter();
    let mut stepper = Stepper::new(Arc::new(Scene::open(BEAM, &[]).unwrap().model));
    let mut values = Vec::new();
    while let Some(event) = stepper.step().cloned() {
        if !matches!(event.outcome, Outcome::Increment { .. }) {
            continue;
        }
        values.clear();
        stepper.monitors(&mut values);
        let row = table.next().unwrap();
        let monitors = stepper.model().monitors.iter().zip(&values);
        let named = monitors.map(|(monitor, value)| (monitor.name.as_str(), *value));
        for (name, value) in named.chain([("load", event.load_factor)]) {
            let read: f64 = row[name].parse().unwrap();
            assert_eq!(read.to_bits(), value.to_bits(), "{name} {value:?}");
        }
    }
    assert_eq!(table.next(), None);
    assert!(!values.is_empty());
}

#[test]
fn a_cycle_ends_with_3_and_is_told_with_place_nodes_and_the_command_that_tries_remedies() {
    let output = ran(&words(&format!(
        "run {OSC} --csv - --set history.increment=0.02"
    )));
    assert_eq!(code(&output), 3);
    assert_eq!(whole_rows(&out(&output)), 2, "what converged before");
    let told = err(&output);
    for part in [
        "increment 3 (load 0.06), major 1, minor 2",
        "cycle of period 2",
        "beam.5 free → fixed",
        "load 0.04",
        "`stickslip remedies osc-inclined-cantilever --set history.increment=0.02` tries",
    ] {
        assert!(told.contains(part), "{part:?} is not in {told}");
    }
}

#[test]
fn a_mechanism_is_named_with_body_and_motion() {
    let free = ["run", BEAM, "--set", "slaves[0].start=free"];
    let by_table_2 = ["--set", "settings.strategy=table2", "-q"];
    let output = ran(&[&free[..], &by_table_2].concat());
    assert_eq!(code(&output), 3);
    let motion = "beam can rotate about (0, 2.828)";
    assert!(err(&output).contains(motion), "{}", err(&output));
    // The ladder says the same, and finds the state in which the floor holds the beam.
    let output = ran(&free);
    assert_eq!(code(&output), 0);
    assert!(err(&output).contains(motion), "{}", err(&output));
}

#[test]
fn an_increment_that_is_accepted_unsettled_is_not_accepted_in_silence() {
    let limits = format!(
        "run {BEAM} --quiet --set settings.minors=1 --set settings.at_minor_limit=accept --set \
            settings.majors=1 --set settings.at_major_limit=accept --set history.path[1]=0.02 --set \
            history.path[2]=0.03"
    );
    let limits = words(&limits);
    let output = ran(&limits);
    assert_eq!(code(&output), 0, "{}", err(&output));
    let told = err(&output);
    assert!(
        told.contains("increment 1 (load 0.01) was accepted, but"),
        "{told}"
    );
}

#[test]
fn a_body_that_moves_without_a_force_is_warned_of() {
    let wedge = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/findings/wedge-let-go.ron"
    );
    let warned = |arguments: &[&str]| {
        let output = ran(&[&["run", wedge, "--quiet"], arguments].concat());
        assert_eq!(code(&output), 0, "{}", err(&output));
        err(&output).contains("body wedge moved by up to")
    };
    assert!(warned(&[]));
    // While the ram presses, there is nothing to warn of.
    assert!(!warned(&["--set", "loads[1].value=0.005"]));
}

/// The lid is open throughout; the points of the contact below are nodes of no body.
#[test]
fn a_block_carried_by_face_contact_moves_with_a_force() {
    let directory = tempfile::tempdir().unwrap();
    let text = r#"(
    title: "A carried block under a lid that does not touch",
    nodes: [
        Block(id: "base", corners: [(-0.5, 0.0), (1.5, 0.5)], elements: (2, 1)),
        Block(id: "b", corners: [(0.0, 0.5), (1.0, 1.0)], elements: (2, 1)),
        Block(id: "lid", corners: [(-0.5, 1.2), (1.5, 1.5)], elements: (2, 1)),
    ],
    materials: [Elastic(id: "soft", E: 1000.0, nu: 0.2)],
    bodies: [
        Solid(id: "base", mesh: "base", material: "soft"),
        Solid(id: "b", mesh: "b", material: "soft"),
        Solid(id: "lid", mesh: "lid", material: "soft"),
    ],
    surfaces: [(id: "below", along: "base.top"), (id: "above", along: "b.top")],
    slaves: [
        (nodes: ["b.bottom"], on: ["below"], law: Penalty(stiffness: 1e5), by: surface, friction: (angle: 30.0)),
        (nodes: ["lid.bottom"], on: ["above"]),
    ],
    supports: [(node: "base.bottom", fix: [y]), (node: "lid.top", fix: [x, y])],
    loads: [
        Force(node: "b.top.2", y: -1.0, scale: [(0.0, 1.0), (1.0, 1.0)]),
        Displacement(node: "base.bottom", component: x, value: 0.2),
    ],
    history: (path: [0.0, 1.0], increment: 0.5),
)"#;
    let scene = directory.path().join("carried.ron");
    std::fs::write(&scene, text).unwrap();
    let output = ran(&["run", scene.to_str().unwrap(), "--quiet"]);
    assert_eq!(code(&output), 0, "{}", err(&output));
    assert!(!err(&output).contains("no force"), "{}", err(&output));
}

/// Both nodes of the base's top lie beyond the ends of the pad's bottom; the other way round, the pad's nodes lie over the base.
#[test]
fn bodies_that_overlap_after_a_run_are_warned_of() {
    let directory = tempfile::tempdir().unwrap();
    let warned = |slaves: &str, surface: &str| {
        let text = format!(
            r#"(
    title: "A pad on a wider base",
    nodes: [
        Block(id: "base", corners: [(-1.0, 0.0), (2.0, 1.0)], elements: (1, 1), element: quad4),
        Block(id: "pad", corners: [(0.0, 1.0), (1.0, 2.0)], elements: (1, 1), element: quad4),
    ],
    materials: [Elastic(id: "soft", E: 100.0, nu: 0.2)],
    bodies: [
        Solid(id: "base", mesh: "base", material: "soft"),
        Solid(id: "pad", mesh: "pad", material: "soft"),
    ],
    surfaces: [(id: "face", along: "{surface}")],
    slaves: [(nodes: ["{slaves}"], on: ["face"])],
    supports: [(node: "base.bottom", fix: [x, y]), (node: "pad.top", fix: [x])],
    loads: [Displacement(node: "pad.top", component: y, value: -0.1)],
    history: (path: [0.0, 1.0], increment: 0.5),
)"#
        );
        std::fs::write(directory.path().join("pad.ron"), text).unwrap();
        let output = crate::program::ran(directory.path(), &["run", "pad.ron", "--quiet"]);
        assert_eq!(code(&output), 0, "{}", err(&output));
        let lies_inside = "bodies base and pad overlap in the last accepted state: pad.1 of the \
                           second lies inside the first by 0.1.";
        err(&output).contains(lies_inside)
    };
    assert!(warned("base.top", "pad.bottom"));
    assert!(!warned("pad.bottom", "base.top"));
}

#[test]
fn bad_input_ends_with_2_and_one_line() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(
        directory.path().join("bad.ron"),
        "(title: \"a\",\n  nose: 3)",
    )
    .unwrap();
    std::fs::write(directory.path().join("noise.ron"), [0xff, 0, 7, 0xfe]).unwrap();
    for arguments in [
        &["run", "no-such-scene"][..],
        &["run", "bad.ron"],
        &["check", "bad.ron"],
        &["check", "noise.ron"],
        &["run", "."],
        &["check", BEAM, "--set", "friction.angel=3"],
        &["check", BEAM, "--set", "friction.angle=95"],
        &["run", BEAM, "--csv", "no/such/directory/a.csv"],
        &words(&format!("run {BEAM} --csv - --trace -")),
        &["replay", "no-such-file.ron"],
        &["replay", "noise.ron"],
        &["replay", "bad.ron"],
        &["diff", "bad.ron", "bad.ron"],
        &["record", BEAM, "--at", "77"],
        &["record", BEAM, "--at", "1.2.500"],
    ] {
        let output = crate::program::ran(directory.path(), arguments);
        assert_eq!(code(&output), 2, "{arguments:?}: {}", err(&output));
        assert_eq!(out(&output), "", "{arguments:?}");
        assert_eq!(err(&output).lines().count(), 1, "{}", err(&output));
    }
    assert_eq!(names(directory.path()), ["bad.ron", "noise.ron"]);
    let output = crate::program::ran(directory.path(), &["check", "bad.ron"]);
    assert!(err(&output).starts_with("bad.ron:2:"), "{}", err(&output));
}

#[test]
fn bad_usage_ends_with_2() {
    for arguments in [
        &["run"][..],
        &["run", BEAM, "--sett", "a=b"],
        &["run", BEAM, "--set", "friction.angle"],
        &["record", BEAM],
        &["record", BEAM, "--at", "0"],
        &["record", BEAM, "--at", "1.2.3.4"],
        &["replay"],
        &["diff", "one"],
    ] {
        let output = ran(arguments);
        assert_eq!(code(&output), 2, "{arguments:?}");
        assert_eq!(out(&output), "");
        assert!(!err(&output).is_empty());
    }
    for arguments in [&["--help"][..], &["--version"], &["run", "--help"]] {
        assert_eq!(code(&ran(arguments)), 0, "{arguments:?}");
    }
}

#[test]
fn without_a_terminal_the_debugger_says_so_and_names_run() {
    for arguments in [&[][..], &[BEAM], &[BEAM, "--set", "friction.angle=20"]] {
        let output = ran(arguments);
        assert_eq!(code(&output), 2);
        assert_eq!(out(&output), "");
        let told = err(&output);
        assert!(told.contains("terminal"), "{told}");
        assert!(told.contains("stickslip run"), "{told}");
    }
}

#[test]
fn list_and_check_tell_what_there_is() {
    let output = ran(&["list"]);
    assert_eq!((code(&output), err(&output)), (0, String::new()));
    let builtin = stickslip::scene::builtin::list();
    assert_eq!(out(&output).lines().count(), builtin.len());
    for (line, scene) in out(&output).lines().zip(builtin) {
        assert!(line.starts_with(scene.name));
        assert!(line.ends_with(&stickslip::scene::builtin::title(scene)));
        let output = ran(&["check", scene.name]);
        assert_eq!(code(&output), 0, "{}", err(&output));
        assert!(out(&output).contains("unknowns"), "{}", out(&output));
    }
}

#[test]
fn check_lists_the_paths_that_set_takes() {
    let output = ran(&["check", BEAM, "--paths", "--set", "friction.angle=20"]);
    assert_eq!(code(&output), 0);
    let listed = out(&output);
    assert!(listed.contains("friction.angle\t20.0\t"), "{listed}");
    for line in listed.lines() {
        let mut fields = line.split('\t');
        let (path, value) = (fields.next().unwrap(), fields.next().unwrap());
        let same = format!("{path}={value}");
        let output = ran(&["check", BEAM, "--set", &same]);
        assert_eq!(code(&output), 0, "{same}: {}", err(&output));
        if listed.lines().count() > 40 && path.starts_with("monitors") {
            break; // Each is a process of its own; the rest are of a kind.
        }
    }
}

#[test]
fn set_changes_the_scene() {
    let load = |set: &str| {
        let output = ran(&["run", ROUGH, "--csv", "-", "-q", "--set", set]);
        assert_eq!(code(&output), 0, "{}", err(&output));
        out(&output)
    };
    assert_eq!(whole_rows(&load("history.increment=0.5")), 5);
    assert_eq!(whole_rows(&load("history.path[1]=0.1")), 2);
    assert_ne!(load("refine=2"), load("refine=1"));
}

#[test]
fn files_are_overwritten_only_when_asked_and_that_is_known_before_the_solve() {
    let directory = tempfile::tempdir().unwrap();
    for option in ["--csv", "--trace", "--snapshot"] {
        let file = directory.path().join("precious");
        std::fs::write(&file, "precious").unwrap();
        // This run would take minutes.
        let mut arguments = vec!["run", ROUGH, option, "precious"];
        arguments.extend(LONG);
        let output = crate::program::ran(directory.path(), &arguments);
        refused(&output, "--force");
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "precious");
        let output = crate::program::ran(
            directory.path(),
            &["run", ROUGH, option, "precious", "--force"],
        );
        assert_eq!(code(&output), 0, "{}", err(&output));
        assert_ne!(std::fs::read_to_string(&file).unwrap(), "precious");
        assert_eq!(
            names(directory.path()),
            ["precious"],
            "nothing is left over"
        );
    }
    let same = crate::program::ran(
        directory.path(),
        &words(&format!("run {ROUGH} --csv new --trace new")),
    );
    assert_eq!(code(&same), 2);
    assert_eq!(names(directory.path()), ["precious"]);
}

#[test]
fn a_failing_run_leaves_whole_files() {
    let directory = tempfile::tempdir().unwrap();
    let arguments = format!(
        "run {OSC} --csv a.csv --trace a.trace --snapshot a.ron --set history.increment=0.02"
    );
    let arguments = words(&arguments);
    let output = crate::program::ran(directory.path(), &arguments);
    assert_eq!(code(&output), 3);
    assert_eq!(names(directory.path()), ["a.csv", "a.ron", "a.trace"]);
    let read = |name: &str| std::fs::read_to_string(directory.path().join(name)).unwrap();
    assert_eq!(whole_rows(&read("a.csv")), 2);
    let trace = read("a.trace");
    whole_rows(&trace);
    assert!(
        trace
            .lines()
            .last()
            .unwrap()
            .starts_with("3,1,1,2,beam.5,fixed,free,fixed-opens,")
    );
    let replayed = crate::program::ran(directory.path(), &["replay", "a.ron"]);
    assert_eq!(code(&replayed), 0, "{}", out(&replayed));
}

#[test]
fn what_is_recorded_replays_and_what_differs_is_told() {
    let directory = tempfile::tempdir().unwrap();
    let ran = |arguments: &[&str]| crate::program::ran(directory.path(), arguments);
    for (at, file) in [("3", "a.ron"), ("3.1", "b.ron"), ("26.1.1", "c.ron")] {
        let output = ran(&["record", BEAM, "--at", at, "-o", file]);
        assert_eq!(code(&output), 0, "{}", err(&output));
        assert_eq!(out(&output), "");
    }
    let output = ran(&["replay", "a.ron", "b.ron", "c.ron"]);
    assert_eq!(code(&output), 0, "{}{}", out(&output), err(&output));
    assert_eq!(out(&output).lines().count(), 3);
    assert!(out(&output).lines().all(|line| line.contains(": equal")));

    assert_eq!(code(&ran(&["diff", "a.ron", "a.ron"])), 0);
    let output = ran(&["diff", "a.ron", "c.ron"]);
    assert_eq!(code(&output), 1);
    for part in ["increment", "beam.5 next", "sliding-sticks", "beam.5 x"] {
        assert!(out(&output).contains(part), "{part}: {}", out(&output));
    }

    // Another friction is another scene, and the recorded state is not the one that it leads to.
    let text = std::fs::read_to_string(directory.path().join("c.ron")).unwrap();
    let other = text.replace("angle: 30.0", "angle: 20.0");
    assert_ne!(other, text);
    std::fs::write(directory.path().join("other.ron"), other).unwrap();
    let output = ran(&["replay", "a.ron", "other.ron"]);
    assert_eq!(code(&output), 1, "{}", err(&output));
    assert!(out(&output).contains("beam.5 f_t"), "{}", out(&output));
    assert!(out(&output).contains("the states are of increments 26 and"));
    let lines: Vec<_> = out(&output).lines().map(str::to_owned).collect();
    assert_eq!(lines.len(), 1 + 3 + 12 + 1, "{lines:#?}");
    assert!(lines[16].starts_with("and ") && lines[16].ends_with(" more"));
    let output = ran(&["diff", "c.ron", "other.ron"]);
    assert_eq!(code(&output), 1);
    assert!(
        out(&output).contains("scene friction.angle"),
        "{}",
        out(&output)
    );

    let unknown = text.replace("format: 1", "format: 7");
    std::fs::write(directory.path().join("unknown.ron"), unknown).unwrap();
    let output = ran(&["replay", "unknown.ron", "a.ron"]);
    refused(&output, "format 7");
    assert!(out(&output).contains("a.ron: equal"), "the others are done");

    let output = ran(&words(&format!("record {BEAM} --at 3 -o a.ron")));
    assert_eq!(code(&output), 2, "never overwritten unasked");
}

#[test]
fn record_names_its_file_and_tells_a_place_that_is_not_reached() {
    let directory = tempfile::tempdir().unwrap();
    let output = crate::program::ran(directory.path(), &["record", OSC, "--at", "1.1.2"]);
    assert_eq!(code(&output), 0, "{}", err(&output));
    let file = "osc-inclined-cantilever-1.1.2.ron";
    assert_eq!(names(directory.path()), [file]);
    let output = crate::program::ran(directory.path(), &["record", OSC, "--at", "2"]);
    assert_eq!(code(&output), 3);
    assert!(err(&output).contains("2 not reached"), "{}", err(&output));
    assert_eq!(names(directory.path()), [file]);
    let output = ran(&words(&format!("record {OSC} --at 1.1.1 -o -")));
    assert!(out(&output).starts_with("(\n    format: 1,"));
}

#[test]
fn a_reader_that_closes_the_pipe_is_no_panic_and_no_interruption() {
    for mut arguments in [
        vec!["run", ROUGH, "--csv", "-"],
        vec!["run", ROUGH, "--trace", "-"],
    ] {
        arguments.extend(LONG);
        let output = read_first_line(program(Path::new("."), &arguments));
        assert!(!err(&output).contains("panicked"), "{}", err(&output));
    }
    for arguments in [
        &["check", BEAM, "--paths"][..],
        &["list"],
        &["--help"],
        &["help"],
        &["show", BEAM],
        &["audit", OSC, "--set", "settings.strategy=ladder"],
        &["remedies", OSC],
        &words(&format!("record {OSC} --at 1.1.1 -o -")),
        &words(&format!(
            "run {OSC} --set settings.strategy=ladder --csv - -q"
        )),
        &words(&format!(
            "study {OSC} --vary settings.strategy=ladder --csv - -q"
        )),
        &words(&format!("map {OSC} --strategies ladder --csv - -q")),
        &words(&format!(
            "chart {OSC} --over settings.strategy=ladder,sliding --repeats 1 --csv - -q"
        )),
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = program(Path::new("."), arguments)
            .stdout(writer)
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
            .wait_with_output()
            .unwrap();
        assert_eq!(code(&output), 0, "{arguments:?}: {}", err(&output));
        // What remedies are of is told beside the table.
        let quiet = arguments[0] != "remedies";
        assert!(!quiet || err(&output).is_empty(), "{}", err(&output));
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_while_recording_leaves_nothing_behind() {
    let directory = tempfile::tempdir().unwrap();
    let mut arguments = vec!["record", ROUGH, "--at", "400000", "-o", "a.ron"];
    arguments.extend(LONG);
    let child = program(Path::new("."), &arguments)
        .current_dir(directory.path())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The file that is to become a.ron shows that the program listens.
    while names(directory.path()).is_empty() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    interrupted(child);
    assert!(names(directory.path()).is_empty());
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_run_with_130_and_whole_files() {
    let directory = tempfile::tempdir().unwrap();
    let mut arguments = vec!["run", ROUGH, "--trace", "-", "--csv", "a.csv"];
    arguments.extend(LONG);
    let mut child = program(Path::new("."), &arguments)
        .current_dir(directory.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut trace = BufReader::new(child.stdout.take().unwrap());
    let mut text = String::new();
    for _ in 0..200 {
        trace.read_line(&mut text).unwrap();
    }
    let killed = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(killed.unwrap().success());
    trace.read_to_string(&mut text).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(code(&output), 130, "{}", err(&output));
    assert!(err(&output).contains("interrupted"), "{}", err(&output));
    assert!(whole_rows(&text) >= 199);
    assert_eq!(names(directory.path()), ["a.csv"]);
    let csv = std::fs::read_to_string(directory.path().join("a.csv")).unwrap();
    assert!(whole_rows(&csv) > 1);
}

/// Journals that were written before the solver became a package of its own, and its names the field's: what they hold of
/// every state is a digest of all its fields with their names.
#[test]
fn journals_of_an_earlier_revision_lead_to_the_same_bits() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/journals");
    let entries = std::fs::read_dir(folder).unwrap();
    let journals: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    assert!(journals.len() >= 2, "{journals:?}");
    for journal in journals {
        let output = ran(&["resume", "--check", &journal.to_string_lossy()]);
        assert_eq!(code(&output), 0, "{}: {}", journal.display(), err(&output));
    }
}

/// The increment in which nodes touched is solved here from the same state with `touch: start`, in a session.
#[test]
fn a_run_tells_what_one_step_of_coulombs_law_makes_of_the_increment_in_which_nodes_touched() {
    const SCENE: &str = "bench-mindlin";
    let output = ran(&["run", SCENE]);
    assert_eq!(code(&output), 0, "{}", err(&output));
    let told = err(&output);
    let note = told
        .lines()
        .find(|line| line.starts_with("note: with touch: start"));
    let note = note.unwrap_or_else(|| panic!("{told}"));
    let between = |before: &str, after: &str| {
        let (_, rest) = note.split_once(before).unwrap();
        rest.split_once(after).unwrap().0.to_owned()
    };
    let increment: u32 = between("increment ", " ").parse().unwrap();
    let percent: f64 = between("differ by ", " %").parse().unwrap();

    let model = Arc::new(Scene::open(SCENE, &[]).unwrap().model);
    let forces = |stepper: &mut Stepper| loop {
        let event = stepper.step().expect("more increments").clone();
        if matches!(event.outcome, Outcome::Increment { .. }) {
            let forces: Vec<[f64; 2]> = event.nodes.iter().map(|r| [r.f_n, r.f_t]).collect();
            return forces;
        }
    };
    let (mut ours, mut theirs) = (Stepper::new(model.clone()), Stepper::new(model));
    for _ in 1..increment {
        forces(&mut ours);
    }
    theirs.restore(ours.state());
    let mut settings = ours.state().controls.settings;
    settings.touch = Touch::Start;
    theirs.intervene(&Intervention::Settings(settings)).unwrap();
    let (ours, theirs) = (forces(&mut ours), forces(&mut theirs));
    let size = |f: &[f64; 2]| f[0].hypot(f[1]);
    let largest = ours.iter().map(size).fold(0.0, f64::max);
    let apart = ours
        .iter()
        .zip(&theirs)
        .map(|(a, b)| size(&[a[0] - b[0], a[1] - b[1]]));
    let wanted = 100.0 * apart.fold(0.0, f64::max) / largest;
    // The normals of the two ends differ a little.
    assert!(
        (percent / wanted - 1.0).abs() < 0.02,
        "{percent} % told, {wanted} % found"
    );

    for quiet in [
        &["run", SCENE, "--set", "settings.touch=start"][..],
        &["run", SCENE, "--set", "settings.touch=ratio"],
        &["run", SCENE, "--quiet"],
        &["run", "02-two-cantilevers-smooth"],
    ] {
        assert!(!err(&ran(quiet)).contains("touch: start"), "{quiet:?}");
    }
}

#[test]
fn a_failed_run_advises_nothing_and_names_the_command_that_tries_remedies() {
    for set in [&[][..], &["--set", "friction.angle=25"]] {
        let output = ran(&[&["run", OSC][..], set].concat());
        let told = err(&output);
        assert_eq!(code(&output), 3, "{told}");
        assert!(
            !told.contains("try the") && !told.contains("at_cycle"),
            "{told}"
        );
        let command = told.split('`').nth(1).unwrap_or_default();
        let words: Vec<&str> = command.split(' ').collect();
        assert_eq!(words, [&["stickslip", "remedies", OSC][..], set].concat());
        // What it names was not tried yet, and does try.
        let output = ran(&words[1..]);
        assert_eq!(code(&output), 0, "{}", err(&output));
        assert!(out(&output).contains("converged"), "{}", out(&output));
    }
}
