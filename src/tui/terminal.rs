//! The real terminal: taken over, and given back whatever happens.
//!
//! It is given back when [`Terminal`] is dropped (the end, or an error on its way up), by the panic hook (before the
//! message is printed, so that it can be read), and before the process obeys SIGTERM, SIGINT or SIGHUP. Ctrl-Z and SIGTSTP give it back, stop the process as the shell
//! expects, and take it again with a full redraw when the process goes on.

use crate::tui::app::App;
use crate::tui::screen;
use crate::tui::view::View;
use crossterm::clipboard::CopyToClipboard;
use crossterm::cursor::{Hide, Show};
use crossterm::event::{DisableBracketedPaste, EnableBracketedPaste};
use crossterm::terminal::{
    BeginSynchronizedUpdate, EndSynchronizedUpdate, EnterAlternateScreen, LeaveAlternateScreen,
    disable_raw_mode, enable_raw_mode,
};
use crossterm::{execute, queue};
use ratatui::backend::CrosstermBackend;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use signal_hook::consts::{SIGCONT, SIGHUP, SIGINT, SIGTERM, SIGTSTP};
use signal_hook::iterator::Handle;
use signal_hook::{SigId, flag, low_level};
use std::fmt;
use std::io::{self, IsTerminal, Stdout, Write, stdout};
use std::mem::ManuallyDrop;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, Once, PoisonError};
use std::thread;
use std::time::Duration;

/// Whether the terminal is ours at this moment.
static TAKEN: AtomicBool = AtomicBool::new(false);
/// Whether the mouse is to be heeded whenever the terminal is ours.
static MOUSE: AtomicBool = AtomicBool::new(false);
/// What a panic on another thread had to say; the screen is not its to write on.
static PANIC: Mutex<Option<String>> = Mutex::new(None);

/// Has clicks and the wheel reported, with places of any size. The library's own order wants every motion, too.
struct HeedMouse;

impl crossterm::Command for HeedMouse {
    fn write_ansi(&self, f: &mut impl fmt::Write) -> fmt::Result {
        f.write_str("\x1b[?1000h\x1b[?1006h")
    }
}

/// Has nothing of the mouse reported.
struct LeaveMouse;

impl crossterm::Command for LeaveMouse {
    fn write_ansi(&self, f: &mut impl fmt::Write) -> fmt::Result {
        f.write_str("\x1b[?1006l\x1b[?1000l")
    }
}

/// The terminal, taken over for as long as this lives.
#[derive(Debug)]
pub struct Terminal {
    /// Never dropped: it would show the cursor once more, and panic where it cannot say that there is no terminal to show it on.
    screen: ManuallyDrop<ratatui::Terminal<CrosstermBackend<Stdout>>>,
}

impl Terminal {
    /// Takes the terminal over.
    pub fn enter() -> io::Result<Self> {
        hook_panics();
        take()?;
        match ratatui::Terminal::new(CrosstermBackend::new(stdout())) {
            Ok(screen) => Ok(Terminal {
                screen: ManuallyDrop::new(screen),
            }),
            Err(error) => {
                give_back();
                Err(error)
            }
        }
    }

    /// Draws what changed of the debugger's screen; returns its size.
    pub fn draw(&mut self, app: &App, view: Option<&View>) -> io::Result<Rect> {
        self.show(|buffer, area| screen::draw(buffer, area, app, view))
    }

    /// Draws what changed of any screen, in one go where the terminal can do that; returns its size.
    pub fn show(&mut self, screen: impl FnOnce(&mut Buffer, Rect)) -> io::Result<Rect> {
        queue!(stdout(), BeginSynchronizedUpdate)?;
        let drawn = self.screen.draw(|frame| {
            let area = frame.area();
            screen(frame.buffer_mut(), area);
        });
        let drawn = drawn.map(|frame| frame.area);
        execute!(stdout(), EndSynchronizedUpdate)?;
        drawn
    }

    /// Has clicks and the wheel reported, or leaves the mouse to the terminal.
    pub fn heed_mouse(&mut self, on: bool) -> io::Result<()> {
        MOUSE.store(on, Ordering::SeqCst);
        match on {
            true => execute!(stdout(), HeedMouse),
            false => execute!(stdout(), LeaveMouse),
        }
    }

    /// Copies a text to the clipboard, where the terminal lets a program do that (OSC 52).
    pub fn copy(&mut self, text: &str) -> io::Result<()> {
        execute!(stdout(), CopyToClipboard::to_clipboard_from(text))
    }

    /// Forgets what is on the screen, so that the next draw is a full one.
    ///
    /// Not with the library's `clear`: that one asks the terminal where the cursor is, and fails where no answer comes
    /// within two seconds.
    pub fn forget(&mut self) -> io::Result<()> {
        let size = self.screen.size()?;
        self.screen.resize(size.into())
    }

