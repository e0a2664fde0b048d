//! `stickslip story JOURNAL`: what a session did and saw, as text; or what a CalculiX run that is over did.

use super::base::{Error, Exit, say};
use super::past;
use crate::explain::past::summary;
use crate::record::journal::Record;
use crate::record::story::story;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// A journal, or the .cel of a CalculiX run that is over
    journal: PathBuf,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    if let Some(past) = args
        .journal
        .to_str()
        .map(past::named)
        .transpose()?
        .flatten()
    {
        say(&summary::text(&past))?;
        return Ok(Exit::Good);
    }
    let record = Record::read(&args.journal)?;
    say(&story(&record)?)?;
    Ok(Exit::Good)
}
