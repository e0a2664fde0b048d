//! A finished CalculiX run, looked at: screens at every size, keys, and sessions in a pseudo-terminal. The runs are those of
//! `tests/calculix`, which `tests/peers/past.py` makes.

use crate::stored::rows;
use crate::terminal::*;
use proptest::prelude::*;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Modifier;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use stickslip::action::Colours;
use stickslip::recorded::calculix::run::{CalculixRun, Status};
use stickslip::recorded::calculix::{self, words};
use stickslip::recorded::recording::Recording;
use stickslip::session::Session as Debugged;
use stickslip::tui::debugger::{Debugger, TerminalRequest};
use stickslip::tui::layout::Pane;
use stickslip::tui::theme::Theme;
use stickslip::tui::{keys, screen};
use stickslip_exchange::calculix::files::CalculixFiles;
use stickslip_exchange::calculix::{cel, cvg};
use vt100::Screen;

const CTRL_Z: &str = "\x1a";
const ESC: &str = "\x1b";

fn file(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/calculix");
    folder.join(format!("{name}.cel"))
}

fn on(recording: Recording) -> Debugger {
    let session = Debugged::recorded(recording);
    Debugger::new(Theme::mono(), Vec::new(), Some(session))
}

fn debugger(name: &str) -> Debugger {
    let recording = Recording::open(file(name).to_str().unwrap()).unwrap();
    on(recording.unwrap())
}

/// Where the debugger is: increment, attempt, iteration.
fn place(debugger: &Debugger) -> (String, u32, u32) {
    let session = debugger.session.as_ref().unwrap();
    let at = session.frame().event.as_ref().unwrap().position;
    let increment = session.model().increment_name(at.increment);
    (increment, at.attempt, at.minor)
}

/// Types keys, and checks where they lead to.
fn leads(debugger: &mut Debugger, keys: &str, (increment, attempt, iteration): (&str, u32, u32)) {
    debugger.type_keys(keys);
    let wanted = (increment.to_owned(), attempt, iteration);
    assert_eq!(place(debugger), wanted, "{keys}");
}

#[test]
fn whole_screens_of_a_run_that_cycles_and_of_one_that_chatters() {
    for name in ["pinned-beam", "two-blocks"] {
        let mut debugger = debugger(name);
        debugger.type_keys("S S");
        for (width, height) in [(80, 24), (120, 40), (200, 60)] {
            let shown = debugger.text(width, height);
            insta::assert_snapshot!(format!("{name}-{width}x{height}"), shown);
        }
        debugger.type_keys("O");
        insta::assert_snapshot!(format!("{name}-page-80x24"), debugger.text(80, 24));
    }
}

#[test]
fn that_stick_and_slip_are_not_in_the_file_is_on_every_screen_and_first_in_the_help() {
    for (width, height) in [(80, 24), (120, 40), (200, 60), (60, 16), (45, 12)] {
        let mut debugger = debugger("two-blocks");
        let shown = debugger.text(width, height);
        assert!(one_line(&shown).contains(words::NO_MODES), "{shown}");
        debugger.type_keys("?");
        let help = debugger.text(width, height);
        assert!(
            help.contains("CalculiX's files do not distinguish"),
            "{help}"
        );
    }
}

/// A screen without its line ends and borders.
fn one_line(shown: &str) -> String {
    let words = shown.split_whitespace();
    words.collect::<Vec<_>>().join(" ")
}

#[test]
fn keys_of_the_debugger_walk_iterations_attempts_and_increments() {
    let mut debugger = debugger("pinned-beam");
    // It opens at the end of the first attempt that did not converge.
    assert_eq!(place(&debugger), ("2.1".into(), 1, 7));
    let told = |debugger: &Debugger| debugger.app.message.text.clone();
    leads(&mut debugger, "5 S", ("2.1", 1, 2));
    leads(&mut debugger, "s", ("2.1", 1, 3));
    leads(&mut debugger, "3 s", ("2.1", 1, 6));
    leads(&mut debugger, "n", ("2.1", 1, 7));
    leads(&mut debugger, "n", ("2.1", 2, 7));
    leads(&mut debugger, "f", ("2.1", 6, 7));
    leads(&mut debugger, "F", ("1.10", 1, 2));
    leads(&mut debugger, "N", ("1.9", 1, 2));
    leads(&mut debugger, "t Left", ("1.9", 1, 1));
    leads(&mut debugger, "F", ("1.8", 1, 2));
    leads(&mut debugger, "c", ("2.1", 1, 7));
    leads(&mut debugger, "c c C", ("2.1", 2, 7));
    leads(&mut debugger, "C", ("2.1", 1, 7));
    leads(&mut debugger, ": g o t o Space 2 3 Enter", ("2.1", 1, 2));
    debugger.type_keys(": g o t o Space 9 9 Enter");
    assert!(told(&debugger).contains("63"), "{}", told(&debugger));
    leads(&mut debugger, "1 0 0 0 s s", ("2.1", 6, 7));
    assert!(
        told(&debugger).contains("last iteration"),
        "{}",
        told(&debugger)
    );
    // A breakpoint at an increment of the whole run.
    debugger.type_keys(": g o t o Space 1 Enter : b r e a k Space a t Space 3 Enter");
    leads(&mut debugger, "c", ("1.3", 1, 1));
}

