//! `stickslip resume [JOURNAL]`: replays a journal, and continues in the debugger.

use super::base::{Error, Exit, notify};
use super::debugger::{DEBUGGER, needs_terminal};
use super::front;
use super::solver::{SolverArgs, session_of};
use std::path::PathBuf;
use stickslip_core::counted;
use stickslip_debugger::record::journal::{self, Journal, JournalError, Record};

#[derive(Debug, clap::Args)]
pub struct Args {
    /// A journal [default: the most recent one]
    journal: Option<PathBuf>,
    /// Only verifies that the replay is bit-identical, without opening the debugger
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    solver: SolverArgs,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    if !args.check {
        front::ready()?;
        needs_terminal(DEBUGGER, "resume --check` replays without one")?;
    }
    let path = match &args.journal {
        Some(path) => path.clone(),
        None => journal::newest()?,
    };
    let mut record = Record::read(&path)?;
    let mut kept = None;
    if !args.check {
        // Locks the journal during the replay; it may have grown before the lock, so it is read again.
        let journal = Journal::open(&path)?;
        record = Record::read(&path)?;
        kept = Some(journal);
    }
    let solved: u64 = record.entries.iter().map(|(_, entry)| entry.solved).sum();
    let text = format!(
        "{}: {}, {}",
        path.display(),
        counted(record.entries.len(), "entry"),
        counted(solved, "minor iteration")
    );
    notify(&format!("replaying {text}"));
    let session = session_of(&record, &args.solver)?;
    let mut session = match record.replay_in(session, &mut |_, _| {}) {
        Err(error @ JournalError::Differs { .. }) => {
            notify(&error.to_string());
            return Ok(Exit::Differ);
        }
        replayed => replayed?,
    };
    let reservations = record.reservations();
    let Some(mut journal) = kept else {
        notify(&format!("replay is bit-identical{reservations}"));
        return Ok(Exit::Good);
    };
    journal.cut(record.whole_bytes)?;
    session.journal_mut().write_to(journal);
    let text = format!(
        "resumed after {}{reservations}",
        counted(record.entries.len(), "entry")
    );
    front::resume(session, &text)?;
    Ok(Exit::Good)
}
