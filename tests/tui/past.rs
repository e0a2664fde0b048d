//! A CalculiX run that is over, looked at: screens at every size, keys, and sessions in a pseudo-terminal. The runs are those of
//! `tests/calculix`, which `tests/peers/past.py` makes.

use crate::terminal::*;
use proptest::prelude::*;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Modifier;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use stickslip::action::{Colours, Keymap};
use stickslip::explain::past::run::{Past, Touch};
use stickslip::explain::past::words;
use stickslip::outside::calculix;
use stickslip::tui::debugger::Outside;
use stickslip::tui::keys;
use stickslip::tui::past::app::{App, Pane};
use stickslip::tui::past::screen;
use stickslip::tui::theme::Theme;
use stickslip_exchange::calculix::past::PastRun;
use stickslip_exchange::calculix::{cel, cvg};
use vt100::Screen;

const CTRL_Z: &str = "\x1a";
const ESC: &str = "\x1b";

fn file(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/calculix");
    folder.join(format!("{name}.cel"))
}

fn past(name: &str) -> Past {
    let run = calculix::read(&file(name)).unwrap();
    Past::new(format!("{name}.cel"), run)
}

fn app(name: &str) -> App {
    App::new(past(name), Theme::mono(), Keymap::default())
}

/// Where the app is: step, increment, attempt, iteration.
fn place(app: &App) -> [u32; 4] {
    let attempt = &app.past.run.attempts[app.past.attempt(app.cursor)];
    let number = app.past.run.iterations[app.cursor].number;
    [attempt.step, attempt.increment, attempt.attempt, number]
}

/// Where some keys lead to.
fn after(app: &mut App, keys: &str) -> [u32; 4] {
    app.type_keys(keys);
    place(app)
}

#[test]
fn whole_screens_of_a_run_that_cycles_and_of_one_that_chatters() {
    for name in ["pinned-beam", "two-blocks"] {
        let mut app = app(name);
        app.type_keys("s s");
        for (width, height) in [(80, 24), (120, 40), (200, 60)] {
            let shown = screen::text(&app, width, height);
            insta::assert_snapshot!(format!("{name}-{width}x{height}"), shown);
        }
    }
}

#[test]
fn that_stick_and_slip_are_not_in_the_file_is_on_every_screen_and_first_in_the_help() {
    for (width, height) in [(80, 24), (120, 40), (200, 60), (60, 16), (45, 12)] {
        let mut app = app("two-blocks");
        let shown = screen::text(&app, width, height);
        assert!(shown.contains(words::NO_MODES), "{shown}");
        app.type_keys("?");
        let help = screen::text(&app, width, height);
        assert!(help.contains("Stick and slip are not in"), "{help}");
    }
}

#[test]
fn keys_of_the_debugger_walk_iterations_attempts_and_increments() {
    let mut app = app("pinned-beam");
    // It opens where the first cycle begins.
    assert_eq!(place(&app), [2, 1, 1, 2]);
    assert_eq!(after(&mut app, "s"), [2, 1, 1, 3]);
    assert_eq!(after(&mut app, "3 s"), [2, 1, 1, 6]);
    assert_eq!(after(&mut app, "n"), [2, 1, 1, 7]);
    assert_eq!(after(&mut app, "n"), [2, 1, 2, 7]);
    assert_eq!(after(&mut app, "f"), [2, 1, 6, 7]);
    assert_eq!(after(&mut app, "F"), [1, 10, 1, 2]);
    assert_eq!(after(&mut app, "N"), [1, 9, 1, 2]);
    assert_eq!(after(&mut app, "Left"), [1, 9, 1, 1]);
    assert_eq!(after(&mut app, "Enter"), [1, 8, 1, 2]);
    assert_eq!(after(&mut app, "c"), [2, 1, 1, 2]);
    assert_eq!(after(&mut app, "c c C"), [2, 1, 2, 4]);
    assert_eq!(after(&mut app, "C C"), [1, 1, 1, 1]);
    assert_eq!(after(&mut app, ": g o t o Space 2 3 Enter"), [2, 1, 1, 2]);
    app.type_keys(": g o t o Space 9 9 Enter");
    assert!(app.message.text.contains("1 to 63"), "{}", app.message.text);
    assert_eq!(place(&app), [2, 1, 1, 2]);
    assert_eq!(after(&mut app, "1 0 0 0 s"), [2, 1, 6, 7]);
    assert!(app.message.text.contains("last iteration"));
}

#[test]
fn attempts_are_walked_where_they_are_listed_and_contacts_elsewhere() {
    let mut app = app("two-blocks");
    app.type_keys("Shift-Tab");
    assert_eq!(app.focus, Pane::Attempts);
    assert_eq!(after(&mut app, "g"), [1, 1, 1, 1]);
    assert_eq!(after(&mut app, "Down Down"), [1, 1, 3, 1]);
    assert_eq!(after(&mut app, "G"), [2, 1, 3, 1]);
    assert_eq!(after(&mut app, "PageUp k k k"), [1, 1, 1, 1]);
    app.type_keys("t / 3 9 Enter");
    assert_eq!(app.past.slave(app.selected), "node 39");
    app.type_keys("/ n o Enter");
    assert_ne!(app.past.slave(app.selected), "node 39");
    app.type_keys("/ x y Enter");
    assert!(app.message.text.contains("no contact's name holds 'xy'"));
}

