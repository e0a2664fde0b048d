//! The event loop for a run that is over. Nothing runs here: it waits for keys, signals, and another size of the terminal.

use super::app::{App, Overlay};
use super::{panes, screen};
use crate::action::Keymap;
use crate::action::config::Config;
use crate::explain::past::run::Past;
use crate::tui::keys;
use crate::tui::run::{BUSY, Error, IDLE, leave, next_event, obey, stop};
use crate::tui::terminal::{Signals, Terminal};
use crate::tui::theme::Theme;
use crossterm::event::Event;
use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

/// Shows a run in the terminal.
///
/// # Errors
/// If there is no terminal, or it fails.
pub fn run(past: Past) -> Result<(), Error> {
    if !io::stdin().is_terminal() || !io::stdout().is_terminal() {
        return Err(Error::NoTerminal);
    }
    let config = Config::open()?;
    let mut app = App::new(past, Theme::chosen(config.colours), config.keymap);
    let signals = Signals::listen()?;
    let ended = Terminal::enter().and_then(|mut terminal| {
        terminal.heed_mouse(false)?;
        events(&mut app, &mut terminal, &signals)
    });
    leave(ended, &signals)
}

fn events(app: &mut App, terminal: &mut Terminal, signals: &Signals) -> io::Result<()> {
    let mut changed = true;
    let mut drawn = Instant::now();
    while signals.end().is_none() {
        if std::mem::take(&mut changed) {
            let area = terminal.show(|buffer, area| screen::draw(buffer, area, app))?;
            drawn = Instant::now();
            if matches!(app.overlay, Overlay::Help(..)) {
                let help = panes::help(app, usize::from(area.width.saturating_sub(2)));
                app.shows_help(help.iter().map(ToString::to_string).collect());
            }
        }
        let mut input = next_event(IDLE)?;
        while let Some(event) = input {
            changed = true;
            let outside = match event {
                Event::Key(key) => keys::apart(&key).find_map(|key| app.key(&key)),
                Event::Paste(text) => {
                    app.paste(&text);
                    None
                }
                _ => None,
            };
            if let Some(outside) = outside
                && obey(outside, terminal, signals, &mut |text| app.complain(text))?
            {
                return Ok(());
            }
            // The scroll range of the help is known only after drawing.
            let waits = matches!(app.overlay, Overlay::Help(..)) || drawn.elapsed() >= BUSY;
            input = match waits {
                true => None,
                false => next_event(Duration::ZERO)?,
            };
        }
        if signals.stop() {
            stop(terminal, signals)?;
            changed = true;
        }
        if signals.resumed() {
            terminal.retake()?;
            changed = true;
        }
    }
    Ok(())
}

/// The screen of a run after some keys, as plain text: the program's own picture of itself. Keys are named as in the table and
/// parted by blanks.
pub fn picture(past: Past, keys: &str, width: u16, height: u16) -> String {
    let mut app = App::new(past, Theme::mono(), Keymap::default());
    app.type_keys(keys);
    screen::text(&app, width, height)
}
