//! What the command line says where something else was meant, and with which code it ends.

use crate::program::{code, err, out, program, ran, read_first_line, well, words};
use std::path::Path;

const OSC: &str = "osc-inclined-cantilever";

fn top(file: &str) -> String {
    format!("{}/{file}", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn a_file_of_another_kind_is_told_with_the_command_that_reads_it() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let copy = |from: &str, to: &str| std::fs::copy(top(from), here.join(to)).unwrap();
    copy("snapshots/02-rough-at-the-end.ron", "snapshot.ron");
    copy("tests/journals/up-the-ladder.journal", "a.journal");
    copy("problems/lessons/modes.ron", "lesson.ron");
    copy("problems/studies/geometry-01.ron", "study.ron");
    copy("problems/osc-snap.ron", "scene.ron");
    std::fs::write(
        here.join("chart.csv"),
        "scene,series,run,status,error,seconds\na,b,c,whole,1e-3,1\n",
    )
    .unwrap();
    std::fs::write(here.join("film.cast"), "{\"version\": 2}\n").unwrap();
    let kinds = [
        (
            "snapshot.ron",
            "a snapshot; `stickslip replay snapshot.ron`",
        ),
        ("a.journal", "a journal; `stickslip resume a.journal`"),
        ("lesson.ron", "a lesson; `stickslip lesson lesson.ron`"),
        ("study.ron", "a study; `stickslip study study.ron`"),
        ("scene.ron", "a scene; `stickslip run scene.ron`"),
        (
            "chart.csv",
            "the table of a work-precision chart; `stickslip chart --from chart.csv`",
        ),
        (
            "film.cast",
            "a terminal recording of a session; `asciinema play film.cast`",
        ),
    ];
    // The words of each reader, and the files that it reads itself.
    let readers: &[(&[&str], &[&str])] = &[
        (&[], &["scene.ron"]),
        (&["run"], &["scene.ron"]),
        (&["check"], &["scene.ron"]),
        (&["core"], &["scene.ron"]),
        (&["remedies"], &["scene.ron"]),
        (&["record", "--at", "1"], &["scene.ron"]),
        (&["map"], &["scene.ron"]),
        (&["study"], &["scene.ron", "study.ron"]),
        (&["chart"], &["scene.ron"]),
        (&["chart", "--from"], &["chart.csv"]),
        (&["lesson", "--check"], &["lesson.ron"]),
        (&["replay"], &["snapshot.ron"]),
        (&["diff", "snapshot.ron"], &["snapshot.ron"]),
        (&["audit"], &["scene.ron", "snapshot.ron"]),
        (&["story"], &["a.journal"]),
        (&["resume", "--check"], &["a.journal"]),
        (&["map", "osc-snap", "--resume"], &[]),
    ];
    let mut told = 0;
    for (words, own) in readers {
        for (file, is) in kinds.iter().filter(|(file, _)| !own.contains(file)) {
            let output = ran(here, &[words, &[*file][..]].concat());
            assert_eq!(code(&output), 2, "{words:?} {file}: {}", err(&output));
            let wanted = format!("this is {is} reads it");
            assert!(
                err(&output).contains(&wanted),
                "{words:?} {file}: {}",
                err(&output)
            );
            assert_eq!(err(&output).lines().count(), 1, "{}", err(&output));
            told += 1;
        }
    }
    assert!(told > 80, "{told}");
}

#[test]
fn a_mistyped_subcommand_or_scene_gets_the_one_that_was_meant() {
    let here = Path::new(".");
    for (words, meant) in [
        (&["rnu", "x"][..], "run"),
        (&["rnu"], "run"),
        (&["exprt", "a.ron", "-o", "b.svg"], "export"),
        (&["remdies", OSC], "remedies"),
        (&["osc-snpa"], "osc-snap"),
        (&["osc-snpa", "--set", "a=1"], "osc-snap"),
    ] {
        let output = ran(here, words);
        assert_eq!(code(&output), 2, "{words:?}");
        let wanted = format!("did you mean {meant:?}?");
        assert!(
            err(&output).contains(&wanted),
            "{words:?}: {}",
            err(&output)
        );
    }
    // Where nothing is near, nothing is proposed; a flag that is wrong is clap's.
    assert!(!err(&ran(here, &["qqqqqq", "x"])).contains("did you mean"));
    assert!(err(&ran(here, &["run", OSC, "--cvs"])).contains("'--cvs'"));
}

#[test]
fn the_help_has_the_subcommands_in_groups() {
    let help = well(&ran(Path::new("."), &["--help"]));
    let heads: Vec<&str> = help
        .lines()
        .filter(|line| line.ends_with(':') && !line.starts_with(' '))
        .collect();
    let wanted =
        words("Solve: Debug: Attach: Record: Sweep: Learn: Files: Install: Arguments: Options:");
    assert_eq!(heads, wanted);
    for word in ["run", "export", "story", "map"] {
        let line = format!("  {word} ");
        assert_eq!(
            help.lines().filter(|l| l.starts_with(&line)).count(),
            1,
            "{word}"
        );
    }
    assert!(
        help.lines().all(|line| line.chars().count() <= 100),
        "{help}"
    );
}

#[test]
fn remedies_say_by_their_code_whether_any_works() {
    let here = Path::new(".");
    let output = ran(here, &["remedies", OSC]);
    assert_eq!(code(&output), 0, "{}", err(&output));
    assert!(out(&output).contains("converged"), "{}", out(&output));
    let directory = tempfile::tempdir().unwrap();
    // Loads on a body that nothing holds.
    let scene = well(&ran(here, &["show", OSC]));
    let held = "supports: [(node: \"beam.start\", fix: [x, y, rotation])]";
    let loose = scene.replace(held, "supports: []");
    assert_ne!(loose, scene);
    std::fs::write(directory.path().join("loose.ron"), loose).unwrap();
    let output = ran(directory.path(), &["remedies", "loose.ron"]);
    assert_eq!(code(&output), 3, "{}{}", out(&output), err(&output));
}

/// With a second place for results, a reader that leaves does not end the run.
#[test]
fn what_else_is_written_is_whole_though_the_reader_of_one_table_left() {
    let directory = tempfile::tempdir().unwrap();
    let arguments = words(
        "run 02-two-cantilevers-rough --set history.increment=0.001 --csv - --snapshot end.ron",
    );
    let output = read_first_line(program(directory.path(), &arguments));
    assert_eq!(code(&output), 0, "{}", err(&output));
    let snapshot = std::fs::read_to_string(directory.path().join("end.ron")).unwrap();
    assert!(snapshot.contains("status: Finished"), "the run was cut");
}

#[test]
fn a_run_of_a_scene_without_monitors_tells_modes_and_forces() {
    let directory = tempfile::tempdir().unwrap();
    let scene = well(&ran(
        Path::new("."),
        &["show", "01-pinned-beam-rough-floor"],
    ));
    let start = scene.find("    monitors: [").unwrap();
    let end = start + scene[start..].find("\n    ],\n").unwrap() + "\n    ],\n".len();
    let without = format!("{}{}", &scene[..start], &scene[end..]);
    std::fs::write(directory.path().join("a.ron"), without).unwrap();
    let arguments = ["run", "a.ron", "--set", "history.path[2]=0.2"];
    let output = ran(directory.path(), &arguments);
    assert_eq!(code(&output), 0, "{}", err(&output));
    let told = err(&output);
    let head = told.lines().find(|line| line.contains("F_n")).expect(&told);
    let row = told
        .lines()
        .find(|line| line.contains("beam.5"))
        .expect(&told);
    assert_eq!(
        head.split_whitespace().collect::<Vec<_>>(),
        ["node", "mode", "gap", "F_n", "F_t"]
    );
    let cells: Vec<&str> = row.split_whitespace().collect();
    assert!(["fixed", "sliding"].contains(&cells[1]), "{row}");
    assert!(cells[3].parse::<f64>().unwrap() > 0.0, "{row}");
    let quiet = ran(directory.path(), &[&arguments[..], &["-q"]].concat());
    assert_eq!(err(&quiet), "");
}

#[test]
fn a_built_in_scene_where_a_snapshot_is_read_is_told_to_be_one() {
    let here = tempfile::tempdir().unwrap();
    for arguments in [
        &["replay", "osc-snap"][..],
        &["diff", "osc-snap", "osc-two6"],
    ] {
        let output = program(here.path(), arguments).output().unwrap();
        assert_eq!(code(&output), 2, "{arguments:?}");
        let told = err(&output);
        assert!(told.contains("osc-snap: a built-in scene"), "{told}");
        assert!(told.contains("`stickslip run osc-snap`"), "{told}");
    }
}

#[test]
fn a_missing_file_gets_a_suggestion_from_its_folder() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::copy(top("problems/osc-two6.ron"), here.join("clip.ron")).unwrap();
    for arguments in [
        &["run", "cilp.ron"][..],
        &["replay", "cilp.ron"],
        &["resume", "--check", "cilp.ron"],
        &["story", "cilp.ron"],
        &["chart", "--from", "cilp.ron"],
        &["chart", "osc-two6", "--reference", "cilp.ron"],
        &["cilp.ron", "--no-journal"],
    ] {
        let wrong = ran(here, arguments);
        let told = err(&wrong);
        assert!(told.contains("; did you mean \"clip.ron\"?"), "{told}");
        assert_eq!(code(&wrong), 2);
    }
    let wrong = err(&ran(here, &["run", "wall.ron"]));
    assert!(!wrong.contains("did you mean"), "{wrong}");
}

