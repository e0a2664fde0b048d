//! Unix systems such as Linux and macOS.

use rustix::fs::{Access, OFlags};
use rustix::io::Errno;
use rustix::process::{Pid, test_kill_process};
use rustix::time::{ClockId, clock_gettime};
use std::fs::{File, FileType, Metadata, OpenOptions, Permissions};
use std::io;
use std::os::unix::fs::{FileTypeExt, MetadataExt, OpenOptionsExt, PermissionsExt};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// Opens without blocking, even a pipe without a reader or writer.
pub fn set_nonblocking(options: &mut OpenOptions) -> &mut OpenOptions {
    let flags = OFlags::NONBLOCK | OFlags::NOCTTY;
    options.custom_flags(flags.bits() as i32)
}

/// Makes reads and writes block again after a non-blocking open.
///
/// # Errors
/// From the system.
pub fn set_blocking(file: &File) -> io::Result<()> {
    let flags = rustix::fs::fcntl_getfl(file)?;
    Ok(rustix::fs::fcntl_setfl(file, flags - OFlags::NONBLOCK)?)
}

/// Whether opening failed because a pipe has no reader.
pub fn is_unread_pipe(error: &io::Error) -> bool {
    Errno::from_io_error(error) == Some(Errno::NXIO)
}

/// Restricts new files to their owner.
pub fn set_private(options: &mut OpenOptions) -> &mut OpenOptions {
    options.mode(0o600)
}

/// The default permissions of new files, for temporary files that are private otherwise.
pub fn usual_permissions() -> Option<Permissions> {
    Some(PermissionsExt::from_mode(0o666))
}

/// The kind of a special file, as part of a message; `None` for a regular file.
pub fn special_kind(found: FileType) -> Option<&'static str> {
    let kinds = [
        (found.is_dir(), "a directory"),
        (found.is_fifo(), "a pipe"),
        (found.is_socket(), "a socket"),
        (
            found.is_char_device() || found.is_block_device(),
            "a device",
        ),
        (!found.is_file(), "not a file"),
    ];
    kinds.into_iter().find(|(is, _)| *is).map(|(_, kind)| kind)
}

/// Whether two files are the same.
pub fn is_same_file(one: &Metadata, other: &Metadata) -> bool {
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

/// Whether a process with this number is running.
pub fn is_running(process: i32) -> bool {
    Pid::from_raw(process).is_none_or(|pid| test_kill_process(pid) != Err(Errno::SRCH))
}

/// Processor time of the calling thread.
pub fn thread_time() -> Duration {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

/// The user's folder for the program's configuration.
pub fn config_folder() -> Option<PathBuf> {
    let ours = directories::ProjectDirs::from("", "", "stickslip")?;
    Some(ours.config_dir().to_owned())
}

/// The user's folder for journals and progress: for state, or for data on systems without one.
pub fn state_folder() -> Option<PathBuf> {
    let ours = directories::ProjectDirs::from("", "", "stickslip")?;
    Some(ours.state_dir().unwrap_or(ours.data_local_dir()).to_owned())
}

/// Syncs a folder, so that its new files survive a power failure. Some file systems cannot.
pub fn sync_folder(folder: &Path) {
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
}

/// Free space of the disk of a folder; `None` if it is not known.
pub fn free_bytes(folder: &Path) -> Option<f64> {
    let disk = rustix::fs::statvfs(folder).ok()?;
    Some(disk.f_bavail as f64 * disk.f_frsize as f64)
}

/// Whether files can be created in a folder.
pub fn is_writable(folder: &Path) -> bool {
    rustix::fs::access(folder, Access::WRITE_OK | Access::EXEC_OK).is_ok()
}

/// The command that runs a line of the shell.
pub fn shell() -> Command {
    let mut command = Command::new("/bin/sh");
    command.arg("-c");
    command
}

/// The pager without the user's choice.
pub const PAGER: &str = "less -R";

/// Gives a file a second name (a hard link).
///
/// # Errors
/// From the system.
pub fn second_name(file: &Path, name: &Path) -> io::Result<()> {
    std::fs::hard_link(file, name)
}
