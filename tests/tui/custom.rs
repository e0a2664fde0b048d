//! Keys, colours and the mouse as the user wants them; what is copied and looked for.

use crate::terminal::{Session, Start};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier};
use std::fs;
use stickslip::action::{Colours, Keymap};
use stickslip::history::verdicts::summaries;
use stickslip::scene::Scene;
use stickslip::session;
use stickslip::tui::debugger::TerminalRequest;
use stickslip::tui::event::{Event, MouseAction, MouseEvent};
use stickslip::tui::layout::Pane;
use stickslip::tui::theme::Theme;
use stickslip::tui::{Debugger, keys, screen};
use tempfile::TempDir;
use vt100::{MouseProtocolEncoding, MouseProtocolMode};

const FLOOR: &str = "01-pinned-beam-rough-floor";

fn debugger(scene: &str, keys: &str, size: (u16, u16)) -> Debugger {
    let session = session::Session::new(Scene::open(scene, &[]).unwrap());
    let mut debugger = Debugger::new(Theme::colour(), Vec::new(), Some(session));
    debugger.app.area = Rect::new(0, 0, size.0, size.1);
    debugger.type_keys(keys);
    debugger
}

fn text(debugger: &Debugger) -> String {
    debugger.text(debugger.app.area.width, debugger.app.area.height)
}

/// The place of the first letter of a text on the screen, from the row on that holds the heading.
fn place(debugger: &Debugger, heading: &str, wanted: &str) -> (u16, u16) {
    let text = text(debugger);
    let rows: Vec<&str> = text.lines().collect();
    let first = rows.iter().position(|row| row.contains(heading));
    let first = first.unwrap_or_else(|| panic!("no {heading}\n{text}"));
    for (y, row) in rows.iter().enumerate().skip(first) {
        if let Some(byte) = row.find(wanted) {
            return (row[..byte].chars().count() as u16, y as u16);
        }
    }
    panic!("{wanted} is not under {heading}\n{text}");
}

fn mouse(debugger: &mut Debugger, kind: MouseAction, (column, row): (u16, u16)) {
    let event = MouseEvent { kind, column, row };
    debugger.event(&Event::Mouse(event));
    debugger.settle();
}

fn click(debugger: &mut Debugger, at: (u16, u16)) {
    mouse(debugger, MouseAction::Click, at);
}

#[test]
fn a_click_selects_a_node_in_the_table_and_in_the_shape() {
    for size in [(80, 24), (120, 40), (200, 60)] {
        let mut debugger = debugger("osc-two6", "c", size);
        assert_eq!(debugger.app.selected, 0);
        let at = place(&debugger, "Slave nodes", "b ");
        click(&mut debugger, at);
        assert_eq!(debugger.app.selected, 1, "{size:?}\n{}", text(&debugger));
        assert_eq!(debugger.app.panes.focus, Pane::Nodes);
        let heading = place(&debugger, "Slave nodes", "Slave nodes");
        click(&mut debugger, heading);
        assert_eq!(debugger.app.selected, 1);
        debugger.type_keys("Tab Tab Tab z");
        assert_eq!(debugger.app.panes.focus, Pane::Shape);
        // Both letters stand in one row; a is the one on the left.
        let rows: Vec<String> = text(&debugger).lines().map(String::from).collect();
        let found = rows.iter().enumerate().find_map(|(y, row)| {
            let letters: Vec<char> = row.chars().collect();
            let marked = letters.windows(2).enumerate();
            let marked: Vec<usize> = marked
                .filter(|(_, pair)| pair[0].is_alphabetic() && pair[1] == '!')
                .map(|(x, _)| x)
                .collect();
            (marked.len() == 2 && y > 4).then(|| (marked[0] as u16, y as u16))
        });
        let at = found.unwrap_or_else(|| panic!("{}", text(&debugger)));
        click(&mut debugger, (at.0 + 1, at.1));
        assert_eq!(
            debugger.app.selected,
            0,
            "{size:?} {at:?}\n{}",
            text(&debugger)
        );
    }
}

