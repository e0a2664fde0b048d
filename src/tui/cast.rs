//! Converts a journal to a film in the asciicast v2 format, with one screen after each entry.
//!
//! The times are computed from the length of the text, so that a journal always gives the same file. Each entry is also a marker at
//! which a player can stop. Only changed rows are written.

use crate::app::App;
use crate::screen;
use crate::theme::{Theme, terminal_number};
use crate::view::View;
use ratatui::buffer::{Buffer, Cell};
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier};
use std::fmt::Write;
use stickslip_core::Model;
use stickslip_debugger::Session;
use stickslip_debugger::record::journal::{Entry, JournalError, Record};
use stickslip_debugger::record::story;
use stickslip_scene::shown;

/// Columns and rows, if none are given.
pub const SIZE: (u16, u16) = (120, 36);
/// Seconds per screen: a base, an amount per character of the message, and a maximum.
const STAY: f64 = 1.5;
const LETTER: f64 = 0.04;
const LONGEST: f64 = 6.0;
/// Seconds that the first screen is shown.
const FIRST: f64 = 2.5;

/// Replays a journal in `session`, which must be at its start, and returns the film, of `size` columns and rows.
///
/// # Errors
/// If the journal's scene is invalid, or the replay does not reach the same states.
pub fn film(record: &Record, session: Session, size: (u16, u16)) -> Result<String, JournalError> {
    let model = record.scene()?.model;
    let mut film = Film::new(&record.header.name, size);
    let see = &mut |session: &Session, entry: Option<&Entry>| film.show(session, &model, entry);
    record.replay_in(session, see)?;
    film.end();
    Ok(film.text)
}

struct Film {
    app: App,
    text: String,
    time: f64,
    before: Buffer,
}

impl Film {
    fn new(title: &str, (width, height): (u16, u16)) -> Film {
        let area = Rect::new(0, 0, width, height);
        let title = format!("stickslip {}", shown::cut(title, 80));
        let text = format!(
            "{{\"version\": 2, \"width\": {width}, \"height\": {height}, \"title\": {}, \"env\": {{\"TERM\": \"xterm-256color\"}}}}\n",
            quoted(&title)
        );
        Film {
            app: App::new(Theme::colour(), Vec::new()),
            text,
            time: 0.0,
            before: Buffer::empty(area),
        }
    }

    /// Adds the screen after an entry, or before the first.
    fn show(&mut self, session: &Session, model: &Model, entry: Option<&Entry>) {
        let view = View::new(session);
        match entry {
            None => self.output("\u{1b}[2J\u{1b}[?25l"),
            Some(entry) => {
                let done = story::done(model, entry);
                self.line('m', &shown::cut(&done, 200));
                self.app.say(entry.said.as_str());
            }
        }
        let mut now = Buffer::empty(self.before.area);
        screen::draw(&mut now, self.before.area, &self.app, Some(&view));
        let changed = rows(&self.before, &now);
        self.output(&changed);
        self.before = now;
        self.time += match entry {
            None => FIRST,
            Some(entry) => {
                let letters = entry.said.chars().count() as f64;
                (STAY + LETTER * letters).min(LONGEST)
            }
        };
    }

    /// Holds the last screen and shows the cursor again.
    fn end(&mut self) {
        let below = format!("\u{1b}[0m\u{1b}[{};1H\u{1b}[?25h", SIZE.1);
        self.output(&below);
    }

    fn output(&mut self, text: &str) {
        if !text.is_empty() {
            self.line('o', text);
        }
    }

    fn line(&mut self, kind: char, text: &str) {
        // Writing to a string does not fail.
        let _ = writeln!(
            self.text,
            "[{:.3}, \"{kind}\", {}]",
            self.time,
            quoted(text)
        );
    }
}

/// The escape sequences that turn the rows of one buffer into those of another.
fn rows(before: &Buffer, now: &Buffer) -> String {
    let mut text = String::new();
    let area = now.area;
    for y in area.top()..area.bottom() {
        let cells = |buffer: &Buffer| -> Vec<Cell> {
            (area.left()..area.right())
                .map(|x| buffer[(x, y)].clone())
                .collect()
        };
        let row = cells(now);
        if row == cells(before) {
            continue;
        }
        let _ = write!(text, "\u{1b}[{};1H", y + 1);
        let mut style = String::new();
        let mut hidden = 0;
        for cell in &row {
            // The second cell of a wide character is covered by it.
            if hidden > 0 {
                hidden -= 1;
                continue;
            }
            let wanted = sgr(cell);
            if wanted != style {
                text.push_str(&wanted);
                style = wanted;
            }
            text.push_str(cell.symbol());
            hidden = unicode_width::UnicodeWidthStr::width(cell.symbol()).saturating_sub(1);
        }
        text.push_str("\u{1b}[0m");
    }
    text
}

/// The escape sequence (SGR) that sets exactly a cell's colours and weights.
fn sgr(cell: &Cell) -> String {
    let mut codes = vec!["0".to_owned()];
    let weights = [
        (Modifier::BOLD, "1"),
        (Modifier::DIM, "2"),
        (Modifier::ITALIC, "3"),
        (Modifier::UNDERLINED, "4"),
        (Modifier::REVERSED, "7"),
    ];
    let set = weights
        .iter()
        .filter(|(weight, _)| cell.modifier.contains(*weight));
    codes.extend(set.map(|(_, code)| (*code).to_owned()));
    codes.extend(colour(cell.fg, 30));
    codes.extend(colour(cell.bg, 40));
    format!("\u{1b}[{}m", codes.join(";"))
}

/// The SGR code of a colour; `base` is 30 for the foreground and 40 for the background.
fn colour(colour: Color, base: u8) -> Option<String> {
    match colour {
        Color::Reset => None,
        Color::Indexed(k) => Some(format!("{};5;{k}", base + 8)),
        Color::Rgb(r, g, b) => Some(format!("{};2;{r};{g};{b}", base + 8)),
        named => terminal_number(named).map(|number| {
            // The second eight are the light ones.
            let code = if number < 8 { base } else { base + 60 - 8 } + number;
            code.to_string()
        }),
    }
}

/// A text as a JSON string.
fn quoted(text: &str) -> String {
    let mut quoted = String::from('"');
    for c in text.chars() {
        match c {
            '"' => quoted.push_str("\\\""),
            '\\' => quoted.push_str("\\\\"),
            c if c.is_control() => {
                let _ = write!(quoted, "\\u{:04x}", c as u32);
            }
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    use super::*;
    use ratatui::style::Style;

    #[test]
    fn only_changed_rows_are_written_and_styles_are_reset() {
        let area = Rect::new(0, 0, 4, 3);
        let before = Buffer::empty(area);
        let mut now = before.clone();
        now.set_string(1, 1, "ab", Style::new().fg(Color::Cyan));
        assert_eq!(
            rows(&before, &now),
            "\u{1b}[2;1H\u{1b}[0m \u{1b}[0;36mab\u{1b}[0m \u{1b}[0m"
        );
        assert_eq!(rows(&now, &now), "");
    }

    #[test]
    fn texts_are_json() {
        assert_eq!(quoted("a\"\\\u{1b}é"), "\"a\\\"\\\\\\u001bé\"");
    }
}