#[test]
fn contacts_are_selected_by_name() {
    let mut debugger = debugger("two-blocks");
    let selected = |debugger: &Debugger| {
        let session = debugger.session.as_ref().unwrap();
        let contact = &session.model().contacts[debugger.app.selected];
        session.model().nodes[contact.node].name.clone()
    };
    debugger.type_keys("/ 3 9 Enter");
    assert_eq!(
        selected(&debugger),
        "node 39",
        "{}",
        debugger.app.message.text
    );
    debugger.type_keys("Down");
    assert_eq!(selected(&debugger), "node 40");
    debugger.type_keys("/ x y Enter");
    assert!(debugger.app.message.text.contains("xy"));
    debugger.type_keys("Shift-Tab Shift-Tab");
    assert_ne!(debugger.app.panes.focus, Pane::Nodes);
}

#[test]
fn what_needs_a_solver_is_refused_with_the_reason() {
    let refused = [
        "m",
        "M",
        "i",
        ": s e t Space s e t t i n g s . s l i p Space m a j o r Enter",
        ": c e n s u s Enter",
        ": j o u r n a l Space x Enter",
        ": s t a r t - f r o m Space 1 Enter",
    ];
    for keys in refused {
        let mut debugger = debugger("pinned-beam");
        debugger.type_keys(keys);
        let told = &debugger.app.message.text;
        assert!(told.starts_with(words::READ_ONLY), "{keys}: {told}");
    }
    let mut debugger = debugger("pinned-beam");
    debugger.type_keys(": n o n s e n s e Enter");
    assert!(debugger.app.message.text.contains("nonsense"));
    let quit = keys::press("q").unwrap();
    assert_eq!(debugger.key(&quit), Some(TerminalRequest::Quit));
}

#[test]
fn the_cure_of_the_diagnosis_is_copied_as_lines_of_the_deck() {
    for row in rows()
        .iter()
        .filter(|row| row.deck == "stick" || row.deck == "open")
    {
        let mut debugger = debugger(&format!("causes/{}", row.deck));
        // Remedies of a finished run are the cures of its diagnosis.
        for [page, copies] in [["d", "Y"], ["r", "Y"], ["d", "Enter"]] {
            debugger.type_keys(page);
            assert_eq!(debugger.app.panes.focus, Pane::Diagnosis);
            let copied = debugger.key(&keys::press(copies).unwrap());
            let Some(TerminalRequest::Copy(text)) = copied else {
                panic!("{}: {copied:?} {}", row.deck, debugger.app.message.text);
            };
            assert_eq!(text, row.cure);
            debugger.type_keys("Esc");
        }
    }
}

#[test]
fn the_shape_shows_the_surfaces_of_the_deck_from_the_chosen_side() {
    let mut debugger = debugger("causes/stiff");
    while debugger.app.panes.focus != Pane::Shape {
        debugger.type_keys("Tab");
    }
    let mut sides = Vec::new();
    for side in ["oblique", "top", "side"] {
        let shown = debugger.text(80, 24);
        assert!(
            shown.contains(&format!("{side} view (V)   faint: master")),
            "{shown}"
        );
        let dots: String = shown
            .chars()
            .filter(|c| ('\u{2801}'..='\u{28ff}').contains(c))
            .collect();
        assert!(
            !sides.contains(&dots) && dots.chars().count() > 20,
            "{shown}"
        );
        sides.push(dots);
        debugger.type_keys("V");
    }
}

#[test]
fn a_finished_run_has_no_forces_no_remedies_and_no_second_branch() {
    let mut debugger = debugger("two-blocks");
    for (keys, shows) in [
        ("E", "CalculiX's files contain no forces at the contacts."),
        ("Esc v", "time 1.015625  69 iterations"),
    ] {
        debugger.type_keys(keys);
        let shown = debugger.text(80, 24);
        assert!(shown.contains(shows), "{shown}");
        assert!(!shown.contains("starts a new branch"), "{shown}");
    }
    while debugger.app.panes.focus != Pane::Remedies {
        debugger.type_keys("Tab");
    }
    let shown = debugger.text(80, 24);
    assert!(shown.contains("are in its diagnosis (d)"), "{shown}");
}

