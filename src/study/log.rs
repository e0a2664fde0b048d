//! Logs of results, which survive a killed process: each result is appended as a whole line when it is ready.
//!
//! The first line identifies the program that wrote the file; results of other revisions are refused. Each
//! other line is a key, a tab, and a result in RON. The key is a hash of everything that the result depends on,
//! so that existing results are never computed again. A line with the key `input` describes what the results
//! belong to ([`Input`]). An incomplete last line was cut off by a kill; it is removed, or ignored if the file
//! is only read.
//!
//! Each line ends with its digest ([`stickslip_exchange::seal`]); a file with a mismatch is refused.

use super::origin;
use super::run_error::{RunError, error_at};
use super::shard::Key;
use super::sweep_input::Input;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fs::TryLockError;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use stickslip_exchange::seal::{opened as unsealed, sealed};
use stickslip_platform::disk::{File, OpenOptions};
use stickslip_platform::input::{self, Unreadable};
use stickslip_scene::format::notation;
use stickslip_scene::format::read::{not_read, plainly};
use stickslip_scene::readers::mistaken;
use stickslip_scene::{FileKind, SceneError};

/// Maximum size of a log in bytes.
const MOST_BYTES: u64 = 2 << 30;
/// Error for a line whose digest does not match.
const CHANGED: &str = "the line was changed after it was written (its digest differs); delete it to compute the result again";
/// Key of a line that describes what the results belong to.
const INPUT: &str = "input";

/// Error for a result that no run can have.
const UNSOUND: &str =
    "the result has a number that is not finite; delete the line to compute it again";

/// A result that can be stored in a log.
pub trait Outcome: Serialize + DeserializeOwned + Clone + Send + Sync {
    /// Maximum size in bytes of a result in a file.
    const MAX_BYTES: usize;

    /// Whether a run can have this result: its numbers are finite wherever those of a run are.
    fn is_sound(&self) -> bool;

    /// Whether the run was not interrupted: only such results are stored.
    fn is_over(&self) -> bool {
        true
    }

    /// Number of runs in the result; a result is refused if its cell has another number.
    fn runs(&self) -> usize {
        1
    }

    /// Combines two results of one cell; `None` if they contradict each other.
    fn join(&self, other: &Self) -> Option<Self> {
        same(self, other).then(|| self.clone())
    }
}

/// Whether two results are the same to the last bit. Compares their text, because NaN is not equal to itself.
pub fn same<T: Serialize>(one: &T, other: &T) -> bool {
    let text = |value: &T| ron::to_string(value).ok();
    text(one) == text(other)
}

/// An open log.
#[derive(Debug)]
pub struct Log {
    path: PathBuf,
    file: Mutex<File>,
}

/// Contents of a log.
#[derive(Debug)]
pub struct Content<T> {
    /// What the results belong to.
    pub inputs: Vec<Input>,
    /// The results in the order of the file.
    pub results: Vec<(Key, StoredResult<T>)>,
}

/// A result in a log.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredResult<T> {
    /// Line number, from 1.
    pub line: usize,
    /// The result.
    pub value: T,
}

/// The lines of a log, read one at a time.
struct Lines<'a> {
    from: BufReader<&'a File>,
    path: &'a Path,
    /// Maximum length of a line in bytes.
    most: usize,
    /// Number of the last line read.
    number: usize,
    /// Length of all complete lines so far, in bytes.
    whole: u64,
}

