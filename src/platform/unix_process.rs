//! Processes started by the program, each in a process group.

use rustix::io::ioctl_fionbio;
use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, kill_process_group, waitid};
use std::io;
use std::os::unix::process::CommandExt;
use std::process::{Child, ChildStdin, Command, Stdio};

/// Gives the process a group, so that a Ctrl-C in the terminal reaches only this program.
pub fn set_group(command: &mut Command) -> &mut Command {
    command.process_group(0)
}

/// Makes writes return instead of waiting for a process that does not read.
///
/// # Errors
/// From the system.
pub fn set_nonblocking(input: &ChildStdin) -> io::Result<()> {
    Ok(ioctl_fionbio(input, true)?)
}

/// How the process ended; `None` while it runs. The process is not reaped, so that the number of its group is not reused.
pub fn end(child: &mut Child) -> Option<String> {
    let look = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
    match waitid(WaitId::Pid(pid(child)?), look) {
        Ok(status) => {
            status.map(
                |status| match (status.exit_status(), status.terminating_signal()) {
                    (Some(code), _) => format!("exit status {code}"),
                    (None, Some(signal)) => format!("killed by signal {signal}"),
                    (None, None) => "ended".into(),
                },
            )
        }
        // The process no longer exists.
        Err(_) => Some("ended".into()),
    }
}

/// Kills a process group if this program ends in any way before the guard is dropped.
pub struct Guard(Child);

/// Waits for the end of its input, which only this program keeps open. A process that reads its own input has a second to end.
const GUARD: &str = "trap '' HUP INT TERM; read -r line; sleep 1; kill -KILL \"-$1\"";

impl Guard {
    /// Guards the group of a process.
    ///
    /// # Errors
    /// From the system.
    pub fn new(child: &Child) -> io::Result<Guard> {
        let mut command = Command::new("/bin/sh");
        let group = child.id().to_string();
        command.args(["-c", GUARD, "stickslip-guard", &group]);
        command.stdin(Stdio::piped()).stdout(Stdio::null());
        set_group(command.stderr(Stdio::null())).spawn().map(Guard)
    }
}

impl Drop for Guard {
    /// To be dropped before the process is reaped, after which the number of its group may be reused.
    fn drop(&mut self) {
        kill(&mut self.0);
        let _ = self.0.wait();
    }
}

fn pid(child: &Child) -> Option<Pid> {
    i32::try_from(child.id()).ok().and_then(Pid::from_raw)
}

/// Interrupts the process and those that it started, as Ctrl-C does.
pub fn interrupt(child: &mut Child) {
    signal(child, Signal::INT);
}

/// Kills the process and those that it started.
pub fn kill(child: &mut Child) {
    signal(child, Signal::KILL);
}

fn signal(child: &Child, signal: Signal) {
    if let Some(group) = pid(child) {
        // The process may have ended in the meantime.
        let _ = kill_process_group(group, signal);
    }
}
