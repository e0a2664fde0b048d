//! Files in a session of the debugger, in a real pseudo-terminal: a journal that cannot be written, what is no file, what
//! would harm the terminal, and a terminal that goes away.

#![cfg(unix)]

use crate::terminal::*;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Stdio;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use stickslip::record::journal::{Journal, JournalError};
use stickslip::scene::{Scene, builtin};
use stickslip::tui::theme::Theme;
use stickslip::tui::{self, App};

const OSCILLATES: &str = "osc-inclined-cantilever";
const FLOOR: &str = "01-pinned-beam-rough-floor";

/// A session whose journals would be kept in something that is no directory.
fn homeless() -> (Session, tempfile::TempDir) {
    let state = tempfile::tempdir().unwrap();
    let home = state.path().join("file");
    std::fs::write(&home, "").unwrap();
    let session = Start::debugger(&[OSCILLATES])
        .variable("XDG_STATE_HOME", home.to_str().unwrap())
        .go();
    session.see("nothing is solved yet");
    (session, state)
}

/// What `resume --check` says of a journal.
#[track_caller]
fn check(journal: &Path) -> String {
    let checked = run(
        &["resume", "--check", journal.to_str().unwrap()],
        Stdio::null(),
    );
    let told = String::from_utf8_lossy(&checked.stderr).into_owned();
    assert_eq!(checked.status.code(), Some(0), "{told}");
    told
}

#[test]
fn a_journal_that_cannot_begin_is_told_whatever_is_done_first_and_another_can_be_begun() {
    for first in ["s", "n", "f", "c", ":rename x\r"] {
        let (mut session, _state) = homeless();
        session.type_and_see(first, "the journal could not be created: ");
        session.see("no journal (:journal FILE)");
        // It is not forgotten by what comes later.
        session.type_and_see(":watch gap\r", "gap beam.5");
        session.see("no journal (:journal FILE)");
        session.type_and_see(":journal\r", "the journal could not be written: ");
        session.keys("f");
        let file = session.directory.path().join("mine");
        session.type_and_see(":journal mine\r", "the journal is now written to mine");
        session.see_no_more("no journal");
        session.type_and_see(":rename later\r", "b1: later");
        session.keys("q");
        assert!(session.end().success());
        session.see("journal: mine (`stickslip resume mine` continues it)");
        let told = check(&file);
        assert!(
            told.contains("4 entries") && told.contains("replay is bit-identical"),
            "{told}"
        );
        let mode = std::fs::metadata(&file).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o600);
    }
}

#[test]
fn a_small_screen_says_too_that_there_is_no_journal_and_so_does_the_end() {
    let (mut session, _state) = homeless();
    session.resize(80, 24);
    session.keys("c");
    session.wait("the warning", |screen| {
        let text = screen.contents();
        text.lines().take(3).any(|line| line.contains("no journal"))
    });
    session.keys("q");
    assert!(session.end().success());
    session.see("no journal: ");
}

#[test]
fn a_journal_that_outgrows_the_disk_says_so_and_keeps_what_is_whole() {
    let line = format!("ulimit -f 12; exec {PROGRAM} {OSCILLATES} --journal j");
    let mut session = Start::program("sh", &["-c", &line]).go();
    session.see("nothing is solved yet");
    for k in 0..80 {
        let (key, shown) = [("s", "free → fixed"), ("S", "at the start")][k % 2];
        session.type_and_see(key, shown);
        if session.text().contains("no journal") {
            break;
        }
        session.type_and_see(&format!(":rename n{k}\r"), &format!("n{k}"));
        if session.text().contains("no journal") {
            break;
        }
    }
    session.see("no journal (:journal FILE)");
    session.see("the journal ends here: j: ");
    let file = session.directory.path().join("j");
    let bytes = std::fs::read(&file).unwrap();
    assert!(
        bytes.len() > 1000 && bytes.ends_with(b"\n"),
        "{}",
        bytes.len()
    );
    session.keys("q");
    assert!(session.end().success());
    session.see_restored();
    assert!(check(&file).contains("replay is bit-identical\n"));
}

