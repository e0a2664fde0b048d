//! Keeps the journal of a session: in a file, in memory until there is one, or not at all.

use crate::record::journal::{Entry, Journal, JournalError};
use std::path::Path;
use stickslip_scene::Scene;

/// The entries of a session and where they are written.
#[derive(Default)]
pub(super) struct Diary {
    at: Kept,
    /// All entries so far, if a journal is kept: a second file can be started from them.
    entries: Vec<Entry>,
    /// Message about a failed journal, until it is shown.
    trouble: String,
}

/// Destination of the journal.
#[derive(Default)]
enum Kept {
    #[default]
    Nowhere,
    /// In memory only; a file can still be started.
    Memory,
    /// At the default path, created with the first entry.
    Due,
    Open(Journal),
    /// Writing failed, with the reason.
    Lost(String),
}

impl Diary {
    /// Writes to this journal from now on.
    pub fn keep(&mut self, journal: Journal) {
        self.at = Kept::Open(journal);
    }

    /// Writes to the default path, created with the first entry.
    pub fn keep_at_default_place(&mut self) {
        self.at = Kept::Due;
    }

    /// Keeps the entries in memory, so that a journal file can be started later.
    pub fn keep_in_memory(&mut self) {
        self.at = Kept::Memory;
    }

    /// Whether entries are kept, in memory or in a file.
    pub fn is_kept(&self) -> bool {
        !matches!(self.at, Kept::Nowhere)
    }

    /// Why the journal failed.
    pub fn lost(&self) -> Option<&str> {
        match &self.at {
            Kept::Lost(why) => Some(why),
            _ => None,
        }
    }

    /// The path of the journal file, if there is one.
    pub fn path(&self) -> Option<&Path> {
        match &self.at {
            Kept::Open(journal) => Some(journal.path()),
            _ => None,
        }
    }

    /// The entries so far.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Adds an entry without writing it: the journal already contains it.
    pub fn add(&mut self, entry: Entry) {
        self.entries.push(entry);
    }

    /// Replaces the last entry.
    pub fn replace_last(&mut self, entry: Entry) {
        if let Some(last) = self.entries.last_mut() {
            *last = entry;
        }
    }

    /// Writes the journal again if its file was deleted, and notes that for the next reply.
    pub fn renew(&mut self, scene: &Scene) {
        let Kept::Open(journal) = &self.at else {
            return;
        };
        if journal.is_there() {
            return;
        }
        let path = journal.path().to_owned();
        match Journal::create(&path, scene, &self.entries) {
            Ok(journal) => {
                self.at = Kept::Open(journal);
                self.trouble = format!(
                    "; {} was deleted and has been rewritten with all {} entries",
                    path.display(),
                    self.entries.len()
                );
            }
            Err(error) => self.lose("the journal was deleted or replaced", &error),
        }
    }

    /// Records a completed command; `changes` is whether it changed the history.
    pub fn done(&mut self, scene: &Scene, entry: Entry, changes: bool) {
        self.entries.push(entry.clone());
        self.write(scene, |journal| journal.done(entry, changes));
    }

    /// Writes to the journal, if there is one. If that fails, the journal ends and the next reply reports the
    /// error.
    pub fn write(
        &mut self,
        scene: &Scene,
        write: impl FnOnce(&mut Journal) -> Result<(), JournalError>,
    ) {
        if matches!(self.at, Kept::Due) {
            match Journal::create_default(scene) {
                Ok(journal) => self.at = Kept::Open(journal),
                Err(error) => return self.lose("the journal could not be created", &error),
            }
        }
        let Kept::Open(journal) = &mut self.at else {
            return;
        };
        if let Err(error) = write(journal) {
            self.lose("the journal ends here", &error);
        }
    }

    fn lose(&mut self, what: &str, error: &JournalError) {
        self.at = Kept::Lost(error.to_string());
        self.trouble =
            format!("; {what}: {error}; :journal FILE starts a new one with all entries");
    }

    /// Returns the message about a failed journal, once.
    pub fn take_trouble(&mut self) -> String {
        std::mem::take(&mut self.trouble)
    }
}
