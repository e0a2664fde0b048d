//! Random keys into the real program: however it is left, the terminal is as it was, and the exit code is one of the
//! contract's.

use super::terminal::{Session, Start, patiently};
use super::{seconds, seed};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;
use std::time::{Duration, Instant};
use stickslip::action;

/// Scenes on which it is begun: quick ones, a large one, none.
const SCENES: [&str; 7] = [
    "osc-three10",
    "osc-two6",
    "osc-zig3",
    "osc-inclined-cantilever",
    "04-cantilever-rigid-circle",
    "osc-block-slide",
    "",
];

/// Keys that are no letters, as terminals send them.
const KEYS: [&str; 30] = [
    "\x1b",
    "\r",
    "\t",
    "\x1b[Z",
    "\x7f",
    " ",
    "\x1b[A",
    "\x1b[B",
    "\x1b[C",
    "\x1b[D",
    "\x1b[H",
    "\x1b[F",
    "\x1b[5~",
    "\x1b[6~",
    "\x1bOP",
    "\x1b[15~",
    "\x1b[21~",
    "\x1b[23~",
    "\x1b[23;2~",
    "\x03",
    "\x0c",
    "\x04",
    "\x1b[200~paste\n1\x1b[201~",
    "\x1b[",
    "\x1b[<0;3;4M",
    "é",
    "日",
    "\u{202e}",
    "\x1b]0;x\x07",
    "\x15",
];

/// Lines for the colon, besides every action by its name.
const LINES: [&str; 22] = [
    "open osc-two6",
    "open /dev/zero",
    "open .",
    "open nowhere.ron",
    "lesson 1",
    "lesson /dev/null",
    "chart /dev/zero",
    "chart history.increment=0.5,0.25",
    "snapshot",
    "snapshot! s.ron",
    "export! e.ron",
    "core! c.ron",
    "journal j",
    "journal /dev/full",
    "set settings.strategy ladder",
    "break mode",
    "watch gap",
    "census",
    "increment 1e-9",
    "friction 89.9",
    "minors 1",
    "goto 0",
];

/// How a session is left.
#[derive(Debug, Clone, Copy, PartialEq)]
enum End {
    Quit,
    Signal(&'static str, &'static str),
    HangUp,
}

const ENDS: [End; 6] = [
    End::Quit,
    End::Quit,
    End::Signal("TERM", "Terminated"),
    End::Signal("INT", "Interrupt"),
    End::Signal("HUP", "Hangup"),
    End::HangUp,
];

struct Typist {
    random: Pcg64,
    /// What was done, for a failure.
    log: Vec<String>,
}

impl Typist {
    fn below(&mut self, count: usize) -> usize {
        (self.random.next_u64() % count as u64) as usize
    }

    fn one<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    /// Some keys.
    fn keys(&mut self) -> String {
        match self.below(10) {
            0..=3 => {
                let letters = b"snfcSNFCtmMibweEvrdz+-0/:?q1234567890hjklgGLapyA<>[]xXuo=";
                let count = 1 + self.below(4);
                (0..count).map(|_| char::from(self.one(letters))).collect()
            }
            4..=5 => self.one(&KEYS).to_owned(),
            6 => format!("\x1b:{}\r", self.one(&LINES)),
            7 => {
                let entry = &action::ACTIONS[self.below(action::ACTIONS.len())];
                let word = self.one(&["", " a", " 2", " sliding", " a fixed", " x y z"]);
                format!("\x1b:{}{word}\r", entry.name)
            }
            _ => self
                .one(&["s", "n", "f", "c", "S", "r", "d", "e", "t", "v"])
                .to_owned(),
        }
    }