#[test]
fn notes_of_a_run_take_one_line_each_and_are_summed_up() {
    let told = err(&ran(Path::new("."), &["run", "01-pinned-beam-rough-floor"]));
    let notes: Vec<&str> = told.lines().filter(|l| l.starts_with("note: ")).collect();
    assert_eq!(notes.len(), 11, "{told}");
    assert!(
        notes.iter().all(|note| note.chars().count() <= 140),
        "{told}"
    );
    assert_eq!(
        notes.last(),
        Some(&"note: in total: increment damped 11 × (increment 50)")
    );
}

#[test]
fn a_body_that_is_loose_until_first_contact_is_named_once() {
    let deck = top("tests/decks/pressed-plates.inp");
    let told = err(&ran(Path::new("."), &["run", &deck]));
    let line = "note: loose until first contact: PLATES-2, increment 1";
    assert_eq!(told.lines().filter(|l| *l == line).count(), 1, "{told}");
}

#[test]
fn numbers_on_the_command_line_without_a_meaning_are_refused() {
    let snapshot = "snapshots/osc-tip-forced-to-sliding.ron";
    for (line, told) in [
        (
            "map osc-two6 --tolerance nan",
            "expected a number that is at least 0",
        ),
        (
            "map osc-two6 --tolerance=-1",
            "expected a number that is at least 0",
        ),
        (
            &format!("replay {snapshot} --tolerance nan"),
            "expected a number that is at least 0",
        ),
        (
            &format!("replay {snapshot} --tolerance inf"),
            "expected a number that is at least 0",
        ),
        (
            "chart osc-two6 --repeats 0",
            "expected a whole number from 1 to 1000",
        ),
        (
            "chart osc-two6 --repeats 1000000000",
            "expected a whole number from 1 to 1000",
        ),
        ("map osc-two6 --jobs 0", "expected a whole number from 1"),
        // A negative number is a value, not an option.
        ("map osc-two6 --jobs -1", "expected a whole number from 1"),
        (
            "map osc-two6 --tolerance -1",
            "expected a number that is at least 0",
        ),
        (
            "map --random 2 --seed -1",
            "expected a whole number, not negative",
        ),
        ("map --write x", "expected a whole number, not negative"),
        (
            "run osc-two6 --max-iterations 1.5",
            "expected a whole number, not negative",
        ),
        (
            "export osc-two6 -o a.svg --font -3",
            "a font has 4 to 200 pixels",
        ),
        (
            "export osc-two6 -o a.svg --size 100000x100000",
            "a picture has 100 to 8000 pixels per side",
        ),
        (
            "run osc-two6 --csv - --json -",
            "can write to standard output",
        ),
    ] {
        let refused = ran(Path::new("."), &words(line));
        assert_eq!(code(&refused), 2, "{line}: {}", err(&refused));
        assert!(err(&refused).contains(told), "{line}: {}", err(&refused));
    }
    well(&ran(
        Path::new("."),
        &["replay", snapshot, "--tolerance", "0.1"],
    ));
}

