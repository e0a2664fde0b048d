//! A terminal as POSIX defines it.

use super::{Answers, questions};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::termios::{self, OptionalActions, Termios};
use std::io::{self, IsTerminal, Stdin, Write, stdin, stdout};
use std::time::{Duration, Instant};

/// Time limit for an answer, also over a slow line.
const PATIENCE: Duration = Duration::from_secs(2);

/// Columns and rows of the terminal on standard output; `None` if it is not a terminal, or its size is not known.
pub fn size() -> Option<(u16, u16)> {
    let size = termios::tcgetwinsize(stdout()).ok()?;
    (size.ws_col > 0 && size.ws_row > 0).then_some((size.ws_col, size.ws_row))
}

/// Enables or disables reports of clicks and the wheel, with positions of any size; without reports of motion.
///
/// # Errors
/// If standard output is closed.
pub fn report_mouse(on: bool) -> io::Result<()> {
    let codes = if on {
        "\x1b[?1000h\x1b[?1006h"
    } else {
        "\x1b[?1006l\x1b[?1000l"
    };
    let mut out = stdout().lock();
    out.write_all(codes.as_bytes())?;
    out.flush()
}

/// Queries the terminal; `None` if standard input or output is not a terminal.
///
/// The queries use the current line, which is empty afterwards.
///
/// # Errors
/// If the terminal cannot be set to raw mode, or is closed.
pub fn ask() -> io::Result<Option<Answers>> {
    if !stdin().is_terminal() || !stdout().is_terminal() {
        return Ok(None);
    }
    let _raw = RawMode::enter()?;
    let mut out = stdout().lock();
    out.write_all(questions().as_bytes())?;
    out.flush()?;
    let mut told = Vec::new();
    let until = Instant::now() + PATIENCE;
    while !Answers::read(&told).1 {
        let left = until.saturating_duration_since(Instant::now());
        let stdin = stdin();
        let mut from = [PollFd::new(&stdin, PollFlags::IN)];
        let left = Timespec::try_from(left).unwrap_or_default();
        if poll(&mut from, Some(&left))? == 0 {
            break;
        }
        let mut some = [0; 256];
        match rustix::io::read(&stdin, &mut some)? {
            0 => break,
            n => told.extend_from_slice(&some[..n]),
        }
    }
    out.write_all(b"\r\x1b[K")?;
    out.flush()?;
    Ok(Some(Answers::read(&told).0))
}

/// The terminal in raw mode, until this is dropped.
struct RawMode {
    of: Stdin,
    before: Termios,
}

impl RawMode {
    fn enter() -> io::Result<RawMode> {
        let of = stdin();
        let before = termios::tcgetattr(&of)?;
        let mut raw = before.clone();
        raw.make_raw();
        termios::tcsetattr(&of, OptionalActions::Now, &raw)?;
        Ok(RawMode { of, before })
    }
}

impl Drop for RawMode {
    fn drop(&mut self) {
        // A late answer must not reach the shell.
        let _ = termios::tcsetattr(&self.of, OptionalActions::Flush, &self.before);
    }
}
