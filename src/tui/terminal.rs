//! Takes over the terminal, and restores it in every case.
//!
//! The terminal is restored when [`Terminal`] is dropped (at the end or on an error), by the panic hook (before the message is
//! printed, so that it is readable), and before the process obeys SIGTERM, SIGINT, SIGHUP or SIGQUIT. Ctrl-Z and SIGTSTP restore it, stop
//! the process as the shell expects, and take it over again with a full redraw when the process continues. A lock serialises taking
//! over and restoring, so a signal in between cannot leave either incomplete.

use crate::app::App;
use crate::event::{Event, KeyCode, KeyEvent, Modifiers, MouseAction, MouseEvent};
use crate::screen;
use crate::view::View;
use crossterm::clipboard::CopyToClipboard;
use crossterm::cursor::{Hide, Show};
use crossterm::event::{
    DisableBracketedPaste, EnableBracketedPaste, Event as TerminalEvent, KeyCode as TerminalKey,
    KeyEventKind, KeyModifiers, MouseButton, MouseEventKind,
};
use crossterm::terminal::{
    BeginSynchronizedUpdate, Clear, ClearType, EndSynchronizedUpdate, EnterAlternateScreen,
    LeaveAlternateScreen, disable_raw_mode, enable_raw_mode,
};
use crossterm::{execute, queue};
use ratatui::backend::CrosstermBackend;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use std::io::{self, IsTerminal, Stdout, Write, stdout};
use std::mem::ManuallyDrop;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, Once, PoisonError};
use std::thread;
use stickslip_platform::signals::{self, Signals};
use stickslip_platform::{task, terminal as console};

/// Whether the program has taken over the terminal.
static OWNERSHIP: Ownership = Ownership(Mutex::new(false));
/// Whether mouse support is on while the program has the terminal.
static MOUSE: AtomicBool = AtomicBool::new(false);

/// The terminal, taken over until this is dropped.
#[derive(Debug)]
pub struct Terminal {
    /// Never dropped: dropping shows the cursor once more, and panics if the terminal is gone and the error cannot be printed.
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

    /// Draws the changes of the debugger's screen; returns the screen size.
    pub fn draw(&mut self, app: &App, view: Option<&View>) -> io::Result<Rect> {
        self.show(|buffer, area| screen::draw(buffer, area, app, view))
    }

    /// Draws the changes of a screen, in a synchronized update if the terminal supports it; returns the screen size.
    pub fn show(&mut self, screen: impl FnOnce(&mut Buffer, Rect)) -> io::Result<Rect> {
        queue!(stdout(), BeginSynchronizedUpdate)?;
        let drawn = self
            .screen
            .draw(|frame| {
                let area = frame.area();
                screen(frame.buffer_mut(), area);
            })
            .map(|frame| frame.area);
        execute!(stdout(), EndSynchronizedUpdate)?;
        drawn
    }

    /// Turns mouse reports on or off.
    pub fn set_mouse(&mut self, on: bool) -> io::Result<()> {
        MOUSE.store(on, Ordering::SeqCst);
        console::report_mouse(on)
    }

    /// Asks the terminal something; the reply arrives among the keys.
    pub fn ask(&mut self, query: &str) -> io::Result<()> {
        stdout().write_all(query.as_bytes())?;
        stdout().flush()
    }

    /// Copies a text to the clipboard, if the terminal allows it (OSC 52).
    pub fn copy(&mut self, text: &str) -> io::Result<()> {
        execute!(stdout(), CopyToClipboard::to_clipboard_from(text))
    }

    /// Discards the stored screen content, so that the next draw is a full one.
    ///
    /// ratatui's `clear` is not used: it asks the terminal for the cursor position, and fails without an answer within two seconds.
    pub fn forget(&mut self) -> io::Result<()> {
        let size = self.screen.size()?;
        self.screen.resize(size.into())
    }

    /// Restores the terminal, stops the process until it is continued, and takes over the terminal again. Returns at once
    /// if no shell with job control could continue the process ([`signals::suspend`]).
    pub fn suspend(&mut self) -> io::Result<()> {
        self.released(signals::suspend)
    }