impl Lines<'_> {
    /// Reads the first line; `false` if it is missing or incomplete.
    fn head(&mut self) -> Result<bool, RunError> {
        let path = self.path;
        let wrong = |message: String| Err(error_at(path, (1, 1), message).into());
        /// Maximum length of the first line in any revision, in bytes.
        const MOST_HEAD: usize = 256;
        let bytes = self.bytes(MOST_HEAD)?;
        let mark = input::MARK.to_string();
        let text = bytes.strip_prefix(mark.as_bytes()).unwrap_or(&bytes);
        let line = text.strip_suffix(b"\n");
        match line.map(|line| line.strip_suffix(b"\r").unwrap_or(line)) {
            Some(line) if line == head().as_bytes() => {
                (self.number, self.whole) = (1, bytes.len() as u64);
                Ok(true)
            }
            None if head().as_bytes().starts_with(text) => Ok(false),
            Some(line)
                if FileKind::from_text(&String::from_utf8_lossy(line))
                    == Some(FileKind::Results) =>
            {
                let theirs = String::from_utf8_lossy(line);
                wrong(format!(
                    "written by another revision of the program, whose results may differ: {theirs:?} instead of {:?}",
                    head()
                ))
            }
            _ => {
                let found = wrong_kind(path).unwrap_or_else(|| {
                    format!("not a log of results (it would begin with {:?})", head())
                });
                wrong(format!("{found}; the file has not been changed"))
            }
        }
    }

    /// The next complete line, without its end.
    fn next(&mut self) -> Result<Option<String>, RunError> {
        if self.number == 0 {
            return Ok(None);
        }
        let mut bytes = self.bytes(self.most)?;
        let broken = |message: &str| broken(self.path, (self.number + 1, 1), message);
        let length = bytes.len();
        if bytes.pop_if(|last| *last == b'\n').is_none() {
            return if length < self.most {
                Ok(None)
            } else {
                Err(broken("the line is longer than any result"))
            };
        }
        // A copy through Windows may end its lines with CRLF.
        bytes.pop_if(|last| *last == b'\r');
        let text = String::from_utf8(bytes).map_err(|_| broken("the line is not valid UTF-8"))?;
        let text = unsealed(&text).ok_or_else(|| broken(CHANGED))?.to_owned();
        self.number += 1;
        self.whole += length as u64;
        Ok(Some(text))
    }

    /// The bytes up to and including the end of a line, or `most` bytes.
    fn bytes(&mut self, most: usize) -> Result<Vec<u8>, RunError> {
        let mut bytes = Vec::new();
        let read = (&mut self.from)
            .take(most as u64)
            .read_until(b'\n', &mut bytes);
        read.map(|_| bytes).map_err(RunError::system(self.path))
    }
}

/// What kind of file this is, if it is another one of the program.
fn wrong_kind(path: &Path) -> Option<String> {
    /// Number of bytes that identify the kind of file.
    const READ_TO_TELL: u64 = 1 << 16;
    let start = input::start(path, READ_TO_TELL).ok()?;
    let name = path.display().to_string();
    mistaken(&name, &String::from_utf8_lossy(&start), FileKind::Results)
}

/// A parsed line.
enum Entry<T> {
    Input(Input),
    Result(Key, T),
}

/// Parses a line; errors have a column and a message.
fn entry<T: Outcome>(line: &str) -> Result<Entry<T>, (usize, String)> {
    let (key, value) = line
        .split_once('\t')
        .ok_or((1, "the line has no key".to_owned()))?;
    let wrong = |e: ron::error::SpannedError| {
        let column = key.chars().count() + 1 + e.span.start.col;
        (column, plainly(&e.code))
    };
    if key == INPUT {
        return notation::read(value).map(Entry::Input).map_err(wrong);
    }
    let key = Key::read(key).ok_or((1, "the key must have 32 hexadecimal digits".to_owned()))?;
    let value = ron::from_str(value).map_err(wrong)?;
    Ok(Entry::Result(key, value))
}

/// The first line.
fn head() -> String {
    format!(
        "stickslip {} results, {}",
        env!("CARGO_PKG_VERSION"),
        origin::REVISION
    )
}

