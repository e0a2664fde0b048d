//! Whole sessions: the real program in a real pseudo-terminal, keys in, screens out.
//!
//! A terminal emulator reads what the program writes, and each test waits for what a person would see. Nothing waits
//! for a fixed time: a test goes on as soon as the screen shows what it must, and fails when that takes too long.

#![cfg(unix)]

use crate::terminal::*;
use rustix::fs::{self, OFlags};
use rustix::io::ioctl_fionread;
use std::path::PathBuf;
use std::process::Stdio;
use std::sync::Arc;
use std::thread;
use stickslip::scene::{Scene, builtin};
use stickslip::teach;
use stickslip::tui;
use tempfile::TempDir;
use vt100::Screen;

const FLOOR: &str = "01-pinned-beam-rough-floor";
const CANTILEVERS: &str = "02-two-cantilevers-rough";
const OSCILLATES: &str = "osc-inclined-cantilever";

const CTRL_C: &str = "\x03";
const CTRL_Z: &str = "\x1a";
const ESC: &str = "\x1b";
const UP: &str = "\x1b[A";
const DOWN: &str = "\x1b[B";

/// The snapshots that a session left behind.
fn snapshots(session: &Session) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(session.directory.path()).unwrap();
    entries.map(|entry| entry.unwrap().path()).collect()
}

#[test]
fn a_whole_session_steps_back_and_forth_interferes_records_and_leaves_no_trace() {
    let mut session = open(FLOOR);
    session.see_taken();
    assert!(session.before.contains("ECHO") && session.before.contains("ICANON"));
    session.keys("s");
    session.see_picture(FLOOR, "s", 120, 40);
    session.keys("5s");
    session.see_picture(FLOOR, "s s s s s s", 120, 40);
    session.keys("n");
    session.see_picture(FLOOR, "6 s n", 120, 40);
    session.keys("f");
    session.see_picture(FLOOR, "6 s n f", 120, 40);
    session.type_and_see("S", " steps");
    session.see_picture(FLOOR, "6 s n f S", 120, 40);

    session.type_and_see("m", "mode of beam.5:");
    session.type_and_see("x", "◇ 1 forced");
    session.see("beam.5 is fixed in the next minor iteration");
    session.type_and_see("M", "beam.5 follows Table 2 again");
    session.see_no_more("◇ 1 forced");
    session.type_and_see("m", "mode of beam.5:");
    session.type_and_see("X", "◆ 1 held");
    session.type_and_see("M", "beam.5 follows Table 2 again");
    session.see_no_more("◆ 1 held");

    session.type_and_see("i", "new increment (now 0.01):");
    session.type_and_see("0.005\r", "increment 0.005 (scene: 0.01)");
    session.type_and_see("s", "attempt 2");
    session.type_and_see("w", ".ron");

    let files = snapshots(&session);
    assert_eq!(files.len(), 1, "{files:?}");
    let replayed = run(&["replay", files[0].to_str().unwrap()], Stdio::null());
    assert_eq!(replayed.status.code(), Some(0), "{replayed:?}");
    session.quit();
}

#[test]
fn the_cycle_that_the_paper_s_rule_runs_into_is_left_by_forcing_the_tip_to_slide() {
    let mut session = open(OSCILLATES);
    session.type_and_see("c", "period 2 from minor 1");
    session.see("✗");
    session.type_and_see("m", "mode of beam.5:");
    session.type_and_see("s", "◇ 1 forced");
    session.type_and_see("c", "the history is complete");
    session.see("load 1 accepted");
    session.quit();
}

#[test]
fn without_a_scene_the_built_in_ones_are_offered_and_enter_opens_one() {
    let mut session = Start::debugger(&[]).size(80, 36).go();
    session.see("Choose a scene");
    session.type_and_see(DOWN, &format!("▸ {}", teach::list()[1].name));
    session.type_and_see(UP, &format!("▸ {}", teach::list()[0].name));
    for scene in builtin::list() {
        session.type_and_see(scene.name, &format!("Choose: {}▏", scene.name));
        session.see(&format!("▸ {}", scene.name));
        session.type_and_see(ESC, "type to find one");
    }
    session.type_and_see(FLOOR, &format!("▸ {FLOOR}"));
    session.keys("\r");
    session.see_picture(FLOOR, "", 80, 36);
    session.quit();
    let mut session = Start::debugger(&[]).go();
    session.see("Choose a scene");
    // Ctrl-C is no way out, q is.
    session.type_and_see(CTRL_C, "nothing is running; q quits");
    session.quit();
}

