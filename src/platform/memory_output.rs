//! Output files in memory.

use super::FileError;
use crate::disk::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// An unfinished file. It gets its name in [`finish`](Output::finish).
pub struct Output {
    pub(super) target: PathBuf,
    bytes: Vec<u8>,
}

impl Output {
    /// Creates a file.
    ///
    /// # Errors
    /// If it exists and `overwrite` is not set.
    pub fn create(path: &Path, overwrite: bool) -> Result<Output, FileError> {
        match disk::metadata(path) {
            Ok(_) if !overwrite => Err(FileError::Exists(path.to_owned())),
            _ => Ok(Output {
                target: path.to_owned(),
                bytes: Vec::new(),
            }),
        }
    }

    /// Finishes the file and gives it its name.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn finish(self) -> Result<(), FileError> {
        let open = OpenOptions::new()
            .create(true)
            .truncate(true)
            .open(&self.target);
        let written = open.and_then(|mut file: File| file.write_all(&self.bytes));
        written.map_err(|source| self.failed(source))
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.bytes.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Finishes several files.
///
/// # Errors
/// As [`Output::finish`].
pub fn finish_all(outputs: Vec<Output>) -> Result<(), FileError> {
    outputs.into_iter().try_for_each(Output::finish)
}
