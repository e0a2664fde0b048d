//! Results that outlive a kill: a file to which each is appended as it comes, a whole line each.
//!
//! The first line tells which program wrote it: results of another one are not ours. Every other line is a key, a tab,
//! and a result as RON; the key is a hash of all that the result depends on, so that whatever is asked for next time, what
//! is there already is not computed again. A line that a kill has cut off has no end, and is taken away.

use crate::format::kind::{FileKind, mistaken};
use crate::format::read::plainly;
use crate::outside::input::{self, Unreadable};
use rustix::fs::{FlockOperation, flock};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Why results could not be kept, or taken up.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The system refused.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The file cannot be read.
    #[error("{}", why.of(&path.display().to_string()))]
    Unread {
        /// The file.
        path: PathBuf,
        /// Why.
        why: Unreadable,
    },
    /// Another run has the file.
    #[error("{}: another run writes to it at present", .0.display())]
    Busy(PathBuf),
    /// The file is of something else.
    #[error("{}:1:1: {}; it is left alone", path.display(), told.clone().unwrap_or_else(|| format!("this is no file of kept results (it would begin with {ours:?})")))]
    Foreign {
        /// The file.
        path: PathBuf,
        /// How a file of results begins.
        ours: String,
        /// What it is, and what reads it, where it is of the program.
        told: Option<String>,
    },
    /// A line of it cannot be read.
    #[error("{}:{line}:{column}: this result cannot be read: {message}", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// From 1.
        line: usize,
        /// From 1, in characters.
        column: usize,
        /// What is wrong there.
        message: String,
    },
}

/// Most bytes of a file that is taken up.
const MOST_BYTES: u64 = 2 << 30;
/// Most bytes of a line of it.
const MOST_LINE: usize = 1 << 20;

/// Where results are kept.
#[derive(Debug)]
pub struct Log {
    path: PathBuf,
    file: Mutex<File>,
}

/// A result that was there, and its line.
#[derive(Debug, Clone, PartialEq)]
pub struct Found<T> {
    /// Line of the file, from 1.
    pub line: usize,
    /// The result.
    pub value: T,
}

/// The lines of a file that is read, one in memory at a time.
struct Lines<'a> {
    from: BufReader<&'a File>,
    path: &'a Path,
    /// Number of the last line.
    number: usize,
    /// Bytes of all whole lines so far.
    whole: u64,
}

impl Lines<'_> {
    /// Reads the first line; false where there is none yet, or only a part of ours.
    fn head(&mut self) -> Result<bool, LogError> {
        let path = self.path;
        let foreign = || LogError::Foreign {
            path: path.to_owned(),
            ours: head(),
            told: told(path),
        };
        // Were it longer, it would not be ours.
        let bytes = self.bytes(head().len() + 8)?;
        let mark = input::MARK.to_string();
        let text = bytes.strip_prefix(mark.as_bytes()).unwrap_or(&bytes);
        match text.strip_suffix(b"\n") {
            Some(line) if line == head().as_bytes() => {
                (self.number, self.whole) = (1, bytes.len() as u64);
                Ok(true)
            }
            None if head().as_bytes().starts_with(text) => Ok(false),
            _ => Err(foreign()),
        }
    }

    /// The next whole line, without its end.
    fn next(&mut self) -> Result<Option<String>, LogError> {
        if self.number == 0 {
            return Ok(None);
        }
        let mut bytes = self.bytes(MOST_LINE)?;
        let broken = |message: &str| LogError::Broken {
            path: self.path.to_owned(),
            line: self.number + 1,
            column: 1,
            message: message.to_owned(),
        };
        let length = bytes.len();
        if bytes.pop_if(|last| *last == b'\n').is_none() {
            return match length < MOST_LINE {
                true => Ok(None),
                false => Err(broken("the line is longer than any result")),
            };
        }
        let text = String::from_utf8(bytes).map_err(|_| broken("it is not text in UTF-8"))?;
        self.number += 1;
        self.whole += length as u64;
        Ok(Some(text))
    }

    /// The bytes up to the end of a line, that included, or so many.
    fn bytes(&mut self, most: usize) -> Result<Vec<u8>, LogError> {
        let mut bytes = Vec::new();
        let read = (&mut self.from)
            .take(most as u64)
            .read_until(b'\n', &mut bytes);
        read.map(|_| bytes).map_err(|source| LogError::File {
            path: self.path.to_owned(),
            source,
        })
    }
}

/// What a file is, where it is another one of the program.
fn told(path: &Path) -> Option<String> {
    /// Bytes that tell one from another.
    const READ_TO_TELL: u64 = 1 << 16;
    let start = input::start(path, READ_TO_TELL).ok()?;
    let name = path.display().to_string();
    mistaken(&name, &String::from_utf8_lossy(&start), FileKind::Results)
}

/// A line's key and its result; the column where that is no such line, and why.
fn entry<T: DeserializeOwned>(line: &str) -> Result<(String, T), (usize, String)> {
    let (key, value) = line
        .split_once('\t')
        .ok_or((1, "it has no key".to_owned()))?;
    let value = ron::from_str(value).map_err(|e| {
        let column = key.chars().count() + 1 + e.span.start.col;
        (column, plainly(&e.code))
    })?;
    Ok((key.to_owned(), value))
}

