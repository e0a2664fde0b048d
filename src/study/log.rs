//! Results that outlive a kill: a file to which each is appended as it comes, a whole line each.
//!
//! The first line tells which program wrote it: results of another one are not ours. Every other line is a key, a tab,
//! and a result as RON; the key is a hash of all that the result depends on, so that whatever is asked for next time, what
//! is there already is not computed again. A line that a kill has cut off has no end, and is taken away.

use rustix::fs::{FlockOperation, flock};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Why results could not be kept, or taken up.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    #[error("{}: {source}", path.display())]
    File { path: PathBuf, source: io::Error },
    #[error("{}: another run writes to it at present", .0.display())]
    Busy(PathBuf),
    #[error("{}: this is no file of kept results (it would begin with {ours:?}); it is left alone", path.display())]
    Foreign { path: PathBuf, ours: String },
    #[error("{}:{line}: this result cannot be read: {message}", path.display())]
    Broken {
        path: PathBuf,
        line: usize,
        message: String,
    },
}

/// Where results are kept.
#[derive(Debug)]
pub struct Log {
    path: PathBuf,
    file: Mutex<File>,
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
    pub fn open<T: DeserializeOwned>(path: &Path) -> Result<(Log, HashMap<String, T>), LogError> {
        let failed = |source| LogError::File {
            path: path.to_owned(),
            source,
        };
        let mut file = File::options()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path)
            .map_err(failed)?;
        if flock(&file, FlockOperation::NonBlockingLockExclusive)
            .is_err_and(|e| e == rustix::io::Errno::WOULDBLOCK)
        {
            return Err(LogError::Busy(path.to_owned()));
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(failed)?;
        let whole = bytes
            .iter()
            .rposition(|&b| b == b'\n')
            .map_or(0, |at| at + 1);
        let foreign = || LogError::Foreign {
            path: path.to_owned(),
            ours: head(),
        };
        let text = std::str::from_utf8(&bytes[..whole]).map_err(|_| foreign())?;
        let ours = text.lines().next().map_or_else(
            || head().as_bytes().starts_with(&bytes),
            |first| first == head(),
        );
        if !ours {
            return Err(foreign());
        }
        let mut found = HashMap::new();
        for (k, line) in text.lines().enumerate().skip(1) {
            let broken = |message: String| LogError::Broken {
                path: path.to_owned(),
                line: k + 1,
                message,
            };
            let (key, value) = line
                .split_once('\t')
                .ok_or_else(|| broken("it has no key".to_owned()))?;
            let value = ron::from_str(value).map_err(|e| broken(e.to_string()))?;
            found.insert(key.to_owned(), value);
        }
        file.set_len(whole as u64).map_err(failed)?;
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
            assert_eq!(found["c"], [2.0]);
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
