//! A solver as a child process, or behind a socket: start, requests, interrupts and end.
//!
//! A thread reads its standard output line by line, with a bounded queue; another thread copies its standard error to the log. The
//! process has a separate process group, so that a Ctrl-C in the terminal reaches only this program, which passes it on: first as a
//! message, then as a signal, then by ending the process.

use super::channel::{Channel, Input, Listener};
use std::io::{self, BufRead, BufReader, Read, Write};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread;
use std::time::{Duration, Instant};
use stickslip_debugger::{Fault, Log};
use stickslip_exchange::attach::conversation::STARTED;
use stickslip_exchange::attach::message::{Level, Progress};
use stickslip_exchange::attach::{Answer, Line, LineReader, MOST_BYTES, Request, Side};
use stickslip_platform::local_socket;
use stickslip_platform::process::{self, Guard};
use stickslip_scene::{joined, mesh_file, number, shown};

/// Polling interval for interrupts.
const LOOK: Duration = Duration::from_millis(10);
/// Time for a solver to end after `bye`.
const FAREWELL: Duration = Duration::from_millis(500);
/// Maximum number of unread lines in the queue; each has the maximum length.
const WAITING: usize = 2;
/// Characters shown of an unreadable line.
const SHOWN: usize = 80;
/// Maximum length of a name in messages.
const NAME: usize = 60;
/// Maximum bytes per line of standard error.
const ERROR_BYTES: u64 = 8192;

/// The command of a solver, its channel and its time limits.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// The program and its arguments; empty for a solver that only connects.
    pub command: Vec<String>,
    /// How messages are exchanged.
    pub channel: Channel,
    /// Time limit from the start to the first answers.
    pub start: Duration,
    /// Time limit for other answers.
    pub answer: Duration,
}

impl Start {
    /// A command with default time limits: one minute to start, ten minutes per answer.
    pub fn new(command: Vec<String>) -> Start {
        Start {
            command,
            channel: Channel::default(),
            start: Duration::from_secs(60),
            answer: Duration::from_secs(600),
        }
    }

    /// The command as typed, or the address of the channel.
    pub fn typed(&self) -> String {
        if self.command.is_empty() {
            self.channel.to_string()
        } else {
            self.command.join(" ")
        }
    }
}

/// A running solver.
pub struct Link {
    child: Option<Child>,
    guard: Option<Guard>,
    input: Option<Input>,
    output: Receiver<io::Result<Line>>,
    log: Log,
    stop: Arc<AtomicUsize>,
    interrupts: bool,
    /// The first line that was not a message, since the last answer and of all.
    stray: [Option<Fault>; 2],
}

