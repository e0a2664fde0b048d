//! Ctrl-C as a flag that is checked between minor iterations.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// The signals that request the end of the program.
const SIGNALS: [i32; 2] = [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM];

/// Makes Ctrl-C end the program at once, with exit code 130.
pub fn end_at_once() {
    let always = Arc::new(AtomicBool::new(true));
    for signal in SIGNALS {
        // If the handler cannot be installed, the signal ends the program with its default action.
        let _ = signal_hook::flag::register_conditional_shutdown(signal, 130, always.clone());
    }
}

/// The flag, and the requests to stop for an attached solver: SIGINT interrupts its iteration, SIGTERM ends it.
pub struct Interrupt(Arc<AtomicBool>, Arc<AtomicUsize>);

impl Interrupt {
    /// Installs the signal handlers. A second signal ends the program at once.
    pub fn listen() -> Interrupt {
        let flag = Arc::new(AtomicBool::new(false));
        for signal in SIGNALS {
            // The order matters: the flag must still be unset when the first signal checks it.
            let _ = signal_hook::flag::register_conditional_shutdown(signal, 130, flag.clone());
            let _ = signal_hook::flag::register(signal, flag.clone());
        }
        let asks = Arc::new(AtomicUsize::new(0));
        for (signal, count) in SIGNALS.into_iter().zip([1, usize::MAX]) {
            let _ = signal_hook::flag::register_usize(signal, asks.clone(), count);
        }
        Interrupt(flag, asks)
    }

    /// The number of requests to stop.
    pub fn asks(&self) -> Arc<AtomicUsize> {
        self.1.clone()
    }

    /// Whether a signal has arrived.
    pub fn has_arrived(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