    /// Gives the terminal back, stops the process until it is continued, and takes the terminal again.
    ///
    /// The whole process group is told, as the terminal itself would by Ctrl-Z: a parent such as cargo would go on
    /// waiting otherwise, and the shell never get its prompt back.
    pub fn suspend(&mut self) -> io::Result<()> {
        give_back();
        rustix::process::kill_current_process_group(rustix::process::Signal::TSTP)?;
        low_level::emulate_default_handler(SIGTSTP)?;
        take()?;
        self.forget()
    }

    /// Takes the terminal again after somebody else may have changed its settings.
    pub fn retake(&mut self) -> io::Result<()> {
        give_back();
        take()?;
        self.forget()
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        give_back();
    }
}

fn take() -> io::Result<()> {
    enable_raw_mode()?;
    TAKEN.store(true, Ordering::SeqCst);
    let mut entered = execute!(stdout(), EnterAlternateScreen, EnableBracketedPaste, Hide);
    if MOUSE.load(Ordering::SeqCst) {
        entered = entered.and_then(|()| execute!(stdout(), HeedMouse));
    }
    if entered.is_err() {
        give_back();
    }
    entered
}

/// Gives the terminal back, if it is ours. Errors are of no use here: there may be no terminal any more.
fn give_back() {
    if TAKEN.swap(false, Ordering::SeqCst) {
        let _ = execute!(
            stdout(),
            EndSynchronizedUpdate,
            LeaveMouse,
            DisableBracketedPaste,
            LeaveAlternateScreen,
            Show
        );
        let _ = stdout().flush();
        let _ = disable_raw_mode();
    }
}

/// Whether the terminal went away under the program: there is none any more where there was one.
pub fn is_gone() -> bool {
    !stdout().is_terminal()
}

/// Makes a panic readable: on this thread the terminal is given back first; on another one (the solver's) the
/// message is kept for [`panic_elsewhere`], since this thread goes on drawing.
fn hook_panics() {
    static ONCE: Once = Once::new();
    let ours = thread::current().id();
    ONCE.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if thread::current().id() == ours || !TAKEN.load(Ordering::SeqCst) {
                give_back();
                before(info);
            } else {
                *PANIC.lock().unwrap_or_else(PoisonError::into_inner) = Some(info.to_string());
            }
        }));
    });
}

/// What a panic on another thread said, once.
pub fn panic_elsewhere() -> Option<String> {
    PANIC.lock().unwrap_or_else(PoisonError::into_inner).take()
}

/// Signals, as flags for the event loop.
#[derive(Debug)]
pub struct Signals {
    /// Number of the signal that asks for the end, or 0.
    end: Arc<AtomicUsize>,
    watch: Handle,
    stop: Arc<AtomicBool>,
    resumed: Arc<AtomicBool>,
    registered: [SigId; 2],
}

/// How long the event loop has to end by itself once a signal asks for it.
const PATIENCE: Duration = Duration::from_millis(300);

impl Signals {
    /// Listens from now on.
    pub fn listen() -> io::Result<Self> {
        let (end, stop, resumed) = (Arc::default(), Arc::default(), Arc::default());
        let watch = watch(&end)?;
        let registered = [
            flag::register(SIGTSTP, Arc::clone(&stop))?,
            flag::register(SIGCONT, Arc::clone(&resumed))?,
        ];
        Ok(Signals {
            end,
            watch,
            stop,
            resumed,
            registered,
        })
    }

    /// The signal that asks for the end, if one came.
    pub fn end(&self) -> Option<i32> {
        match self.end.load(Ordering::SeqCst) {
            0 => None,
            signal => Some(signal as i32),
        }
    }

    /// Whether somebody asked the process to stop, once.
    pub fn stop(&self) -> bool {
        self.stop.swap(false, Ordering::SeqCst)
    }

    /// Whether the process was stopped and goes on, once.
    pub fn resumed(&self) -> bool {
        self.resumed.swap(false, Ordering::SeqCst)
    }
}

impl Drop for Signals {
    fn drop(&mut self) {
        self.watch.close();
        for id in self.registered {
            low_level::unregister(id);
        }
    }
}

/// Waits on a thread of its own for the signals that end the process. The event loop is told and given a moment;
/// it may be stuck, since the terminal library reads for ever from a terminal that is gone.
fn watch(end: &Arc<AtomicUsize>) -> io::Result<Handle> {
    let mut signals = signal_hook::iterator::Signals::new([SIGTERM, SIGINT, SIGHUP])?;
    let handle = signals.handle();
    let end = Arc::clone(end);
    thread::spawn(move || {
        if let Some(signal) = signals.forever().next() {
            end.store(signal as usize, Ordering::SeqCst);
            thread::sleep(PATIENCE);
            give_back();
            let _ = obey(signal);
        }
    });
    Ok(handle)
}

/// Ends the process as the signal would have without us, so that whoever sent it sees that.
pub fn obey(signal: i32) -> io::Result<()> {
    low_level::emulate_default_handler(signal)
}
