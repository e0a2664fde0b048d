//! What an attached solver says while one looks at something else: its warnings and errors are counted, and shown once.

use stickslip_debugger::recorded::log::How;
use stickslip_debugger::recorded::log::Log;
use stickslip_exchange::attach::message::Level;

/// What of a solver's log was heard.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Heard {
    /// Lines.
    lines: usize,
    /// Warnings among its messages.
    pub warnings: usize,
    /// Errors among its messages.
    pub errors: usize,
}

impl Heard {
    /// Hears what is new. Returns whether there is anything, and the last warning or error of it with a word before it.
    pub fn hear(&mut self, log: &Log) -> (bool, Option<String>) {
        let count = log.count();
        if count == self.lines {
            return (false, None);
        }
        let mut told = None;
        for said in log.since(self.lines) {
            match said.how {
                How::Told(Level::Warning) => self.warnings += 1,
                How::Told(Level::Error) => self.errors += 1,
                _ => continue,
            }
            told = Some(format!("{} of the solver: {}", said.how.word(), said.text));
        }
        self.lines = count;
        (true, told)
    }

    /// How many warnings and errors there were, in words; empty where there were none.
    pub fn counted(&self) -> String {
        let of = |count: usize, what: &str| match count {
            0 => None,
            1 => Some(format!("1 {what}")),
            count => Some(format!("{count} {what}s")),
        };
        let parts = [of(self.errors, "error"), of(self.warnings, "warning")];
        parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
    }
}
