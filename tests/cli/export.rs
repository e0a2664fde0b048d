//! Files made of what is there: the kind by the extension, whole, with the same bytes every time.

use crate::program::{code, err, names, out, ran, refused, well};
use std::path::Path;
use std::process::Output;

const OSC: &str = "osc-inclined-cantilever";
const ROUGH: &str = "02-two-cantilevers-rough";

fn exported(directory: &Path, arguments: &[&str]) -> Output {
    ran(directory, &[&["export"], arguments].concat())
}

fn read(directory: &Path, file: &str) -> String {
    std::fs::read_to_string(directory.join(file)).unwrap()
}

/// The texts of a picture, each on a line.
fn texts(svg: &str) -> String {
    let lines = svg
        .lines()
        .filter(|line| !line.trim_start().starts_with('<'));
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn a_picture_says_which_state_it_is_of_whether_the_scene_converges_or_fails() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let output = exported(here, &[ROUGH, "-o", "end.svg"]);
    assert_eq!(code(&output), 0, "{}", err(&output));
    let svg = texts(&read(here, "end.svg"));
    assert!(svg.contains("accepted; end of the history."), "{svg}");
    for word in [
        "free",
        "sliding",
        "fixed",
        "contact force ",
        "length ",
        "outward side",
        "F_n",
        "T_max",
        "gap",
    ] {
        assert!(svg.contains(word), "{word}: {svg}");
    }
    assert!(
        svg.contains("Modes by minor iteration") && svg.contains("✓"),
        "{svg}"
    );
    assert!(
        svg.contains(ROUGH) && svg.contains("strategy ladder. stickslip "),
        "{svg}"
    );
    let output = exported(here, &[OSC, "-o", "failed.svg"]);
    assert_eq!(code(&output), 0, "{}", err(&output));
    assert!(err(&output).contains("exporting this state"));
    let svg = texts(&read(here, "failed.svg"));
    assert!(
        svg.contains("increment 1, major 1, minor 2, load 0.05: last state; the increment failed: cycle of period 2"),
        "{svg}"
    );
    assert!(svg.contains("✗") && svg.contains("beam.5"), "{svg}");
}

#[test]
fn a_long_name_is_cut_where_it_would_cover_the_mode() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let text = std::fs::read_to_string("problems/osc-two6.ron").unwrap();
    let text = text.replace("\"a\"", "\"a-name-of-more-than-20-letters\"");
    std::fs::write(here.join("long.ron"), text).unwrap();
    exported(here, &["long.ron", "-o", "a.svg"]);
    let svg = texts(&read(here, "a.svg"));
    assert!(svg.contains("a-name-of-more-than-…"), "{svg}");
}

#[test]
fn a_picture_is_of_the_place_that_is_asked_for_or_there_is_none() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let output = exported(here, &[ROUGH, "-o", "a.svg", "--at", "2.1.1"]);
    assert_eq!(code(&output), 0, "{}", err(&output));
    assert!(texts(&read(here, "a.svg")).contains("increment 2, major 1, minor 1, load "));
    for (scene, at, wanted) in [(ROUGH, "100000", 2), (ROUGH, "1.90.1", 2), (OSC, "2", 3)] {
        let output = exported(here, &[scene, "-o", "none.svg", "--at", at]);
        assert_eq!(code(&output), wanted, "{at}: {}", err(&output));
    }
    assert_eq!(names(here), ["a.svg"]);
}

#[test]
fn the_same_state_gives_the_same_bytes() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let journal = format!(
        "{}/tests/journals/up-the-ladder.journal",
        env!("CARGO_MANIFEST_DIR")
    );
    for (input, ending) in [
        (OSC, "svg"),
        (OSC, "png"),
        (OSC, "dat"),
        (journal.as_str(), "cast"),
    ] {
        let files = ["a", "b"].map(|name| format!("{name}.{ending}"));
        for file in &files {
            let output = exported(here, &[input, "-o", file]);
            assert_eq!(code(&output), 0, "{}", err(&output));
        }
        let bytes = files.map(|file| std::fs::read(here.join(file)).unwrap());
        assert!(!bytes[0].is_empty() && bytes[0] == bytes[1], "{ending}");
    }
    // A bitmap with as many pixels as it says.
    let png = std::fs::read(here.join("a.png")).unwrap();
    let decoder = png::Decoder::new(std::io::Cursor::new(png));
    let reader = decoder.read_info().unwrap();
    assert_eq!(reader.info().width, 1960);
}