    /// The same after a SIGTSTP from another process, which can also continue this process.
    pub fn stop(&mut self) -> io::Result<()> {
        self.released(signals::stop)
    }

    /// Restores the terminal while `work` runs.
    fn released(&mut self, work: impl FnOnce() -> io::Result<()>) -> io::Result<()> {
        give_back();
        let worked = work();
        take()?;
        self.forget()?;
        worked
    }

    /// Takes the terminal over again after another process may have changed its settings.
    pub fn retake(&mut self) -> io::Result<()> {
        self.released(|| Ok(()))
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        give_back();
    }
}

/// Whether the program has taken over the terminal. The lock hides intermediate states.
struct Ownership(Mutex<bool>);

impl Ownership {
    fn lock(&self) -> MutexGuard<'_, bool> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes over the terminal with `enter`, unless already done. If `enter` fails half way, `leave` undoes it.
    fn take(&self, enter: impl FnOnce() -> io::Result<()>, leave: impl FnOnce()) -> io::Result<()> {
        let mut taken = self.lock();
        if *taken {
            return Ok(());
        }
        let entered = enter();
        match entered {
            Ok(()) => *taken = true,
            Err(_) => leave(),
        }
        entered
    }

    /// Restores the terminal with `leave`, if it was taken over. It cannot be taken over again before the guard is dropped.
    fn give_back(&self, leave: impl FnOnce()) -> MutexGuard<'_, bool> {
        let mut taken = self.lock();
        if std::mem::take(&mut *taken) {
            leave();
        }
        taken
    }
}

fn take() -> io::Result<()> {
    OWNERSHIP.take(enter, leave)
}

fn give_back() {
    drop(OWNERSHIP.give_back(leave));
}

fn enter() -> io::Result<()> {
    enable_raw_mode()?;
    signals::read_without_waiting()?;
    // A killed program leaves the terminal on its alternate screen, which entering it again does not clear.
    execute!(
        stdout(),
        EnterAlternateScreen,
        Clear(ClearType::All),
        EnableBracketedPaste,
        Hide
    )?;
    if MOUSE.load(Ordering::SeqCst) {
        console::report_mouse(true)
    } else {
        Ok(())
    }
}

/// Errors are ignored: the terminal may be gone.
fn leave() {
    let _ = execute!(stdout(), EndSynchronizedUpdate);
    let _ = console::report_mouse(false);
    let _ = execute!(stdout(), DisableBracketedPaste, LeaveAlternateScreen, Show);
    let _ = stdout().flush();
    let _ = disable_raw_mode();
}

/// Installs the signal handlers of the debugger.
pub fn listen() -> io::Result<Signals> {
    Signals::listen(|| OWNERSHIP.give_back(leave))
}

/// Whether the terminal has been closed while the program runs.
pub fn is_gone() -> bool {
    !stdout().is_terminal()
}

/// Makes a panic readable: on this thread the terminal is restored first; on another thread (the solver's) the message is stored
/// for [`task::take_panic`], since this thread keeps drawing.
fn hook_panics() {
    static ONCE: Once = Once::new();
    let ours = thread::current().id();
    ONCE.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if thread::current().id() == ours || !*OWNERSHIP.lock() {
                give_back();
                before(info);
            } else {
                task::store_panic(info.to_string());
            }
        }));
    });
}

/// The debugger's input of a terminal event; `None` for releases and events that no action uses.
pub fn input(event: TerminalEvent) -> Option<Event> {
    Some(match event {
        TerminalEvent::Key(key) if key.kind == KeyEventKind::Release => return None,
        TerminalEvent::Key(key) => {
            let modifiers = Modifiers {
                shift: key.modifiers.contains(KeyModifiers::SHIFT),
                control: key.modifiers.contains(KeyModifiers::CONTROL),
                alt: key.modifiers.contains(KeyModifiers::ALT),
            };
            Event::Key(KeyEvent::new(key_code(key.code)?, modifiers))
        }
        TerminalEvent::Mouse(mouse) => {
            let kind = match mouse.kind {
                MouseEventKind::Down(MouseButton::Left) => MouseAction::Click,
                MouseEventKind::ScrollUp => MouseAction::ScrollUp,
                MouseEventKind::ScrollDown => MouseAction::ScrollDown,
                _ => return None,
            };
            Event::Mouse(MouseEvent {
                kind,
                column: mouse.column,
                row: mouse.row,
            })
        }
        TerminalEvent::Paste(text) => Event::Paste(text),
        _ => return None,
    })
}