#[test]
fn commands_are_typed_completed_recalled_and_refused() {
    let mut session = open(FLOOR);
    session.type_and_see(":ste\t", ":step ");
    session.keys("3\r");
    session.see_picture(FLOOR, "3 s", 120, 40);
    session.type_and_see(":frobnicate\r", "unknown action 'frobnicate'");
    session.type_and_see(&format!(":{UP}{UP}"), ":step 3");
    session.keys("\r");
    session.see_picture(FLOOR, "6 s", 120, 40);
    session.type_and_see(":increment -1\r", "invalid increment '-1'");
    session.quit();
}

#[test]
fn help_opens_scrolls_and_closes() {
    let mut session = open(FLOOR);
    session.type_and_see("?", "Move through the iterations");
    session.type_and_see("G", "closer to switching than the tolerance");
    session.keys(ESC);
    session.see_picture(FLOOR, "? Esc", 120, 40);
    session.type_and_see("?", "Move through the iterations");
    session.keys("?");
    session.see_picture(FLOOR, "? ?", 120, 40);
    session.quit();
}

#[test]
fn nodes_are_found_by_a_part_of_their_name() {
    let mut session = open(CANTILEVERS);
    let model = Scene::open(CANTILEVERS, &[]).unwrap().model;
    let name = |slave: usize| model.nodes[model.contacts[slave].node].name.clone();
    let last = name(model.contacts.len() - 1);
    session.see(&format!("Decision  {}", name(0)));
    session.type_and_see(&format!("/{last}\r"), &format!("Decision  {last}"));
    session.type_and_see("/nowhere\r", "no slave node name contains 'nowhere'");
    session.see(&format!("Decision  {last}"));
    session.quit();
}

#[test]
fn every_size_is_drawn_and_a_changed_one_drawn_anew() {
    let mut session = open(FLOOR);
    session.keys("3s");
    session.see_picture(FLOOR, "3 s", 120, 40);
    for (width, height) in [(80, 24), (200, 60), (20, 5), (1, 1), (120, 40)] {
        session.resize(width, height);
        session.see_picture(FLOOR, "3 s", width, height);
    }
    session.quit();
    for (width, height) in [(20, 5), (80, 24), (200, 60)] {
        let session = Start::debugger(&[FLOOR]).size(width, height).go();
        session.see_picture(FLOOR, "", width, height);
        session.quit();
    }
}

#[test]
fn a_screen_that_somebody_else_wrote_on_is_drawn_anew_when_asked() {
    let mut session = open(FLOOR);
    session.see_picture(FLOOR, "", 120, 40);
    session
        .seen
        .lock()
        .unwrap()
        .parser
        .process(b"\x1b[20;3Hnoise");
    session.see("noise");
    session.keys(CTRL_L);
    session.see_picture(FLOOR, "", 120, 40);
    session.quit();
}

/// Opens a scene that takes hundreds of thousands of minor iterations, and sets it going.
fn long_run() -> Session {
    let mut session = Start::debugger(&[FLOOR, "--set", "history.increment=1e-6"]).go();
    session.see("nothing is solved yet");
    session.type_and_see("c", "solving: load");
    session
}

/// The number before "steps so far".
fn steps(session: &Session) -> Option<u64> {
    let text = session.text();
    let (before, _) = text.split_once(" steps so far")?;
    before.rsplit(' ').next()?.parse().ok()
}

#[test]
fn keys_are_answered_while_the_solver_runs_and_ctrl_c_stops_it_alone() {
    let mut session = long_run();
    session.type_and_see("?", "Move through the iterations");
    session.keys("?");
    session.see_no_more("Move through the iterations");
    session.type_and_see("s", "s waits until the run stops; Ctrl-C interrupts it");
    let now = patiently(|| steps(&session)).unwrap();
    let further = patiently(|| steps(&session).filter(|later| *later > now));
    assert!(further.is_some(), "it stands still\n{}", session.text());
    session.resize(80, 24);
    session.wait("the small screen", |screen| {
        screen
            .contents()
            .lines()
            .last()
            .is_some_and(|line| line.contains("? help"))
    });
    session.resize(120, 40);
    session.type_and_see(CTRL_C, "interrupted;");
    session.see_no_more("solving:");
    session.type_and_see("S", " steps");
    session.type_and_see(CTRL_C, "nothing is running; q quits");
    session.quit();
}