/// The first line.
fn head() -> String {
    format!(
        "stickslip {} results, {}",
        env!("CARGO_PKG_VERSION"),
        super::origin::REVISION
    )
}

impl Log {
    /// Opens a file of results, or begins one, and reads what is there: by key.
    ///
    /// # Errors
    /// If it cannot be read or written, if it is something else, or if another run has it open.
    pub fn open<T: DeserializeOwned>(
        path: &Path,
    ) -> Result<(Log, HashMap<String, Found<T>>), LogError> {
        let failed = |source| LogError::File {
            path: path.to_owned(),
            source,
        };
        let mut options = File::options();
        options.read(true).write(true).create(true).truncate(false);
        let mut file = input::open(path, &mut options).map_err(|why| LogError::Unread {
            path: path.to_owned(),
            why,
        })?;
        if flock(&file, FlockOperation::NonBlockingLockExclusive)
            .is_err_and(|e| e == rustix::io::Errno::WOULDBLOCK)
        {
            return Err(LogError::Busy(path.to_owned()));
        }
        let size = file.metadata().map_err(failed)?.len();
        if size > MOST_BYTES {
            let what = "no file of kept results is read that has";
            let why = Unreadable::TooLarge {
                most: MOST_BYTES,
                what,
            };
            return Err(LogError::Unread {
                path: path.to_owned(),
                why,
            });
        }
        let mut lines = Lines {
            from: BufReader::new(&file),
            path,
            number: 0,
            whole: 0,
        };
        let mut found = HashMap::new();
        let begun = lines.head()?;
        while let Some(line) = lines.next()? {
            let (key, value) = entry(&line).map_err(|(column, message)| LogError::Broken {
                path: path.to_owned(),
                line: lines.number,
                column,
                message,
            })?;
            let line = lines.number;
            found.insert(key, Found { line, value });
        }
        let whole = lines.whole;
        file.set_len(whole).map_err(failed)?;
        file.seek(SeekFrom::End(0)).map_err(failed)?;
        if !begun {
            file.write_all((head() + "\n").as_bytes()).map_err(failed)?;
        }
        let log = Log {
            path: path.to_owned(),
            file: Mutex::new(file),
        };
        Ok((log, found))
    }

    /// What is wrong with the result of a line.
    pub fn broken(&self, line: usize, message: &str) -> LogError {
        LogError::Broken {
            path: self.path.clone(),
            line,
            column: 1,
            message: message.to_owned(),
        }
    }

    /// Keeps a result, in one write.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn keep<T: Serialize>(&self, key: &str, value: &T) -> Result<(), LogError> {
        let failed = |source| LogError::File {
            path: self.path.clone(),
            source,
        };
        let value = ron::to_string(value).map_err(|e| failed(io::Error::other(e)))?;
        let line = format!("{key}\t{value}\n");
        let mut file = self.file.lock().unwrap_or_else(|e| e.into_inner());
        file.write_all(line.as_bytes()).map_err(failed)
    }
}

/// A key: a hash (FNV-1a, 128 bits) of parts of text, the same on every machine.
pub fn key<'a>(parts: impl IntoIterator<Item = &'a str>) -> String {
    let mut hash: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    // A part's end is a byte that no text has.
    let bytes = parts.into_iter().flat_map(|p| p.bytes().chain([0xff]));
    for byte in bytes {
        hash = (hash ^ u128::from(byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b);
    }
    format!("{hash:032x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_there_again_and_a_cut_line_is_not() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.log");
        let (log, found) = Log::open::<Vec<f64>>(&path).unwrap();
        assert!(found.is_empty());
        log.keep("a", &vec![0.1, f64::INFINITY]).unwrap();
        log.keep("b", &vec![1e-300]).unwrap();
        assert!(matches!(
            Log::open::<Vec<f64>>(&path),
            Err(LogError::Busy(_))
        ));
        drop(log);
        let whole = std::fs::read(&path).unwrap();
        for cut in 0..whole.len() {
            std::fs::write(&path, &whole[..cut]).unwrap();
            let (log, found) = Log::open::<Vec<f64>>(&path).unwrap();
            let lines = whole[..cut].iter().filter(|&&b| b == b'\n').count();
            assert_eq!(found.len(), lines.saturating_sub(1), "cut at {cut}");
            log.keep("c", &vec![2.0]).unwrap();
            drop(log);
            let (_, found) = Log::open::<Vec<f64>>(&path).unwrap();
            assert_eq!(found["c"].value, [2.0]);
        }
    }

    #[test]
    fn what_is_no_log_is_left_alone() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.csv");
        for text in ["a,b\n1,2\n", "a,b"] {
            std::fs::write(&path, text).unwrap();
            let refused = Log::open::<f64>(&path);
            assert!(matches!(refused, Err(LogError::Foreign { .. })), "{text}");
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
        }
    }

    #[test]
    fn a_key_tells_where_parts_end() {
        assert_ne!(key(["ab", "c"]), key(["a", "bc"]));
        assert_eq!(key(["ab", "c"]), key(["ab", "c"]));
    }
}
