//! The event loop, and the entry points: a scene, a session, a lesson, or the chooser.

use crate::app::App;
use crate::background::{self, Reply};
use crate::canvas;
use crate::debugger::{Debugger, TerminalRequest, offers};
use crate::terminal::{self, Terminal};
use crate::theme::{Theme, wants_no_colour};
use crossterm::event::{self, Event};
use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};
use stickslip_debugger::action::config::{Config, Dots};
use stickslip_debugger::record::journal::JournalError;
use stickslip_debugger::{Colours, JournalTarget, Lesson, Session};
use stickslip_platform::signals::{self, Signals};
use stickslip_scene::shown;
use stickslip_scene::{Scene, SceneError};

/// Why the debugger could not start, or stopped.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Standard input or output is not a terminal.
    #[error("the debugger needs a terminal; `stickslip run SCENE` solves without one")]
    NoTerminal,
    /// The scene could not be loaded.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The scene is invalid, or the finished run is damaged.
    #[error("{0}")]
    Session(String),
    /// The journal cannot be written.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The terminal failed.
    #[error("terminal: {0}")]
    Terminal(#[from] io::Error),
}

/// Runs the debugger on a scene (a file or a built-in name) with overridden values, or with the chooser. On a terminating signal it
/// returns with the terminal restored.
///
/// # Errors
/// If there is no terminal, the scene cannot be loaded, or the terminal fails.
pub fn run(
    scene: Option<String>,
    overrides: &[(String, String)],
    journal: &JournalTarget,
) -> Result<(), Error> {
    let begin = |scene: String| {
        let mut session = Session::new(Scene::open_any(&scene, overrides)?);
        journal.begin(&mut session)?;
        Ok::<_, Error>(session)
    };
    let session = scene.map(begin).transpose()?;
    go(session, *journal != JournalTarget::Nowhere, None)
}

/// Continues a session, and shows a message first.
///
/// # Errors
/// If there is no terminal, or it fails.
pub fn resume(session: Session, text: &str) -> Result<(), Error> {
    go(Some(session), true, Some(text))
}

/// Runs the debugger on a session; `keeps` also writes journals of scenes opened later.
fn go(session: Option<Session>, keeps: bool, text: Option<&str>) -> Result<(), Error> {
    let mut debugger = in_terminal(session)?;
    debugger.keeps = keeps;
    if let Some(text) = text {
        debugger.app.say(text);
    }
    run_on(debugger)
}

/// Runs a lesson from a step (from 0), or else from where the user left it. Lessons are not recorded, since they can be repeated.
///
/// # Errors
/// If there is no terminal, or it fails.
pub fn run_lesson(lesson: Lesson, step: Option<usize>) -> Result<(), Error> {
    let mut debugger = in_terminal(None)?;
    if let Some(runs) = lesson.runs.clone() {
        // Measured in the background, so that keys need not wait for it; an error is shown where the result is used.
        std::thread::spawn(move || runs.measure().is_ok());
    }
    debugger.teach(lesson, step);
    run_on(debugger)
}

/// A debugger with the user's configuration and files, if there is a terminal.
fn in_terminal(session: Option<Session>) -> Result<Debugger, Error> {
    if !io::stdin().is_terminal() || !io::stdout().is_terminal() {
        return Err(Error::NoTerminal);
    }
    let mut debugger = configured(Config::open()?, session);
    debugger.use_user_files();
    Ok(debugger)
}

/// A debugger with the user's configuration.
fn configured(config: Config, session: Option<Session>) -> Debugger {
    let environment = std::env::var("COLORFGBG").ok();
    let ground = background::is_light(environment.as_deref()).map(Colours::for_background);
    let chosen = config.colours.or(ground);
    let colours = chosen.unwrap_or_default();
    let mut debugger = Debugger::new(Theme::chosen(colours), offers(), session);
    let app = &mut debugger.app;
    (app.keymap, app.colours, app.mouse) = (config.keymap, colours, config.mouse);
    app.octants = config.dots == Dots::Octants;
    app.finds_octants = config.dots == Dots::Auto;
    app.finds_colours = chosen.is_none() && !wants_no_colour();
    debugger
}

fn run_on(mut debugger: Debugger) -> Result<(), Error> {
    let signals = terminal::listen()?;
    let ended = Terminal::enter().and_then(|mut terminal| {
        terminal.set_mouse(debugger.app.mouse)?;
        if debugger.app.finds_colours {
            terminal.ask(background::QUERY)?;
        }
        if debugger.app.finds_octants {
            terminal.ask(background::VERSION_QUERY)?;
        }
        // The terminal is restored before anything is printed.
        events(&mut debugger, &mut terminal, &signals)
    });
    if let Some(session) = &debugger.session {
        print_exit_line(session);
    }
    leave(ended, &signals)
}