#[test]
fn a_click_selects_a_branch_a_step_of_the_timeline_and_a_pane() {
    let mut debugger = debugger("osc-two6", "c m x s m s s v", (120, 40));
    let all = summaries(debugger.session.as_ref().unwrap().timeline().tree()).len();
    assert!(all >= 1);
    debugger.type_keys("S S m f s v v");
    let all = summaries(debugger.session.as_ref().unwrap().timeline().tree()).len();
    assert!(all >= 2, "{}", text(&debugger));
    debugger.app.panes.zoomed = true;
    let at = place(&debugger, "Branches", "b1: ");
    click(&mut debugger, at);
    assert_eq!(debugger.app.branch, 0, "{}", text(&debugger));
    let at = place(&debugger, "Branches", "b2: ");
    click(&mut debugger, at);
    assert_eq!(debugger.app.branch, 1, "{}", text(&debugger));

    let mut debugger = self::debugger("osc-two6", "c t", (80, 24));
    let mark = place(&debugger, "Timeline", "▼");
    assert_eq!(debugger.session.as_ref().unwrap().cursor(), 6);
    click(&mut debugger, (mark.0 - 18, mark.1 + 1));
    assert_eq!(
        debugger.session.as_ref().unwrap().cursor(),
        4,
        "{}",
        text(&debugger)
    );
    let mark = place(&debugger, "Timeline", "▼");
    click(&mut debugger, (mark.0 + 9, mark.1 + 2));
    assert_eq!(debugger.session.as_ref().unwrap().cursor(), 5);
    assert_eq!(debugger.app.selected, 1);

    let mut debugger = self::debugger(FLOOR, "s", (120, 40));
    for (pane, title) in [
        (Pane::Shape, "Shape"),
        (Pane::Residual, "Residual"),
        (Pane::Decision, "Decision"),
        (Pane::Nodes, "Slave nodes"),
    ] {
        let at = place(&debugger, title, title);
        click(&mut debugger, at);
        assert_eq!(debugger.app.panes.focus, pane);
    }
}

#[test]
fn the_wheel_scrolls_what_it_is_over_and_the_focus_stays() {
    let mut debugger = debugger("osc-two6", "c", (120, 40));
    let nodes = place(&debugger, "Slave nodes", "b ");
    mouse(&mut debugger, MouseAction::ScrollDown, nodes);
    assert_eq!(debugger.app.selected, 1);
    mouse(&mut debugger, MouseAction::ScrollUp, nodes);
    assert_eq!(debugger.app.selected, 0);
    let shape = place(&debugger, "Shape", "Shape");
    mouse(&mut debugger, MouseAction::ScrollUp, shape);
    assert!(debugger.app.camera.zoom > 1.0);
    assert_eq!(debugger.app.panes.focus, Pane::Nodes);
    debugger.type_keys("?");
    let top = text(&debugger);
    mouse(&mut debugger, MouseAction::ScrollDown, shape);
    assert_ne!(text(&debugger), top);
    mouse(&mut debugger, MouseAction::ScrollUp, shape);
    assert_eq!(text(&debugger), top);
    debugger.type_keys("Esc t");
    mouse(&mut debugger, MouseAction::ScrollUp, (40, 20));
    assert_eq!(debugger.session.as_ref().unwrap().cursor(), 5);
}

#[test]
fn a_mouse_that_is_switched_off_does_nothing() {
    let mut debugger = debugger("osc-two6", "c", (120, 40));
    let at = place(&debugger, "Slave nodes", "b ");
    debugger.type_text(":mouse off");
    assert_eq!(
        debugger.key(&keys::press("Enter").unwrap()),
        Some(TerminalRequest::Mouse(false))
    );
    click(&mut debugger, at);
    assert_eq!(debugger.app.selected, 0);
}

/// What `Y` copies after some keys, and the message.
fn copied(scene: &str, keys: &str, line: &str) -> (Option<String>, String) {
    let mut debugger = debugger(scene, keys, (120, 40));
    let press = |debugger: &mut Debugger, name: &str| debugger.key(&keys::press(name).unwrap());
    let outside = match line {
        "" => press(&mut debugger, "Y"),
        line => {
            debugger.type_text(&format!(":{line}"));
            press(&mut debugger, "Enter")
        }
    };
    let text = match outside {
        Some(TerminalRequest::Copy(text)) => Some(text),
        _ => None,
    };
    (text, debugger.app.message.text)
}

