//! The debugger in the terminal, as subcommands begin it. A build without the feature `tui` has `frontless.rs` instead.

use super::base::Error;
use stickslip_debugger::record::journal::{Keep, Record};
use stickslip_debugger::session::Session;
use stickslip_debugger::teach::Lesson;
use stickslip_tui as tui;

/// That this build has the debugger.
pub fn ready() -> Result<(), Error> {
    Ok(())
}

/// The debugger on a scene; without one, it offers the built-in ones.
pub fn debug(scene: Option<String>, set: &[(String, String)], keep: &Keep) -> Result<(), Error> {
    tui::run(scene, set, keep).map_err(told)
}

/// The debugger on a session that was replayed.
pub fn resume(session: Session, words: &str) -> Result<(), Error> {
    tui::resume(session, words).map_err(told)
}

/// A guided lesson.
pub fn lesson(lesson: Lesson) -> Result<(), Error> {
    tui::run_lesson(lesson).map_err(told)
}

/// A journal as a film.
pub fn film(record: &Record, session: Session) -> Result<String, Error> {
    Ok(tui::cast::film(record, session)?)
}

fn told(error: impl ToString) -> Error {
    Error::Usage(error.to_string())
}
