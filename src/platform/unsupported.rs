//! Systems without files or processes, such as browsers: files are regular, private and never locked, and clocks do not advance.

use std::fs::{File, FileType, Metadata, OpenOptions, Permissions};
use std::io;
use std::time::Duration;

/// Does nothing: opening never blocks.
pub fn set_nonblocking(options: &mut OpenOptions) -> &mut OpenOptions {
    options
}

/// Does nothing.
///
/// # Errors
/// Never.
pub fn set_blocking(_: &File) -> io::Result<()> {
    Ok(())
}

/// False: there are no pipes.
pub fn is_unread_pipe(_: &io::Error) -> bool {
    false
}

/// Does nothing: files are private.
pub fn set_private(options: &mut OpenOptions) -> &mut OpenOptions {
    options
}

/// `None`: the system's default.
pub fn usual_permissions() -> Option<Permissions> {
    None
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

/// True, since it cannot be determined.
pub fn is_running(_: i32) -> bool {
    true
}

/// Zero, since it cannot be measured.
pub fn thread_time() -> Duration {
    Duration::ZERO
}
