//! The journal of a session: all its commands, written as they are executed, from which the session can be
//! replayed bit by bit.
//!
//! A RON text file with one entry per line. The first line is the [`JournalHeader`] with the whole scene, so that the
//! file is self-contained. Each command that changed something or moved the cursor adds an [`Entry`] with a
//! digest of the resulting state; a motion that solves is announced by a line before it starts. Entries that
//! changed something are synced to disk (fdatasync), and so is the folder of a new journal; cursor moves are
//! only passed to the system. Nothing is lost if the process is killed; a power failure can lose cursor moves.
//! A killed process leaves an incomplete last line, which is dropped and reported.

use crate::Command;
use crate::refusal::refused_by;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;
use std::fs::TryLockError;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use stickslip_platform::disk::File;
use stickslip_platform::input::{self, RECORD_BYTES};
use stickslip_platform::{clock, disk, files, system};
use stickslip_scene::format::{notation, read};
use stickslip_scene::readers::or_mistaken;
use stickslip_scene::{FileKind, Scene, SceneError, Spec};

/// Format version written by this program, and the only one it reads.
pub const FORMAT: u32 = 1;
/// File extension of journals.
const EXTENSION: &str = "journal";

/// The first line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JournalHeader {
    /// Format version.
    pub format: u32,
    /// Version of the program that wrote the journal.
    pub version: String,
    /// Start of the session, in seconds since 1970.
    pub began: u64,
    /// Name of the scene.
    pub name: String,
    /// The whole scene, with all `--set` overrides.
    pub scene: Spec,
}

/// Any line after the first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum Line {
    /// A motion has started to solve.
    Begun(Command),
    Done(Entry),
}

/// A command and its result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Time of the command, in seconds since 1970.
    pub at: u64,
    /// The command.
    pub command: Command,
    /// New minor iterations that it solved.
    pub solved: u64,
    /// Increments accepted among them.
    pub accepted: u64,
    /// Current branch afterwards.
    pub branch: usize,
    /// Cursor afterwards: index on the branch's line, from 0.
    pub cursor: usize,
    /// Digest of the resulting state ([`crate::record::state_digest`]).
    pub digest: String,
    /// Reply shown to the user.
    pub said: String,
}

/// Why a journal cannot be written, read or replayed.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The file cannot be written.
    #[error("{}: the journal cannot be written: {source}", file.display())]
    File {
        /// Path of the journal.
        file: PathBuf,
        /// Cause.
        source: io::Error,
    },
    /// The file cannot be read, is not a journal, or is damaged.
    #[error(transparent)]
    Read(Box<SceneError>),
    /// The file for a new journal exists.
    #[error("{}: the file already exists; `stickslip resume` continues a journal", .0.display())]
    Exists(PathBuf),
    /// Another session is writing this journal.
    #[error("{}: another session is writing this journal", .0.display())]
    Busy(PathBuf),
    /// The system does not name a directory for journals.
    #[error(
        "no folder for journals: this system has no home directory; choose a file with --journal FILE"
    )]
    NoPlace,
    /// The directory contains no journal.
    #[error("there is no journal in {}; `stickslip SCENE` writes one", .0.display())]
    NoJournal(PathBuf),
    /// The journal's scene is invalid.
    #[error("{file}:1: the journal's scene is invalid: {source}")]
    Scene {
        /// Name of the journal.
        file: String,
        /// What is wrong with the scene.
        source: Box<SceneError>,
    },
    /// A replayed command leads to another state than recorded.
    #[error("{file}:{line}: the replay differs from the journal: {message}")]
    Differs {
        /// Name of the journal.
        file: String,
        /// Line of the command, from 1.
        line: usize,
        /// What differs.
        message: String,
    },
}

refused_by!(JournalError);

impl From<SceneError> for JournalError {
    fn from(error: SceneError) -> Self {
        JournalError::Read(Box::new(error))
    }
}

/// Where to write the journal of a session.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum JournalTarget {
    /// No journal.
    Nowhere,
    /// In the user's folder for journals.
    Default,
    /// To this file.
    File(PathBuf),
}

/// A journal open for writing.
pub struct Journal {
    path: PathBuf,
    file: File,
    /// Length of all complete lines, in bytes.
    whole: u64,
}

