//! Processes started by the program, each in a process group.

use rustix::io::ioctl_fionbio;
use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, kill_process_group, waitid};
use signal_hook::consts::{SIGINT, SIGQUIT, SIGTERM};
use signal_hook::{SigId, flag, low_level};
use std::fs;
use std::io;
use std::os::unix::process::CommandExt;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::Arc;

/// Signals that end a solver, and that it gets with their default actions.
const ENDING: [i32; 3] = [SIGINT, SIGQUIT, SIGTERM];

/// Starts a process in a separate group. The signals that end it have their default actions, also if this program was started with
/// them ignored, as shells do with background jobs; SIGHUP stays ignored, as `nohup` requests.
///
/// # Errors
/// From the system.
pub fn spawn(command: &mut Command) -> io::Result<Child> {
    // A process starts with default actions for signals that its parent handles. After the handler is removed, the parent ignores
    // the signal again.
    let ignored = ignored_signals();
    let is_ignored = |signal: &i32| ignored >> (signal - 1) & 1 == 1;
    let handled = ENDING.into_iter().filter(is_ignored);
    let handled = handled.filter_map(|signal| flag::register(signal, Arc::default()).ok());
    let handled: Vec<SigId> = handled.collect();
    let child = set_group(command).spawn();
    for id in handled {
        low_level::unregister(id);
    }
    child
}

/// The signals that this program ignores, one bit each; none where the system does not report them.
fn ignored_signals() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let bits = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    bits.and_then(|bits| u64::from_str_radix(bits.trim(), 16).ok())
        .unwrap_or_default()
}

/// Gives the process a group, so that a Ctrl-C in the terminal reaches only this program.
fn set_group(command: &mut Command) -> &mut Command {
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