#[test]
fn any_size_shows_something_and_none_panics() {
    let pages: Vec<String> = (0..9).map(|tabs| "Tab ".repeat(tabs) + "z").collect();
    for name in ["pinned-beam", "two-blocks"] {
        for keys in pages
            .iter()
            .map(String::as_str)
            .chain(["", "?", "O", ":", "/"])
        {
            let mut debugger = debugger(name);
            debugger.type_keys(keys);
            for width in [1, 5, 17, 30, 80, 109, 110, 300] {
                for height in [1, 2, 5, 6, 7, 10, 16, 24, 30, 100] {
                    let shown = debugger.text(width, height);
                    assert_eq!(shown.lines().count(), usize::from(height));
                }
            }
        }
    }
}

#[test]
fn letters_tell_what_colours_tell_too() {
    let shown = |theme: Theme| {
        let mut debugger = debugger("two-blocks");
        debugger.app.theme = theme;
        debugger.type_keys("c c c");
        let area = Rect::new(0, 0, 120, 40);
        let mut buffer = Buffer::empty(area);
        screen::draw(&mut buffer, area, &debugger.app, debugger.view().as_ref());
        let symbols: Vec<String> = buffer
            .content
            .iter()
            .map(|c| c.symbol().to_owned())
            .collect();
        let colours = buffer
            .content
            .iter()
            .filter(|c| c.fg != ratatui::style::Color::Reset);
        let bold = buffer
            .content
            .iter()
            .filter(|c| c.modifier.contains(Modifier::BOLD));
        (symbols, colours.count(), bold.count())
    };
    let (plain, none, bold) = shown(Theme::mono());
    let (colour, some, _) = shown(Theme::new(Colours::Dark));
    assert_eq!(plain, colour);
    assert!(none == 0 && some > 0 && bold > 0);
}

/// A slave face with two of its three points in contact, then on another face, then not told.
#[test]
fn faces_show_how_much_of_them_touches() {
    let element = |k: u32, master: u32, iteration: u32| {
        format!(
            "*ELEMENT,TYPE=C3D8,ELSET=contactelements_st1_in1_at1_it{iteration}\n{k}, {master}, 2, 3, 4, 12, 11, 14, 13\n"
        )
    };
    let first: String = (0..3).map(|k| element(k, 1, 1)).collect();
    let second: String = (0..2).map(|k| element(k, 1, 2)).collect();
    let third: String = (0..3).map(|k| element(k, 5, 3)).collect();
    let cel = first + &second + &third;
    let rows = "1 1 1 1 3 1. 1. 0. 0.\n1 1 1 2 2 1. 1. 0. 0.\n1 1 1 3 3 1. 1. 0. 0.\n1 1 1 4 7 1. 1. 0. 0.\n";
    let cvg = format!("SUMMARY OF C0NVERGENCE INFORMATION\n{rows}");
    let files = CalculixFiles::new(
        cel::read(cel.as_bytes()).unwrap(),
        None,
        Some(cvg::read(cvg.as_bytes()).unwrap()),
    );
    let run = CalculixRun::new("faces.cel", files);
    let found: Vec<Status> = (0..4).map(|k| run.status(k, 0)).collect();
    let wanted = [
        Status::Closed,
        Status::Part(6),
        Status::Moved,
        Status::Unknown,
    ];
    assert_eq!(found, wanted);
    assert_eq!(run.switching[0].most(), (0, 2));
    let notes = words::notes(&run).join("\n");
    assert!(notes.contains("faces.sta is missing"), "{notes}");
    assert!(
        notes.contains("step 1, increment 1, attempt 1, iteration 4"),
        "{notes}"
    );
    let mut debugger = on(Recording::Calculix(Box::new(
        calculix::open(run, None).unwrap(),
    )));
    debugger.type_keys("1 0 s");
    insta::assert_snapshot!("faces-80x24", debugger.text(80, 24));
    debugger.type_keys("O");
    insta::assert_snapshot!("faces-page-80x24", debugger.text(80, 24));
}

