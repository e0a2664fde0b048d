//! Counts the warnings and errors in an attached solver's log, and announces the last new one once.

use stickslip_core::counted;
use stickslip_debugger::Log;
use stickslip_debugger::recorded::log::LogOrigin;
use stickslip_exchange::attach::message::Level;
use stickslip_scene::joined;

/// How much of a solver's log has been counted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct LogCounts {
    /// Lines counted so far.
    lines: usize,
    /// Number of warnings.
    pub warnings: usize,
    /// Number of errors.
    pub errors: usize,
}

impl LogCounts {
    /// Counts the new lines. Returns whether there are any, and the last warning or error among them, with its level.
    pub fn count(&mut self, log: &Log) -> (bool, Option<String>) {
        let count = log.count();
        if count == self.lines {
            return (false, None);
        }
        let mut last = None;
        for said in log.since(self.lines) {
            match said.how {
                LogOrigin::Message(Level::Warning) => self.warnings += 1,
                LogOrigin::Message(Level::Error) => self.errors += 1,
                _ => continue,
            }
            last = Some(format!("solver {}: {}", said.how.word(), said.text));
        }
        self.lines = count;
        (true, last)
    }

    /// The number of warnings and errors in words; empty if there are none.
    pub fn words(&self) -> String {
        let of = |count: usize, what: &str| (count > 0).then(|| counted(count, what));
        let parts = [of(self.errors, "error"), of(self.warnings, "warning")];
        joined(parts.into_iter().flatten(), ", ")
    }
}
