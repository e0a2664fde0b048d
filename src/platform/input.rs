//! Reads files: only regular ones, without blocking, and up to a maximum size.

use crate::disk::{self, File, Metadata, OpenOptions};
use crate::similar::did_you_mean_file;
use crate::system;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

/// Maximum size of a table of a chart or a reference.
pub const TABLE_BYTES: u64 = 64 << 20;
/// Maximum size of a snapshot or a journal; the largest scenes need a tenth of it.
pub const RECORD_BYTES: u64 = 256 << 20;

/// Why a file was not read.
#[derive(Debug, thiserror::Error)]
pub enum Unreadable {
    /// The system reports an error.
    #[error("the file cannot be read: {0}")]
    Failed(#[from] io::Error),
    /// Not a regular file, but this.
    #[error("the file is {0}; only regular files are read")]
    NoFile(&'static str),
    /// The file is too large.
    #[error("the file has more than {} MiB; {what}", most >> 20)]
    TooLarge {
        /// Maximum number of bytes.
        most: u64,
        /// The end of the message: a reason, or what to do instead.
        what: &'static str,
    },
    /// It is not text.
    #[error("the file is not UTF-8 text")]
    NoText {
        /// Line of the first invalid byte, from 1.
        line: usize,
        /// Its column, from 1.
        column: usize,
    },
}

impl Unreadable {
    /// The message: the file's name, the line and column if known, and the error.
    pub fn of(&self, file: &str) -> String {
        match self {
            Unreadable::NoText { line, column } => format!("{file}:{line}:{column}: {self}"),
            _ => format!("{file}: {self}"),
        }
    }
}

/// The bytes of a file with at most `most` of them; `what` ends the message for a larger file.
///
/// # Errors
/// If it is not a regular file, cannot be read, or is larger.
pub fn bytes(path: &Path, most: u64, what: &'static str) -> Result<Vec<u8>, Unreadable> {
    let file = open(path, OpenOptions::new().read(true))?;
    let mut bytes = Vec::new();
    file.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        Err(Unreadable::TooLarge { most, what })
    } else {
        Ok(bytes)
    }
}

/// The path of a file named in another file. It must be in the same folder or below it, so that a scene from someone else cannot
/// refer to other files of the machine, directly or through a link.
///
/// # Errors
/// A message with the reason.
pub fn path_in_folder(own: &Path, named: &str) -> Result<PathBuf, String> {
    let parts = || Path::new(named).components();
    if named.is_empty() || !parts().all(|part| matches!(part, Component::Normal(_))) {
        return Err("the file must be in the same folder as this one or below it; expected a relative path without ..".to_owned());
    }
    let folder = own.parent().unwrap_or(Path::new(""));
    let path = folder.join(named);
    let message = |error: io::Error| failed(&path, error).to_string();
    let real = disk::canonicalize(&path).map_err(message)?;
    let here = if folder == Path::new("") {
        Path::new(".")
    } else {
        folder
    };
    if real.starts_with(disk::canonicalize(here).map_err(message)?) {
        Ok(path)
    } else {
        Err("the file is a link to a file outside this folder".to_owned())
    }
}

/// The first bytes of a file, at most `most`.
///
/// # Errors
/// If it is not a regular file, or cannot be read.
pub fn start(path: &Path, most: u64) -> Result<Vec<u8>, Unreadable> {
    let file = open(path, OpenOptions::new().read(true))?;
    let mut bytes = Vec::new();
    file.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The text of a file, without a byte-order mark.
///
/// # Errors
/// As [`bytes`], and if it is not UTF-8.
pub fn text(path: &Path, most: u64, what: &'static str) -> Result<String, Unreadable> {
    utf8(bytes(path, most, what)?)
}

/// Decodes UTF-8, without a byte-order mark.
///
/// # Errors
/// If it is not UTF-8.
pub fn utf8(bytes: Vec<u8>) -> Result<String, Unreadable> {
    let mut text = String::from_utf8(bytes).map_err(|e| {
        let good = &e.as_bytes()[..e.utf8_error().valid_up_to()];
        let start = good.iter().rposition(|&b| b == b'\n').map_or(0, |k| k + 1);
        Unreadable::NoText {
            line: 1 + good.iter().filter(|&&b| b == b'\n').count(),
            column: 1 + String::from_utf8_lossy(&good[start..]).chars().count(),
        }
    })?;
    if text.starts_with(MARK) {
        text.drain(..MARK.len_utf8());
    }
    Ok(text)
}

/// The byte-order mark, which some editors write at the start of a file.
pub const MARK: char = '\u{feff}';

/// Opens a regular file without blocking.
///
/// # Errors
/// If it is not a regular file, or cannot be opened.
pub fn open(path: &Path, options: &mut OpenOptions) -> Result<File, Unreadable> {
    // Checked before opening, since opening some devices has side effects, and afterwards, since the file may have been replaced.
    match disk::metadata(path) {
        Ok(found) => regular(&found)?,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) => return Err(error.into()),
    }
    let file = system::set_nonblocking(options)
        .open(path)
        .map_err(|error| failed(path, error))?;
    regular(&file.metadata()?)?;
    Ok(file)
}

/// The error with the name of a similar file if this one does not exist.
fn failed(path: &Path, error: io::Error) -> Unreadable {
    let similar = match error.kind() {
        io::ErrorKind::NotFound => did_you_mean_file(&path.to_string_lossy()),
        _ => String::new(),
    };
    if similar.is_empty() {
        Unreadable::Failed(error)
    } else {
        Unreadable::Failed(io::Error::new(error.kind(), format!("{error}{similar}")))
    }
}

fn regular(found: &Metadata) -> Result<(), Unreadable> {
    match system::special_kind(found.file_type()) {
        None => Ok(()),
        Some(kind) => Err(Unreadable::NoFile(kind)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn special_files_are_rejected_without_blocking() {
        use rustix::fs::{CWD, Mode, mkfifoat};
        let directory = tempfile::tempdir().unwrap();
        let pipe = directory.path().join("pipe");
        mkfifoat(CWD, &pipe, Mode::RUSR | Mode::WUSR).unwrap();
        for (path, kind) in [
            (pipe.as_path(), "a pipe"),
            (directory.path(), "a directory"),
            (Path::new("/dev/zero"), "a device"),
        ] {
            let refused = bytes(path, 10, "").unwrap_err();
            assert!(
                matches!(refused, Unreadable::NoFile(k) if k == kind),
                "{refused}"
            );
        }
        let missing = bytes(&directory.path().join("none"), 10, "").unwrap_err();
        assert!(matches!(missing, Unreadable::Failed(_)));
    }

    #[cfg(unix)]
    #[test]
    fn a_named_file_is_in_the_folder_or_below() {
        let directory = tempfile::tempdir().unwrap();
        let folder = directory.path().join("own");
        std::fs::create_dir_all(folder.join("deep")).unwrap();
        for file in ["own/a", "own/deep/b", "other"] {
            std::fs::write(directory.path().join(file), "").unwrap();
        }
        std::os::unix::fs::symlink("../other", folder.join("out")).unwrap();
        std::os::unix::fs::symlink("deep/b", folder.join("in")).unwrap();
        let own = folder.join("scene");
        for named in ["a", "deep/b", "in"] {
            assert_eq!(path_in_folder(&own, named), Ok(folder.join(named)));
        }
        let absolute = folder.join("a");
        let wrong = [
            "../other",
            "deep/../a",
            "out",
            "",
            "none",
            absolute.to_str().unwrap(),
        ];
        for named in wrong {
            assert!(path_in_folder(&own, named).is_err(), "{named}");
        }
    }

    #[test]
    fn size_text_and_mark() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("file");
        std::fs::write(&path, "\u{feff}ten bytes").unwrap();
        assert_eq!(text(&path, 12, "").unwrap(), "ten bytes");
        assert!(matches!(
            text(&path, 11, ""),
            Err(Unreadable::TooLarge { .. })
        ));
        std::fs::write(&path, b"a\nb\xc3\xbc\xff").unwrap();
        let place = text(&path, 12, "").unwrap_err();
        assert!(matches!(place, Unreadable::NoText { line: 2, column: 3 }));
    }
}
