//! What stands for `front` in a build without the feature `tui`: all of it says that this build has no debugger.

use super::base::Error;
use stickslip_debugger::record::journal::{Keep, Record};
use stickslip_debugger::session::Session;
use stickslip_debugger::teach::Lesson;

/// Whether this build has the debugger: it has not.
pub fn ready() -> Result<(), Error> {
    let told = "this build has no debugger; cargo install stickslip --features tui";
    Err(Error::Usage(told.to_owned()))
}

/// Would be the debugger on a scene.
pub fn debug(_: Option<String>, _: &[(String, String)], _: &Keep) -> Result<(), Error> {
    ready()
}

/// Would be the debugger on a session.
pub fn resume(_: Session, _: &str) -> Result<(), Error> {
    ready()
}

/// Would be a guided lesson.
pub fn lesson(_: Lesson) -> Result<(), Error> {
    ready()
}

/// Would be a journal as a film.
pub fn film(_: &Record, _: Session) -> Result<String, Error> {
    ready().map(|()| String::new())
}
