//! Processes started by the program, each in a process group.

use std::io;
use std::os::windows::process::CommandExt;
use std::process::{Child, ChildStdin, Command, Stdio};

/// `CREATE_NEW_PROCESS_GROUP` of the Windows API.
const NEW_GROUP: u32 = 0x200;

/// Starts a process in a separate group, so that a Ctrl-C in the console reaches only this program.
///
/// # Errors
/// From the system.
pub fn spawn(command: &mut Command) -> io::Result<Child> {
    command.creation_flags(NEW_GROUP).spawn()
}

/// Does nothing: pipes between processes always block. A solver that does not read its input delays this program.
///
/// # Errors
/// Never.
pub fn set_nonblocking(_: &ChildStdin) -> io::Result<()> {
    Ok(())
}

/// Does nothing: a solver that computes when this program is killed ends when it reads its input next.
pub struct Guard;

impl Guard {
    /// Guards nothing.
    ///
    /// # Errors
    /// Never.
    pub fn new(_: &Child) -> io::Result<Guard> {
        Ok(Guard)
    }
}

/// How the process ended; `None` while it runs.
pub fn end(child: &mut Child) -> Option<String> {
    match child.try_wait() {
        Ok(None) => None,
        Ok(Some(status)) => Some(status.to_string()),
        Err(_) => Some("ended".into()),
    }
}

/// Kills the process and those that it started: a process group cannot be sent a Ctrl-C that only it receives.
pub fn interrupt(child: &mut Child) {
    kill(child);
}

/// Kills the process and those that it started.
pub fn kill(child: &mut Child) {
    let number = child.id().to_string();
    let mut command = Command::new("taskkill");
    command.args(["/T", "/F", "/PID", &number]);
    // The process may have ended in the meantime.
    let _ = command.stdout(Stdio::null()).stderr(Stdio::null()).status();
    let _ = child.kill();
}