impl Journal {
    /// Creates the journal of a session, with the entries so far. The file is readable by its owner only.
    ///
    /// # Errors
    /// If the file exists or cannot be written. No incomplete file is left behind.
    pub fn create(path: &Path, scene: &Scene, done: &[Entry]) -> Result<Journal, JournalError> {
        let mut options = File::options();
        options.append(true).create_new(true);
        let file = system::set_private(&mut options)
            .open(path)
            .map_err(|source| match source.kind() {
                io::ErrorKind::AlreadyExists => JournalError::Exists(path.to_owned()),
                _ => failure(path, source),
            })?;
        let mut journal = Journal {
            path: path.to_owned(),
            file,
            whole: 0,
        };
        match journal.open_with(scene, done) {
            Ok(()) => {
                sync_folder(path);
                Ok(journal)
            }
            Err(error) => {
                // This call created the file, and it is incomplete.
                let _ = disk::remove_file(path);
                Err(error)
            }
        }
    }

    fn open_with(&mut self, scene: &Scene, done: &[Entry]) -> Result<(), JournalError> {
        self.lock()?;
        let header = JournalHeader {
            format: FORMAT,
            version: env!("CARGO_PKG_VERSION").into(),
            began: now(),
            name: scene.name.clone(),
            scene: scene.spec.clone(),
        };
        self.write(&header, done.is_empty())?;
        for (k, entry) in done.iter().enumerate() {
            self.write(&Line::Done(entry.clone()), k + 1 == done.len())?;
        }
        Ok(())
    }

    /// Creates a journal in the user's folder for journals, named after the scene and the time.
    ///
    /// # Errors
    /// If there is no such folder, or the file cannot be written.
    pub fn create_default(scene: &Scene) -> Result<Journal, JournalError> {
        let directory = directory()?;
        disk::create_dir_all(&directory).map_err(|e| failure(&directory, e))?;
        let stem = format!("{}-{}", files::stem(&scene.name), stamp(now()));
        // Several sessions can start in the same second.
        const MOST: u32 = 100;
        let mut k = 0;
        loop {
            let path = directory.join(numbered(&stem, k, EXTENSION));
            match Journal::create(&path, scene, &[]) {
                Err(JournalError::Exists(_)) if k < MOST => k += 1,
                made => return made,
            }
        }
    }

    /// Opens a journal to continue it.
    ///
    /// # Errors
    /// If it cannot be written, or another session is writing it.
    pub fn open(path: &Path) -> Result<Journal, JournalError> {
        let failed = |e| failure(path, e);
        let file = File::options().append(true).open(path).map_err(failed)?;
        let whole = file.metadata().map_err(failed)?.len();
        let journal = Journal {
            path: path.to_owned(),
            file,
            whole,
        };
        journal.lock()?;
        Ok(journal)
    }

    /// Removes an incomplete last line.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn cut(&mut self, whole_bytes: u64) -> Result<(), JournalError> {
        self.file
            .set_len(whole_bytes)
            .map_err(|e| failure(&self.path, e))?;
        self.whole = whole_bytes;
        Ok(())
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether the file still exists at its path and has not been replaced.
    pub(crate) fn is_there(&self) -> bool {
        match (disk::metadata(&self.path), self.file.metadata()) {
            (Ok(named), Ok(own)) => system::is_same_file(&named, &own),
            _ => false,
        }
    }

    /// Locks the file for this session until the process ends.
    fn lock(&self) -> Result<(), JournalError> {
        match self.file.try_lock() {
            Err(TryLockError::WouldBlock) => Err(JournalError::Busy(self.path.clone())),
            // Some file systems do not support locks.
            _ => Ok(()),
        }
    }

    /// Records that a motion starts to solve.
    pub(crate) fn begun(&mut self, command: &Command) -> Result<(), JournalError> {
        self.write(&Line::Begun(command.clone()), false)
    }

    /// Records the result of a command; `sync` if it changed something.
    pub(crate) fn done(&mut self, entry: Entry, sync: bool) -> Result<(), JournalError> {
        self.write(&Line::Done(entry), sync)
    }

    fn write(&mut self, line: &impl Serialize, sync: bool) -> Result<(), JournalError> {
        let failed = |source| failure(&self.path, source);
        let text = notation::line(line).map_err(|e| failed(io::Error::other(e)))? + "\n";
        let written = self
            .file
            .write_all(text.as_bytes())
            .and_then(|()| if sync { self.file.sync_data() } else { Ok(()) });
        match written {
            Ok(()) => self.whole += text.len() as u64,
            // Drop the incomplete line; devices cannot be truncated.
            Err(_) => drop(self.file.set_len(self.whole)),
        }
        written.map_err(failed)
    }
}

/// A journal that has been read.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Name of the file for messages.
    pub file: String,
    /// The first line.
    pub header: JournalHeader,
    /// Entries with their line numbers.
    pub entries: Vec<(usize, Entry)>,
    /// A motion that was running when the session ended.
    pub unfinished: Option<Command>,
    /// Number of an incomplete last line.
    pub torn: Option<usize>,
    /// Length of all complete lines, in bytes.
    pub whole_bytes: u64,
}