/// A node that has left all surfaces has no gap.
#[test]
fn a_node_off_all_surfaces_has_a_dash_for_a_gap() {
    let scene = "tests/findings/7-slid-onto-border-303-243.ron";
    let told = ran(Path::new("."), &["run", scene, "--csv", "-"]);
    let row = err(&told);
    let row = row.lines().find(|line| line.contains("l.40")).expect(&row);
    let cells: Vec<&str> = row.split_whitespace().collect();
    assert_eq!(cells[..3], ["l.40", "free", "-"], "{row}");
}

#[test]
fn no_output_replaces_the_input_or_writes_a_table_into_a_scene() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let scene = std::fs::read_to_string(top("problems/osc-snap.ron")).unwrap();
    std::fs::write(here.join("a.ron"), &scene).unwrap();
    std::fs::write(here.join("a"), &scene).unwrap();
    for line in [
        "run a.ron --csv a.ron",
        "run a.ron --trace a.ron",
        "run a.ron --snapshot a.ron",
        "run a.ron --snapshot ./a.ron",
        "record a.ron --at 1 -o a.ron",
        "export a.ron -o a.ron",
        "core a.ron -o a.ron",
        "study a.ron --vary settings.slip=step --csv a.ron",
        "map a.ron --over settings.majors=20,30 --csv a.ron",
        "map a.ron --over settings.majors=20,30 --svg a.ron",
        "run a --csv a",
        "run a --json a",
    ] {
        let output = ran(here, &[&words(line)[..], &["--force"]].concat());
        assert_eq!(code(&output), 2, "{line}: {}", err(&output));
        for file in ["a.ron", "a"] {
            let kept = std::fs::read_to_string(here.join(file)).unwrap();
            assert_eq!(kept, scene, "{line}");
        }
    }
}
