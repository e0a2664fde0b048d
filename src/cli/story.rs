//! `stickslip story JOURNAL`: prints a journal as text, or a finished run of CalculiX or of an attached solver.

use super::base::{Error, Exit, answer};
use std::path::PathBuf;
use stickslip_debugger::Recording;
use stickslip_debugger::record::journal::{self, Record};
use stickslip_debugger::record::story::story;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// A journal, the .cel file of a finished CalculiX run, or the recorded exchange of an attached solver [default: the newest
    /// journal]
    journal: Option<PathBuf>,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let journal = match &args.journal {
        Some(journal) => journal.clone(),
        None => journal::newest()?,
    };
    if let Some(name) = journal.to_str()
        && let Some(mut recording) = Recording::open(name).map_err(Error::Usage)?
    {
        return answer(&recording.text(name));
    }
    let record = Record::read(&journal)?;
    answer(&story(&record)?)
}
