//! Signals of a program with a terminal, as POSIX defines them.

use rustix::process::Signal;
use rustix::termios::{OptionalActions, SpecialCodeIndex, tcgetattr, tcsetattr};
use signal_hook::consts::{SIGCONT, SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGTSTP, SIGTTIN, SIGXFSZ};
use signal_hook::iterator::Handle;
use signal_hook::{SigId, flag, low_level};
use std::io::{self, stdin};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

/// Signals, as flags for an event loop.
#[derive(Debug)]
pub struct Signals {
    /// The terminating signal, or 0.
    end: Arc<AtomicUsize>,
    watch: Handle,
    stop: Arc<AtomicBool>,
    resumed: Arc<AtomicBool>,
    registered: [SigId; 2],
}

/// Time for the event loop to end after a terminating signal.
const PATIENCE: Duration = Duration::from_millis(300);

impl Signals {
    /// Installs the signal handlers. If the event loop does not end in time after a terminating signal, `restore` is called, and
    /// the process ends while its result exists.
    ///
    /// # Errors
    /// From the system.
    pub fn listen<G>(restore: fn() -> G) -> io::Result<Self>
    where
        G: 'static,
    {
        let (end, stop, resumed) = (Arc::default(), Arc::default(), Arc::default());
        let watch = watch(&end, restore)?;
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

    /// The terminating signal, if one arrived.
    pub fn end(&self) -> Option<i32> {
        match self.end.load(Ordering::SeqCst) {
            0 => None,
            signal => Some(signal as i32),
        }
    }

    /// Whether a request to stop arrived since the last call.
    pub fn stop(&self) -> bool {
        self.stop.swap(false, Ordering::SeqCst)
    }

    /// Whether the process was continued since the last call.
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

/// Waits on a separate thread for terminating signals. The event loop gets time to end by itself; it may be blocked in a write to a
/// closed terminal.
fn watch<G>(end: &Arc<AtomicUsize>, restore: fn() -> G) -> io::Result<Handle>
where
    G: 'static,
{
    let mut signals = signal_hook::iterator::Signals::new([SIGTERM, SIGINT, SIGHUP, SIGQUIT])?;
    let handle = signals.handle();
    let end = Arc::clone(end);
    thread::spawn(move || {
        if let Some(signal) = signals.forever().next() {
            end.store(signal as usize, Ordering::SeqCst);
            thread::sleep(PATIENCE);
            let _nobody_takes_it_again = restore();
            let _ = obey(signal);
        }
    });
    Ok(handle)
}

/// Ends the process as the default action of the signal would, so that the parent sees it.
///
/// # Errors
/// From the system.
pub fn obey(signal: i32) -> io::Result<()> {
    low_level::emulate_default_handler(signal)
}

/// Ends the process as if its terminal had been closed.
///
/// # Errors
/// From the system.
pub fn hang_up() -> io::Result<()> {
    obey(SIGHUP)
}

/// Stops the process until it is continued. Returns at once if no shell with job control could continue it.
///
/// The signal goes to the whole process group, as from the terminal itself on Ctrl-Z: otherwise a parent such as cargo
/// would wait endlessly, and the shell would never show its prompt. This process catches SIGTSTP, so it stops by
/// SIGTTIN: unlike SIGSTOP, the kernel ignores that signal in a process group without a shell above it (an orphaned
/// group in POSIX), where nothing would continue the process.
///
/// # Errors
/// From the system.
pub fn suspend() -> io::Result<()> {
    rustix::process::kill_current_process_group(Signal::TSTP)?;
    low_level::raise(SIGTTIN)
}

/// As [`suspend`], after a SIGTSTP from another process, which can also continue this process.
///
/// # Errors
/// From the system.
pub fn stop() -> io::Result<()> {
    rustix::process::kill_current_process_group(Signal::TSTP)?;
    low_level::emulate_default_handler(SIGTSTP)
}

/// Makes reads from the terminal return immediately when there is no input. Crossterm reads on after an incomplete or unknown
/// escape sequence, and would block the screen until the next key. Leaving raw mode restores the old setting.
///
/// # Errors
/// From the system.
pub fn read_without_waiting() -> io::Result<()> {
    let mut settings = tcgetattr(stdin())?;
    settings.special_codes[SpecialCodeIndex::VMIN] = 0;
    settings.special_codes[SpecialCodeIndex::VTIME] = 0;
    Ok(tcsetattr(stdin(), OptionalActions::Now, &settings)?)
}

/// Makes a write beyond the file size limit fail with an error instead of ending the program (SIGXFSZ).
pub fn let_large_writes_fail() {
    let _ = flag::register(SIGXFSZ, Arc::default());
}
