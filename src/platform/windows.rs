//! Windows.

use std::fs::{File, FileType, Metadata, OpenOptions, Permissions};
use std::io;
use std::os::windows::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::process::Command;
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

/// False: named pipes are not files.
pub fn is_unread_pipe(_: &io::Error) -> bool {
    false
}

/// Does nothing: files in the user's folders are private.
pub fn set_private(options: &mut OpenOptions) -> &mut OpenOptions {
    options
}

/// `None`: the folder's permissions.
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

/// Whether two files have the same size and time of creation, so that they may be the same file.
pub fn is_same_file(one: &Metadata, other: &Metadata) -> bool {
    (one.creation_time(), one.file_size()) == (other.creation_time(), other.file_size())
}

/// True, since the numbers of processes are reused at once: only the lock shows whether a file is in use.
pub fn is_running(_: i32) -> bool {
    true
}

/// Time since the first call: Windows counts the processor time of a thread in steps of 16 ms.
pub fn thread_time() -> Duration {
    static START: std::sync::LazyLock<std::time::Instant> =
        std::sync::LazyLock::new(std::time::Instant::now);
    START.elapsed()
}

/// The user's folder for the program's configuration.
pub fn config_folder() -> Option<PathBuf> {
    let ours = directories::ProjectDirs::from("", "", "stickslip")?;
    Some(ours.config_dir().to_owned())
}

/// The user's folder for journals and progress.
pub fn state_folder() -> Option<PathBuf> {
    let ours = directories::ProjectDirs::from("", "", "stickslip")?;
    Some(ours.data_local_dir().to_owned())
}

/// Does nothing: folders cannot be synced.
pub fn sync_folder(_: &Path) {}

/// `None`: the free space of a folder is not known.
pub fn free_bytes(_: &Path) -> Option<f64> {
    None
}

/// Whether the attributes of a folder allow files to be created in it.
pub fn is_writable(folder: &Path) -> bool {
    folder
        .metadata()
        .is_ok_and(|found| !found.permissions().readonly())
}

/// The command that runs a line of the shell.
pub fn shell() -> Command {
    let mut command = Command::new("cmd");
    command.arg("/C");
    command
}

/// The pager without the user's choice.
pub const PAGER: &str = "more";

/// Fails: while the second name is open, the file itself cannot be replaced.
///
/// # Errors
/// Always.
pub fn second_name(_: &Path, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}
