//! A solver as a child process: it is started, asked, interrupted and ended.
//!
//! Its standard output is read on a thread of its own, line by line and bounded; its standard error on another, into the log.
//! It runs in a process group of its own, so that a Ctrl-C in the terminal is this program's to pass on: first as a message, then
//! as a signal, then for good.

use rustix::io::ioctl_fionbio;
use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, kill_process_group, waitid};
use std::io::{self, BufRead, BufReader, Read, Write};
use std::os::unix::process::CommandExt;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread;
use std::time::{Duration, Instant};
use stickslip_debugger::recorded::fault::Fault;
use stickslip_debugger::recorded::log::Log;
use stickslip_exchange::attach::conversation::STARTED;
use stickslip_exchange::attach::{Answer, Line, Lines, MOST_BYTES, Request, Side};
use stickslip_scene::shown;

/// How often who waits looks whether it is to be interrupted.
const LOOK: Duration = Duration::from_millis(10);
/// How long a solver has to end after `bye`.
const FAREWELL: Duration = Duration::from_millis(500);
/// Lines that may wait to be read; each can be as long as any.
const WAITING: usize = 2;
/// Characters that are shown of a line that cannot be read.
const SHOWN: usize = 80;
/// Most characters of a name in what is told.
const NAME: usize = 60;
/// Most bytes of a line of standard error.
const ERROR_BYTES: u64 = 8192;

/// How a solver is started, and how long it may take.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// The program and its arguments.
    pub command: Vec<String>,
    /// How long it may take from its start to its first answers.
    pub start: Duration,
    /// How long any other answer may take.
    pub answer: Duration,
}

impl Start {
    /// This command, with a minute to start, and ten for every answer.
    pub fn new(command: Vec<String>) -> Start {
        Start {
            command,
            start: Duration::from_secs(60),
            answer: Duration::from_secs(600),
        }
    }

    /// The command as one would type it.
    pub fn typed(&self) -> String {
        self.command.join(" ")
    }
}

/// A running solver.
pub struct Link {
    child: Child,
    input: Option<ChildStdin>,
    output: Receiver<io::Result<Line>>,
    log: Log,
    stop: Arc<AtomicUsize>,
    interrupts: bool,
}

impl Link {
    /// Starts a solver. `stop` is looked at while it is waited for: once asked to stop, a solver that offers it gets a message;
    /// asked twice, any gets a signal; and asked a third time, it is ended for good.
    ///
    /// # Errors
    /// [`Fault::NotStarted`].
    pub fn start(start: &Start, log: &Log, stop: Arc<AtomicUsize>) -> Result<Link, Fault> {
        let not_started = |why: String| Fault::NotStarted {
            command: start.typed(),
            why,
        };
        let [program, arguments @ ..] = start.command.as_slice() else {
            return Err(not_started("no command is named after --".into()));
        };
        let mut command = Command::new(program);
        command
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .process_group(0);
        let mut child = command
            .spawn()
            .map_err(|error| not_started(error.to_string()))?;
        log.noted(&format!("{STARTED}: {}", start.typed()));
        let (lines, output) = sync_channel(WAITING);
        if let Some(stream) = child.stdout.take() {
            thread::spawn(move || read(stream, &lines));
        }
        if let Some(stream) = child.stderr.take() {
            let log = log.clone();
            thread::spawn(move || listen(stream, &log));
        }
        let input = child.stdin.take();
        if let Some(input) = &input {
            // A solver that does not read must not hold this program.
            ioctl_fionbio(input, true).map_err(|error| not_started(error.to_string()))?;
        }
        Ok(Link {
            input,
            child,
            output,
            log: log.clone(),
            stop,
            interrupts: false,
        })
    }

    /// Whether the solver looks at its input while it works, so that it can be asked to end a request.
    pub fn set_interrupts(&mut self, interrupts: bool) {
        self.interrupts = interrupts;
    }

    /// What counts from now on how often the user has asked to stop.
    pub fn heed(&mut self, asks: Arc<AtomicUsize>) {
        self.stop = asks;
    }