impl Link {
    /// Starts a solver. `stop` counts the user's requests to stop while waiting: after the first, a solver that supports it gets a
    /// message; after the second, any solver gets a signal; after the third, the process is killed.
    ///
    /// # Errors
    /// [`Fault::NotStarted`].
    pub fn start(start: &Start, log: &Log, stop: Arc<AtomicUsize>) -> Result<Link, Fault> {
        let not_started = |why: String| Fault::NotStarted {
            command: start.typed(),
            why,
        };
        let failed = |error: io::Error| not_started(error.to_string());
        let (lines, output) = sync_channel(WAITING);
        let mut link = Link {
            input: None,
            child: None,
            guard: None,
            output,
            log: log.clone(),
            stop,
            interrupts: false,
            stray: [None, None],
        };
        let listener = start.channel.listen().map_err(failed)?;
        if start.command.is_empty() && listener.is_none() {
            return Err(not_started("no command after --".into()));
        }
        let mut streams: [Option<Box<dyn Read + Send>>; 2] = [None, None];
        if let [program, arguments @ ..] = start.command.as_slice() {
            let (own, standard_input) = match start.channel {
                Channel::Streams => (None, Stdio::piped()),
                Channel::Inherited => {
                    let (own, other) = local_socket::pair().map_err(failed)?;
                    (Some(Input::Unix(own)), other)
                }
                Channel::Unix(_) | Channel::Tcp { .. } => (None, Stdio::null()),
            };
            let mut command = Command::new(program);
            command
                .args(arguments)
                .envs(start.channel.environment())
                .stdin(standard_input)
                .stdout(Stdio::piped())
                .stderr(Stdio::piped());
            let mut child = process::spawn(&mut command).map_err(failed)?;
            link.input = own.or_else(|| child.stdin.take().map(Input::Pipe));
            streams = [
                child.stdout.take().map(|stream| Box::new(stream) as _),
                child.stderr.take().map(|stream| Box::new(stream) as _),
            ];
            match Guard::new(&child) {
                Ok(guard) => link.guard = Some(guard),
                Err(why) => log.noted(&format!(
                    "no guard ends the solver if this program is killed: {why}"
                )),
            }
            link.child = Some(child);
        }
        log.noted(&format!("{STARTED}: {}", start.typed()));
        if let Some(listener) = listener {
            link.input = Some(link.connection(&listener, start)?);
        }
        // Writing must not block if the solver does not read.
        let input = link.input.take().map(Input::prepared).transpose();
        link.input = input.map_err(failed)?;
        let reader = link.input.as_ref().map(Input::reader).transpose();
        let messages = reader
            .map_err(failed)?
            .flatten()
            .or_else(|| streams[0].take());
        if let Some(stream) = messages {
            thread::spawn(move || read(stream, &lines));
        }
        for stream in streams.into_iter().flatten() {
            let log = log.clone();
            thread::spawn(move || listen(stream, &log));
        }
        Ok(link)
    }

    /// Waits for a solver to connect.
    fn connection(&mut self, listener: &Listener, start: &Start) -> Result<Input, Fault> {
        let asked = || "the connection".to_owned();
        let until = Instant::now() + start.start;
        loop {
            match listener.accept() {
                Ok(Some(input)) => return Ok(input),
                Ok(None) => {}
                // Another connection may do better.
                Err(error) => self.log.message(
                    Level::Warning,
                    &format!("a connection was refused: {error}"),
                ),
            }
            if self.stop.load(Ordering::Relaxed) > 0 {
                return Err(Fault::Stopped { asked: asked() });
            }
            if let Some(how) = self.end() {
                return Err(Fault::Died {
                    how,
                    asked: asked(),
                });
            }
            if Instant::now() > until {
                return Err(Fault::Silent {
                    asked: asked(),
                    after: start.start,
                    longer: "--start-timeout",
                });
            }
            thread::sleep(LOOK);
        }
    }

    /// Sets whether the solver reads its input during a request, so that it can be interrupted.
    pub fn set_interrupts(&mut self, interrupts: bool) {
        self.interrupts = interrupts;
    }

    /// Installs the counter of the user's requests to stop.
    pub fn set_cancel(&mut self, asks: Arc<AtomicUsize>) {
        self.stop = asks;
    }

    /// The first line on standard output that was not a message.
    pub fn stray(&self) -> Option<&Fault> {
        self.stray[1].as_ref()
    }

    /// Sends a request, and waits for the answer. Lines that are no messages become warnings in the log.
    ///
    /// # Errors
    /// The fault that ended the solver; it cannot be used afterwards. Without an answer, a line that was not a message is the
    /// fault.
    pub fn ask(&mut self, request: &Request, within: Duration) -> Result<Answer, Fault> {
        let answer = self.exchange(request, within);
        self.log.set_progress(None);
        let stray = self.stray[0].take();
        match (answer, stray) {
            (Err(Fault::Silent { .. } | Fault::Died { .. }), Some(stray)) => Err(stray),
            (answer, _) => answer,
        }
    }

