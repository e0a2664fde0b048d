//! Signals of a program with a console. Windows has no job control: nothing suspends the program.

use signal_hook::consts::SIGTERM;
use signal_hook::{SigId, flag, low_level};
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Signals, as flags for an event loop.
#[derive(Debug)]
pub struct Signals {
    end: Arc<AtomicBool>,
    registered: SigId,
}

impl Signals {
    /// Installs the signal handlers.
    ///
    /// # Errors
    /// From the system.
    pub fn listen<G>(_: fn() -> G) -> io::Result<Self> {
        let end = Arc::default();
        let registered = flag::register(SIGTERM, Arc::clone(&end))?;
        Ok(Signals { end, registered })
    }

    /// The terminating signal, if one arrived.
    pub fn end(&self) -> Option<i32> {
        self.end.load(Ordering::SeqCst).then_some(SIGTERM)
    }

    /// False.
    pub fn stop(&self) -> bool {
        false
    }

    /// False.
    pub fn resumed(&self) -> bool {
        false
    }
}

impl Drop for Signals {
    fn drop(&mut self) {
        low_level::unregister(self.registered);
    }
}

/// Ends the process as the default action of the signal would.
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
    obey(SIGTERM)
}

/// Does nothing.
///
/// # Errors
/// Never.
pub fn suspend() -> io::Result<()> {
    Ok(())
}

/// Does nothing.
///
/// # Errors
/// Never.
pub fn stop() -> io::Result<()> {
    Ok(())
}

/// Does nothing: crossterm reads events, not bytes.
///
/// # Errors
/// Never.
pub fn read_without_waiting() -> io::Result<()> {
    Ok(())
}

/// Does nothing: writes beyond a limit always fail with an error.
pub fn let_large_writes_fail() {}