    /// Asks, and waits for the answer.
    ///
    /// # Errors
    /// The fault by which the solver ends; it is of no use any more then.
    pub fn ask(&mut self, request: &Request, within: Duration) -> Result<Answer, Fault> {
        let mut waiting = Waiting::new(request, within);
        // What came since the last answer.
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
            // Who goes on talking is not listened to for ever.
            self.wait_on(&mut waiting)?;
        }
    }

    /// What a line answers; `None` for a message, which is no answer.
    fn heard(
        &mut self,
        line: io::Result<Line>,
        waiting: &Waiting,
    ) -> Result<Option<Answer>, Fault> {
        let line = line.map_err(|error| self.died(&error.to_string(), waiting))?;
        match self.read(line, waiting)? {
            Answer::Message { level, text } => {
                self.log.told(level, &text);
                Ok(None)
            }
            Answer::Bye { reason } => Err(Fault::Bye {
                reason,
                asked: waiting.asked.clone(),
            }),
            answer => Ok(Some(answer)),
        }
    }

    /// A line that came where no answer is due.
    fn besides(&mut self, line: io::Result<Line>, waiting: &Waiting) -> Result<(), Fault> {
        match self.heard(line, waiting)? {
            None => Ok(()),
            Some(answer) => Err(Fault::Unasked {
                answer: answer.kind().to_owned(),
                asked: waiting.asked.clone(),
            }),
        }
    }

    /// What a line says.
    fn read(&mut self, line: Line, waiting: &Waiting) -> Result<Answer, Fault> {
        let text = match line {
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
                    .exchanged(Side::Noted, &format!("no UTF-8: {line}"));
                let why = "it is not UTF-8".into();
                return Err(Fault::Junk { why, line });
            }
        };
        self.log.exchanged(Side::Answered, &text);
        Answer::read(&text).map_err(|broken| {
            let letters = text.trim_start();
            let why = match broken.at {
                _ if letters.is_empty() => "an empty line".to_owned(),
                Some((_, column)) if letters.starts_with('{') => {
                    format!("column {column}: {broken}")
                }
                _ => "it is no JSON object".to_owned(),
            };
            // What is wrong in a long line stands around the column.
            let from = broken.at.map_or(0, |(_, column)| column.saturating_sub(40));
            let asked = waiting.asked.clone();
            match letters.starts_with('{') {
                true => Fault::Misformed {
                    asked,
                    why,
                    line: text.chars().skip(from).take(SHOWN).collect(),
                },
                false => Fault::Junk {
                    why,
                    line: text.chars().take(SHOWN).collect(),
                },
            }
        })
    }

    /// Sends a request as fast as it is taken. A solver that is still talking is listened to meanwhile, or both would wait for
    /// each other.
    fn send(&mut self, request: &Request, waiting: &mut Waiting) -> Result<(), Fault> {
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

    /// It takes nothing more. It may have said why.
    fn gone(&mut self, waiting: &Waiting) -> Fault {
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
        self.died("it closed its standard input", waiting)
    }

    /// No answer has come yet.
    fn wait_on(&mut self, waiting: &mut Waiting) -> Result<(), Fault> {
        let asked = || waiting.asked.clone();
        let asks = self.stop.load(Ordering::Relaxed);
        if asks > waiting.heeded {
            match asks {
                1 if self.interrupts && !waiting.partly => self.interrupt(),
                // It is waited for: the iteration at hand is the last one then.
                1 => {}
                2 => self.signal(Signal::INT),
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
        // Its output may be held open by something that it has started.
        waiting.look = now + FAREWELL;
        match (self.end(), waiting.gone) {
            (Some(_), true) => Err(self.died("what it started lives on", waiting)),
            (end, _) => {
                waiting.gone = end.is_some();
                Ok(())
            }
        }
    }

    /// Asks it to end the request at hand.
    pub(super) fn interrupt(&mut self) {
        let line = Request::Interrupt.line();
        self.log.exchanged(Side::Asked, &line);
        if let Some(input) = &mut self.input {
            // So short a line goes whole or not at all; who does not read has to be signalled.
            let _ = input.write(line.as_bytes());
        }
    }

    /// How the process ended; `None` where it runs. It stays known to the system, so that its group's number is still its own.
    fn end(&self) -> Option<String> {
        let pid = i32::try_from(self.child.id())
            .ok()
            .and_then(Pid::from_raw)?;
        let look = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        match waitid(WaitId::Pid(pid), look) {
            Ok(status) => {
                status.map(
                    |status| match (status.exit_status(), status.terminating_signal()) {
                        (Some(code), _) => format!("exit status {code}"),
                        (None, Some(signal)) => format!("killed by signal {signal}"),
                        (None, None) => "it ended".into(),
                    },
                )
            }
            // There is no such process any more.
            Err(_) => Some("it ended".into()),
        }
    }

    /// Whether it ends within a time.
    fn ends_within(&self, time: Duration) -> bool {
        let until = Instant::now() + time;
        loop {
            if self.end().is_some() {
                return true;
            }
            if Instant::now() > until {
                return false;
            }
            thread::sleep(LOOK / 5);
        }
    }

    /// It is gone, or closed its output.
    fn died(&mut self, why: &str, waiting: &Waiting) -> Fault {
        self.ends_within(FAREWELL);
        // What it printed last comes over another pipe.
        thread::sleep(2 * LOOK);
        let how = self
            .end()
            .unwrap_or_else(|| "it closed its standard output".into());
        let last = self.log.last_printed();
        let parts = [
            Some(how),
            Some(why.to_owned()).filter(|why| !why.is_empty()),
            last,
        ];
        let how = parts.into_iter().flatten().collect::<Vec<_>>().join("; ");
        let asked = waiting.asked.clone();
        Fault::Died { how, asked }
    }

    fn signal(&self, signal: Signal) {
        if let Some(group) = i32::try_from(self.child.id()).ok().and_then(Pid::from_raw) {
            // It may have ended in the meantime.
            let _ = kill_process_group(group, signal);
        }
    }

    /// Closes its input, with a word of farewell or without; whether it ended.
    pub(super) fn leave(&mut self, farewell: bool) -> bool {
        if let Some(mut input) = self.input.take().filter(|_| farewell) {
            let line = Request::Bye.line();
            self.log.exchanged(Side::Asked, &line);
            // Who does not read sees the end of its input.
            let _ = input.write(line.as_bytes());
        }
        self.ends_within(FAREWELL)
    }
}

impl Drop for Link {
    /// It is told to end, then made to.
    fn drop(&mut self) {
        if self.input.is_some() {
            self.leave(true);
        }
        // What it started itself goes with it.
        self.signal(Signal::KILL);
        let _ = self.child.wait();
    }
}

/// What an answer is waited for by.
struct Waiting {
    /// What was asked.
    asked: String,
    within: Duration,
    /// The option by which it would have longer.
    longer: &'static str,
    until: Instant,
    /// How often it was asked to stop, as far as that was passed on.
    heeded: usize,
    /// Whether a part of the request is sent.
    partly: bool,
    /// When it is looked next whether it lives, and whether it had ended by then.
    look: Instant,
    gone: bool,
}

impl Waiting {
    fn new(request: &Request, within: Duration) -> Self {
        let now = Instant::now();
        Waiting {
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

/// What is asked, in a word or two.
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
    let mut stream = Lines::new(BufReader::with_capacity(1 << 16, stream), MOST_BYTES);
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