#[test]
fn a_session_walks_searches_is_resized_stopped_and_leaves_no_trace() {
    let cel = file("two-blocks");
    let mut session = Start::debugger(&[cel.to_str().unwrap()]).size(80, 24).go();
    session.see("stick and slip are not in the file");
    session.see_taken();
    session.type_and_see("s", "increment 1.1   attempt 2");
    session.type_and_see("cc", "increment 2.1");
    session.type_and_see("m", "finished CalculiX run (read-only): forced modes");
    session.resize(120, 40);
    session.see("Timeline  step");
    session.type_and_see("/39\r", "Decision  node 39");
    session.type_and_see("?", "CalculiX's files do not distinguish");
    // Part of a page may be drawn over the timeline; keys right after Esc would be read as one with it.
    session.keys(ESC);
    session.see_no_more("CalculiX's files do not distinguish");
    session.type_and_see("O", "2 steps, 9 increments, 13 attempts");
    session.keys(ESC);
    session.see_no_more("2 steps, 9 increments, 13 attempts");
    session.see("Timeline  step");
    // There is no shell here that could continue it; who sends a signal can.
    session.type_and_see(CTRL_Z, "cannot suspend");
    session.signal("TSTP");
    session.wait("the shell's screen", Session::on_main_screen);
    let back = patiently(|| {
        session.signal("CONT");
        session.screen(Screen::alternate_screen).then_some(())
    });
    assert!(back.is_some(), "it does not come back");
    session.see("Timeline  step");
    session.quit();
}

#[test]
fn no_colours_are_sent_where_none_are_wanted() {
    let cel = file("two-blocks");
    let arguments = [cel.to_str().unwrap()];
    let session = Start::debugger(&arguments).variable("NO_COLOR", "1").go();
    session.see("not converged");
    let coloured = session.screen(|screen| {
        let (columns, rows) = (80, 24);
        let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        let cells = cells.filter_map(|(row, column)| screen.cell(row, column));
        cells
            .filter(|cell| cell.fgcolor() != vt100::Color::Default)
            .count()
    });
    assert_eq!(coloured, 0);
    session.quit();
}

#[test]
fn without_a_terminal_the_text_is_named_and_nothing_else_goes_with_a_run_that_is_over() {
    let cel = file("pinned-beam");
    let cel = cel.to_str().unwrap();
    let sta = cel.replace(".cel", ".sta");
    for (arguments, wanted) in [
        (
            vec![cel],
            format!("`stickslip story {cel}` prints it as text"),
        ),
        (
            vec![cel, "--set", "a=b"],
            format!("--set cannot be used with this input: {}", words::READ_ONLY),
        ),
        (vec![&sta], format!("`stickslip {cel}`")),
        (
            vec!["run", cel],
            format!("this is the .cel file of a finished CalculiX run; `stickslip {cel}` reads it"),
        ),
        (vec!["check", &sta], format!("`stickslip {cel}` reads it")),
        (
            vec!["show", "nowhere.cel"],
            "nowhere.cel: the file cannot be read".into(),
        ),
    ] {
        let output = run(&arguments, Stdio::null());
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{told}");
        assert!(told.contains(&wanted), "{arguments:?}\n{told}\n{wanted}");
    }
}

#[test]
fn the_text_tells_attempts_cycles_and_who_chatters() {
    let text = |command: &str, name: &str| {
        let output = run(&[command, file(name).to_str().unwrap()], Stdio::null());
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    let beam = text("show", "pinned-beam");
    assert_eq!(text("story", "pinned-beam"), beam);
    // The machine's own path is none of the text that must stay.
    let own = |text: &str| text.split_once('\n').unwrap().1.to_owned();
    insta::assert_snapshot!("text-pinned-beam", own(&beam));
    insta::assert_snapshot!("text-two-blocks", own(&text("show", "two-blocks")));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn no_keys_make_it_panic(typed in prop::collection::vec(prop::sample::select(KEYS), 0..60), size in (1_u16..130, 1_u16..50)) {
        let mut debugger = debugger("two-blocks");
        for name in typed {
            debugger.type_keys(name);
        }
        debugger.text(size.0, size.1);
    }
}

/// All keys that there are here, and letters for lines.
const KEYS: &[&str] = &[
    "s",
    "n",
    "f",
    "c",
    "S",
    "N",
    "F",
    "C",
    "Enter",
    "Up",
    "Down",
    "Left",
    "Right",
    "PageUp",
    "PageDown",
    "g",
    "G",
    "/",
    "t",
    "Tab",
    "Shift-Tab",
    "z",
    ":",
    "?",
    "Esc",
    "Ctrl-c",
    "Ctrl-l",
    "Y",
    "0",
    "1",
    "9",
    "m",
    "o",
    "e",
    "Backspace",
    "Space",
];
