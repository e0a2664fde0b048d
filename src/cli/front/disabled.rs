//! Replaces `front` in a build without the feature `tui`: every function reports that this build has no debugger.

use super::base::Error;
use stickslip_debugger::record::journal::Record;
use stickslip_debugger::{Colours, JournalTarget, Lesson, Session};

/// Fails: this build has no debugger.
pub fn ready() -> Result<(), Error> {
    let text = "this build has no debugger; cargo install --path . --features tui";
    Err(Error::usage(text))
}

pub fn debug(_: Option<String>, _: &[(String, String)], _: &JournalTarget) -> Result<(), Error> {
    ready()
}

pub fn resume(_: Session, _: &str) -> Result<(), Error> {
    ready()
}

pub fn lesson(_: Lesson, _: Option<usize>) -> Result<(), Error> {
    ready()
}

pub fn film(_: &Record, _: Session, _: Option<(u16, u16)>) -> Result<String, Error> {
    ready().map(|()| String::new())
}

pub struct MainScreen<'a> {
    pub name: &'a str,
    pub scene: Option<&'a str>,
    pub keys: &'a str,
}

pub const MAIN_SCREENS: [MainScreen<'static>; 0] = [];
pub const SIZES: [(u16, u16); 0] = [];

pub fn screenshots(
    _: &MainScreen<'_>,
    _: (u16, u16),
    _: &[Colours],
) -> Result<Vec<Vec<u8>>, Error> {
    ready().map(|()| Vec::new())
}