fn key_code(code: TerminalKey) -> Option<KeyCode> {
    Some(match code {
        TerminalKey::Char(letter) => KeyCode::Char(letter),
        TerminalKey::F(number) => KeyCode::F(number),
        TerminalKey::Enter => KeyCode::Enter,
        TerminalKey::Tab => KeyCode::Tab,
        TerminalKey::BackTab => KeyCode::BackTab,
        TerminalKey::Esc => KeyCode::Esc,
        TerminalKey::Up => KeyCode::Up,
        TerminalKey::Down => KeyCode::Down,
        TerminalKey::Left => KeyCode::Left,
        TerminalKey::Right => KeyCode::Right,
        TerminalKey::Home => KeyCode::Home,
        TerminalKey::End => KeyCode::End,
        TerminalKey::PageUp => KeyCode::PageUp,
        TerminalKey::PageDown => KeyCode::PageDown,
        TerminalKey::Backspace => KeyCode::Backspace,
        TerminalKey::Delete => KeyCode::Delete,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::{RecvTimeoutError, channel};
    use std::time::Duration;

    #[test]
    fn restoring_waits_until_the_terminal_is_taken_over() {
        static OWNED: Ownership = Ownership(Mutex::new(false));
        let (entering, entered) = (channel(), channel::<()>());
        let (sender, left) = channel();
        let taker = thread::spawn(move || {
            let enter = || {
                entering.0.send(()).unwrap();
                entered.1.recv().unwrap();
                Ok(())
            };
            OWNED.take(enter, || panic!("nothing failed")).unwrap();
        });
        entering.1.recv().unwrap();
        let giver = thread::spawn(move || drop(OWNED.give_back(|| sender.send(()).unwrap())));
        // A signal arrives while the terminal is being taken over: restoring must wait until that is complete.
        let early = left.recv_timeout(Duration::from_millis(50));
        assert_eq!(early, Err(RecvTimeoutError::Timeout));
        entered.0.send(()).unwrap();
        taker.join().unwrap();
        giver.join().unwrap();
        assert_eq!(left.try_iter().count(), 1);
        assert!(!*OWNED.lock());
    }

    #[test]
    fn a_failed_takeover_is_undone_and_a_foreign_terminal_is_left_alone() {
        let owned = Ownership(Mutex::new(false));
        let mut undone = 0;
        let failed = owned.take(|| Err(io::ErrorKind::Other.into()), || undone += 1);
        assert!(failed.is_err() && undone == 1 && !*owned.lock());
        drop(owned.give_back(|| panic!("it is not ours")));
        owned.take(|| Ok(()), || panic!("nothing failed")).unwrap();
        owned.take(|| panic!("it is ours"), || ()).unwrap();
        drop(owned.give_back(|| undone += 1));
        assert_eq!(undone, 2);
    }

    #[test]
    fn the_terminal_cannot_be_taken_while_the_process_ends() {
        static OWNED: Ownership = Ownership(Mutex::new(true));
        let ending = OWNED.give_back(|| ());
        let (sender, taken) = channel();
        let taker = thread::spawn(move || {
            let enter = || {
                sender.send(()).unwrap();
                Ok(())
            };
            OWNED.take(enter, || ())
        });
        let early = taken.recv_timeout(Duration::from_millis(50));
        assert_eq!(early, Err(RecvTimeoutError::Timeout));
        drop(ending);
        taker.join().unwrap().unwrap();
        assert!(taken.recv().is_ok());
    }
}
