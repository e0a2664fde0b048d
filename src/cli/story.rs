//! `stickslip story JOURNAL`: what a session did and saw, as text.

use super::base::{Error, Exit, say};
use crate::record::journal::Record;
use crate::record::story::story;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// A journal
    journal: PathBuf,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let record = Record::read(&args.journal)?;
    say(&story(&record)?)?;
    Ok(Exit::Good)
}
