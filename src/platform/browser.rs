//! Browsers: files are in memory, private and never locked.

use crate::disk::{FileType, Metadata, OpenOptions};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Does nothing: opening never blocks.
pub fn set_nonblocking(options: &mut OpenOptions) -> &mut OpenOptions {
    options
}

/// Does nothing: files are private.
pub fn set_private(options: &mut OpenOptions) -> &mut OpenOptions {
    options
}

/// The kind of a special file, as part of a message; `None` for a regular file.
pub fn special_kind(found: FileType) -> Option<&'static str> {
    match (found.is_dir(), found.is_file()) {
        (true, _) => Some("a directory"),
        (_, false) => Some("not a file"),
        _ => None,
    }
}

/// True, since it cannot be determined.
pub fn is_same_file(_: &Metadata, _: &Metadata) -> bool {
    true
}

/// Zero, since it cannot be measured.
pub fn thread_time() -> Duration {
    Duration::ZERO
}

/// `None`: the defaults hold.
pub fn config_folder() -> Option<PathBuf> {
    None
}

/// The folder whose files the page keeps.
pub fn state_folder() -> Option<PathBuf> {
    Some(PathBuf::from("/stickslip"))
}

/// Does nothing.
pub fn sync_folder(_: &Path) {}