    fn act(&mut self, session: &mut Session) {
        match self.below(24) {
            0 => {
                let size = (1 + self.below(200) as u16, 1 + self.below(60) as u16);
                self.log.push(format!("resize {size:?}"));
                session.resize(size.0, size.1);
            }
            1 => {
                let name = self.one(&["TSTP", "CONT", "WINCH", "USR1"]);
                // It would end a program that does not know it.
                let name = if name == "USR1" { "CONT" } else { name };
                self.log.push(format!("signal {name}"));
                session.signal(name);
            }
            2 => std::thread::sleep(Duration::from_millis(20)),
            _ => {
                // Quitting comes at the end.
                let keys = self.keys();
                let leaves =
                    keys.contains("quit") || keys.contains("suspend") || keys.contains('q');
                if !leaves {
                    self.log.push(format!("{keys:?}"));
                    session.keys(&keys);
                }
            }
        }
    }
}

/// One session; what was wrong with it.
fn session(number: u64) -> Result<End, String> {
    let mut typist = Typist {
        random: Pcg64::new(u128::from(seed()), u128::from(number)),
        log: Vec::new(),
    };
    let scene = typist.one(&SCENES);
    let mut arguments = vec![scene];
    if typist.below(3) == 0 {
        arguments.push("--no-journal");
    }
    arguments.retain(|argument| !argument.is_empty());
    let mut session = Start::debugger(&arguments).size(100, 30).go();
    session.see_taken();
    for _ in 0..20 + typist.below(60) {
        typist.act(&mut session);
    }
    let end = typist.one(&ENDS);
    let told = |what: &str, typist: &Typist| {
        format!(
            "session {number} of seed {}, {arguments:?}, {end:?}: {what}; {}",
            seed(),
            typist.log.join(" ")
        )
    };
    let mut shown = String::new();
    let status = match end {
        End::HangUp => {
            // A terminal that is gone lets nothing go on that is stopped.
            for _ in 0..4 {
                session.signal("CONT");
                std::thread::sleep(Duration::from_millis(50));
            }
            let mut child = session.hang_up();
            patiently(|| child.try_wait().unwrap())
        }
        _ => {
            let status = leave(&mut session, end);
            session.wait("the terminal restored", Session::on_main_screen);
            patiently(|| {
                (super::terminal::modes(&*session.master) == session.before).then_some(())
            })
            .ok_or_else(|| told("the terminal's modes are others", &typist))?;
            // Where it broke down, this is why.
            shown = session.text();
            status
        }
    };
    let status = status.ok_or_else(|| told("it never ends", &typist))?;
    let right = match end {
        End::Quit => status.signal().is_none() && [0, 2, 3, 130].contains(&status.exit_code()),
        End::Signal(_, name) => status.signal() == Some(name),
        End::HangUp => status.signal() == Some("Hangup"),
    };
    // What is typed while it is stopped goes to the terminal, and Ctrl-C there ends whoever is stopped.
    let typed = |what: &str| typist.log.iter().any(|done| done.contains(what));
    let struck = typed("\\u{3}") && typed("signal TSTP") && status.signal() == Some("Interrupt");
    match right || struck {
        true => Ok(end),
        false => Err(told(
            &format!("it ends with {status}; {}", shown.trim()),
            &typist,
        )),
    }
}

/// Leaves it as one does, again and again where something lay over the panes or it was stopped.
fn leave(session: &mut Session, end: End) -> Option<portable_pty::ExitStatus> {
    let begun = Instant::now();
    let mut sent = false;
    while begun.elapsed() < Duration::from_secs(30) {
        if let Ok(Some(status)) = session.child.try_wait() {
            return Some(status);
        }
        // One that comes before it has stopped is lost.
        session.signal("CONT");
        match end {
            End::Signal(name, _) if !sent => {
                session.signal(name);
                sent = true;
            }
            End::Quit => {
                // It may be gone in this moment.
                let _ = session.keyboard.write_all(b"\x1b");
                std::thread::sleep(Duration::from_millis(60));
                let _ = session.keyboard.write_all(b"q");
            }
            _ => {}
        }
        std::thread::sleep(Duration::from_millis(60));
    }
    None
}

/// Random keys, resizes and signals; at least a few sessions.
#[test]
fn keys() {
    let begun = Instant::now();
    let mut number = 0;
    while number < 6 || begun.elapsed() < seconds() {
        if let Err(wrong) = session(number) {
            panic!("{wrong}");
        }
        number += 1;
    }
    eprintln!("keys: {number} sessions of seed {}", seed());
}