impl Record {
    /// Reads a journal.
    ///
    /// # Errors
    /// If the file cannot be read or is damaged, with the line.
    pub fn read(path: &Path) -> Result<Record, JournalError> {
        let file = path.display().to_string();
        let bytes = input::bytes(path, RECORD_BYTES, "too large for a journal")
            .map_err(|why| read::not_read(&file, &why))?;
        Record::from_bytes(&file, &bytes)
    }

    /// Reads a journal from bytes; `file` is its name for messages.
    ///
    /// # Errors
    /// If it is damaged, with the line.
    pub fn from_bytes(file: &str, bytes: &[u8]) -> Result<Record, JournalError> {
        let whole = bytes
            .iter()
            .rposition(|byte| *byte == b'\n')
            .map_or(0, |at| at + 1);
        let marked = if bytes.starts_with(input::MARK.to_string().as_bytes()) {
            input::MARK.len_utf8().min(whole)
        } else {
            0
        };
        let text = str::from_utf8(&bytes[marked..whole]).map_err(|e| {
            let good = &bytes[..marked + e.valid_up_to()];
            let line = 1 + good.iter().filter(|byte| **byte == b'\n').count();
            damaged(file, (line, 1), "the line is not valid UTF-8")
        })?;
        let mut lines = text.lines().enumerate().map(|(k, line)| (k + 1, line));
        let (_, first) = lines.next().ok_or_else(|| {
            let message = "no complete line found; the first line of a journal contains the scene";
            damaged(file, (1, 1), message)
        })?;
        let header = header(file, first).map_err(|error| match error.at {
            Some(_) => or_mistaken(error, file, text, FileKind::Journal),
            None => error,
        })?;
        let mut record = Record {
            file: file.to_owned(),
            header,
            entries: Vec::new(),
            unfinished: None,
            torn: (whole < bytes.len()).then(|| text.lines().count() + 1),
            whole_bytes: whole as u64,
        };
        for (number, line) in lines {
            match parsed(file, number, line)? {
                Line::Begun(command) => record.unfinished = Some(command),
                Line::Done(entry) => {
                    record.unfinished = None;
                    record.entries.push((number, entry));
                }
            }
        }
        Ok(record)
    }

    /// The scene of the journal.
    ///
    /// # Errors
    /// If this version rejects it.
    pub fn scene(&self) -> Result<Scene, JournalError> {
        let header = &self.header;
        Scene::from_spec(&header.name, header.scene.clone()).map_err(|source| JournalError::Scene {
            file: self.file.clone(),
            source: Box::new(source),
        })
    }

    /// Remarks about the end of the journal; empty if it is complete.
    pub fn reservations(&self) -> String {
        let mut text = String::new();
        if let Some(line) = self.torn {
            let _ = write!(text, "; line {line} is incomplete and has been ignored");
        }
        if self.unfinished.is_some() {
            text += "; the last motion was interrupted and is not repeated";
        }
        text
    }
}

fn header(file: &str, line: &str) -> Result<JournalHeader, SceneError> {
    check_format(file, line, "journal", FORMAT, "")?;
    parsed(file, 1, line)
}

/// Checks the format version of a file, which is the only part that all versions have; `instead` ends the message.
pub(super) fn check_format(
    file: &str,
    text: &str,
    kind: &str,
    known: u32,
    instead: &str,
) -> Result<(), SceneError> {
    #[derive(Deserialize)]
    struct VersionLine {
        format: u32,
    }
    match notation::read(text) {
        Ok(VersionLine { format }) if format != known => Err(SceneError::whole(
            file,
            format!(
                "the {kind} has format {format}, but this program reads only format {known}{instead}"
            ),
        )),
        _ => Ok(()),
    }
}

fn parsed<T: DeserializeOwned>(file: &str, number: usize, line: &str) -> Result<T, SceneError> {
    notation::read(line)
        .map_err(|e| read::refused(file, number, "the line is not a journal entry: ", &e))
}

fn damaged(file: &str, at: (usize, usize), message: &str) -> SceneError {
    SceneError {
        at: Some(at),
        ..SceneError::whole(file, message)
    }
}

fn failure(file: &Path, source: io::Error) -> JournalError {
    JournalError::File {
        file: file.to_owned(),
        source,
    }
}