#[test]
fn what_is_selected_is_copied_and_named() {
    let (row, told) = copied("osc-two6", "c Down", "");
    let row = row.unwrap();
    let cells: Vec<&str> = row.split('\t').collect();
    assert_eq!(&cells[..3], ["b", "fixed", "free"]);
    assert_eq!(cells.len(), 8);
    assert!(
        cells[3..].iter().all(|cell| cell.parse::<f64>().is_ok()),
        "{row}"
    );
    assert!(told.starts_with("copied the row of b: b"), "{told}");

    for (keys, line, wanted) in [
        ("c t", "", "goto 6"),
        ("c v", "", "branch b1"),
        (
            "c : f r i c t i o n Space 2 0 Enter",
            "copy command",
            "friction 20",
        ),
    ] {
        let (text, told) = copied("osc-two6", keys, line);
        assert_eq!(text.as_deref(), Some(wanted), "{told}");
    }
    let (margin, _) = copied("osc-two6", "c Tab", "");
    assert!(margin.unwrap().parse::<f64>().is_ok_and(|m| m < 0.0));
    let (force, told) = copied("osc-two6", "c", "copy f_n");
    assert!(force.unwrap().parse::<f64>().is_ok_and(|f| f < 0.0));
    assert!(told.starts_with("copied f_n a: "), "{told}");
    let (found, _) = copied("osc-two6", "c d", "");
    assert!(found.unwrap().contains("of a and b: 1 of 16"));
    let (remedy, _) = copied("osc-two6", "c r Down", "");
    let remedy = remedy.unwrap();
    assert!(
        remedy.starts_with("settings: (") && remedy.ends_with("),"),
        "{remedy}"
    );
    let (keys, _) = copied("osc-two6", "", "copy keys");
    assert_eq!(
        Keymap::read("keys.ron", &keys.unwrap()).map(|k| k.text()),
        Ok(Keymap::default().text()),
        "what is copied can be read again"
    );
    let (nothing, told) = copied("osc-two6", "Tab", "");
    assert_eq!(nothing, None);
    assert!(told.contains("margin a has no value here"), "{told}");
}

#[test]
fn what_is_hidden_until_it_is_predicted_is_not_copied() {
    let (row, _) = copied("osc-two6", "p s", "");
    assert_eq!(row.unwrap().split('\t').nth(2), Some("?"));
    for keys in ["p s t", "p s Tab"] {
        let (nothing, told) = copied("osc-two6", keys, "");
        assert_eq!(nothing, None);
        assert!(told.contains("hidden until"), "{told}");
    }
}

#[test]
fn a_text_is_found_in_the_help_and_in_lists() {
    let mut debugger = debugger("osc-two6", "? / b r a n c h e s Enter", (80, 24));
    let first = text(&debugger);
    assert!(first.contains("branches"), "{first}");
    debugger.type_keys("n");
    let second = text(&debugger);
    assert_ne!(first, second);
    debugger.type_keys("N");
    assert_eq!(text(&debugger), first);
    debugger.type_keys("/ z z z Enter");
    assert!(text(&debugger).contains("no match for 'zzz'"));
    debugger.type_keys("j");
    assert!(!text(&debugger).contains("no match for"));
    // The end is the end: a key up moves at once.
    debugger.type_keys("G");
    let end = text(&debugger);
    debugger.type_keys("k");
    assert_ne!(text(&debugger), end);

    let mut debugger = self::debugger("osc-two6", "c r / i n c r e m e n t Enter", (80, 24));
    let label = |debugger: &Debugger| {
        let text = text(debugger);
        let row = text.lines().find(|row| row.contains('▸')).unwrap();
        row.to_owned()
    };
    let first = label(&debugger);
    assert!(first.contains("increment"), "{first}");
    debugger.type_keys("/ Enter");
    let second = label(&debugger);
    assert!(second.contains("increment") && second != first, "{second}");
    debugger.type_keys("/ z z Enter");
    assert!(text(&debugger).contains("no entry of this list contains 'zz'"));
    debugger.type_keys("Esc Tab / b Enter");
    assert_eq!(debugger.app.selected, 1);
}

