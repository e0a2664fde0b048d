//! What the tests of hostile files share: the program run with a deadline, and what it refuses in one line.

#![cfg(unix)]

use crate::program::{code, err, out, program};
use std::fs;
use std::process::{Output, Stdio};
use std::time::{Duration, Instant};
use stickslip::scene::builtin;
use tempfile::TempDir;

pub const CYCLES: &str = "osc-two6";

/// Far more than a refusal takes, since the machine may be busy with other tests.
pub const DEADLINE: Duration = Duration::from_secs(60);

/// Runs the program, and does not wait forever.
#[track_caller]
pub fn run(directory: &TempDir, arguments: &[&str]) -> Output {
    let mut child = program(directory.path(), arguments)
        .env("XDG_STATE_HOME", directory.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // What it says fits into a pipe.
    let begin = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if begin.elapsed() > DEADLINE {
            child.kill().unwrap();
            panic!("it waits forever: {arguments:?}");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    child.wait_with_output().unwrap()
}

/// What it says where it refuses something: one line, not longer than one can read.
#[track_caller]
pub fn refusal(directory: &TempDir, arguments: &[&str]) -> String {
    let output = run(directory, arguments);
    let told = err(&output);
    assert_eq!(code(&output), 2, "{arguments:?}: {told}");
    assert_eq!(out(&output), "", "{arguments:?}");
    assert!(
        told.lines().count() == 1 && told.len() < 2000,
        "{arguments:?}: {told}"
    );
    told
}

pub fn put(directory: &TempDir, name: &str, text: &str) {
    fs::write(directory.path().join(name), text).unwrap();
}

pub fn scene(name: &str) -> String {
    builtin::find(name).unwrap().text.to_owned()
}

pub const STUDY: &str = r#"(title: "ORDERSA study", about: "Why ORDERS not", scene: "osc-two6",
    set: [("settings.strategy", "table2")], vary: [("history.increment", [0.5])])"#;

pub const LESSON: &str = r#"(title: "ORDERSA lesson", about: "ORDERSabout", scene: Name("osc-two6"),
    steps: [Text("ORDERSread"), Press(text: "ORDERSdo", press: "s"),
    Ask(text: "ORDERSsay", answer: Mode(node: "a"), hint: "ORDERSh", then: "ORDERSt")])"#;

pub const CHART: &str = "# ORDERSwhere from\nscene,series,run,status,error,seconds\n\
    ORDERSscene,\"ORDERSone, two\",ORDERSrun=1,whole,1e-3,0.1\n\
    ORDERSscene,\"ORDERSone, two\",ORDERSrun=2,ORDERSfailed,,0.2\n";

pub const REFERENCE: &str = "# ORDERSof whom\nload,u_x,u_y\n1,0.5,0.1\n";

pub const CONTACTS: &str = r#"Contacts(
    title: "t",
    contacts: [
        (id: "a", gap: 0.5, friction: (angle: 20.0), load: (-1.0, 0.25)),
        (id: "b", friction: (angle: 9.0), load: (0.0, 1.0)),
    ],
    matrix: Stiffness([
        [4.0, 0.0, 0.0, 0.0],
        [0.0, 3.0, 0.0, 0.0],
        [0.0, 0.0, 2.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ]),
    history: (path: [0, 1], increment: 0.5),
)"#;

/// Every command that reads a file, with `FILE` for it.
pub const READERS: &[&str] = &[
    "check FILE",
    "run FILE",
    "record FILE --at 1",
    "remedies FILE",
    "core FILE",
    "study FILE",
    "map FILE",
    "chart FILE",
    "lesson --check FILE",
    "story FILE",
    "resume --check FILE",
    "audit FILE",
    "replay FILE",
    "diff FILE FILE",
    "chart --from FILE",
    "chart osc-two6 --reference FILE",
    "map osc-two6 --resume FILE",
    "map --random 1 --resume FILE",
];

pub fn reader<'a>(line: &'a str, file: &'a str) -> Vec<&'a str> {
    let words = line.split(' ');
    words
        .map(|word| if word == "FILE" { file } else { word })
        .collect()
}

pub fn pipe(directory: &TempDir, name: &str) {
    use rustix::fs::{CWD, Mode, mkfifoat};
    mkfifoat(CWD, directory.path().join(name), Mode::RUSR | Mode::WUSR).unwrap();
}
