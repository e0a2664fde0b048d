//! Files and names that try to harm the terminal.

#![cfg(unix)]

use crate::hostile::{CHART, CYCLES, LESSON, REFERENCE, STUDY, put, run, scene};
use crate::program::{code, err, names, out, rows, well};
use std::fs;
use stickslip::record::journal::JournalTarget;
use stickslip::scene::Scene;
use stickslip::scene::shown;
use stickslip::session::Session;
use tempfile::TempDir;

/// What would set a title, ring, clear the screen, turn the writing, and colour by C1.
const ORDERS: &str = "\u{1b}]0;PWN\u{7}\u{202e}\u{1b}[2J\u{9b}31m";

const SHOWN: &str = "\\u{1b}]0;PWN\\u{7}\\u{202e}\\u{1b}[2J\\u{9b}31m";

/// A text with the orders in it, as RON writes them.
fn in_ron(text: &str) -> String {
    text.replace("ORDERS", SHOWN)
}

/// A directory with one file of every kind, each with orders in it wherever a text can be.
fn harmful() -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    put(&directory, "study.ron", &in_ron(STUDY));
    put(&directory, "lesson.ron", &in_ron(LESSON));
    put(&directory, "chart.csv", &CHART.replace("ORDERS", ORDERS));
    put(
        &directory,
        "reference.csv",
        &REFERENCE.replace("ORDERS", ORDERS),
    );
    let path = directory.path().join("j");
    let mut session = Session::new(Scene::open(CYCLES, &[]).unwrap());
    JournalTarget::File(path.clone())
        .begin(&mut session)
        .unwrap();
    for line in ["step", "rename x", "watch gap a"] {
        use stickslip::action::{Action, Context, parse};
        let context = Context {
            model: Some(session.model()),
            ..Context::default()
        };
        let Ok(Action::Session(command)) = parse(line, &context) else {
            panic!("{line}")
        };
        session.submit(command).unwrap();
        session.wait();
    }
    let text = fs::read_to_string(&path).unwrap();
    put(
        &directory,
        "story.journal",
        &text.replace("said:\"", &format!("said:\"{SHOWN}")),
    );
    let other = text
        .replace("version:\"", &format!("version:\"{SHOWN}"))
        .replace("name:\"osc", &format!("name:\"{SHOWN}osc"))
        .replace("digest:\"", "digest:\"1");
    put(&directory, "resume.journal", &other);
    let scene = scene(CYCLES);
    put(&directory, &format!("{ORDERS}.ron"), &scene);
    put(
        &directory,
        &format!("{ORDERS}wrong.ron"),
        &scene.replacen("title", "tittle", 1),
    );
    directory
}

#[test]
fn orders_to_the_terminal_out_of_files_and_their_names_are_shown_everywhere_and_nowhere_obeyed() {
    let directory = harmful();
    let (good, wrong) = (format!("{ORDERS}.ron"), format!("{ORDERS}wrong.ron"));
    let (good, wrong) = (good.as_str(), wrong.as_str());
    let study_csv = format!("{ORDERS}.csv");
    let cases: &[(&[&str], i32)] = &[
        (
            &[
                "study",
                "study.ron",
                "--csv",
                "study.csv",
                "--svg",
                "study.svg",
            ],
            0,
        ),
        (&["study", good, "--csv", "-", "--vary", "refine=1"], 0),
        (&["lesson", "--check", "lesson.ron"], 0),
        (
            &[
                "chart",
                "--from",
                "chart.csv",
                "--csv",
                "made.csv",
                "--svg",
                "chart.svg",
            ],
            0,
        ),
        (&["chart", "--from", "chart.csv", "--csv", "-"], 0),
        (
            &[
                "chart",
                CYCLES,
                "--over",
                "settings.strategy=ladder,lemke",
                "--reference",
                "reference.csv",
                "--repeats",
                "1",
                "--csv",
                "-",
                "--svg",
                "reference.svg",
            ],
            0,
        ),
        (&["story", "story.journal"], 0),
        (&["story", "resume.journal"], 0),
        (&["resume", "--check", "resume.journal"], 1),
        (&["check", good], 0),
        (&["check", good, "--paths"], 0),
        (&["check", wrong], 2),
        (&["run", good, "--csv", &study_csv], 3),
        (&["run", good, "--set", ORDERS], 2),
        (&["run", good, "--set", "refine=\u{1b}]0;x\u{7}"], 2),
        (&["remedies", good], 0),
        (&["core", good], 0),
        (&["record", good, "--at", "1.1.1"], 0),
        (
            &[
                "map",
                good,
                "--strategies",
                "ladder,lemke",
                "--csv",
                "-",
                "--svg",
                "map.svg",
            ],
            0,
        ),
        (&["check", ORDERS], 2),
        (&["study", ORDERS], 2),
        (&["lesson", ORDERS], 2),
        (&["story", ORDERS], 2),
        (&["diff", ORDERS, ORDERS], 2),
        (&["run", "a", ORDERS], 2),
        (&[ORDERS, ORDERS], 2),
    ];
    for (arguments, wanted) in cases {
        let output = run(&directory, arguments);
        let (out, err) = (out(&output), err(&output));
        assert_eq!(code(&output), *wanted, "{arguments:?}: {err}");
        let told = out + &err;
        let harm = |c: char| shown::is_order(c) && c != '\n' && c != '\t';
        assert!(!told.contains(harm), "{arguments:?}: {told:?}");
        // Neither escapes of RON count here nor a file whose name is not told.
        let quiet = ["core", "lesson", "chart", "remedies", "record"].contains(&arguments[0])
            && *wanted == 0;
        let quiet = quiet || arguments.contains(&"--paths");
        assert!(quiet || told.contains("\\u{1b}"), "{arguments:?}: {told}");
    }
    for name in [
        "study.csv",
        "study.svg",
        "made.csv",
        "chart.svg",
        "reference.svg",
        "map.svg",
    ] {
        let text = fs::read_to_string(directory.path().join(name)).unwrap();
        let harm = text.contains(|c| shown::is_order(c) && !"\n\t\r".contains(c));
        assert!(
            !harm && (text.contains("\\u{1b}") || name == "study.csv"),
            "{name}: {text}"
        );
    }
    let again = well(&run(
        &directory,
        &["chart", "--from", "made.csv", "--csv", "-"],
    ));
    assert!(rows(&again)[0]["series"].starts_with(SHOWN), "{again}");
    // A snapshot is not called as the scene's file would have it.
    let made = names(directory.path());
    let ours = made.iter().filter(|name| name.ends_with("-1.1.1.ron"));
    assert!(
        ours.into_iter().all(|name| !name.contains(shown::is_order)),
        "{made:?}"
    );
}
