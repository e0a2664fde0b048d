//! `stickslip story JOURNAL`: what a session did and saw, as text; or what a CalculiX run
//! that is over did, or an attached solver whose exchange was kept.

use super::base::{Error, Exit, say};
use super::past;
use crate::attach::story as kept;
use crate::explain::past::summary;
use crate::record::journal::Record;
use crate::record::story::story;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// A journal, the .cel of a CalculiX run that is over, or the kept exchange of an attached solver
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
    if let Some(mut opened) = args.journal.to_str().map(past::kept).transpose()?.flatten() {
        let name = args.journal.display().to_string();
        say(&kept::story(&name, &mut opened))?;
        return Ok(Exit::Good);
    }
    let record = Record::read(&args.journal)?;
    say(&story(&record)?)?;
    Ok(Exit::Good)
}