#[test]
fn q_ends_it_in_the_midst_of_a_run() {
    long_run().quit();
}

#[test]
fn ctrl_z_goes_back_to_the_shell_and_fg_returns() {
    let mut session = Start::program("sh", &["-i"])
        .variable("PS1", "ready> ")
        .go();
    session.see("ready> ");
    session.keys(&format!("{PROGRAM} {FLOOR}\r"));
    session.see_picture(FLOOR, "", 120, 40);
    session.keys("3s");
    session.see_picture(FLOOR, "3 s", 120, 40);
    session.keys(CTRL_Z);
    session.wait("the main screen", Session::on_main_screen);
    session.see("Stopped");
    // The shell's own line editor may change modes while it waits, so the terminal is asked for those of a command.
    session.keys("stty -a; echo asked=$?\r");
    session.see("asked=0");
    let text = session.text();
    let on = |mode: &str| text.split([' ', '\n', ';']).any(|word| word == mode);
    for mode in ["echo", "icanon", "isig", "icrnl", "opost"] {
        assert!(on(mode), "{mode} is off\n{text}");
    }
    session.keys("fg\r");
    session.see_picture(FLOOR, "3 s", 120, 40);
    session.keys("s");
    session.see_picture(FLOOR, "4 s", 120, 40);
    session.keys("q");
    // The shell forgets what is typed before it has taken its terminal back.
    session.wait("the shell's prompt", |screen| {
        Session::on_main_screen(screen) && screen.contents().trim_end().ends_with("ready>")
    });
    session.type_and_see("echo left=$?\r", "left=0");
    session.keys("exit\r");
    session.end();
}

#[test]
fn ctrl_z_without_a_shell_to_return_to_does_not_freeze_it() {
    // The program leads the session here: nobody could continue it.
    let mut session = open(FLOOR);
    session.keys("3s");
    session.see_picture(FLOOR, "3 s", 120, 40);
    session.type_and_see(CTRL_Z, "cannot suspend");
    session.see_taken();
    session.keys("s");
    session.see_picture(FLOOR, "4 s", 120, 40);
    session.quit();
}

/// What the terminal keeps for the program to read.
fn unread(session: &Session) -> u64 {
    let name = session.master.tty_name().unwrap();
    let terminal = fs::open(name, OFlags::RDONLY | OFlags::NOCTTY, fs::Mode::empty());
    ioctl_fionread(terminal.unwrap()).unwrap()
}

#[test]
fn thousands_of_keys_in_one_write_are_all_read() {
    let past = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/calculix/pinned-beam.cel"
    );
    for (opened, first) in [
        (FLOOR, "nothing is solved yet"),
        (past, "stick and slip are not in the file"),
    ] {
        let mut session = Start::debugger(&[opened]).go();
        session.see(first);
        // No key follows that could wake it.
        session.keys(&"j".repeat(5000));
        let read = patiently(|| (unread(&session) == 0).then_some(()));
        assert!(
            read.is_some(),
            "{opened}: {} bytes are unread",
            unread(&session)
        );
        let all = format!("{}q", "jk".repeat(2500));
        session.keys(&all);
        assert!(session.end().success());
        session.see_restored();
    }
}

#[test]
fn a_paste_and_clicks_of_thousands_of_bytes_are_read_whole() {
    let mut session = open(FLOOR);
    let wheel = "\x1b[<65;5;8M".repeat(500);
    session.keys(&format!(
        "{wheel}:\x1b[200~{}tail\x1b[201~",
        "step ".repeat(300)
    ));
    session.see("step tail");
    session.keys(ESC);
    session.see_no_more("step tail");
    session.quit();
}

#[test]
fn half_an_escape_sequence_and_unknown_ones_do_not_hold_up_the_screen() {
    for keys in ["\x1b[", "\x1b[99z", "\x1b[<1;", "\u{e9}\x1b[?1;2;3c"] {
        let mut session = long_run();
        session.keys(keys);
        let now = patiently(|| steps(&session)).unwrap();
        let further = patiently(|| steps(&session).filter(|later| *later > now + 50));
        assert!(
            further.is_some(),
            "{keys:?}: it stands still\n{}",
            session.text()
        );
        session.signal("TERM");
        session.end();
    }
}

