//! The one way in which files are written: whole or not at all, and never over another one unasked.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    #[error("{}: the file exists already, and nothing is overwritten unasked", .0.display())]
    Exists(PathBuf),
    #[error("{}: it cannot be written: {source}", path.display())]
    Failed { path: PathBuf, source: io::Error },
}

/// A file in the making. It appears under its name when it is finished, and leaves nothing behind when it is not.
pub struct Output {
    target: PathBuf,
    overwrite: bool,
    to: To,
}

enum To {
    /// A file beside the target that takes its name in the end.
    Beside(BufWriter<NamedTempFile>),
    /// A device or a pipe, which cannot be replaced.
    Straight(BufWriter<File>),
}

impl Output {
    /// Starts a file.
    ///
    /// # Errors
    /// If it exists and `overwrite` is not set, or if there is no writing there.
    pub fn create(path: &Path, overwrite: bool) -> Result<Output, FileError> {
        let failed = |source| FileError::Failed {
            path: path.to_owned(),
            source,
        };
        let found = std::fs::metadata(path).ok();
        if let Some(found) = &found
            && !found.is_file()
            && !found.is_dir()
        {
            let open = File::options().write(true).open(path).map_err(failed)?;
            return Ok(Output {
                target: path.to_owned(),
                overwrite,
                to: To::Straight(BufWriter::new(open)),
            });
        }
        // A dangling link has no metadata, and is still not ours to replace.
        if (found.is_some() || path.is_symlink()) && !overwrite {
            return Err(FileError::Exists(path.to_owned()));
        }
        if found.is_some_and(|found| found.is_dir()) {
            return Err(failed(io::Error::other("it is a directory")));
        }
        // Where the name is a link, what it points to is replaced, and not the link.
        let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let to = beside(&target).map_err(failed)?;
        Ok(Output {
            target,
            overwrite,
            to: To::Beside(BufWriter::new(to)),
        })
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// If it cannot be written to the end, or if a file of that name has appeared in the meantime.
    pub fn finish(self) -> Result<(), FileError> {
        let Output {
            target,
            overwrite,
            to,
        } = self;
        let failed = |source| FileError::Failed {
            path: target.clone(),
            source,
        };
        let file = match to {
            To::Straight(mut file) => return file.flush().map_err(failed),
            To::Beside(file) => file.into_inner().map_err(|e| failed(e.into_error()))?,
        };
        file.as_file().sync_all().map_err(failed)?;
        if overwrite {
            return file.persist(&target).map(drop).map_err(|e| failed(e.error));
        }
        file.persist_noclobber(&target).map(drop).map_err(|e| {
            if e.error.kind() == io::ErrorKind::AlreadyExists {
                FileError::Exists(target.clone())
            } else {
                failed(e.error)
            }
        })
    }

    /// An error of writing to it, with its name.
    pub fn failed(&self, source: io::Error) -> FileError {
        FileError::Failed {
            path: self.target.clone(),
            source,
        }
    }
}

/// A nameless file in the target's directory, so that it can take the target's name in one step.
fn beside(target: &Path) -> io::Result<NamedTempFile> {
    let directory = match target.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    if target.file_name().is_none() {
        return Err(io::Error::other("it is no name of a file"));
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".stickslip-");
    // Temporary files are private unless told otherwise; results are as public as other files are.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(directory)
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.to {
            To::Beside(file) => file.write(bytes),
            To::Straight(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.to {
            To::Beside(file) => file.flush(),
            To::Straight(file) => file.flush(),
        }
    }
}

/// Writes a whole text.
///
/// # Errors
/// As [`Output::create`] and [`Output::finish`].
pub fn write(path: &Path, text: &str, overwrite: bool) -> Result<(), FileError> {
    let mut output = Output::create(path, overwrite)?;
    output
        .write_all(text.as_bytes())
        .map_err(|e| output.failed(e))?;
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
    fn what_exists_is_replaced_only_when_asked() {
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
