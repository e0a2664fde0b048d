//! Files: the system's, or files in memory where there are none.

use std::path::Path;

#[cfg(not(target_family = "wasm"))]
pub use std::fs::{
    DirEntry, File, FileType, Metadata, OpenOptions, canonicalize, create_dir_all, metadata,
    read_dir, remove_file,
};

#[cfg(target_family = "wasm")]
pub use crate::memory_disk::{
    DirEntry, File, FileType, Metadata, OpenOptions, canonicalize, create_dir_all, metadata,
    read_dir, remove_file,
};

/// Whether there is a file at this path.
pub fn is_file(path: impl AsRef<Path>) -> bool {
    metadata(path).is_ok_and(|found| found.is_file())
}

/// Whether there is a file or folder at this path.
pub fn exists(path: impl AsRef<Path>) -> bool {
    metadata(path).is_ok()
}