#[test]
fn footer_help_and_completion_show_the_present_keys() {
    let mut debugger = debugger(FLOOR, "", (120, 80));
    let file = "{\"step\": [\"x\", \"F2\"], \"diagnosis\": []}";
    debugger.app.keymap = Keymap::read("keys.ron", file).unwrap();
    let footer = text(&debugger)
        .trim_end()
        .lines()
        .last()
        .unwrap()
        .to_owned();
    assert!(
        footer.contains(" x step") && !footer.contains("diagnosis"),
        "{footer}"
    );
    debugger.type_keys("s");
    assert!(text(&debugger).contains("s is not bound here"));
    debugger.type_keys("x");
    assert_eq!(debugger.session.as_ref().unwrap().cursor(), 1);
    debugger.type_keys("2 F2");
    assert_eq!(debugger.session.as_ref().unwrap().cursor(), 3);
    debugger.type_keys("?");
    let help = text(&debugger);
    let row = help
        .lines()
        .find(|row| row.contains("step [COUNT]"))
        .unwrap();
    assert!(row.contains(" x F2 "), "{row}");
    debugger.type_keys("Esc : s t e p");
    assert!(text(&debugger).contains("[x F2]"), "{}", text(&debugger));
    debugger.type_keys("Esc : x Enter");
    assert_eq!(debugger.session.as_ref().unwrap().cursor(), 4);
    debugger.type_keys(": k e y s Enter");
    let listed = text(&debugger);
    assert!(
        listed.contains("\"step\": [\"x\", \"F2\"],   // changed"),
        "{listed}"
    );
    assert!(listed.contains("\"next\": [\"n\", \"F10\"],"), "{listed}");
}

#[test]
fn every_theme_tells_the_modes_by_letters_first_and_none_of_them_hides_a_cell() {
    for colours in Colours::ALL {
        let mut debugger = debugger("osc-two6", "c", (120, 40));
        let plain = text(&debugger);
        debugger.app.theme = Theme::new(colours);
        // The letters are the same, whatever the colours.
        assert_eq!(text(&debugger), plain);
        let area = debugger.app.area;
        let mut buffer = Buffer::empty(area);
        screen::draw(&mut buffer, area, &debugger.app, debugger.view().as_ref());
        for cell in buffer.content() {
            let coloured = cell.fg != Color::Reset || cell.bg != Color::Reset;
            assert!(colours != Colours::None || !coloured, "{cell:?}");
            assert_ne!((cell.fg, cell.bg), (Color::Black, Color::Black));
            if colours == Colours::HighContrast {
                assert_eq!(cell.bg, Color::Black, "{cell:?}");
                assert!(!cell.modifier.contains(Modifier::DIM), "{cell:?}");
            }
        }
    }
}

/// A folder with files of the user's.
fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let ours = folder.path().join("stickslip");
    fs::create_dir(&ours).unwrap();
    for (name, text) in files {
        fs::write(ours.join(name), text).unwrap();
    }
    folder
}

fn started<'a>(folder: &'a TempDir, more: &[(&'a str, &'a str)]) -> Session {
    let mut start = Start::debugger(&["osc-two6"]);
    start = start.variable("XDG_CONFIG_HOME", folder.path().to_str().unwrap());
    for (name, value) in more {
        start = start.variable(name, value);
    }
    start.go()
}

#[test]
fn the_terminal_reports_the_mouse_only_while_it_is_wanted() {
    let modes = |session: &Session| {
        session.screen(|screen| {
            (
                screen.mouse_protocol_mode(),
                screen.mouse_protocol_encoding(),
            )
        })
    };
    let on = (MouseProtocolMode::PressRelease, MouseProtocolEncoding::Sgr);
    let off = (MouseProtocolMode::None, MouseProtocolEncoding::Default);
    let none = folder(&[]);
    let mut session = started(&none, &[]);
    session.see("nothing is solved yet");
    assert_eq!(modes(&session), on);
    session.type_and_see("c", "repeat with period 6");
    let rows = session.text();
    let row = rows.lines().position(|row| row.contains("* b ")).unwrap();
    session.type_and_see(&format!("\x1b[<0;8;{}M", row + 1), "Decision  b");
    session.type_and_see(":mouse off\r", "mouse off; :mouse on turns it on");
    assert_eq!(modes(&session), off);
    session.type_and_see(":mouse on\r", "mouse on: click selects");
    assert_eq!(modes(&session), on);
    session.signal("TSTP");
    session.see_restored();
    assert_eq!(modes(&session), off);
    let back = crate::terminal::patiently(|| {
        session.signal("CONT");
        session
            .screen(|screen| screen.alternate_screen())
            .then_some(())
    });
    assert!(back.is_some());
    session.wait("the mouse again", |screen| {
        screen.mouse_protocol_mode() == on.0
    });
    let seen = std::sync::Arc::clone(&session.seen);
    session.quit();
    let mode = seen.lock().unwrap().parser.screen().mouse_protocol_mode();
    assert_eq!(mode, off.0);

    let never = folder(&[("debugger.ron", "(mouse: false)")]);
    let session = started(&never, &[]);
    session.see("nothing is solved yet");
    assert_eq!(modes(&session), off);
    session.quit();
}

