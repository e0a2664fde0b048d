//! Sockets between processes of this machine, with names in the file system or without.

use std::fs::{Permissions, remove_file, set_permissions};
use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::fs::PermissionsExt;
pub use std::os::unix::net::{UnixListener as LocalListener, UnixStream as LocalStream};
use std::path::Path;
use std::process::Stdio;

/// Creates a socket to which only the user can connect.
///
/// # Errors
/// If the name exists, or from the system.
pub fn bind(path: &Path) -> io::Result<LocalListener> {
    let listener = LocalListener::bind(path)?;
    set_permissions(path, Permissions::from_mode(0o600)).inspect_err(|_| {
        // The name of a socket that nobody listens to.
        let _ = remove_file(path);
    })?;
    Ok(listener)
}

/// A connected pair: the own end, and the standard input of another process.
///
/// # Errors
/// From the system.
pub fn pair() -> io::Result<(LocalStream, Stdio)> {
    let (own, other) = LocalStream::pair()?;
    Ok((own, OwnedFd::from(other).into()))
}