/// The contents of a file, and the length of its complete lines; empty if the first line is missing. A file
/// that belongs to something else than `ours` is refused before its results are read.
fn content<T: Outcome>(
    file: &File,
    path: &Path,
    ours: &Input,
) -> Result<(Content<T>, u64), RunError> {
    let failed = RunError::system(path);
    let size = file.metadata().map_err(failed)?.len();
    if size > MOST_BYTES {
        let what = "too large for a log of results";
        let most = MOST_BYTES;
        return Err(unread(path, &Unreadable::TooLarge { most, what }));
    }
    let mut lines = Lines {
        from: BufReader::new(file),
        path,
        most: T::MAX_BYTES,
        number: 0,
        whole: 0,
    };
    let mut content = Content {
        inputs: Vec::new(),
        results: Vec::new(),
    };
    lines.head()?;
    while let Some(line) = lines.next()? {
        let read = entry::<T>(&line)
            .map_err(|(column, message)| broken(path, (lines.number, column), &message))?;
        match read {
            Entry::Input(input) => {
                if let Some(why) = ours.difference(&input) {
                    return Err(SceneError::whole(&path.display().to_string(), why).into());
                }
                content.inputs.push(input);
            }
            Entry::Result(_, value) if !value.is_sound() => {
                return Err(broken(path, (lines.number, 1), UNSOUND));
            }
            Entry::Result(key, value) => {
                let line = lines.number;
                content.results.push((key, StoredResult { line, value }));
            }
        }
    }
    Ok((content, lines.whole))
}

/// Opens a file with these options.
fn opened(path: &Path, options: &mut OpenOptions) -> Result<File, RunError> {
    input::open(path, options).map_err(|why| unread(path, &why))
}

fn unread(path: &Path, why: &Unreadable) -> RunError {
    not_read(&path.display().to_string(), why).into()
}

/// An invalid result.
pub(super) fn broken(path: &Path, at: (usize, usize), message: &str) -> RunError {
    error_at(path, at, format!("this result cannot be read: {message}")).into()
}

/// Reads a log without changing it; another process may be writing to it.
///
/// # Errors
/// If it cannot be read, or belongs to something else.
pub fn read<T: Outcome>(path: &Path, ours: &Input) -> Result<Content<T>, RunError> {
    let file = opened(path, File::options().read(true))?;
    Ok(content(&file, path, ours)?.0)
}

impl Log {
    /// Opens or creates a log, and reads its contents.
    ///
    /// # Errors
    /// If it cannot be read or written, is something else, or is open in another run.
    pub fn open<T: Outcome>(path: &Path, ours: &Input) -> Result<(Log, Content<T>), RunError> {
        let failed = RunError::system(path);
        let mut options = File::options();
        options.read(true).write(true).create(true).truncate(false);
        let mut file = opened(path, &mut options)?;
        if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
            let path = path.display();
            return Err(RunError::Again(format!(
                "{path}: another run is writing to this file"
            )));
        }
        let (found, whole) = content(&file, path, ours)?;
        file.set_len(whole).map_err(failed)?;
        file.seek(SeekFrom::End(0)).map_err(failed)?;
        if whole == 0 {
            file.write_all((head() + "\n").as_bytes()).map_err(failed)?;
        }
        let log = Log {
            path: path.to_owned(),
            file: Mutex::new(file),
        };
        Ok((log, found))
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Appends a result, in one write.
    ///
    /// # Errors
    /// If it cannot be written, or could not be read back.
    pub fn keep<T: Outcome>(&self, key: Key, value: &T) -> Result<(), RunError> {
        if value.is_sound() {
            self.write(&key.to_string(), value)
        } else {
            let why = "a result has a number that is not finite, so it cannot be stored";
            Err(SceneError::whole(&self.path.display().to_string(), why).into())
        }
    }