#[test]
fn nothing_is_overwritten_unasked_and_an_unknown_extension_lists_the_known_ones() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("mine.svg"), "mine").unwrap();
    let output = exported(here, &[OSC, "-o", "mine.svg"]);
    assert_eq!(code(&output), 2);
    assert!(err(&output).contains("exists already") && err(&output).contains("--force"));
    assert_eq!(read(here, "mine.svg"), "mine");
    assert_eq!(
        code(&exported(here, &[OSC, "-o", "mine.svg", "--force"])),
        0
    );
    assert!(read(here, "mine.svg").starts_with("<svg"));
    for file in ["a.bmp", "a", "-"] {
        let output = exported(here, &[OSC, "-o", file]);
        assert_eq!(code(&output), 2, "{file}");
        for known in [".svg (", ".png (", ".ron (", ".dat (", ".cast ("] {
            assert!(err(&output).contains(known), "{file}: {}", err(&output));
        }
    }
    for (arguments, told) in [
        (
            &[OSC, "-o", "a.svg", "--frozen"][..],
            "--frozen cannot be used with .svg",
        ),
        (&[OSC, "-o", "a.cast"], "made from a journal"),
        (&["no-such-scene", "-o", "a.svg"], "no such file"),
    ] {
        let output = exported(here, arguments);
        refused(&output, told);
    }
    assert_eq!(names(here), ["mine.svg"]);
}

#[test]
fn a_snapshot_is_drawn_where_it_was_taken_and_gives_its_scene_back() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let snapshot = format!(
        "{}/snapshots/osc-tip-forced-to-sliding.ron",
        env!("CARGO_MANIFEST_DIR")
    );
    let output = exported(here, &[&snapshot, "-o", "a.svg"]);
    assert_eq!(code(&output), 0, "{}", err(&output));
    let svg = texts(&read(here, "a.svg"));
    assert!(svg.contains("beam.5") && svg.contains("sliding"), "{svg}");
    // What the user did is told.
    assert!(svg.contains("osc-inclined-cantilever, with "), "{svg}");
    well(&exported(here, &[&snapshot, "-o", "scene.ron"]));
    let checked = ran(here, &["check", "scene.ron"]);
    assert!(
        well(&checked).starts_with("scene.ron: sound"),
        "{}",
        err(&checked)
    );
    let output = exported(here, &[&snapshot, "-o", "b.svg", "--at", "1"]);
    refused(&output, "--at is for scenes");
}

#[test]
fn a_scene_is_written_as_its_author_did_or_with_what_was_set() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    well(&exported(here, &[OSC, "-o", "as-it-is.ron"]));
    assert_eq!(read(here, "as-it-is.ron"), well(&ran(here, &["show", OSC])));
    well(&exported(
        here,
        &[OSC, "-o", "set.ron", "--set", "friction.angle=12.5"],
    ));
    let paths = well(&ran(here, &["check", "set.ron", "--paths"]));
    assert!(paths.contains("friction.angle\t12.5\t"), "{paths}");
    let run = |scene: &[&str]| {
        let arguments = [
            &["run"],
            scene,
            &["--set", "settings.strategy=ladder", "--csv", "-"],
        ];
        well(&ran(here, &arguments.concat()))
    };
    assert_eq!(
        run(&["set.ron"]),
        run(&[OSC, "--set", "friction.angle=12.5"])
    );
}

/// Modes and forces that a run of a frozen problem tells in the end.
fn answers(directory: &Path, file: &str) -> Vec<(String, f64, f64)> {
    let arguments = [
        "record",
        file,
        "--set",
        "settings.strategy=census",
        "--at",
        "1",
        "-o",
        "-",
    ];
    let text = well(&ran(directory, &arguments));
    let row = |line: &str| {
        let field = |name: &str| {
            let rest = line.split_once(&format!("{name}: "))?.1;
            Some(rest.split([',', ')']).next()?.trim().to_owned())
        };
        let number = |name: &str| field(name)?.parse::<f64>().ok();
        Some((field("mode")?, number("f_n")?, number("f_t")?))
    };
    text.lines().filter_map(row).collect()
}

#[test]
fn a_problem_for_siconos_has_the_answers_of_the_frozen_problem() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    for (scene, at) in [
        (OSC, "1.1.1"),
        ("osc-two3", "1.1.1"),
        ("osc-zig3", "1.1.1"),
        (ROUGH, "4.1.1"),
        (ROUGH, "6"),
    ] {
        for file in ["a.ron", "a.dat"] {
            let arguments = [scene, "-o", file, "--at", at, "--frozen", "--force"];
            let output = exported(here, &arguments);
            assert_eq!(code(&output), 0, "{scene} {at}: {}", err(&output));
        }
        let (ours, theirs) = (answers(here, "a.ron"), answers(here, "a.dat"));
        assert!(!ours.is_empty() && ours.len() == theirs.len(), "{scene}");
        let largest = ours
            .iter()
            .map(|(_, n, t)| n.hypot(*t))
            .fold(1e-12, f64::max);
        for (a, b) in ours.iter().zip(&theirs) {
            let off = (a.1 - b.1).hypot(a.2 - b.2) / largest;
            assert!(
                a.0 == b.0 && off < 1e-6,
                "{scene} {at}: {ours:?} {theirs:?}"
            );
        }
    }
}

#[test]
fn what_no_file_can_say_is_refused_and_leaves_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let cohesive = exported(here, &["osc-coh-none", "-o", "a.dat", "--at", "1.1.1"]);
    assert_eq!(code(&cohesive), 3, "{}", err(&cohesive));
    let words = "cohesion, which only .ron files support";
    assert!(err(&cohesive).contains(words), "{}", err(&cohesive));
    assert_eq!(out(&cohesive), "");
    assert!(names(here).is_empty());
}

