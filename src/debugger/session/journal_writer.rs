//! Writes the journal of a session: to a file, to memory until there is one, or not at all.

use crate::record::journal::{Entry, Journal, JournalError};
use crate::refusal::{Refusal, refusal};
use std::fmt::Display;
use std::path::{Path, PathBuf};
use stickslip_core::counted;
use stickslip_scene::Scene;

/// The entries of a session and where they are written.
#[derive(Default)]
pub struct JournalWriter {
    to: Destination,
    /// All entries so far, if a journal is written: a second file can be started from them.
    entries: Vec<Entry>,
    /// Message about a failed journal, until it is shown.
    trouble: String,
}

/// Destination of the journal.
#[derive(Default)]
enum Destination {
    #[default]
    Nowhere,
    /// Only memory; a file can still be started.
    Memory,
    /// The default path, created with the first entry.
    DefaultPath,
    File(Journal),
    /// Writing failed, with the reason.
    Lost(String),
}

use Destination::*;

impl JournalWriter {
    /// Writes to this journal from now on.
    pub fn write_to(&mut self, journal: Journal) {
        self.to = File(journal);
    }

    /// Writes to the default path, created with the first entry.
    pub fn write_to_default_path(&mut self) {
        self.to = DefaultPath;
    }

    /// Stores the entries in memory, so that a journal file can be started later.
    pub(super) fn write_to_memory(&mut self) {
        self.to = Memory;
    }

    /// Whether entries are stored, in memory or in a file.
    pub(super) fn is_on(&self) -> bool {
        !matches!(self.to, Nowhere)
    }

    /// Why the journal failed.
    pub fn lost(&self) -> Option<&str> {
        match &self.to {
            Lost(why) => Some(why),
            _ => None,
        }
    }

    /// The path of the journal file, if there is one.
    pub fn path(&self) -> Option<&Path> {
        match &self.to {
            File(journal) => Some(journal.path()),
            _ => None,
        }
    }

    /// Starts a journal with all entries so far and continues it; without a file, reports the path of the
    /// current one. `has_steps` is whether the session has a history already.
    pub(super) fn begin(
        &mut self,
        file: Option<PathBuf>,
        scene: &Scene,
        has_steps: bool,
    ) -> Result<String, Refusal> {
        let Some(file) = file else {
            return Ok(match &self.to {
                File(journal) => {
                    format!("the journal is written to {}", journal.path().display())
                }
                Lost(why) => {
                    format!(
                        "the journal could not be written: {why}. :journal FILE starts a new one"
                    )
                }
                _ => "there is no journal yet; :journal FILE starts one".into(),
            });
        };
        if !self.is_on() && has_steps {
            return Err(refusal!(
                "this session has kept no record of its commands, so no journal can be written"
            ));
        }
        self.write_to(Journal::create(&file, scene, &self.entries)?);
        Ok(format!(
            "the journal is now written to {}, which already contains {}",
            file.display(),
            counted(self.entries.len(), "entry")
        ))
    }

    /// Adds an entry without writing it: the journal already contains it.
    pub(super) fn add(&mut self, entry: Entry) {
        self.entries.push(entry);
    }

    /// Replaces the last entry.
    pub(super) fn replace_last(&mut self, entry: Entry) {
        if let Some(last) = self.entries.last_mut() {
            *last = entry;
        }
    }

    /// Writes the journal again if its file was deleted, and notes that for the next reply.
    pub(super) fn renew(&mut self, scene: &Scene) {
        let File(journal) = &self.to else {
            return;
        };
        if journal.is_there() {
            return;
        }
        let path = journal.path().to_owned();
        match Journal::create(&path, scene, &self.entries) {
            Ok(journal) => {
                self.to = File(journal);
                self.trouble = format!(
                    "; {} was deleted and has been rewritten with all its entries ({})",
                    path.display(),
                    self.entries.len()
                );
            }
            Err(JournalError::Exists(path)) => {
                let error = format!("{}: another file has replaced it", path.display());
                self.lose("the journal was replaced", &error);
            }
            Err(error) => self.lose("the journal was deleted", &error),
        }
    }

    /// Records a completed command; `changes` is whether it changed the history.
    pub(super) fn done(&mut self, scene: &Scene, entry: Entry, changes: bool) {
        self.entries.push(entry.clone());
        self.write(scene, |journal| journal.done(entry, changes));
    }

    /// Writes to the journal, if there is one. If that fails, the journal ends and the next reply reports the
    /// error.
    pub(super) fn write(
        &mut self,
        scene: &Scene,
        write: impl FnOnce(&mut Journal) -> Result<(), JournalError>,
    ) {
        if matches!(self.to, DefaultPath) {
            match Journal::create_default(scene) {
                Ok(journal) => self.to = File(journal),
                Err(error) => return self.lose("the journal could not be created", &error),
            }
        }
        let File(journal) = &mut self.to else {
            return;
        };
        if let Err(error) = write(journal) {
            self.lose("the journal ends here", &error);
        }
    }

    fn lose(&mut self, what: &str, error: &dyn Display) {
        self.to = Lost(error.to_string());
        self.trouble =
            format!("; {what}: {error}; :journal FILE starts a new one with all entries");
    }

    /// Returns the message about a failed journal, once.
    pub(super) fn take_trouble(&mut self) -> String {
        std::mem::take(&mut self.trouble)
    }
}
