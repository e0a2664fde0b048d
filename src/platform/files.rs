//! Writes files completely or not at all, and overwrites existing ones only on request.

use crate::system;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

#[cfg_attr(not(target_family = "wasm"), path = "disk_output.rs")]
#[cfg_attr(target_family = "wasm", path = "memory_output.rs")]
mod output;

pub use output::{Output, finish_all};

/// Why a file was not written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The file exists.
    #[error("{}: the file exists already", .0.display())]
    Exists(PathBuf),
    /// Writing failed.
    #[error("{}: the file cannot be written: {source}", path.display())]
    Failed {
        /// The file.
        path: PathBuf,
        /// The error from the system.
        source: io::Error,
    },
    /// A folder cannot be created.
    #[error("{}: the folder cannot be created: {source}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// The error from the system.
        source: io::Error,
    },
}

impl FileError {
    /// Writing failed.
    fn new(path: &Path, source: io::Error) -> Self {
        let path = path.to_owned();
        FileError::Failed { path, source }
    }
}

impl Output {
    /// Appends bytes.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn append(&mut self, bytes: &[u8]) -> Result<(), FileError> {
        self.write_all(bytes).map_err(|source| self.failed(source))
    }

    /// A write error with the file's name.
    pub fn failed(&self, source: io::Error) -> FileError {
        FileError::new(&self.target, source)
    }
}

/// Creates a folder for output, with its parents, unless it exists.
///
/// # Errors
/// If it cannot be created, for example because a file has its name.
pub fn create_folder(path: &Path) -> Result<(), FileError> {
    crate::disk::create_dir_all(path).map_err(|why| FileError::Folder {
        path: path.to_owned(),
        source: match why.kind() {
            io::ErrorKind::AlreadyExists => io::Error::other("a file has this name"),
            _ => why,
        },
    })
}

/// Writes several files, all or none.
///
/// # Errors
/// As [`Output::create`] and [`Output::finish`].
pub fn write_all(files: &[(PathBuf, impl AsRef<[u8]>)], overwrite: bool) -> Result<(), FileError> {
    let mut outputs = Vec::with_capacity(files.len());
    for (path, bytes) in files {
        let mut output = Output::create(path, overwrite)?;
        output.append(bytes.as_ref())?;
        outputs.push(output);
    }
    finish_all(outputs)
}

/// Rejects paths that exist and are not regular files, whose writes could block.
///
/// # Errors
/// If it is not a regular file.
pub fn regular(path: &Path) -> Result<(), FileError> {
    let found = crate::disk::metadata(path).ok();
    match found.and_then(|found| system::special_kind(found.file_type())) {
        None => Ok(()),
        Some(kind) => Err(FileError::new(path, io::Error::other(format!("is {kind}")))),
    }
}

/// A file name stem for a scene: its letters, digits, `-`, `_` and `.`.
pub fn stem(scene: &str) -> String {
    const MOST: usize = 64;
    let stem = Path::new(scene).file_stem().unwrap_or_default();
    stem.to_string_lossy()
        .chars()
        .take(MOST)
        .map(|c| {
            if c.is_alphanumeric() || "-_.".contains(c) {
                c
            } else {
                '_'
            }
        })
        .collect()
}

