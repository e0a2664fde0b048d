//! The journal of a session: what changed anything, written as it happens, so that it can be replayed to the same bits.
//!
//! A RON text file, one entry per line. The first line is the [`Header`] with the whole scene, so the file is
//! self-contained; then comes an [`Entry`] for every command that changed something or moved the cursor, with a digest of
//! the state after it, and before a motion that solves a line that announces it. Entries that changed something are synced
//! to the disk (fdatasync), and so is the folder when a journal begins; cursor moves are only written to the system. A kill
//! loses neither, a power failure only cursor moves. A last line without its end is an entry cut off by a kill; it is
//! dropped and reported.

use crate::record::command::Command;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;
use std::fs::{File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};
use stickslip_core::step::state::State;
use stickslip_exchange::seal::Digest;
use stickslip_platform::input::{self, RECORD_BYTES};
use stickslip_platform::{files, system};
use stickslip_scene::Scene;
use stickslip_scene::format::kind::FileKind;
use stickslip_scene::format::{SceneError, Spec, notation, read};

/// The format that this program writes, and the only one that it reads.
pub const FORMAT: u32 = 1;
/// How the names of journals end.
const EXTENSION: &str = "journal";

/// The first line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// Version of this format.
    pub format: u32,
    /// Version of the program that wrote it.
    pub version: String,
    /// When the session began, in seconds since 1970.
    pub began: u64,
    /// What the scene was called.
    pub name: String,
    /// The whole scene, with what was set from outside.
    pub scene: Spec,
}

/// Any other line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum Line {
    /// A motion has begun to solve.
    Begun(Command),
    Done(Entry),
}

/// A command, and where it led.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// When it was done, in seconds since 1970.
    pub at: u64,
    /// What was done.
    pub command: Command,
    /// New minor iterations that it solved, and increments that were accepted among them.
    pub solved: u64,
    /// Increments that were accepted among the new minor iterations.
    pub accepted: u64,
    /// Branch, and place on its line, afterwards.
    pub branch: usize,
    /// Place on the branch's line afterwards, from 0.
    pub cursor: usize,
    /// Digest of the state there ([`digest`]).
    pub digest: String,
    /// What the user was told.
    pub said: String,
}

/// Why a journal cannot be written, read or replayed.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The system refused.
    #[error("{}: the journal cannot be {doing}: {source}", file.display())]
    File {
        /// The journal.
        file: PathBuf,
        /// What was tried, as "written".
        doing: &'static str,
        /// Why.
        source: io::Error,
    },
    /// It cannot be read, is no journal, or is a damaged one.
    #[error(transparent)]
    Read(Box<SceneError>),
    /// A new journal was wanted, and there is a file of that name.
    #[error("{}: the file exists already; `stickslip resume` goes on with a journal", .0.display())]
    Exists(PathBuf),
    /// Another session has it.
    #[error("{}: another session is writing this journal", .0.display())]
    Busy(PathBuf),
    /// The system names no directory for journals.
    #[error(
        "there is no place for journals: this system names no home directory; --journal FILE names a file"
    )]
    NoPlace,
    /// There is none in this directory.
    #[error("there is no journal in {}; `stickslip SCENE` writes one", .0.display())]
    NoJournal(PathBuf),
    /// The scene in it is unsound.
    #[error("{file}:1: the journal's scene is unsound: {source}")]
    Scene {
        /// The journal.
        file: String,
        /// What is wrong with the scene.
        source: Box<SceneError>,
    },
    /// Done again, a command leads to another state than the journal says.
    #[error("{file}:{line}: replayed, it is not what it was: {message}")]
    Differs {
        /// The journal.
        file: String,
        /// Line of the command, from 1.
        line: usize,
        /// What differs.
        message: String,
    },
}

impl From<SceneError> for JournalError {
    fn from(error: SceneError) -> Self {
        JournalError::Read(Box::new(error))
    }
}

/// Where the journal of a session is to be.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Keep {
    /// There is none.
    Nowhere,
    /// In the user's directory for journals.
    Default,
    /// In this file.
    File(PathBuf),
}

