//! A journal as a film: what a player shows in the end is the screen of the session.

use crate::terminal::cells;
use std::path::Path;
use stickslip::record::journal::Record;
use stickslip::session::Session;
use stickslip::tui::app::App;
use stickslip::tui::cast::{SIZE, film};
use stickslip::tui::screen;
use stickslip::tui::theme::Theme;
use stickslip::tui::view::View;

/// A text that JSON has in quotes.
fn unquoted(text: &str) -> String {
    let inner = text.strip_prefix('"').and_then(|t| t.strip_suffix('"'));
    let (mut plain, mut letters) = (String::new(), inner.unwrap().chars());
    while let Some(c) = letters.next() {
        match (c, c == '\\') {
            (_, false) => plain.push(c),
            _ => match letters.next().unwrap() {
                'u' => {
                    let code: String = letters.by_ref().take(4).collect();
                    let code = u32::from_str_radix(&code, 16).unwrap();
                    plain.push(char::from_u32(code).unwrap());
                }
                other => plain.push(other),
            },
        }
    }
    plain
}

#[test]
fn the_last_screen_of_a_film_is_that_of_the_session() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/journals");
    let journals = [
        ("forced-and-turned.journal", SIZE),
        ("up-the-ladder.journal", (80, 24)),
    ];
    for (name, size) in journals {
        let record = Record::read(&folder.join(name)).unwrap();
        let session = || Session::new(record.scene().unwrap());
        let made = film(&record, session(), size).unwrap();
        assert_eq!(
            made,
            film(&record, session(), size).unwrap(),
            "not the same bytes"
        );
        let mut terminal = vt100::Parser::new(cells(size.1), cells(size.0), 0);
        for line in made.lines().skip(1) {
            let (_, rest) = line.trim_end_matches(']').split_once(", ").unwrap();
            let (kind, text) = rest.split_once(", ").unwrap();
            // The last order puts the cursor back, and letters stay.
            if kind == "\"o\"" {
                terminal.process(unquoted(text).as_bytes());
            }
        }
        let shown: Vec<String> = terminal.screen().rows(0, size.0).collect();
        let session = record.replay().unwrap();
        let mut app = App::new(Theme::colour(), Vec::new());
        app.say(record.entries.last().unwrap().1.said.as_str());
        let wanted = screen::text(&app, Some(&View::new(&session)), size.0, size.1);
        for (row, wanted) in shown.iter().zip(wanted.lines()) {
            assert_eq!(row.trim_end(), wanted, "{name}");
        }
    }
}