/// Writes a whole file.
///
/// # Errors
/// As [`Output::create`] and [`Output::finish`].
pub fn write(path: &Path, text: impl AsRef<[u8]>, overwrite: bool) -> Result<(), FileError> {
    let mut output = Output::create(path, overwrite)?;
    output.append(text.as_ref())?;
    output.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(directory: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(directory).unwrap();
        entries
            .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
            .collect()
    }

    #[test]
    fn a_file_appears_whole_or_not_at_all() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.csv");
        let mut output = Output::create(&path, false).unwrap();
        output.write_all(b"half").unwrap();
        assert!(!path.exists());
        drop(output);
        assert!(names(directory.path()).is_empty());
        write(&path, "whole", false).unwrap();
        assert_eq!(names(directory.path()), ["a.csv"]);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "whole");
    }

    #[test]
    fn several_files_appear_all_or_none_and_what_was_there_is_there_again() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        let outputs = |overwrite: bool| {
            let made = ["a", "b", "c"].map(|name| {
                let mut output = Output::create(&at(name), overwrite).unwrap();
                output.write_all(b"new").unwrap();
                output
            });
            Vec::from(made)
        };
        let all = outputs(false);
        std::fs::write(at("c"), "somebody else's").unwrap();
        assert!(matches!(finish_all(all), Err(FileError::Exists(path)) if path == at("c")));
        assert_eq!(names(directory.path()), ["c"]);
        std::fs::write(at("a"), "old").unwrap();
        let all = outputs(true);
        std::fs::remove_file(at("c")).unwrap();
        std::fs::create_dir(at("c")).unwrap();
        assert!(finish_all(all).is_err());
        assert_eq!(std::fs::read_to_string(at("a")).unwrap(), "old");
        assert!(!at("b").exists());
        std::fs::remove_dir(at("c")).unwrap();
        finish_all(outputs(true)).unwrap();
        let mut left = names(directory.path());
        left.sort();
        assert_eq!(left, ["a", "b", "c"]);
        assert_eq!(std::fs::read_to_string(at("a")).unwrap(), "new");
    }

    #[cfg(unix)]
    #[test]
    fn a_dangling_link_gets_its_target_on_request_and_stays_a_link() {
        use std::os::unix::fs::symlink;
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        std::fs::create_dir(at("sub")).unwrap();
        symlink("sub/there.csv", at("first")).unwrap();
        symlink("first", at("link")).unwrap();
        assert!(matches!(
            write(&at("link"), "a", false),
            Err(FileError::Exists(_))
        ));
        for text in ["a", "b"] {
            write(&at("link"), text, true).unwrap();
            assert_eq!(std::fs::read_to_string(at("sub/there.csv")).unwrap(), text);
            assert!(at("link").is_symlink() && at("first").is_symlink());
        }
        symlink("nowhere/x", at("lost")).unwrap();
        assert!(write(&at("lost"), "a", true).is_err());
        symlink("loop", at("loop")).unwrap();
        assert!(write(&at("loop"), "a", true).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn only_files_of_killed_runs_are_swept() {
        let directory = tempfile::tempdir().unwrap();
        let mut dead = std::process::Command::new("true").spawn().unwrap();
        dead.wait().unwrap();
        let ours = std::process::id();
        let abandoned = [
            format!(".stickslip-{}-aB3xYz.tmp", dead.id()),
            format!(".stickslip-{ours}-aB3xYz.tmp"),
        ];
        let others = [
            ".stickslip-1-aB3xYz.tmp".to_owned(),
            format!(".stickslip-{}-.tmp", dead.id()),
            format!(".stickslip-{}-a/b.tmp", dead.id()).replace('/', "."),
            ".stickslip-notes".to_owned(),
        ];
        let held = Output::create(&directory.path().join("held.csv"), false).unwrap();
        for name in abandoned.iter().chain(&others) {
            std::fs::write(directory.path().join(name), "half").unwrap();
        }
        write(&directory.path().join("a.csv"), "whole", false).unwrap();
        held.finish().unwrap();
        let mut left = names(directory.path());
        left.sort();
        let mut wanted = others.to_vec();
        wanted.extend(["a.csv".to_owned(), "held.csv".to_owned()]);
        wanted.sort();
        assert_eq!(left, wanted);
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_without_a_reader_fails_at_once() {
        let directory = tempfile::tempdir().unwrap();
        let pipe = directory.path().join("pipe");
        let mode = rustix::fs::Mode::RUSR | rustix::fs::Mode::WUSR;
        rustix::fs::mkfifoat(rustix::fs::CWD, &pipe, mode).unwrap();
        assert!(
            write(&pipe, "a", false)
                .unwrap_err()
                .to_string()
                .contains("without a reader")
        );
        assert!(regular(&pipe).is_err() && regular(directory.path()).is_err());
        let reading = pipe.clone();
        let reader = std::thread::spawn(move || std::fs::read_to_string(reading).unwrap());
        while write(&pipe, "to a reader", false).is_err() {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        assert_eq!(reader.join().unwrap(), "to a reader");
    }

    #[test]
    fn existing_files_are_replaced_only_on_request() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.csv");
        write(&path, "first", false).unwrap();
        assert!(matches!(
            write(&path, "second", false),
            Err(FileError::Exists(_))
        ));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "first");
        write(&path, "second", true).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "second");
        let late = directory.path().join("late.csv");
        let output = Output::create(&late, false).unwrap();
        std::fs::write(&late, "somebody else's").unwrap();
        assert!(matches!(output.finish(), Err(FileError::Exists(_))));
        assert_eq!(std::fs::read_to_string(&late).unwrap(), "somebody else's");
        assert!(Output::create(directory.path(), true).is_err());
        assert!(Output::create(&directory.path().join("no/such/place"), false).is_err());
    }
}