#[test]
fn a_stop_from_outside_gives_the_terminal_back_and_going_on_takes_it_again() {
    let mut session = open(FLOOR);
    session.keys("3s");
    session.see_picture(FLOOR, "3 s", 120, 40);
    session.signal("TSTP");
    session.see_restored();
    // It may not quite have stopped yet, and a signal to go on before that is lost.
    let back = patiently(|| {
        session.signal("CONT");
        session.screen(Screen::alternate_screen).then_some(())
    });
    assert!(back.is_some(), "it does not come back");
    session.see_taken();
    session.see_picture(FLOOR, "3 s", 120, 40);
    session.keys("s");
    session.see_picture(FLOOR, "4 s", 120, 40);
    session.quit();
}

#[test]
fn a_signal_that_ends_it_restores_the_terminal_and_is_seen_by_the_parent() {
    for (name, told) in [
        ("TERM", "Terminated"),
        ("HUP", "Hangup"),
        ("INT", "Interrupt"),
        ("QUIT", "Quit"),
    ] {
        for mut session in [open(FLOOR), long_run()] {
            session.see_taken();
            session.signal(name);
            let status = session.end();
            assert_eq!(status.signal(), Some(told), "{name}: {status}");
            session.see_restored();
        }
    }
}

#[test]
fn a_terminal_that_goes_away_ends_it() {
    for session in [open(FLOOR), long_run()] {
        session.see_taken();
        let mut child = session.hang_up();
        let status = patiently(|| child.try_wait().unwrap());
        assert!(status.is_some(), "it outlives its terminal");
    }
}

/// The only journal in a directory for states.
fn journal(state: &TempDir) -> PathBuf {
    let journals = state.path().join("stickslip/journals");
    let mut entries = std::fs::read_dir(&journals)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let found = entries.next().unwrap();
    assert!(entries.next().is_none());
    found
}

/// The panes alone: without status and messages.
fn panes(session: &Session) -> Vec<String> {
    let text = session.text();
    let lines = text
        .lines()
        .skip_while(|line| !line.contains("Slave nodes"));
    lines.take(30).map(trimmed).collect()
}

#[test]
fn a_session_that_was_killed_resumes_where_it_was() {
    let state = tempfile::tempdir().unwrap();
    let home = state.path().to_str().unwrap().to_string();
    let mut session = Start::debugger(&[OSCILLATES])
        .variable("XDG_STATE_HOME", &home)
        .go();
    session.see("nothing is solved yet");
    session.type_and_see("c", "period 2 from minor 1");
    session.type_and_see("S", "1 of 2 steps");
    session.type_and_see("m", "mode of beam.5:");
    session.type_and_see("s", "in the new branch b2: beam.5 sliding");
    session.type_and_see("5f", "load 0.25 accepted");
    session.type_and_see("2S", " steps");
    session.wait("no message", |screen| {
        !screen.contents().contains("running;")
    });
    let before = panes(&session);
    session.signal("KILL");
    session.end();

    let file = journal(&state);
    let mut bytes = std::fs::read(&file).unwrap();
    bytes.extend_from_slice(b"Done((at:1,comma");
    std::fs::write(&file, bytes).unwrap();
    let checked = run(
        &["resume", "--check", file.to_str().unwrap()],
        Stdio::null(),
    );
    let told = String::from_utf8_lossy(&checked.stderr).into_owned();
    assert_eq!(checked.status.code(), Some(0), "{told}");
    assert!(told.contains("line 9 is incomplete"), "{told}");

    let mut session = Start::debugger(&["resume"])
        .variable("XDG_STATE_HOME", &home)
        .go();
    session.see("resumed after 5 entries; line 9 is incomplete and has been ignored");
    assert_eq!(panes(&session), before);
    // The journal is this session's alone.
    let other = Start::debugger(&["resume"])
        .variable("XDG_STATE_HOME", &home)
        .go();
    other.see("another session is writing this journal");
    session.type_and_see("c", "the history is complete");
    session.quit();
    let checked = run(
        &["resume", "--check", file.to_str().unwrap()],
        Stdio::null(),
    );
    let told = String::from_utf8_lossy(&checked.stderr).into_owned();
    assert!(
        told.contains("6 entries") && told.contains("replay is bit-identical\n"),
        "{told}"
    );
}

