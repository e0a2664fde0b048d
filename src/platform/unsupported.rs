//! Systems without files or processes, such as a browser: files are regular, private and never locked, and clocks stand still.

use std::fs::{File, FileType, Metadata, OpenOptions, Permissions};
use std::io;
use std::time::Duration;

/// Opening never waits here.
pub fn set_nonblocking(options: &mut OpenOptions) -> &mut OpenOptions {
    options
}

/// Nothing to undo.
///
/// # Errors
/// Never.
pub fn set_blocking(_: &File) -> io::Result<()> {
    Ok(())
}

/// There are no pipes.
pub fn is_unread_pipe(_: &io::Error) -> bool {
    false
}

/// Nobody else can read a file.
pub fn set_private(options: &mut OpenOptions) -> &mut OpenOptions {
    options
}

/// The default of the system.
pub fn usual_permissions() -> Option<Permissions> {
    None
}

/// The kind of a file that is not a regular one, as part of a message.
pub fn special_kind(found: FileType) -> Option<&'static str> {
    match (found.is_dir(), found.is_file()) {
        (true, _) => Some("a directory"),
        (_, false) => Some("no file"),
        _ => None,
    }
}

/// Not known: two files count as one.
pub fn is_same_file(_: &Metadata, _: &Metadata) -> bool {
    true
}

/// Not known: every process counts as running.
pub fn is_running(_: i32) -> bool {
    true
}

/// Not known.
pub fn thread_time() -> Duration {
    Duration::ZERO
}
