//! A program in a pseudo-terminal, with an emulator that reads what it writes.
#![allow(dead_code)]

use portable_pty::{Child, CommandBuilder, ExitStatus, MasterPty, PtySize, SlavePty};
use std::io::{Read, Write};
use std::num::NonZeroU16;
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};
use stickslip::tui;
use tempfile::TempDir;
use vt100::{MouseProtocolMode, Parser, Screen};

pub const PROGRAM: &str = env!("CARGO_BIN_EXE_stickslip");

/// How long anything may take: far more than it does, since the machine may be busy with other tests.
pub const DEADLINE: Duration = Duration::from_secs(30);

pub const CTRL_L: &str = "\x0c";

/// A program in a terminal.
pub struct Session {
    pub master: Box<dyn MasterPty + Send>,
    /// Kept open, so that the terminal outlives the program and can be looked at.
    pub slave: Box<dyn SlavePty + Send>,
    pub keyboard: Box<dyn Write + Send>,
    pub child: Box<dyn Child + Send + Sync>,
    pub seen: Arc<Mutex<Seen>>,
    /// Ends the reader after its next read.
    pub deaf: Arc<AtomicBool>,
    pub reader: JoinHandle<()>,
    /// The terminal's modes before the program started.
    pub before: String,
    pub directory: TempDir,
    /// Where it keeps its journals, unless a test says where.
    pub _state: TempDir,
}

/// What the terminal was sent.
pub struct Seen {
    pub parser: Parser,
    pub raw: Vec<u8>,
}

/// What is to be started, and in what terminal.
pub struct Start<'a> {
    pub program: &'a str,
    pub arguments: Vec<&'a str>,
    pub variables: Vec<(&'a str, &'a str)>,
    pub size: (u16, u16),
}

impl<'a> Start<'a> {
    pub fn program(program: &'a str, arguments: &[&'a str]) -> Self {
        Start {
            program,
            arguments: arguments.to_vec(),
            variables: vec![("TERM", "xterm-256color")],
            size: (120, 40),
        }
    }

    pub fn debugger(arguments: &[&'a str]) -> Self {
        Start::program(PROGRAM, arguments)
    }

    pub fn size(self, width: u16, height: u16) -> Self {
        let size = (width, height);
        Start { size, ..self }
    }

    pub fn variable(mut self, name: &'a str, value: &'a str) -> Self {
        self.variables.push((name, value));
        self
    }

    pub fn go(self) -> Session {
        let directory = tempfile::tempdir().unwrap();
        let state = tempfile::tempdir().unwrap();
        let mut command = CommandBuilder::new(self.program);
        command.args(&self.arguments);
        command.cwd(directory.path());
        for name in ["NO_COLOR", "COLORFGBG", "ENV"] {
            command.env_remove(name);
        }
        command.env("HOME", state.path());
        command.env("XDG_STATE_HOME", state.path());
        command.env("XDG_CONFIG_HOME", state.path());
        for (name, value) in &self.variables {
            command.env(name, value);
        }
        let (width, height) = self.size;
        let pair = portable_pty::native_pty_system()
            .openpty(pty_size(width, height))
            .unwrap();
        let before = modes(&*pair.master);
        let child = pair.slave.spawn_command(command).unwrap();
        let seen = Arc::new(Mutex::new(Seen {
            parser: Parser::new(cells(height), cells(width), 0),
            raw: Vec::new(),
        }));
        let deaf = Arc::default();
        let reader = read(&*pair.master, &seen, &deaf);
        Session {
            keyboard: pair.master.take_writer().unwrap(),
            master: pair.master,
            slave: pair.slave,
            child,
            seen,
            deaf,
            reader,
            before,
            directory,
            _state: state,
        }
    }
}

/// Opens a scene at 120x40 and waits for its first screen.
pub fn open(scene: &str) -> Session {
    let session = Start::debugger(&[scene]).go();
    session.see("nothing is solved yet");
    session
}

pub fn cells(count: u16) -> NonZeroU16 {
    NonZeroU16::new(count).unwrap()
}

pub fn pty_size(cols: u16, rows: u16) -> PtySize {
    PtySize {
        rows,
        cols,
        ..PtySize::default()
    }
}

/// All of the terminal's modes, in words.
pub fn modes(master: &dyn MasterPty) -> String {
    format!("{:?}", master.get_termios().unwrap())
}

/// Reads on a thread of its own, until the terminal is gone or nobody wants to hear more.
pub fn read(
    master: &dyn MasterPty,
    seen: &Arc<Mutex<Seen>>,
    deaf: &Arc<AtomicBool>,
) -> JoinHandle<()> {
    let mut from = master.try_clone_reader().unwrap();
    let (seen, deaf) = (Arc::clone(seen), Arc::clone(deaf));
    thread::spawn(move || {
        let mut bytes = [0; 4096];
        while let Ok(count @ 1..) = from.read(&mut bytes) {
            let mut seen = seen.lock().unwrap();
            seen.parser.process(&bytes[..count]);
            seen.raw.extend(&bytes[..count]);
            if deaf.load(Ordering::SeqCst) {
                break;
            }
        }
    })
}