#[test]
fn a_session_that_was_killed_in_the_midst_of_a_run_resumes_before_it_and_says_so() {
    let state = tempfile::tempdir().unwrap();
    let home = state.path().to_str().unwrap().to_string();
    let mut session = Start::debugger(&[FLOOR, "--set", "history.increment=1e-6"])
        .variable("XDG_STATE_HOME", &home)
        .go();
    session.see("nothing is solved yet");
    session.type_and_see("3s", "minor 3");
    session.type_and_see("c", "solving: load");
    session.signal("KILL");
    session.end();
    let mut session = Start::debugger(&["resume"])
        .variable("XDG_STATE_HOME", &home)
        .go();
    session.see("the last motion was interrupted and is not repeated");
    session.type_and_see("s", "minor 4");
    session.quit();
}

#[test]
fn no_journal_is_kept_where_none_is_wanted_or_nothing_is_done() {
    let state = tempfile::tempdir().unwrap();
    let home = state.path().to_str().unwrap().to_string();
    for (arguments, keys) in [(vec![FLOOR], ""), (vec![FLOOR, "--no-journal"], "s")] {
        let mut session = Start::debugger(&arguments)
            .variable("XDG_STATE_HOME", &home)
            .go();
        session.see("nothing is solved yet");
        session.keys(keys);
        session.see_picture(FLOOR, keys, 120, 40);
        session.quit();
        assert!(!state.path().join("stickslip").exists());
    }
    // A file that is named is made at once, and never over another.
    let file = state.path().join("mine");
    let name = file.to_str().unwrap();
    let session = Start::debugger(&[FLOOR, "--journal", name]).go();
    session.see("nothing is solved yet");
    assert!(file.exists());
    session.quit();
    let mut session = Start::debugger(&[FLOOR, "--journal", name]).go();
    session.see("the file already exists");
    assert_eq!(session.end().exit_code(), 2);
}

/// Tells the copies of this test program that the next test starts which part they play.
const PART: &str = "STICKSLIP_TEST_PART";

/// Not a test by itself: in a terminal and with a part to play, it breaks down while the terminal is taken.
#[test]
fn breaks_down() {
    match std::env::var(PART).as_deref() {
        Ok("here") => {
            let _terminal = tui::terminal::Terminal::enter().unwrap();
            panic!("broken down here");
        }
        Ok("elsewhere") => {
            let terminal = tui::terminal::Terminal::enter().unwrap();
            let solver = thread::spawn(|| panic!("broken down elsewhere"));
            assert!(solver.join().is_err());
            let told = stickslip_platform::task::take_panic();
            drop(terminal);
            println!(
                "kept: {}",
                told.is_some_and(|told| told.contains("broken down elsewhere"))
            );
        }
        _ => {}
    }
}

fn breaking_down(part: &str) -> Session {
    let program = std::env::current_exe().unwrap();
    let arguments = [
        "--exact",
        "sessions::breaks_down",
        "--nocapture",
        "--test-threads=1",
    ];
    Start::program(program.to_str().unwrap(), &arguments)
        .variable(PART, part)
        .go()
}

#[test]
fn a_panic_is_told_on_a_terminal_that_is_restored_first() {
    let mut session = breaking_down("here");
    let status = session.end();
    assert!(!status.success());
    session.see("broken down here");
    session.see_restored();
    let raw = String::from_utf8_lossy(&session.seen.lock().unwrap().raw).into_owned();
    let (left, told) = (raw.find("\x1b[?1049l"), raw.find("broken down here"));
    assert!(left.is_some() && left < told, "{raw:?}");
    assert_eq!(raw.matches("\x1b[?1049l").count(), 1, "{raw:?}");
}

#[test]
fn a_panic_of_the_solver_does_not_write_on_the_screen() {
    let mut session = breaking_down("elsewhere");
    let status = session.end();
    assert!(status.success(), "{}", session.text());
    session.see("kept: true");
    session.see_restored();
    let raw = String::from_utf8_lossy(&session.seen.lock().unwrap().raw).into_owned();
    assert!(!raw.contains("broken down elsewhere"), "{raw:?}");
}

/// A killed program leaves the terminal on the alternate screen; the next one must not draw around what is there.
#[test]
fn the_screen_that_is_taken_over_is_cleared() {
    let mut session = Start::debugger(&[FLOOR]).go();
    session.see("nothing is solved yet");
    session.keys("q");
    session.end();
    let raw = String::from_utf8_lossy(&session.seen.lock().unwrap().raw).into_owned();
    let (_, taken) = raw.split_once("\x1b[?1049h").unwrap();
    let cleared = taken.find("\x1b[2J");
    assert!(
        cleared.is_some() && cleared < taken.find("stickslip"),
        "{raw:?}"
    );
}

