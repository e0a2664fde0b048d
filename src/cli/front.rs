//! Entry points of the terminal debugger for the subcommands. A build without the feature `tui` uses `front/disabled.rs` instead.

use super::base::Error;
use stickslip_debugger::record::journal::Record;
use stickslip_debugger::{Colours, JournalTarget, Lesson, Session};
use stickslip_tui as tui;

pub use tui::main_screens::{MAIN_SCREENS, MainScreen, SIZES};

/// Succeeds: this build has the debugger.
pub fn ready() -> Result<(), Error> {
    Ok(())
}

/// Opens the debugger on a scene, or on the chooser.
pub fn debug(
    scene: Option<String>,
    set: &[(String, String)],
    keep: &JournalTarget,
) -> Result<(), Error> {
    tui::run(scene, set, keep).map_err(Error::usage)
}

/// Opens the debugger on a replayed session.
pub fn resume(session: Session, words: &str) -> Result<(), Error> {
    tui::resume(session, words).map_err(Error::usage)
}

/// Starts a guided lesson at a step (from 0), or else where the user left it.
pub fn lesson(lesson: Lesson, step: Option<usize>) -> Result<(), Error> {
    tui::run_lesson(lesson, step).map_err(Error::usage)
}

/// Converts a journal to a film.
pub fn film(record: &Record, session: Session, size: Option<(u16, u16)>) -> Result<String, Error> {
    let size = size.unwrap_or(tui::cast::SIZE);
    Ok(tui::cast::film(record, session, size)?)
}

/// A screen as PNG, in each of these colours.
pub fn screenshots(
    screen: &MainScreen<'_>,
    size: (u16, u16),
    colours: &[Colours],
) -> Result<Vec<Vec<u8>>, Error> {
    let mono = tui::theme::Theme::mono();
    let mut debugger =
        tui::after_keys(screen.scene, screen.keys, size, mono).map_err(Error::Usage)?;
    colours
        .iter()
        .map(|&colours| {
            debugger.app.theme = tui::theme::Theme::new(colours);
            tui::screenshot::png(&debugger, size, colours).map_err(Error::usage)
        })
        .collect()
}
