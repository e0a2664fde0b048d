//! A session made again from its journal, to the same bits.

use super::machine::Session;
use super::refusal::Departure;
use crate::record::command::{Command, Unit};
use crate::record::journal::{self, Entry, Journal, JournalError, Keep, Record};
use stickslip_scene::shown;

impl Session {
    /// Does what an entry of a journal says.
    ///
    /// # Errors
    /// A message where it leads elsewhere than it did.
    fn replay(&mut self, entry: &Entry) -> Result<(), Departure> {
        match &entry.command {
            // Those that write files must not be done on the word of a file.
            command if command.is_look() => return Err(Departure::NoMotion),
            command if command.is_motion() => self.travel(entry.solved, entry.cursor)?,
            command => {
                self.submit(command.clone())?;
                self.wait();
            }
        }
        let place = (self.tree.current(), self.cursor);
        if place != (entry.branch, entry.cursor) {
            return Err(Departure::Leads {
                now: (place.0 + 1, place.1),
                then: (entry.branch.saturating_add(1), entry.cursor),
            });
        }
        let digest = journal::digest(&self.frame().state);
        if digest != entry.digest {
            return Err(Departure::State {
                now: digest,
                then: shown::cut(&entry.digest, 40).to_string(),
            });
        }
        // A motion is replayed as far as it went, and not as it was told.
        match entry.command.is_motion() {
            true => self.diary.add(entry.clone()),
            false => self.diary.replace_last(entry.clone()),
        }
        Ok(())
    }

    /// Solves so many minor iterations from the tip of the branch, then goes to a step.
    fn travel(&mut self, solved: u64, step: usize) -> Result<(), Departure> {
        if solved > 0 {
            self.solved = 0;
            self.cursor = self.frames().len() - 1;
            let count = u32::try_from(solved).map_err(|_| Departure::TooMuch)?;
            self.solve(Unit::Minor, count, Vec::new());
            self.wait();
        }
        if solved > 0 && self.solved != solved {
            return Err(Departure::Solves {
                now: self.solved,
                then: solved,
            });
        }
        self.jump(step)?;
        self.wait();
        Ok(())
    }

    /// A command with the steps only that it took: one that was interrupted is replayed as far as it went.
    pub(super) fn as_far_as_done(&self, command: Command) -> Command {
        match command {
            Command::Follow { label, mut steps } => {
                let own = self.tree.branches()[self.tree.current()].from;
                steps.truncate(self.frames().len() - own);
                Command::Follow { label, steps }
            }
            command => command,
        }
    }
}

impl Record {
    /// Does all of it again, on the session's worker, and proves after each entry that the state has the same bits.
    ///
    /// # Errors
    /// If the scene is unsound, or at the first entry that leads elsewhere.
    pub fn replay(&self) -> Result<Session, JournalError> {
        self.replay_in(Session::new(self.scene()?), &mut |_, _| {})
    }

    /// The same in a session at the start of what the journal is of, with a look at it there, and after each entry.
    ///
    /// # Errors
    /// As [`Record::replay`].
    pub fn replay_in(
        &self,
        mut session: Session,
        see: &mut dyn FnMut(&Session, Option<&Entry>),
    ) -> Result<Session, JournalError> {
        session.diary.keep_in_memory();
        see(&session, None);
        for (line, entry) in &self.entries {
            session.replay(entry).map_err(|departure| {
                let other = match self.header.version.as_str() {
                    env!("CARGO_PKG_VERSION") => String::new(),
                    version => format!("; version {version} wrote the journal"),
                };
                JournalError::Differs {
                    file: self.file.clone(),
                    line: *line,
                    message: departure.to_string() + &other,
                }
            })?;
            see(&session, Some(entry));
        }
        Ok(session)
    }
}

impl Keep {
    /// Begins the journal of a session.
    ///
    /// # Errors
    /// If the file that is asked for exists, or cannot be written.
    pub fn begin(&self, session: &mut Session) -> Result<(), JournalError> {
        match self {
            Keep::Nowhere => {}
            Keep::Default => session.keep_at_default_place(),
            Keep::File(path) => {
                let journal = Journal::create(path, session.scene(), &[])?;
                session.keep(journal);
            }
        }
        Ok(())
    }
}
