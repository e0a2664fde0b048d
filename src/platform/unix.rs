//! Unix: Linux, macOS and their relatives.

use rustix::fs::OFlags;
use rustix::io::Errno;
use rustix::process::{Pid, test_kill_process};
use rustix::time::{ClockId, clock_gettime};
use std::fs::{File, FileType, Metadata, OpenOptions, Permissions};
use std::io;
use std::os::unix::fs::{FileTypeExt, MetadataExt, OpenOptionsExt, PermissionsExt};
use std::time::Duration;

/// Makes opening return at once, even for a pipe that nobody reads or writes.
pub fn set_nonblocking(options: &mut OpenOptions) -> &mut OpenOptions {
    let flags = OFlags::NONBLOCK | OFlags::NOCTTY;
    options.custom_flags(flags.bits() as i32)
}

/// Makes writing wait again, after opening without.
///
/// # Errors
/// From the system.
pub fn set_blocking(file: &File) -> io::Result<()> {
    let flags = rustix::fs::fcntl_getfl(file)?;
    Ok(rustix::fs::fcntl_setfl(file, flags - OFlags::NONBLOCK)?)
}

/// Whether opening failed because nobody reads the pipe.
pub fn is_unread_pipe(error: &io::Error) -> bool {
    Errno::from_io_error(error) == Some(Errno::NXIO)
}

/// Restricts new files to their owner.
pub fn set_private(options: &mut OpenOptions) -> &mut OpenOptions {
    options.mode(0o600)
}

/// The usual permissions of new files, for files that would be private by default.
pub fn usual_permissions() -> Option<Permissions> {
    Some(PermissionsExt::from_mode(0o666))
}

/// The kind of a file that is not a regular one, as part of a message.
pub fn special_kind(found: FileType) -> Option<&'static str> {
    let kinds = [
        (found.is_dir(), "a directory"),
        (found.is_fifo(), "a pipe"),
        (found.is_socket(), "a socket"),
        (
            found.is_char_device() || found.is_block_device(),
            "a device",
        ),
        (!found.is_file(), "no file"),
    ];
    kinds.into_iter().find(|(is, _)| *is).map(|(_, kind)| kind)
}

/// Whether two files are one.
pub fn is_same_file(one: &Metadata, other: &Metadata) -> bool {
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

/// Whether a process with this number exists.
pub fn is_running(process: i32) -> bool {
    Pid::from_raw(process).is_none_or(|pid| test_kill_process(pid) != Err(Errno::SRCH))
}

/// Processor time of the calling thread.
pub fn thread_time() -> Duration {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}