/// Syncs the folder of a new file. Some file systems cannot sync folders; the file itself is synced in any
/// case.
fn sync_folder(file: &Path) {
    let folder = file.parent().filter(|folder| *folder != Path::new(""));
    system::sync_folder(folder.unwrap_or(Path::new(".")));
}

/// The name of a file, with a number from 1 on if it is not the first of its name.
pub(super) fn numbered(stem: &str, number: u32, extension: &str) -> String {
    match number {
        0 => format!("{stem}.{extension}"),
        number => format!("{stem}-{number}.{extension}"),
    }
}

/// Default folder for journals: in the user's folder for state, or for data on systems without one.
///
/// # Errors
/// If the system has no home directory.
pub fn directory() -> Result<PathBuf, JournalError> {
    Ok(home()?.join("journals"))
}

/// The program's folder for journals and lesson progress.
///
/// # Errors
/// If the system has no home directory.
pub fn home() -> Result<PathBuf, JournalError> {
    system::state_folder().ok_or(JournalError::NoPlace)
}

/// The latest journal.
///
/// # Errors
/// If there is none.
pub fn newest() -> Result<PathBuf, JournalError> {
    let directory = directory()?;
    let none = || JournalError::NoJournal(directory.clone());
    let written = |entry: disk::DirEntry| {
        let path = entry.path();
        let ours = path
            .extension()
            .is_some_and(|extension| extension == EXTENSION);
        let time = entry.metadata().and_then(|data| data.modified()).ok()?;
        ours.then_some((time, path))
    };
    let entries = disk::read_dir(&directory).map_err(|_| none())?;
    let newest = entries.filter_map(|entry| written(entry.ok()?)).max();
    newest.map(|(_, path)| path).ok_or_else(none)
}

/// Seconds since 1970; 0 if the clock is set earlier.
pub(crate) fn now() -> u64 {
    clock::since_1970().as_secs()
}

/// Date and time in UTC: `20260131-235959`.
fn stamp(seconds: u64) -> String {
    let [year, month, day, hour, minute, second] = date(seconds);
    format!("{year:04}{month:02}{day:02}-{hour:02}{minute:02}{second:02}")
}

/// The last second of the year 9999.
const LAST_SECOND: u64 = 253_402_300_799;

/// Year, month, day, hour, minute and second in UTC of a time since 1970; capped at the end of the year 9999.
pub(super) fn date(seconds: u64) -> [u64; 6] {
    // A file can contain any time, and the loop below counts years.
    let seconds = seconds.min(LAST_SECOND);
    let (mut days, rest) = (seconds / 86_400, seconds % 86_400);
    let leap = |year: u64| {
        (year.is_multiple_of(4) && !year.is_multiple_of(100)) || year.is_multiple_of(400)
    };
    let mut year = 1970;
    while days >= 365 + u64::from(leap(year)) {
        days -= 365 + u64::from(leap(year));
        year += 1;
    }
    let february = 28 + u64::from(leap(year));
    let mut month = 1;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31] {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    [
        year,
        month,
        days + 1,
        rest / 3600,
        rest / 60 % 60,
        rest % 60,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use rustix::fs::{CWD, Mode, mkfifoat};

    /// A pipe accepts bytes but fails to sync, so a sync request shows as an error.
    #[test]
    fn changes_are_synced_and_cursor_moves_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("a.journal");
        mkfifoat(CWD, &pipe, Mode::RUSR | Mode::WUSR).unwrap();
        let _both = File::options().read(true).write(true).open(&pipe).unwrap();
        let mut journal = Journal::open(&pipe).unwrap();
        let entry = Entry {
            at: 0,
            command: Command::Goto { step: 0 },
            solved: 0,
            accepted: 0,
            branch: 0,
            cursor: 0,
            digest: String::new(),
            said: String::new(),
        };
        journal.begun(&entry.command).unwrap();
        journal.done(entry.clone(), false).unwrap();
        let refused = journal.done(entry, true).unwrap_err();
        let JournalError::File { source, .. } = &refused else {
            panic!("{refused:?}");
        };
        assert_eq!(source.kind(), io::ErrorKind::InvalidInput, "{refused}");
    }

    #[test]
    fn dates_match_the_calendar() {
        assert_eq!(stamp(0), "19700101-000000");
        assert_eq!(stamp(951_782_399), "20000228-235959");
        assert_eq!(stamp(951_782_400), "20000229-000000");
        assert_eq!(stamp(1_709_251_200), "20240301-000000");
        assert_eq!(stamp(1_735_689_599), "20241231-235959");
        assert_eq!(stamp(4_107_542_400), "21000301-000000");
        assert_eq!(stamp(u64::MAX), "99991231-235959");
    }
}
