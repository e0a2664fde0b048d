//! Rebuilds a session from its journal, bit by bit.

use super::machine::Session;
use crate::record::journal::{Entry, Journal, JournalError, Record};
use crate::record::state_digest::digest_like;
use crate::refusal::{Refusal, refusal};
use crate::{Breakpoints, JournalTarget, Unit};
use stickslip_core::counted;
use stickslip_scene::shown;

impl Session {
    /// Repeats one entry of a journal.
    ///
    /// # Errors
    /// If the result differs from the recorded one.
    fn replay(&mut self, entry: &Entry) -> Result<(), Refusal> {
        match &entry.command {
            // A journal must not be able to make the program write files.
            command if command.is_look() => {
                return Err(refusal!("a journal cannot contain this command"));
            }
            command if command.is_motion() => self.travel(entry.solved, entry.cursor)?,
            command => {
                self.submit(command.clone())?;
                self.wait();
            }
        }
        let place = self.timeline.place();
        if place != (entry.branch, entry.cursor) {
            return Err(refusal!(
                "it now ends at step {} of branch b{} instead of step {} of b{}",
                place.1,
                place.0 + 1,
                entry.cursor,
                entry.branch.saturating_add(1)
            ));
        }
        let digest = digest_like(&entry.digest, &self.frame().state);
        if digest != entry.digest {
            return Err(refusal!(
                "the state is now {digest} instead of {then}",
                then = shown::cut(&entry.digest, 40)
            ));
        }
        // An interrupted motion is replayed up to where it stopped.
        if entry.command.is_motion() {
            self.journal.add(entry.clone())
        } else {
            self.journal.replace_last(entry.clone())
        }
        Ok(())
    }

    /// Solves this many minor iterations from the tip of the branch, then moves to a step.
    fn travel(&mut self, solved: u64, step: usize) -> Result<(), Refusal> {
        if solved > 0 {
            self.solved = 0;
            self.timeline.move_to(self.timeline.tip());
            let count = u32::try_from(solved)
                .map_err(|_| refusal!("it solves too many iterations for one motion"))?;
            self.solve(Unit::Minor, count, Breakpoints::default());
            self.wait();
        }
        if solved > 0 && self.solved != solved {
            return Err(refusal!(
                "it now solves {} instead of {solved}",
                counted(self.solved, "minor iteration")
            ));
        }
        self.jump(step)?;
        self.wait();
        Ok(())
    }
}

impl Record {
    /// Repeats all entries on the session's worker, and checks the bits of the state after each one.
    ///
    /// # Errors
    /// If the scene is invalid, or at the first entry whose result differs.
    pub fn replay(&self) -> Result<Session, JournalError> {
        self.replay_in(Session::new(self.scene()?), &mut |_, _| {})
    }

    /// Replays in a session at the start of the journal's scene. Calls `see` at the start and after each entry.
    ///
    /// # Errors
    /// As [`Record::replay`].
    pub fn replay_in(
        &self,
        mut session: Session,
        see: &mut dyn FnMut(&Session, Option<&Entry>),
    ) -> Result<Session, JournalError> {
        session.journal.write_to_memory();
        see(&session, None);
        for (line, entry) in &self.entries {
            session.replay(entry).map_err(|departure| {
                let other = match self.header.version.as_str() {
                    env!("CARGO_PKG_VERSION") => String::new(),
                    version => format!("; the journal was written by version {version}"),
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

impl JournalTarget {
    /// Starts the journal of a session.
    ///
    /// # Errors
    /// If the named file exists or cannot be written.
    pub fn begin(&self, session: &mut Session) -> Result<(), JournalError> {
        match self {
            JournalTarget::Nowhere => {}
            JournalTarget::Default => session.journal_mut().write_to_default_path(),
            JournalTarget::File(path) => {
                let journal = Journal::create(path, session.scene(), &[])?;
                session.journal_mut().write_to(journal);
            }
        }
        Ok(())
    }
}