/// Tries again and again, until there is something. `None` if there never is.
pub fn patiently<T>(mut attempt: impl FnMut() -> Option<T>) -> Option<T> {
    let begin = Instant::now();
    loop {
        if let Some(found) = attempt() {
            return Some(found);
        }
        if begin.elapsed() > DEADLINE {
            return None;
        }
        thread::sleep(Duration::from_millis(5));
    }
}

impl Session {
    pub fn keys(&mut self, keys: &str) {
        self.keyboard.write_all(keys.as_bytes()).unwrap();
        self.keyboard.flush().unwrap();
    }

    /// Keys, and what the screen must show after them.
    pub fn type_and_see(&mut self, keys: &str, text: &str) {
        self.keys(keys);
        self.see(text);
    }

    pub fn screen<T>(&self, look: impl FnOnce(&Screen) -> T) -> T {
        look(self.seen.lock().unwrap().parser.screen())
    }

    pub fn text(&self) -> String {
        self.screen(Screen::contents)
    }

    /// Waits until the screen is as it must be.
    #[track_caller]
    pub fn wait(&self, what: &str, holds: impl Fn(&Screen) -> bool) {
        let found = patiently(|| self.screen(&holds).then_some(()));
        assert!(found.is_some(), "never seen: {what}\n{}", self.text());
    }

    #[track_caller]
    pub fn see(&self, text: &str) {
        self.wait(text, |screen| screen.contents().contains(text));
    }

    #[track_caller]
    pub fn see_no_more(&self, text: &str) {
        let gone = |screen: &Screen| !screen.contents().contains(text);
        self.wait(&format!("the end of '{text}'"), gone);
    }

    /// Waits until the screen is the one that the program pictures after these keys.
    #[track_caller]
    pub fn see_picture(&self, scene: &str, keys: &str, width: u16, height: u16) {
        let picture = tui::screen(scene, keys, width, height).unwrap();
        let lines = |text: &str| text.trim_end().lines().map(trimmed).collect::<Vec<_>>();
        let wanted = lines(&picture);
        let same = |screen: &Screen| lines(&screen.contents()) == wanted;
        self.wait(&format!("at {width}x{height}\n{picture}"), same);
    }

    pub fn resize(&self, width: u16, height: u16) {
        // Nothing that is drawn at the new size may meet an emulator of the old one.
        let mut seen = self.seen.lock().unwrap();
        seen.parser.set_size(cells(height), cells(width));
        self.master.resize(pty_size(width, height)).unwrap();
    }

    pub fn signal(&self, name: &str) {
        let id = self.child.process_id().unwrap();
        let kill = format!("kill -{name} {id}");
        let status = Command::new("sh").args(["-c", &kill]).status().unwrap();
        assert!(status.success(), "{kill}");
    }

    #[track_caller]
    pub fn end(&mut self) -> ExitStatus {
        match patiently(|| self.child.try_wait().unwrap()) {
            Some(status) => status,
            None => panic!("the program never ends\n{}", self.text()),
        }
    }

    /// Whether the screen is the main one, with its cursor, the keyboard's pastes are plain and the mouse is its own.
    pub fn on_main_screen(screen: &Screen) -> bool {
        let mouse = screen.mouse_protocol_mode() != MouseProtocolMode::None;
        let plain = !screen.hide_cursor() && !screen.bracketed_paste();
        !screen.alternate_screen() && plain && !mouse
    }

    /// Waits until the terminal is the program's: raw, on the alternate screen.
    #[track_caller]
    pub fn see_taken(&self) {
        self.wait("the terminal taken", |screen| {
            screen.alternate_screen() && screen.hide_cursor() && screen.bracketed_paste()
        });
        let modes = patiently(|| Some(modes(&*self.master)).filter(|now| *now != self.before));
        assert!(modes.is_some(), "the terminal is not raw");
    }

    /// Waits until the terminal is as it was before the program took it.
    #[track_caller]
    pub fn see_restored(&self) {
        self.wait("the terminal restored", Session::on_main_screen);
        patiently(|| (modes(&*self.master) == self.before).then_some(()));
        assert_eq!(modes(&*self.master), self.before);
    }

    /// `q` ends it well, and nothing of it is left on the terminal.
    #[track_caller]
    pub fn quit(mut self) {
        self.keys("q");
        let status = self.end();
        assert!(status.success(), "{status}\n{}", self.text());
        self.see_restored();
    }

    /// The terminal goes away under the program.
    pub fn hang_up(self) -> Box<dyn Child + Send + Sync> {
        let Session {
            master,
            slave,
            mut keyboard,
            child,
            deaf,
            reader,
            ..
        } = self;
        // The reader holds the terminal open until it has read something more.
        deaf.store(true, Ordering::SeqCst);
        keyboard.write_all(CTRL_L.as_bytes()).unwrap();
        reader.join().unwrap();
        drop((slave, keyboard, master));
        child
    }
}

pub fn trimmed(line: &str) -> String {
    line.trim_end().to_string()
}

/// Runs the program without a terminal.
pub fn run(arguments: &[&str], input: Stdio) -> Output {
    Command::new(PROGRAM)
        .args(arguments)
        .stdin(input)
        .output()
        .unwrap()
}
