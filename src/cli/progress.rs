//! The progress line of `stickslip run` on a terminal.

use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};
use stickslip_core::{Event, Model, State, counted};
use stickslip_debugger::explain::names;

/// Interval between two progress lines.
const INTERVAL: Duration = Duration::from_millis(100);

/// Progress line on a terminal.
pub struct Progress {
    wanted: bool,
    shown: bool,
    last: Instant,
}

impl Progress {
    /// Shows nothing with `quiet`, or if standard error is not a terminal.
    pub fn new(quiet: bool) -> Self {
        Progress {
            wanted: !quiet && io::stderr().is_terminal(),
            shown: false,
            last: Instant::now(),
        }
    }

    /// Shows an event, at most once per [`INTERVAL`]; `steps` is the number of minor iterations so far.
    pub fn show(&mut self, model: &Model, state: &State, event: &Event, steps: u64) {
        if !self.wanted || self.last.elapsed() < INTERVAL {
            return;
        }
        let at = names::position(event.position);
        let load = names::load_of(model, state.start.leg, event.load_factor);
        let _ = write!(
            io::stderr(),
            "\r\x1b[K{load}: {at}; {} so far",
            counted(steps, "minor iteration")
        );
        (self.shown, self.last) = (true, Instant::now());
    }

    /// Removes the line.
    pub fn clear(&mut self) {
        if self.shown {
            let _ = write!(io::stderr(), "\r\x1b[K");
            self.shown = false;
        }
    }
}