    /// Records what the results belong to.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn name(&self, input: &Input) -> Result<(), RunError> {
        self.write(INPUT, input)
    }

    fn write<T: Serialize>(&self, key: &str, value: &T) -> Result<(), RunError> {
        let failed = RunError::system(&self.path);
        let value = notation::strict_line(value).map_err(|e| failed(io::Error::other(e)))?;
        let line = sealed(&format!("{key}\t{value}")) + "\n";
        let mut file = self
            .file
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        file.write_all(line.as_bytes()).map_err(failed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Outcome for Vec<f64> {
        const MAX_BYTES: usize = 1 << 10;

        fn is_sound(&self) -> bool {
            self.iter().all(|value| !value.is_nan())
        }
    }

    fn open(path: &Path) -> Result<(Log, Content<Vec<f64>>), RunError> {
        Log::open(path, &Input::new("test", Vec::new()))
    }

    /// The error for a file of results, and its line.
    fn refused(path: &Path) -> (usize, String) {
        match open(path) {
            Err(RunError::File(error)) => {
                let message = error.message.strip_prefix("this result cannot be read: ");
                (error.at.unwrap().0, message.unwrap().to_owned())
            }
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_changed_digit_refuses_the_file_and_names_its_line() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.log");
        let (log, _) = open(&path).unwrap();
        for key in ["a", "b", "c"] {
            log.keep(Key::from_parts([key]), &vec![0.125, 7.0]).unwrap();
        }
        drop(log);
        let whole = std::fs::read_to_string(&path).unwrap();
        let (head, rest) = whole.split_once('\n').unwrap();
        for (place, letter) in rest.char_indices().filter(|(_, c)| c.is_ascii_digit()) {
            let mut changed = rest.as_bytes().to_vec();
            changed[place] = if letter == '3' { b'4' } else { b'3' };
            let changed = String::from_utf8(changed).unwrap();
            std::fs::write(&path, format!("{head}\n{changed}")).unwrap();
            let line = 2 + rest[..place].matches('\n').count();
            assert_eq!(refused(&path), (line, CHANGED.to_owned()), "{changed}");
        }
        // Without this line, the other results can be read.
        let left: Vec<&str> = rest.lines().skip(1).collect();
        std::fs::write(&path, format!("{head}\n{}\n", left.join("\n"))).unwrap();
        let (_, found) = open(&path).unwrap();
        assert_eq!(found.results.len(), 2);
    }

    #[test]
    fn non_finite_numbers_and_lines_without_a_digest_are_refused() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.log");
        for number in ["NaN", "-NaN"] {
            let line = format!("{}\t[1.0,{number}]", Key::from_parts(["a"]));
            std::fs::write(&path, format!("{}\n{}\n", head(), sealed(&line))).unwrap();
            assert_eq!(refused(&path), (2, UNSOUND.to_owned()));
            std::fs::write(&path, format!("{}\n{line}\n", head())).unwrap();
            assert_eq!(refused(&path), (2, CHANGED.to_owned()));
        }
    }

    #[test]
    fn results_are_read_back_and_an_incomplete_line_is_dropped() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.log");
        let (log, found) = open(&path).unwrap();
        assert!(found.results.is_empty());
        log.keep(Key::from_parts(["a"]), &vec![0.1, f64::INFINITY])
            .unwrap();
        log.keep(Key::from_parts(["b"]), &vec![1e-300]).unwrap();
        assert!(matches!(open(&path), Err(RunError::Again(_))));
        drop(log);
        let whole = std::fs::read(&path).unwrap();
        for cut in 0..whole.len() {
            std::fs::write(&path, &whole[..cut]).unwrap();
            let (log, found) = open(&path).unwrap();
            let lines = whole[..cut].iter().filter(|&&b| b == b'\n').count();
            assert_eq!(found.results.len(), lines.saturating_sub(1), "cut at {cut}");
            log.keep(Key::from_parts(["c"]), &vec![2.0]).unwrap();
            drop(log);
            let (_, found) = open(&path).unwrap();
            let last = found.results.last().unwrap();
            assert_eq!(
                (last.0, &last.1.value[..]),
                (Key::from_parts(["c"]), &[2.0][..])
            );
        }
    }

    #[test]
    fn other_files_are_not_changed() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.csv");
        for text in ["a,b\n1,2\n", "a,b"] {
            std::fs::write(&path, text).unwrap();
            let refused = open(&path).unwrap_err().to_string();
            let start = format!("{}:1:1: ", path.display());
            let end = "; the file has not been changed";
            assert!(
                refused.starts_with(&start) && refused.ends_with(end),
                "{refused}"
            );
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
        }
    }
}