#[test]
fn a_copy_goes_to_the_terminal_as_one_order_of_harmless_letters_colours_or_not() {
    let none = folder(&[]);
    let mut session = started(&none, &[("NO_COLOR", "1")]);
    session.see("nothing is solved yet");
    session.type_and_see("Y", "copied the row of a: a");
    let seen = std::sync::Arc::clone(&session.seen);
    session.quit();
    let raw = String::from_utf8_lossy(&seen.lock().unwrap().raw).into_owned();
    // "a\tfree\tfree"
    let wanted = "\x1b]52;c;YQlmcmVlCWZyZWU=\x1b\\";
    assert!(raw.contains(wanted), "{raw:?}");
    assert_eq!(raw.matches("\x1b]52").count(), 1);
}

#[test]
fn the_user_s_files_give_keys_and_colours_and_no_color_wins() {
    let files = [
        ("keys.ron", "{\"step\": [\"x\"]}"),
        ("debugger.ron", "(colours: high_contrast)"),
    ];
    let mine = folder(&files);
    let black = |session: &Session| {
        session.screen(|screen| screen.cell(0, 3).unwrap().bgcolor()) != vt100::Color::Default
    };
    let mut session = started(&mine, &[]);
    session.see(" x step");
    session.type_and_see("x", "minor 1");
    assert!(black(&session));
    session.type_and_see(":colours dark\r", "colours: dark");
    session.wait("another ground", |screen| {
        screen.cell(0, 3).unwrap().bgcolor() == vt100::Color::Default
    });
    session.type_and_see(
        ":colours purple\r",
        "unknown word 'purple'; expected one of: dark, light, high contrast, none",
    );
    session.quit();
    let mut session = started(&mine, &[("NO_COLOR", "1")]);
    session.see(" x step");
    assert!(!black(&session));
    session.type_and_see(":colours light\r", "the environment sets NO_COLOR");
    session.quit();
}

#[test]
fn colours_follow_a_light_background_and_keys_around_the_reply_are_kept() {
    let nothing = folder(&[]);
    let tinted = |session: &Session, wanted: u8| {
        let free = |screen: &vt100::Screen| {
            let (rows, columns) = screen.size();
            let (rows, columns) = (rows.get(), columns.get());
            let mut cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
            cells.any(|(row, column)| {
                let cell = screen.cell(row, column).unwrap();
                cell.fgcolor() == vt100::Color::Idx(wanted)
            })
        };
        session.wait(&format!("colour {wanted}"), free);
    };
    // Warnings are yellow on a dark background and magenta on a light one.
    let (yellow, magenta) = (3, 5);
    let mut session = started(&nothing, &[]);
    session.see(" s step");
    // The mark of a held mode is a warning.
    session.type_and_see("mF", "◆");
    tinted(&session, yellow);
    session.keys("s\x1b]11;rgb:ffff/ffff/dddd\x1b\\s");
    session.see("minor 2");
    tinted(&session, magenta);
    session.type_and_see(":colours dark\r", "colours: dark");
    tinted(&session, yellow);
    session.quit();
    let mut session = started(&nothing, &[("COLORFGBG", "0;15")]);
    session.see(" s step");
    session.type_and_see("mF", "◆");
    tinted(&session, magenta);
    session.quit();
}

#[test]
fn a_wrong_file_of_the_user_s_ends_the_program_with_its_place_and_what_would_be_right() {
    for (file, text, told) in [
        (
            "keys.ron",
            "{\n \"stpe\": []}",
            "keys.ron:2:2: unknown action \"stpe\"; did you mean \"step\"?",
        ),
        (
            "debugger.ron",
            "(colors: dark)",
            "did you mean \"colours\"?",
        ),
    ] {
        let mine = folder(&[(file, text)]);
        let mut session = started(&mine, &[]);
        let status = session.end();
        assert_eq!(status.exit_code(), 2);
        let whole = |screen: &vt100::Screen| screen.contents().replace('\n', "");
        session.wait(told, |screen| whole(screen).contains(told));
        session.see_restored();
    }
}
