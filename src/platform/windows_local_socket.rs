//! Windows has no sockets with names in the file system, and none as standard input: the functions fail.

use std::io;
pub use std::net::{TcpListener as LocalListener, TcpStream as LocalStream};
use std::path::Path;
use std::process::Stdio;

fn unsupported<T>() -> io::Result<T> {
    let why = "unix: and fd:0 need a Unix system; tcp: works here";
    Err(io::Error::new(io::ErrorKind::Unsupported, why))
}

/// Fails.
///
/// # Errors
/// Always.
pub fn bind(_: &Path) -> io::Result<LocalListener> {
    unsupported()
}

/// Fails.
///
/// # Errors
/// Always.
pub fn pair() -> io::Result<(LocalStream, Stdio)> {
    unsupported()
}