#[test]
fn a_film_is_an_asciicast_whose_times_rise_and_which_names_what_was_done() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let journal = format!(
        "{}/tests/journals/forced-and-turned.journal",
        env!("CARGO_MANIFEST_DIR")
    );
    well(&exported(here, &[&journal, "-o", "a.cast"]));
    let cast = read(here, "a.cast");
    let mut lines = cast.lines();
    let head = lines.next().unwrap();
    assert!(
        head.starts_with("{\"version\": 2, \"width\": 120, \"height\": 36,"),
        "{head}"
    );
    assert!(!head.contains("timestamp"), "{head}");
    let (mut last, mut marks) = (0.0, 0);
    for line in lines {
        let inner = line
            .strip_prefix('[')
            .and_then(|l| l.strip_suffix(']'))
            .unwrap();
        let (time, rest) = inner.split_once(", ").unwrap();
        let time: f64 = time.parse().unwrap();
        assert!(time >= last, "{line}");
        last = time;
        marks += usize::from(rest.starts_with("\"m\", "));
        assert!(
            rest.starts_with("\"o\", \"") || rest.starts_with("\"m\", \""),
            "{line}"
        );
    }
    let entries = std::fs::read_to_string(&journal)
        .unwrap()
        .matches("Done(")
        .count();
    assert_eq!(marks, entries);
    assert!(cast.contains("Forced beam.5 to sliding"), "{cast}");
}

#[test]
fn a_part_of_a_picture_has_the_requested_size_and_options_of_pictures_are_refused_elsewhere() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    for (part, wanted) in [
        ("shape", "Displacements magnified ×"),
        ("timeline", "Modes by minor iteration"),
        ("chart", "load factor"),
        ("cone", "T_max found"),
    ] {
        let file = format!("{part}.svg");
        let size = ["--only", part, "--size", "1280x720", "--font", "20"];
        let scene = ["01-pinned-beam-rough-floor", "--at", "3", "-o", &file];
        let output = exported(here, &[&scene[..], &size].concat());
        assert_eq!(code(&output), 0, "{}", err(&output));
        let svg = read(here, &file);
        assert!(svg.contains("1280") && svg.contains("720"), "{svg}");
        assert!(texts(&svg).contains(wanted), "{part}: {}", texts(&svg));
        let table = texts(&svg).contains("slave node");
        assert!(!table, "{part} is the only part");
        // No side of the beam has pressures, so that none is drawn or named.
        assert!(!texts(&svg).contains("pressure"), "{}", texts(&svg));
    }
    // The timeline of one node fills its picture with bands; the numbers of the axes are round.
    for (part, wanted) in [
        ("timeline", &["50.12", "50.11", "50.10", "50.9", "50.8"][..]),
        ("chart", &["−0.014", "−0.01", "−0.004", "0.05", "0.25"]),
    ] {
        let scene = ["01-pinned-beam-rough-floor", "-o", "whole.svg", "--force"];
        let size = ["--only", part, "--size", "1920x1080", "--font", "20"];
        assert_eq!(code(&exported(here, &[&scene[..], &size].concat())), 0);
        let seen = texts(&read(here, "whole.svg"));
        let lines: Vec<&str> = seen.lines().map(str::trim).collect();
        assert!(wanted.iter().all(|text| lines.contains(text)), "{seen}");
        let bands = lines.iter().filter(|line| **line == "beam.5").count();
        assert!((part == "chart") == (bands < 5), "{seen}");
    }
    let png = [
        "01-pinned-beam-rough-floor",
        "--at",
        "1",
        "--size",
        "1280x720",
        "-o",
        "a.png",
    ];
    assert_eq!(code(&exported(here, &png)), 0);
    let bytes = std::fs::read(here.join("a.png")).unwrap();
    let side = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    assert_eq!((side(16), side(20)), (1280, 720));
    for (arguments, wanted) in [
        (
            &[OSC, "-o", "a.ron", "--only", "cone"][..],
            "--only is for pictures only",
        ),
        (
            &[OSC, "-o", "a.svg", "--only", "moon"],
            "possible values: shape, timeline, chart, cone",
        ),
        (
            &[OSC, "-o", "a.svg", "--size", "9x9"],
            "a picture has 100 to 8000 pixels per side",
        ),
        (
            &[OSC, "-o", "a.svg", "--node", "beam.5"],
            "--node selects the contact of --only cone",
        ),
        (
            &[OSC, "-o", "a.svg", "--only", "cone", "--node", "tip"],
            "unknown slave node 'tip'; known: beam.5",
        ),
        (
            &[OSC, "-o", "a.svg", "--size", "400x300", "--font", "60"],
            "use a smaller --font",
        ),
    ] {
        let output = exported(here, arguments);
        assert!(
            err(&output).contains(wanted),
            "{arguments:?}: {}",
            err(&output)
        );
        assert_ne!(code(&output), 0);
    }
}