#[test]
fn a_journal_that_could_not_begin_leaves_no_file() {
    let line = format!("ulimit -f 1; exec {PROGRAM} {FLOOR} --journal j");
    let mut session = Start::program("sh", &["-c", &line]).go();
    session.see("j: the journal cannot be written");
    assert_eq!(session.end().exit_code(), 2);
    assert!(!session.directory.path().join("j").exists());
    let scene = Scene::open(FLOOR, &[]).unwrap();
    let nowhere = Journal::create(Path::new("/dev/full"), &scene, &[]);
    assert!(matches!(nowhere, Err(JournalError::Exists(_))));
}

#[test]
fn on_quitting_a_line_says_where_the_journal_is_if_there_is_one() {
    let mut session = open(OSCILLATES);
    session.type_and_see("s", "minor 1");
    session.keys("q");
    assert!(session.end().success());
    session.see_restored();
    session.see("continues it)");
    assert_eq!(session.text().matches("journal: ").count(), 1);
    let mut session = open(OSCILLATES);
    session.see_taken();
    session.keys("q");
    assert!(session.end().success());
    session.see_restored();
    assert!(!session.text().contains("journal"), "{}", session.text());
}

#[test]
fn pipes_devices_and_folders_never_block_the_keys() {
    use rustix::fs::{CWD, Mode, mkfifoat};
    let mut session = open(OSCILLATES);
    session.type_and_see("s", "minor 1");
    let pipe = session.directory.path().join("pipe");
    mkfifoat(CWD, &pipe, Mode::RUSR | Mode::WUSR).unwrap();
    for (k, command) in [
        "open",
        "lesson",
        "chart",
        "snapshot",
        "snapshot!",
        "core",
        "core!",
        "export",
        "journal",
    ]
    .iter()
    .enumerate()
    {
        let told = if *command == "journal" {
            "already exists"
        } else {
            "is a pipe"
        };
        session.type_and_see(&format!(":{command} pipe\r"), told);
        session.type_and_see(&format!(":rename r{k}\r"), &format!("b1: r{k}"));
    }
    for command in ["open", "lesson", "chart", "snapshot!", "core!"] {
        session.type_and_see(&format!(":{command} /dev/zero\r"), "is a device");
        session.type_and_see(":rename x\r", "b1: x");
        session.type_and_see(":rename y\r", "b1: y");
    }
    session.quit();
}

#[test]
fn a_scene_that_takes_long_to_read_leaves_the_keys_alive_and_can_be_given_up() {
    let mut session = open(OSCILLATES);
    let mut text = builtin::find(FLOOR).unwrap().text.to_owned();
    // Some seconds of reading: the most that a file may have, and an error at its end.
    let rest = (8 << 20) - text.len() - 16;
    let row = "/* ( [ */ ";
    text = format!("{}{text})", row.repeat(rest / row.len()));
    std::fs::write(session.directory.path().join("large.ron"), text).unwrap();
    session.keys(":open large.ron\r");
    session.type_and_see("?", "Move through the iterations");
    session.keys("?");
    session.see("large.ron:");
    session.quit();
}

/// A lesson and a table that would set the terminal's title and turn what is written.
const LESSON: &str = r#"(title: "A\u{1b}]0;PWN\u{7}B", about: "a", scene: Name("osc-two6"),
    steps: [Text("read\u{202e}\u{1b}]0;PWN\u{7}\u{9b}31mme"), Press(text: "do", press: "s")])"#;
const CHART: &str = "scene,series,run,status,error,seconds\n\
    s\u{1b}]0;PWN\u{7},t\u{202e},r\u{9b}31m,whole,1e-3,0.1\n";