/// The parameters of every SGR sequence.
fn styles(raw: &[u8]) -> Vec<String> {
    let text = String::from_utf8_lossy(raw);
    let parameters = |piece: &str| {
        let end = piece.find(|c: char| !c.is_ascii_digit() && c != ';' && c != ':')?;
        piece[end..]
            .starts_with('m')
            .then(|| piece[..end].to_string())
    };
    text.split("\x1b[").skip(1).filter_map(parameters).collect()
}

/// Whether an SGR sequence chooses a colour; going back to the terminal's own (39, 49) does not.
fn colours(style: &str) -> bool {
    let codes = style.split([';', ':']).filter_map(|code| code.parse().ok());
    let colour = |code: u32| matches!(code, 30..=38 | 40..=48 | 58 | 90..=107);
    codes.into_iter().any(colour)
}

/// All that is drawn on the way through panes, prompts, marks, help, and a failure.
fn drawn(start: Start) -> Vec<u8> {
    let mut session = start.go();
    session.see("nothing is solved yet");
    session.type_and_see("c", "period 2");
    session.type_and_see("m", "mode of beam.5:");
    session.type_and_see("S", "◆ 1 held");
    session.type_and_see("c", "the history is complete");
    session.type_and_see(":nonsense\r", "unknown action");
    session.type_and_see(":incremnt 1\r", "did you mean \"increment\"?");
    session.type_and_see("?", "Move through the iterations");
    session.keys("?");
    session.see_no_more("Move through the iterations");
    session.type_and_see("o", "Choose a scene");
    session.keys("q");
    session.see_no_more("Choose a scene");
    let seen = Arc::clone(&session.seen);
    session.quit();
    std::mem::take(&mut seen.lock().unwrap().raw)
}

#[test]
fn no_color_leaves_weights_but_no_colours() {
    let plain = styles(&drawn(
        Start::debugger(&[OSCILLATES]).variable("NO_COLOR", "1"),
    ));
    let coloured: Vec<_> = plain
        .iter()
        .filter(|style| colours(style.as_str()))
        .collect();
    assert!(coloured.is_empty(), "{coloured:?}");
    for weight in ["1", "7"] {
        let there = |style: &String| style.split(';').any(|code| code == weight);
        assert!(plain.iter().any(there), "no {weight} among {plain:?}");
    }
    // Without it there are colours, so that the above has something to miss.
    let styles = styles(&drawn(Start::debugger(&[OSCILLATES])));
    assert!(styles.iter().any(|style| colours(style)), "{styles:?}");
}

#[test]
fn without_a_terminal_it_names_run_and_ends_with_2() {
    for arguments in [vec![], vec![FLOOR]] {
        let ended = run(&arguments, Stdio::piped());
        let message = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert_eq!(ended.status.code(), Some(2), "{message}");
        assert!(message.contains("stickslip run"), "{message}");
        assert!(ended.stdout.is_empty());
    }
    // One of the two is not enough.
    for elsewhere in ["< /dev/null", "> out"] {
        let line = format!("{PROGRAM} {FLOOR} {elsewhere}; echo ended=$?");
        let mut session = Start::program("sh", &["-c", &line]).go();
        session.see("stickslip run");
        session.see("ended=2");
        session.end();
        let raw = session.seen.lock().unwrap().raw.clone();
        assert!(!raw.contains(&b'\x1b'), "the terminal was touched");
    }
}

#[test]
fn a_lesson_is_taken_in_the_terminal() {
    let mut session = Start::debugger(&["lesson", "4-oscillation"])
        .size(80, 24)
        .variable("NO_COLOR", "1")
        .go();
    session.see("Lesson  Why free and fixed oscillate  1/12");
    session.type_and_see(" ", "▶ press s (step)");
    session.type_and_see("s", "f→?");
    session.type_and_see("as", "✗ No. Look at row free");
    session.type_and_see("ax", "✓ Right: fixed.");
    session.type_and_see(" ", "4/12  score 0/1");
    session.type_and_see("q", "");
    let status = session.end();
    assert!(status.success(), "{status}");
    session.see_restored();
}
