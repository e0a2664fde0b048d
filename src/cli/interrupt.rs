//! Ctrl-C as a flag to look at between minor iterations.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// The signals that ask a program to end.
const SIGNALS: [i32; 2] = [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM];

/// Lets a write beyond the limit of a file's size fail like any other that fails, instead of ending the program in its midst.
pub fn let_large_writes_fail() {
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
}

/// Makes Ctrl-C end the program with the code that says so.
pub fn end_at_once() {
    let always = Arc::new(AtomicBool::new(true));
    for signal in SIGNALS {
        // Where signals cannot be caught they end the program, as they always did.
        let _ = signal_hook::flag::register_conditional_shutdown(signal, 130, always.clone());
    }
}

/// Whether somebody wants the program to end.
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Listens to Ctrl-C and requests to terminate. A second one ends the program at once.
    pub fn listen() -> Interrupt {
        let flag = Arc::new(AtomicBool::new(false));
        for signal in SIGNALS {
            // The order matters: the flag must still be down when the first signal looks at it.
            let _ = signal_hook::flag::register_conditional_shutdown(signal, 130, flag.clone());
            let _ = signal_hook::flag::register(signal, flag.clone());
        }
        Interrupt(flag)
    }

    /// Counts the first signal for an iteration at hand, too.
    pub fn count(&self, asks: &Arc<AtomicUsize>) {
        for signal in SIGNALS {
            let _ = signal_hook::flag::register_usize(signal, asks.clone(), 1);
        }
    }

    /// Whether a signal came.
    pub fn came(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
