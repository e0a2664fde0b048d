//! The debugger's side: sessions on solvers that are this program itself, and what is left of them.

use rustix::process::{Pid, test_kill_process};
use std::path::PathBuf;
use std::time::{Duration, Instant};
use stickslip::attach::{Attached, Start};
use stickslip::model::Mode;
use stickslip::record::command::{Command, Unit};
use stickslip::recorded::{fault::Fault, log::Log};
use stickslip::scene::shown;
use stickslip::session::{Reply, Session};
use tempfile::TempDir;

/// Long enough for whatever comes at all on a busy machine.
pub const PATIENT: Duration = Duration::from_secs(30);
/// Long enough for what never comes.
pub const SHORT: Duration = Duration::from_millis(500);

/// This program as a solver.
pub fn own() -> String {
    std::env::current_exe().unwrap().display().to_string()
}

/// A solver that is rude in this way.
pub struct Rude {
    folder: TempDir,
    pub start: Start,
}

impl Rude {
    pub fn new(how: &str) -> Rude {
        let folder = tempfile::tempdir().unwrap();
        let pids = folder.path().join("pids").display().to_string();
        let command = vec![own(), super::rude::NAME.into(), how.into(), pids];
        let start = Start {
            start: PATIENT,
            answer: PATIENT,
            ..Start::new(command)
        };
        Rude { folder, start }
    }

    /// With little time to answer.
    pub fn hurried(how: &str) -> Rude {
        let mut rude = Rude::new(how);
        rude.start.answer = SHORT;
        rude
    }

    pub fn folder(&self) -> PathBuf {
        self.folder.path().to_owned()
    }

    pub fn attach(&self) -> Result<Session, Fault> {
        let log = Log::default();
        let (scene, attached) = Attached::attach(self.start.clone(), log.clone())?;
        Ok(Session::attached(scene, Box::new(attached), log))
    }

    /// Processes that it had.
    pub fn pids(&self) -> Vec<i32> {
        let text = std::fs::read_to_string(self.folder.path().join("pids")).unwrap_or_default();
        text.lines().map(|line| line.parse().unwrap()).collect()
    }

    /// Fails if one of its processes is left.
    pub fn is_gone(&self) {
        let until = Instant::now() + Duration::from_secs(5);
        for pid in self.pids() {
            while is_there(pid) {
                assert!(
                    Instant::now() < until,
                    "{:?}: {pid} lives on",
                    self.start.command[2]
                );
                std::thread::sleep(Duration::from_millis(20));
            }
        }
    }
}

/// Whether a process is there, and no zombie that waits for a parent that is not this program.
fn is_there(pid: i32) -> bool {
    if test_kill_process(Pid::from_raw(pid).unwrap()).is_err() {
        return false;
    }
    let state = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
    let parent_and_state = state.rsplit(')').next().unwrap_or_default();
    let mut fields = parent_and_state.split_whitespace();
    let zombie = fields.next() == Some("Z");
    let ours = fields.next() == Some(std::process::id().to_string().as_str());
    !zombie || ours
}

pub fn forward(unit: Unit, count: u32) -> Command {
    Command::Forward { unit, count }
}

pub fn minor() -> Command {
    forward(Unit::Minor, 1)
}

pub fn back(unit: Unit, count: u32) -> Command {
    Command::Back { unit, count }
}

/// Forces the first contact.
pub fn force(mode: Mode, hold: bool) -> Command {
    Command::Force {
        slave: 0,
        mode,
        hold,
    }
}

/// Does a command, and waits: what is said of it at last.
pub fn does(session: &mut Session, command: Command) -> String {
    match session.submit(command) {
        Ok(Reply(now)) => session.wait().map_or(now, |Reply(then)| then),
        Err(refusal) => refusal.to_string(),
    }
}

/// Fails if a terminal would obey a part of a text of several lines.
pub fn is_harmless(text: &str) {
    let order = text
        .chars()
        .find(|&c| shown::is_order(c) && c != '\n' && c != '\t');
    assert_eq!(order, None, "{text:?}");
}