    fn exchange(&mut self, request: &Request, within: Duration) -> Result<Answer, Fault> {
        let mut waiting = Wait::new(request, within);
        // Lines that arrived since the last answer.
        while let Ok(line) = self.output.try_recv() {
            self.besides(line, &waiting)?;
            self.wait_on(&mut waiting)?;
        }
        self.send(request, &mut waiting)?;
        loop {
            match self.output.recv_timeout(LOOK) {
                Ok(line) => {
                    if let Some(answer) = self.heard(line, &waiting)? {
                        return Ok(answer);
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Err(self.died("", &waiting)),
            }
            // A solver that keeps sending messages must not delay the time limit.
            self.wait_on(&mut waiting)?;
        }
    }

    /// The answer in a line; `None` for a message.
    fn heard(&mut self, line: io::Result<Line>, waiting: &Wait) -> Result<Option<Answer>, Fault> {
        let line = line.map_err(|error| self.died(&error.to_string(), waiting))?;
        let answer = match self.read(line, waiting) {
            Err(stray @ Fault::Junk { .. }) => {
                self.log.message(Level::Warning, &stray.to_string());
                for first in &mut self.stray {
                    first.get_or_insert_with(|| stray.clone());
                }
                return Ok(None);
            }
            answer => answer?,
        };
        match answer {
            Answer::Message { level, text } => {
                self.log.message(level, &text);
                Ok(None)
            }
            Answer::Progress(progress) => {
                self.log.set_progress(Some(words(&progress)));
                Ok(None)
            }
            Answer::Bye { reason } => Err(Fault::Bye {
                reason,
                asked: waiting.asked.clone(),
            }),
            answer => Ok(Some(answer)),
        }
    }

    /// Handles a line outside a request.
    fn besides(&mut self, line: io::Result<Line>, waiting: &Wait) -> Result<(), Fault> {
        match self.heard(line, waiting)? {
            None => Ok(()),
            Some(answer) => Err(Fault::Unasked {
                answer: answer.kind().to_owned(),
                asked: waiting.asked.clone(),
            }),
        }
    }

    /// Decodes a line.
    fn read(&mut self, line: Line, waiting: &Wait) -> Result<Answer, Fault> {
        let mut text = match line {
            Line::Text(text) => text,
            Line::End => return Err(self.died("", waiting)),
            Line::Torn(line) => {
                self.log
                    .exchanged(Side::Noted, &format!("torn line: {line}"));
                return Err(Fault::Torn(line));
            }
            Line::TooLong(line) => {
                self.log
                    .exchanged(Side::Noted, &format!("line too long: {line}"));
                let most = MOST_BYTES;
                return Err(Fault::TooLong { most, line });
            }
            Line::NoText(line) => {
                self.log
                    .exchanged(Side::Noted, &format!("not UTF-8: {line}"));
                let why = "not UTF-8".into();
                return Err(Fault::Junk { why, line });
            }
        };
        let mut answer = Answer::read(&text);
        if let Ok(Answer::Scene(scene)) = &mut answer
            && scene.mesh.is_some()
        {
            let (message, inserted) = ("scene", mesh_file::insert(scene));
            inserted.map_err(|why| Fault::Unfit { message, why })?;
            // A stored exchange names no files.
            text = answer
                .as_ref()
                .map_or(text, Answer::line)
                .trim_end()
                .to_owned();
        }
        if text.trim_start().starts_with('{') {
            self.log.exchanged(Side::Answered, &text)
        } else {
            self.log
                .exchanged(Side::Noted, &format!("not a message: {text}"))
        }
        answer.map_err(|broken| {
            let letters = text.trim_start();
            let why = match broken.at {
                _ if letters.is_empty() => "an empty line".to_owned(),
                Some((_, column)) if letters.starts_with('{') => {
                    format!("column {column}: {broken}")
                }
                None if letters.starts_with('{') => broken.to_string(),
                _ => "not a JSON object".to_owned(),
            };
            // In a long line the error is near the column.
            let from = broken.at.map_or(0, |(_, column)| column.saturating_sub(40));
            let asked = waiting.asked.clone();
            if letters.starts_with('{') {
                Fault::Misformed {
                    asked,
                    why,
                    line: text.chars().skip(from).take(SHOWN).collect(),
                }
            } else {
                Fault::Junk {
                    why,
                    line: text.chars().take(SHOWN).collect(),
                }
            }
        })
    }

    /// Sends a request in as many parts as the pipe accepts. Output of the solver is read meanwhile, since otherwise both sides
    /// could block.
    fn send(&mut self, request: &Request, waiting: &mut Wait) -> Result<(), Fault> {
        let line = request.line();
        self.log.exchanged(Side::Asked, &line);
        let mut rest = line.as_bytes();
        while !rest.is_empty() {
            let wrote = match &mut self.input {
                Some(input) => input.write(rest),
                None => Err(io::ErrorKind::BrokenPipe.into()),
            };
            match wrote {
                Ok(count) if count > 0 => {
                    rest = &rest[count..];
                    waiting.partly = !rest.is_empty();
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {
                    if let Ok(line) = self.output.recv_timeout(LOOK) {
                        self.besides(line, waiting)?;
                    }
                    self.wait_on(waiting)?;
                }
                Ok(_) | Err(_) => return Err(self.gone(waiting)),
            }
        }
        Ok(())
    }

    /// The fault for a closed standard input; the solver may have sent the reason.
    fn gone(&mut self, waiting: &Wait) -> Fault {
        let until = Instant::now() + FAREWELL;
        while Instant::now() < until {
            match self.output.recv_timeout(LOOK) {
                Ok(line) => {
                    if let Err(fault) = self.heard(line, waiting) {
                        return fault;
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        self.died("standard input closed", waiting)
    }

    /// Checks interrupts, time limit and process state while waiting for an answer.
    fn wait_on(&mut self, waiting: &mut Wait) -> Result<(), Fault> {
        let asked = || waiting.asked.clone();
        let asks = self.stop.load(Ordering::Relaxed);
        if asks > waiting.heeded {
            match asks {
                1 if self.interrupts && !waiting.partly => self.interrupt(),
                // The solver cannot be interrupted, so this waits for the current iteration.
                1 => {}
                2 => {
                    if let Some(child) = &mut self.child {
                        process::interrupt(child);
                    }
                }
                _ => return Err(Fault::Stopped { asked: asked() }),
            }
            waiting.heeded = asks;
        }
        let now = Instant::now();
        if now > waiting.until {
            return Err(Fault::Silent {
                asked: asked(),
                after: waiting.within,
                longer: waiting.longer,
            });
        }
        if now < waiting.look {
            return Ok(());
        }
        // The output may be kept open by a child of the solver.
        waiting.look = now + FAREWELL;
        match (self.end(), waiting.gone) {
            (Some(_), true) => Err(self.died("a child process keeps its output open", waiting)),
            (end, _) => {
                waiting.gone = end.is_some();
                Ok(())
            }
        }
    }

    /// Asks the solver to end the current request.
    pub(super) fn interrupt(&mut self) {
        let line = Request::Interrupt.line();
        self.log.exchanged(Side::Asked, &line);
        if let Some(input) = &mut self.input {
            // A line this short is written in one piece or not at all; a solver that does not read gets a signal next.
            let _ = input.write(line.as_bytes());
        }
    }

    /// How the process ended; `None` while it runs, or if none was started.
    fn end(&mut self) -> Option<String> {
        self.child.as_mut().and_then(process::end)
    }

    /// Whether the process ends within a time.
    fn ends_within(&mut self, time: Duration) -> bool {
        let until = Instant::now() + time;
        loop {
            if self.child.is_none() || self.end().is_some() {
                return true;
            }
            if Instant::now() > until {
                return false;
            }
            thread::sleep(LOOK / 5);
        }
    }

    /// The fault for a process that ended or closed its output.
    fn died(&mut self, why: &str, waiting: &Wait) -> Fault {
        self.ends_within(FAREWELL);
        // Standard error is a separate pipe; its last lines may arrive later.
        thread::sleep(2 * LOOK);
        let how = self.end().unwrap_or_else(|| match self.input {
            Some(Input::Unix(_) | Input::Tcp(_)) => "connection closed".into(),
            _ => "standard output closed".into(),
        });
        let last = self.log.last_printed();
        let parts = [
            Some(how),
            Some(why.to_owned()).filter(|why| !why.is_empty()),
            last,
        ];
        let how = joined(parts.into_iter().flatten(), "; ");
        let asked = waiting.asked.clone();
        Fault::Died { how, asked }
    }

    /// Closes the input, after a `bye` if `farewell`; returns whether the process ended within this time.
    pub(super) fn leave(&mut self, farewell: bool, within: Duration) -> bool {
        if let Some(mut input) = self.input.take().filter(|_| farewell) {
            let line = Request::Bye.line();
            self.log.exchanged(Side::Asked, &line);
            // A solver that does not read sees the end of its input.
            let _ = input.write(line.as_bytes());
        }
        self.ends_within(within)
    }
}

impl Drop for Link {
    /// Asks the solver to end, then kills its process group.
    fn drop(&mut self) {
        if self.input.is_some() {
            self.leave(true, FAREWELL);
        }
        // Also kills processes that the solver started.
        if let Some(child) = &mut self.child {
            process::kill(child);
            self.guard = None;
            let _ = child.wait();
        }
    }
}

/// Progress in words, safe to print to a terminal.
fn words(progress: &Progress) -> String {
    let amount = match (progress.done, progress.of) {
        (Some(done), Some(of)) => format!("{} of {}", number::shortest(done), number::shortest(of)),
        (Some(done), None) => number::shortest(done),
        (None, _) => String::new(),
    };
    let text = shown::cut(progress.text.trim(), NAME);
    [text, amount].join(" ").trim().to_owned()
}

/// State of a wait for an answer.
struct Wait {
    /// The request, in words.
    asked: String,
    within: Duration,
    /// The option that extends the time limit.
    longer: &'static str,
    until: Instant,
    /// Number of requests to stop that were passed on.
    heeded: usize,
    /// Whether only a part of the request has been sent.
    partly: bool,
    /// Time of the next check of the process, and whether it had ended at the last one.
    look: Instant,
    gone: bool,
}

impl Wait {
    fn new(request: &Request, within: Duration) -> Self {
        let now = Instant::now();
        Wait {
            asked: name(request),
            within,
            longer: match request {
                Request::Hello { .. } | Request::Scene => "--start-timeout",
                _ => "--timeout",
            },
            until: now + within,
            heeded: 0,
            partly: false,
            look: now + FAREWELL,
            gone: false,
        }
    }
}

/// A request in a few words.
pub(super) fn name(request: &Request) -> String {
    match request {
        Request::Hello { .. } => "hello".into(),
        Request::Scene => "scene".into(),
        Request::Step => "step".into(),
        Request::Force { contact, .. } => format!(
            "force of contact {}",
            shown::cut(&contact.to_string(), NAME)
        ),
        Request::Release { contact } => format!(
            "release of contact {}",
            shown::cut(&contact.to_string(), NAME)
        ),
        Request::Set { name, .. } => format!("set of {}", shown::cut(name, NAME)),
        Request::Save => "save".into(),
        Request::Restore { .. } => "restore".into(),
        Request::Problem => "problem".into(),
        Request::Interrupt => "interrupt".into(),
        Request::Bye => "bye".into(),
    }
}

/// Reads its standard output to the end.
fn read(stream: impl Read, lines: &SyncSender<io::Result<Line>>) {
    let mut stream = LineReader::new(BufReader::with_capacity(1 << 16, stream), MOST_BYTES);
    loop {
        let line = stream.next_line();
        let last = !matches!(line, Ok(Line::Text(_) | Line::NoText(_)));
        if lines.send(line).is_err() || last {
            return;
        }
    }
}

/// Reads its standard error to the end.
fn listen(stream: impl Read, log: &Log) {
    let mut stream = BufReader::new(stream);
    let mut line = Vec::new();
    loop {
        line.clear();
        match stream
            .by_ref()
            .take(ERROR_BYTES)
            .read_until(b'\n', &mut line)
        {
            Ok(0) | Err(_) => return,
            Ok(_) => log.printed(String::from_utf8_lossy(&line).trim_end_matches(['\n', '\r'])),
        }
    }
}