/// Prints one line on exit: where the journal is, or why there is none.
fn print_exit_line(session: &Session) {
    let text = match (session.journal().path(), session.journal().lost()) {
        (Some(path), _) => {
            let path = path.display();
            format!("journal: {path} (`stickslip resume {path}` continues it)")
        }
        (None, Some(why)) => format!("no journal: {why}"),
        (None, None) => return,
    };
    // Standard error may be closed.
    let _ = writeln!(io::stderr(), "{}", shown::line(&text));
}

/// Ends the process as its signal would, exits quietly if the terminal is gone, and otherwise returns the error.
fn leave(ended: io::Result<()>, watched: &Signals) -> Result<(), Error> {
    if let Some(signal) = watched.end() {
        signals::obey(signal)?;
    }
    if ended.is_err() && terminal::is_gone() {
        signals::hang_up()?;
    }
    ended.map_err(Error::from)
}

/// Longest wait for a key: the screen follows a running solver.
const IDLE: Duration = Duration::from_millis(100);
const BUSY: Duration = Duration::from_millis(40);
/// With a timeout of zero, crossterm does not read its input. Below 1 ms it does not sleep.
const LEAST_WAIT: Duration = Duration::from_micros(200);

fn events(debugger: &mut Debugger, terminal: &mut Terminal, signals: &Signals) -> io::Result<()> {
    let mut changed = true;
    let mut drawn = Instant::now();
    let mut reply = Reply::default();
    reply.expects_colour = debugger.app.finds_colours;
    reply.expects_version = debugger.app.finds_octants;
    while signals.end().is_none() {
        changed |= debugger.advance();
        while let Some(outside) = debugger.take_request() {
            changed = true;
            if obey(outside, terminal, signals, &mut debugger.app)? {
                return Ok(());
            }
        }
        // Keys are read between slices of a run, and the screen is redrawn at a fixed rate.
        let behind = debugger.is_behind();
        if changed && (!behind || drawn.elapsed() >= BUSY) {
            changed = false;
            let app = &debugger.app;
            debugger.app.area = terminal.draw(app, debugger.view().as_ref())?;
            drawn = Instant::now();
        }
        let works = debugger.is_working();
        let wait = match (behind, works) {
            (true, _) => Duration::ZERO,
            (false, true) => BUSY,
            (false, false) => IDLE,
        };
        let mut input = next_event(wait, &mut reply)?;
        if let Some(light) = reply.light.take() {
            changed = true;
            debugger.app.find_colours(light);
        }
        if let Some(version) = reply.version.take() {
            changed = true;
            debugger.app.octants = canvas::has_octants(&version);
        }
        while let Some(event) = input {
            changed = true;
            if let Some(event) = terminal::input(event)
                && let Some(outside) = debugger.event(&event)
                && obey(outside, terminal, signals, &mut debugger.app)?
            {
                return Ok(());
            }
            debugger.breathe();
            // Redraws during a burst of keys, too.
            input = if drawn.elapsed() < BUSY {
                next_event(Duration::ZERO, &mut reply)?
            } else {
                None
            };
        }
        if signals.stop() {
            // From another process.
            terminal.stop()?;
            continued(signals);
            changed = true;
        }
        if signals.resumed() {
            terminal.retake()?;
            changed = true;
        }
    }
    Ok(())
}

/// The next event within `wait`, if any, without the terminal's reply. Pending input is always found.
fn next_event(wait: Duration, reply: &mut Reply) -> io::Result<Option<Event>> {
    let mut next = reply.next();
    while next.is_none() && event::poll(wait.max(LEAST_WAIT))? {
        reply.push(event::read()?);
        next = reply.next();
        if reply.light.is_some() || reply.version.is_some() {
            return Ok(next);
        }
    }
    if next.is_none() {
        reply.release();
        next = reply.next();
    }
    Ok(next)
}

/// Executes requests that need the event loop; returns true to quit.
fn obey(
    outside: TerminalRequest,
    terminal: &mut Terminal,
    signals: &Signals,
    app: &mut App,
) -> io::Result<bool> {
    match outside {
        TerminalRequest::Quit => return Ok(true),
        TerminalRequest::Suspend => {
            terminal.suspend()?;
            if !continued(signals) {
                app.complain(
                    "cannot suspend: the program was not started by a shell with job control",
                );
            }
        }
        TerminalRequest::Redraw => terminal.forget()?,
        TerminalRequest::Copy(text) => terminal.copy(&text)?,
        TerminalRequest::Mouse(on) => terminal.set_mouse(on)?,
    }
    Ok(false)
}

/// Whether the process was stopped and continued since the last call.
fn continued(signals: &Signals) -> bool {
    // A SIGTSTP sent to the process group arrives here, too.
    signals.stop();
    signals.resumed()
}
