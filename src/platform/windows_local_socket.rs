//! Windows has no sockets with names in the file system, and none as standard input: their types have no values.

use std::io::{self, Read, Write};
use std::net::Shutdown;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

/// A socket that waits for connections.
pub enum LocalListener {}

/// A connection.
pub enum LocalStream {}

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

#[allow(missing_docs, clippy::missing_errors_doc)]
impl LocalListener {
    pub fn set_nonblocking(&self, _: bool) -> io::Result<()> {
        match *self {}
    }

    pub fn accept(&self) -> io::Result<(LocalStream, ())> {
        match *self {}
    }
}

#[allow(missing_docs, clippy::missing_errors_doc)]
impl LocalStream {
    pub fn set_nonblocking(&self, _: bool) -> io::Result<()> {
        match *self {}
    }

    pub fn set_write_timeout(&self, _: Option<Duration>) -> io::Result<()> {
        match *self {}
    }

    pub fn try_clone(&self) -> io::Result<LocalStream> {
        match *self {}
    }

    pub fn shutdown(&self, _: Shutdown) -> io::Result<()> {
        match *self {}
    }
}

impl Read for LocalStream {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        match *self {}
    }
}

impl Write for LocalStream {
    fn write(&mut self, _: &[u8]) -> io::Result<usize> {
        match *self {}
    }

    fn flush(&mut self) -> io::Result<()> {
        match *self {}
    }
}
