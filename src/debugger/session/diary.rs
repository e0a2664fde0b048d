//! Where a session keeps what was done: in a journal, in memory until there is one, or nowhere.

use crate::record::journal::{Entry, Journal, JournalError};
use std::path::Path;
use stickslip_scene::Scene;

/// What was done, and where that is written.
#[derive(Default)]
pub(super) struct Diary {
    at: Kept,
    /// What was done so far, where a journal is wanted: another file can be begun with it.
    entries: Vec<Entry>,
    /// That the journal was lost, until it is said.
    trouble: String,
}

/// Where the journal of a session is.
#[derive(Default)]
enum Kept {
    #[default]
    Nowhere,
    /// In memory only, so that it can be written yet.
    Memory,
    /// At the default place, once there is something to write.
    Due,
    Open(Journal),
    /// It could not be written, and why.
    Lost(String),
}

impl Diary {
    /// Keeps a journal from now on.
    pub fn keep(&mut self, journal: Journal) {
        self.at = Kept::Open(journal);
    }

    /// Keeps a journal at the default place, which is made when there is something to write.
    pub fn keep_at_default_place(&mut self) {
        self.at = Kept::Due;
    }

    /// Keeps what is done in memory, so that a journal can be begun later.
    pub fn keep_in_memory(&mut self) {
        self.at = Kept::Memory;
    }

    /// Whether anything is kept, or was to be.
    pub fn is_kept(&self) -> bool {
        !matches!(self.at, Kept::Nowhere)
    }

    /// Why there is no journal any more although one was wanted.
    pub fn lost(&self) -> Option<&str> {
        match &self.at {
            Kept::Lost(why) => Some(why),
            _ => None,
        }
    }

    /// Where the journal is, if there is one.
    pub fn path(&self) -> Option<&Path> {
        match &self.at {
            Kept::Open(journal) => Some(journal.path()),
            _ => None,
        }
    }

    /// What was done so far.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Adds what was done without writing it: a journal has it already.
    pub fn add(&mut self, entry: Entry) {
        self.entries.push(entry);
    }

    /// Puts an entry in the place of the last one.
    pub fn replace_last(&mut self, entry: Entry) {
        if let Some(last) = self.entries.last_mut() {
            *last = entry;
        }
    }

    /// Writes the journal again if its file was deleted, and reports it.
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
                    "; {} was deleted, and is written again with all {} entries",
                    path.display(),
                    self.entries.len()
                );
            }
            Err(error) => self.lose("the journal was deleted or replaced", &error),
        }
    }

    /// Notes what a command led to; `changes` where it changed something.
    pub fn done(&mut self, scene: &Scene, entry: Entry, changes: bool) {
        self.entries.push(entry.clone());
        self.write(scene, |journal| journal.done(entry, changes));
    }

    /// Writes to the journal, if there is one. Where that fails it ends, and the next reply says so.
    pub fn write(
        &mut self,
        scene: &Scene,
        write: impl FnOnce(&mut Journal) -> Result<(), JournalError>,
    ) {
        if matches!(self.at, Kept::Due) {
            match Journal::create_default(scene) {
                Ok(journal) => self.at = Kept::Open(journal),
                Err(error) => return self.lose("there is no journal", &error),
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
            format!("; {what}: {error}; :journal FILE begins one with all that was done");
    }

    /// That the journal was lost, said once.
    pub fn take_trouble(&mut self) -> String {
        std::mem::take(&mut self.trouble)
    }
}
