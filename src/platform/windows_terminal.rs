//! The console of Windows.

use super::Answers;
use crossterm::event::{DisableMouseCapture, EnableMouseCapture};
use std::io::{self, IsTerminal, stdout};

/// Columns and rows of the terminal on standard output; `None` if it is not a terminal, or its size is not known.
pub fn size() -> Option<(u16, u16)> {
    let size = stdout().is_terminal().then(crossterm::terminal::size)?;
    size.ok()
        .filter(|(columns, rows)| *columns > 0 && *rows > 0)
}

/// Enables or disables reports of the mouse.
///
/// # Errors
/// If there is no console.
pub fn report_mouse(on: bool) -> io::Result<()> {
    if on {
        crossterm::execute!(stdout(), EnableMouseCapture)
    } else {
        crossterm::execute!(stdout(), DisableMouseCapture)
    }
}

/// `None`: the console is not queried.
///
/// # Errors
/// Never.
pub fn ask() -> io::Result<Option<Answers>> {
    Ok(None)
}