/// A journal that is being written.
pub struct Journal {
    path: PathBuf,
    file: File,
    /// Bytes of all whole lines.
    whole: u64,
}

impl Journal {
    /// Begins a journal of a session on a scene, with what was done until now. Nobody else may read it.
    ///
    /// # Errors
    /// If the file exists, or cannot be written; it is not left behind half written.
    pub fn create(path: &Path, scene: &Scene, done: &[Entry]) -> Result<Journal, JournalError> {
        let failed = |source: io::Error| match source.kind() {
            io::ErrorKind::AlreadyExists => JournalError::Exists(path.to_owned()),
            _ => failure(path, "written", source),
        };
        let mut options = File::options();
        options.append(true).create_new(true);
        let file = system::set_private(&mut options)
            .open(path)
            .map_err(failed)?;
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
                // It is ours, and of no use to anybody.
                let _ = std::fs::remove_file(path);
                Err(error)
            }
        }
    }

    fn open_with(&mut self, scene: &Scene, done: &[Entry]) -> Result<(), JournalError> {
        self.lock()?;
        let header = Header {
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

    /// Begins a journal in the user's directory for journals, with a name from the scene and the time.
    ///
    /// # Errors
    /// If there is no such directory, or the file cannot be written.
    pub fn create_default(scene: &Scene) -> Result<Journal, JournalError> {
        let directory = directory()?;
        std::fs::create_dir_all(&directory).map_err(|e| failure(&directory, "written", e))?;
        let stem = format!("{}-{}", files::stem(&scene.name), stamp(now()));
        let name = |k: u32| match k {
            0 => directory.join(format!("{stem}.{EXTENSION}")),
            k => directory.join(format!("{stem}-{k}.{EXTENSION}")),
        };
        // Two sessions can begin in the same second.
        const MOST: u32 = 100;
        let mut k = 0;
        loop {
            match Journal::create(&name(k), scene, &[]) {
                Err(JournalError::Exists(_)) if k < MOST => k += 1,
                made => return made,
            }
        }
    }

    /// Opens a journal to go on with it.
    ///
    /// # Errors
    /// If it cannot be written, or another session is writing it.
    pub fn open(path: &Path) -> Result<Journal, JournalError> {
        let failed = |e| failure(path, "written", e);
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

    /// Cuts off what a kill has left of a line.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn cut(&mut self, whole_bytes: u64) -> Result<(), JournalError> {
        let failed = |e| failure(&self.path, "written", e);
        self.file.set_len(whole_bytes).map_err(failed)?;
        self.whole = whole_bytes;
        Ok(())
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether the journal still exists under its name: the file was neither deleted nor replaced.
    pub(crate) fn is_there(&self) -> bool {
        match (std::fs::metadata(&self.path), self.file.metadata()) {
            (Ok(named), Ok(own)) => system::is_same_file(&named, &own),
            _ => false,
        }
    }

    /// Takes the file for this session, until the process ends.
    fn lock(&self) -> Result<(), JournalError> {
        match self.file.try_lock() {
            Err(TryLockError::WouldBlock) => Err(JournalError::Busy(self.path.clone())),
            // Where a file system knows no locks, there is nothing to be done.
            _ => Ok(()),
        }
    }

    /// Notes that a motion begins to solve.
    pub(crate) fn begun(&mut self, command: &Command) -> Result<(), JournalError> {
        self.write(&Line::Begun(command.clone()), false)
    }

    /// Notes what a command led to; `sync` where it changed something.
    pub(crate) fn done(&mut self, entry: Entry, sync: bool) -> Result<(), JournalError> {
        self.write(&Line::Done(entry), sync)
    }

    fn write(&mut self, line: &impl Serialize, sync: bool) -> Result<(), JournalError> {
        #[cfg(mutants)]
        let sync = stickslip_core::mutants::pick("journal-not-synced", sync, false);
        let failed = |source| failure(&self.path, "written", source);
        let text = notation::line(line);
        let text = text.map_err(|e| failed(io::Error::other(e)))? + "\n";
        let written = self.file.write_all(text.as_bytes());
        let written = written.and_then(|()| match sync {
            true => self.file.sync_data(),
            false => Ok(()),
        });
        match written {
            Ok(()) => self.whole += text.len() as u64,
            // What there is of the line is of no use; a device has no length to cut.
            Err(_) => drop(self.file.set_len(self.whole)),
        }
        written.map_err(failed)
    }
}

/// A journal that was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// What messages call it.
    pub file: String,
    /// The first line: the scene, and who wrote it.
    pub header: Header,
    /// Entries, with their lines.
    pub entries: Vec<(usize, Entry)>,
    /// A motion that was under way when the session ended.
    pub unfinished: Option<Command>,
    /// The line of which only a part was written.
    pub torn: Option<usize>,
    /// Bytes of all whole lines.
    pub whole_bytes: u64,
}

impl Record {
    /// Reads a journal.
    ///
    /// # Errors
    /// If the file cannot be read or is damaged, with the line.
    pub fn read(path: &Path) -> Result<Record, JournalError> {
        let file = path.display().to_string();
        let bytes = input::bytes(path, RECORD_BYTES, "no journal has").map_err(|why| {
            SceneError::whole(&file, format!("the journal cannot be read: {why}"))
        })?;
        Record::from_bytes(&file, &bytes)
    }

    /// Reads a journal from the bytes of its file; `file` is what messages call it.
    ///
    /// # Errors
    /// If it is damaged, with the line.
    pub fn from_bytes(file: &str, bytes: &[u8]) -> Result<Record, JournalError> {
        let whole = bytes
            .iter()
            .rposition(|byte| *byte == b'\n')
            .map_or(0, |at| at + 1);
        let marked = match bytes.starts_with(input::MARK.to_string().as_bytes()) {
            true => input::MARK.len_utf8().min(whole),
            false => 0,
        };
        let text = str::from_utf8(&bytes[marked..whole]).map_err(|e| {
            let good = &bytes[..marked + e.valid_up_to()];
            let line = 1 + good.iter().filter(|byte| **byte == b'\n').count();
            damaged(file, (line, 1), "the line is not text in UTF-8")
        })?;
        let mut lines = text.lines().enumerate().map(|(k, line)| (k + 1, line));
        let (_, first) = lines.next().ok_or_else(|| {
            let message = "the file has no whole line; a journal's first is its scene";
            damaged(file, (1, 1), message)
        })?;
        let header = header(file, first).map_err(|error| match error.at {
            Some(_) => read::or_mistaken(error, file, text, FileKind::Journal),
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

    /// The scene that it holds.
    ///
    /// # Errors
    /// If this version finds it unsound.
    pub fn scene(&self) -> Result<Scene, JournalError> {
        let header = &self.header;
        Scene::from_spec(&header.name, header.scene.clone()).map_err(|source| JournalError::Scene {
            file: self.file.clone(),
            source: Box::new(source),
        })
    }

    /// What is to be said about its end; empty where it ended well.
    pub fn reservations(&self) -> String {
        let mut told = String::new();
        if let Some(line) = self.torn {
            let _ = write!(told, "; line {line} was only begun, and is left out");
        }
        if self.unfinished.is_some() {
            told += "; a motion was under way at the end, and is not repeated";
        }
        told
    }
}

fn header(file: &str, line: &str) -> Result<Header, SceneError> {
    /// What any format has.
    #[derive(Deserialize)]
    struct Any {
        format: u32,
    }
    if let Ok(Any { format }) = notation::read(line)
        && format != FORMAT
    {
        return Err(SceneError::whole(
            file,
            format!("the journal has format {format}, and this program knows only format {FORMAT}"),
        ));
    }
    parsed(file, 1, line)
}

fn parsed<T: DeserializeOwned>(file: &str, number: usize, line: &str) -> Result<T, SceneError> {
    notation::read(line)
        .map_err(|e| read::refused(file, number, "the line is no entry of a journal: ", &e))
}

fn damaged(file: &str, at: (usize, usize), message: &str) -> SceneError {
    SceneError {
        at: Some(at),
        ..SceneError::whole(file, message)
    }
}

fn failure(file: &Path, doing: &'static str, source: io::Error) -> JournalError {
    JournalError::File {
        file: file.to_owned(),
        doing,
        source,
    }
}

/// Syncs the name of a new file. Some file systems cannot sync folders; the file itself is synced in any case.
fn sync_folder(file: &Path) {
    let folder = file.parent().filter(|folder| *folder != Path::new(""));
    let _ = File::open(folder.unwrap_or(Path::new("."))).and_then(|folder| folder.sync_all());
}

/// Whether a file's name says that it is a journal.
pub fn is_named_so(file: &Path) -> bool {
    file.extension().is_some_and(|ending| ending == EXTENSION)
}

/// Where journals are kept that are given no place: in the user's directory for states, or for data where the system
/// has none.
///
/// # Errors
/// If the system names no home directory.
pub fn directory() -> Result<PathBuf, JournalError> {
    Ok(home()?.join("journals"))
}

/// The program's own place among what the user keeps: journals, and what was done of the lessons.
///
/// # Errors
/// If the system names no home directory.
pub fn home() -> Result<PathBuf, JournalError> {
    let ours = directories::ProjectDirs::from("", "", "stickslip").ok_or(JournalError::NoPlace)?;
    Ok(ours.state_dir().unwrap_or(ours.data_local_dir()).to_owned())
}

/// The journal that was written last.
///
/// # Errors
/// If there is none.
pub fn newest() -> Result<PathBuf, JournalError> {
    let directory = directory()?;
    let none = || JournalError::NoJournal(directory.clone());
    let written = |entry: std::fs::DirEntry| {
        let path = entry.path();
        let ours = path
            .extension()
            .is_some_and(|extension| extension == EXTENSION);
        let time = entry.metadata().and_then(|data| data.modified()).ok()?;
        ours.then_some((time, path))
    };
    let entries = std::fs::read_dir(&directory).map_err(|_| none())?;
    let newest = entries.filter_map(|entry| written(entry.ok()?)).max();
    newest.map(|(_, path)| path).ok_or_else(none)
}

/// A digest of a state's bits, computed from its RON text, in which floats are exact.
pub fn digest(state: &State) -> String {
    let state = state.digested();
    #[cfg(mutants)]
    let state = match stickslip_core::mutants::is_active("digest-without-contacts") {
        true => State {
            nodes: Vec::new(),
            ..state
        },
        false => state,
    };
    let mut digest = Digest::default();
    match notation::line_to(&mut digest, &state) {
        Ok(()) => digest.to_string(),
        // No state is known that RON cannot take; a digest that equals no other says so.
        Err(error) => format!("none: {error}"),
    }
}

/// Seconds since 1970; 0 where the clock stands before that.
pub(crate) fn now() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| since.as_secs())
}

/// A time of day and date, UTC: `20260131-235959`.
fn stamp(seconds: u64) -> String {
    let [year, month, day, hour, minute, second] = date(seconds);
    format!("{year:04}{month:02}{day:02}-{hour:02}{minute:02}{second:02}")
}

/// The last second of the year 9999.
const LAST_SECOND: u64 = 253_402_300_799;

/// Year, month, day, hour, minute and second of a time since 1970, UTC; no later than the year 9999.
pub(super) fn date(seconds: u64) -> [u64; 6] {
    // A file may claim any time; years are counted one by one here.
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
    fn what_changed_something_is_synced_and_a_move_of_the_cursor_is_not() {
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
    fn dates_are_those_of_the_calendar() {
        assert_eq!(stamp(0), "19700101-000000");
        assert_eq!(stamp(951_782_399), "20000228-235959");
        assert_eq!(stamp(951_782_400), "20000229-000000");
        assert_eq!(stamp(1_709_251_200), "20240301-000000");
        assert_eq!(stamp(1_735_689_599), "20241231-235959");
        assert_eq!(stamp(4_107_542_400), "21000301-000000");
        assert_eq!(stamp(u64::MAX), "99991231-235959");
    }
}