#[test]
fn orders_in_files_and_their_names_are_shown_on_the_screen_and_not_obeyed() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("n\u{1b}]0;PWN\u{7}.ron");
    std::fs::write(&file, builtin::find(OSCILLATES).unwrap().text).unwrap();
    std::fs::write(directory.path().join("lesson"), LESSON).unwrap();
    std::fs::write(directory.path().join("chart"), CHART).unwrap();
    let mut session = Start::debugger(&[file.to_str().unwrap()])
        .size(200, 40)
        .go();
    session.see("n\\u{1b}]0;PWN\\u{7}.ron");
    session.type_and_see("w", "wrote ");
    let folder = directory.path().display();
    session.type_and_see(&format!(":chart {folder}/chart\r"), "s\\u{1b}]0;PWN\\u{7}");
    session.see("t\\u{202e}");
    session.type_and_see("q", "nothing is solved yet");
    session.type_and_see(
        &format!(":lesson {folder}/lesson\r"),
        "A\\u{1b}]0;PWN\\u{7}B",
    );
    session.see("read\\u{202e}\\u{1b}]0;PWN\\u{7}\\u{9b}31mme");
    session.type_and_see(":open x\u{202e}y\r", "no such file or built-in scene");
    let seen = Arc::clone(&session.seen);
    session.quit();
    let raw = String::from_utf8_lossy(&seen.lock().unwrap().raw).into_owned();
    let raw = raw.replace("\u{1b}]11;?\u{1b}\\", "");
    for harm in ["\u{1b}]", "\u{7}", "\u{202e}", "\u{9b}"] {
        assert!(!raw.contains(harm), "{harm:?}");
    }
}

/// Tells the copies of this test program that the next test starts which part they play.
const PART: &str = "STICKSLIP_TEST_PART";

/// Not a test by itself: with a part to play, it draws on a terminal that is no more.
#[test]
fn draws_on_nothing() {
    if std::env::var(PART).as_deref() != Ok("gone") {
        return;
    }
    let ignored: Arc<AtomicBool> = Arc::default();
    signal_hook::flag::register(signal_hook::consts::SIGHUP, ignored).unwrap();
    let mut terminal = tui::terminal::Terminal::enter().unwrap();
    let app = App::new(Theme::mono(), tui::debugger::offers());
    terminal.draw(&app, None).unwrap();
    let gone = patiently(|| {
        // The test waits for something to be drawn.
        let _ = terminal.forget().and_then(|()| terminal.draw(&app, None));
        tui::terminal::is_gone().then_some(())
    });
    let failed = terminal.draw(&app, None).is_err();
    drop(terminal);
    std::process::exit(if gone.is_some() && failed { 7 } else { 8 });
}

#[test]
fn to_draw_on_a_terminal_that_is_gone_is_an_error_and_no_panic() {
    let program = std::env::current_exe().unwrap();
    let arguments = [
        "--exact",
        "session_files::draws_on_nothing",
        "--nocapture",
        "--test-threads=1",
    ];
    let session = Start::program(program.to_str().unwrap(), &arguments)
        .variable(PART, "gone")
        .go();
    session.see_taken();
    session.see("a step-through debugger");
    let mut child = session.hang_up();
    let status = patiently(|| child.try_wait().unwrap()).unwrap();
    assert_eq!(status.exit_code(), 7);
}

#[test]
fn a_terminal_that_goes_away_while_it_is_drawn_on_ends_the_program_as_a_hangup_does() {
    for k in 0..12 {
        let mut session = Start::debugger(&["osc-three10", "--no-journal"]).go();
        session.see_taken();
        // Something new is to be drawn all the time.
        session.keys(&"s\u{c}".repeat(40 * k));
        if k % 2 == 0 {
            session.resize(60 + 5 * k as u16, 30);
        }
        let mut child = session.hang_up();
        let status = patiently(|| child.try_wait().unwrap()).unwrap();
        assert_eq!(status.signal(), Some("Hangup"), "{status}");
    }
}

#[test]
fn q_right_after_an_export_leaves_when_the_file_is_written() {
    let mut session = open(OSCILLATES);
    session.type_and_see("s", "minor 1");
    session.keys(":export a.svg\rq");
    let file = session.directory.path().join("a.svg");
    assert!(session.end().success());
    assert!(file.exists());
}