#[test]
fn what_needs_a_solver_is_refused_with_the_reason() {
    for key in ["m", "M", "i", "d", "r", "w", "o", "b", "v", "e", "p", "L"] {
        let mut app = app("pinned-beam");
        let entry = app.keymap.by_key(key);
        app.type_keys(key);
        let told = &app.message.text;
        assert!(
            entry.is_none() || told.ends_with(words::READ_ONLY),
            "{key}: {told}"
        );
    }
    let mut app = app("pinned-beam");
    app.type_keys(": s e t Space a Enter");
    assert!(app.message.text.ends_with(words::READ_ONLY));
    app.type_keys(": n o n s e n s e Enter");
    assert!(app.message.text.contains("nonsense"));
    let quit = keys::press("q").unwrap();
    assert_eq!(app.key(&quit), Some(Outside::Quit));
}

#[test]
fn any_size_shows_something_and_none_panics() {
    for name in ["pinned-beam", "two-blocks"] {
        for keys in [
            "",
            "z",
            "Tab z",
            "Tab Tab z",
            "Tab Tab Tab z",
            "?",
            ":",
            "/",
        ] {
            let mut app = app(name);
            app.type_keys(keys);
            for width in [1, 5, 17, 30, 80, 109, 110, 300] {
                for height in [1, 2, 5, 6, 7, 10, 16, 24, 30, 100] {
                    let shown = screen::text(&app, width, height);
                    assert_eq!(shown.lines().count(), usize::from(height));
                }
            }
        }
    }
}

#[test]
fn letters_tell_what_colours_tell_too() {
    let shown = |theme: Theme| {
        let mut app = app("two-blocks");
        app.theme = theme;
        app.type_keys("c c c");
        let area = Rect::new(0, 0, 120, 40);
        let mut buffer = Buffer::empty(area);
        screen::draw(&mut buffer, area, &app);
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
    let (colour, some, _) = shown(Theme::of(Colours::Dark));
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
    let run = PastRun::new(
        cel::read(cel.as_bytes()).unwrap(),
        None,
        Some(cvg::read(cvg.as_bytes()).unwrap()),
    );
    let past = Past::new("faces.cel", run);
    let touches: Vec<Touch> = (0..4).map(|k| past.touch(k, 0)).collect();
    let wanted = [Touch::Closed, Touch::Part(6), Touch::Moved, Touch::Unknown];
    assert_eq!(touches, wanted);
    assert_eq!(past.chatter[0].most(), 2);
    assert_eq!(past.find("12", 0), Some(0));
    let notes = words::notes(&past).join("\n");
    assert!(notes.contains("faces.sta is not there"), "{notes}");
    assert!(
        notes.contains("step 1, increment 1, attempt 1, iteration 4"),
        "{notes}"
    );
    let app = App::new(past, Theme::mono(), Keymap::default());
    insta::assert_snapshot!("faces-80x24", screen::text(&app, 80, 24));
}

#[test]
fn a_session_walks_searches_is_resized_stopped_and_leaves_no_trace() {
    let cel = file("two-blocks");
    let mut session = Start::debugger(&[cel.to_str().unwrap()]).size(80, 24).go();
    session.see("stick and slip are not in the file");
    session.see_taken();
    session.type_and_see("s", "increment 1  attempt 1");
    session.type_and_see("cc", "step 2  increment 1");
    session.type_and_see("m", "read-only: a CalculiX run that is over");
    session.resize(120, 40);
    session.see("Attempts: 13");
    session.type_and_see("/39\r", "node 39");
    session.type_and_see("?", "What can be done");
    session.type_and_see(ESC, "Attempts: 13");
    // There is no shell here that could continue it; who sends a signal can.
    session.type_and_see(CTRL_Z, "it cannot be suspended");
    session.signal("TSTP");
    session.wait("the shell's screen", Session::on_main_screen);
    let back = patiently(|| {
        session.signal("CONT");
        session.screen(Screen::alternate_screen).then_some(())
    });
    assert!(back.is_some(), "it does not come back");
    session.see("Attempts: 13");
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
            format!("`stickslip show {cel}` prints it as text"),
        ),
        (
            vec![cel, "--set", "a=b"],
            format!("--set does not go with it; it is {}", words::READ_ONLY),
        ),
        (vec![&sta], format!("`stickslip {cel}`")),
        (
            vec!["run", cel],
            format!("this is the .cel of a CalculiX run that is over; `stickslip {cel}` reads it"),
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
        let mut app = app("two-blocks");
        for name in typed {
            app.type_keys(name);
            prop_assert!(app.cursor < app.past.len() && app.selected < app.past.run.slaves.len());
        }
        screen::text(&app, size.0, size.1);
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
