//! The log of an attached solver: its messages and its standard error; also stores the whole exchange in a
//! file, on request.

use std::collections::VecDeque;
use std::io::Write;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use stickslip_exchange::attach::conversation::SEALED_HEAD;
use stickslip_exchange::attach::message::Level;
use stickslip_exchange::attach::{Side, TranscriptLine};
use stickslip_platform::disk::File;
use stickslip_scene::shown;

/// Maximum number of lines kept for display.
const MOST_LINES: usize = 10_000;
/// Maximum number of characters displayed of a line.
const MOST_CHARS: usize = 2_000;

/// A line of the log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LogLine {
    /// Source of the line.
    pub how: LogOrigin,
    /// The line, safe to print to a terminal.
    pub text: String,
}

/// Source of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LogOrigin {
    /// Standard error of the solver.
    Printed,
    /// A message of the solver.
    Message(Level),
    /// A remark of this program, for example that the solver was started or lost.
    Noted,
}

impl LogOrigin {
    /// The word for the source on the page `:log`.
    pub fn word(self) -> &'static str {
        match self {
            LogOrigin::Printed => "stderr",
            LogOrigin::Message(Level::Info) => "info",
            LogOrigin::Message(Level::Warning) => "warning",
            LogOrigin::Message(Level::Error) => "error",
            LogOrigin::Noted => "note",
        }
    }
}

/// Handle of the log; all clones share it.
#[derive(Debug, Clone, Default)]
pub struct Log(Arc<Mutex<LogContents>>);

#[derive(Debug, Default)]
struct LogContents {
    lines: VecDeque<LogLine>,
    /// Number of lines so far, including dropped ones.
    count: usize,
    kept: Option<File>,
    /// Why the exchange can no longer be stored.
    lost: Option<String>,
    /// How far the solver is with the current request.
    progress: Option<String>,
}

impl Log {
    /// Stores the exchange in a file from now on.
    ///
    /// # Errors
    /// If the file exists and may not be overwritten, or cannot be written.
    pub fn keep(&self, path: &Path, overwrite: bool) -> std::io::Result<()> {
        let mut file = File::options()
            .write(true)
            .append(!overwrite)
            .truncate(overwrite)
            .create(overwrite)
            .create_new(!overwrite)
            .open(path)?;
        file.write_all(format!("{SEALED_HEAD}\n").as_bytes())?;
        self.with(|inner| inner.kept = Some(file));
        Ok(())
    }

    /// Adds a line of the exchange, verbatim.
    pub fn exchanged(&self, side: Side, text: &str) {
        self.with(|inner| inner.write(side, text));
    }

    /// Adds a line of the solver's standard error.
    pub fn printed(&self, line: &str) {
        self.with(|inner| {
            inner.write(Side::Logged, line);
            inner.push(LogOrigin::Printed, line);
        });
    }

    /// Adds a message of the solver.
    pub fn message(&self, level: Level, text: &str) {
        self.with(|inner| {
            text.lines()
                .for_each(|line| inner.push(LogOrigin::Message(level), line))
        });
    }

    /// Sets how far the solver is with the current request.
    pub fn set_progress(&self, progress: Option<String>) {
        self.with(|inner| inner.progress = progress);
    }

    /// How far the solver is with the current request, if it reports that.
    pub fn progress(&self) -> Option<String> {
        self.with(|inner| inner.progress.clone())
    }

    /// Adds a remark of this program.
    pub fn noted(&self, text: &str) {
        self.with(|inner| {
            inner.write(Side::Noted, text);
            inner.push(LogOrigin::Noted, text);
        });
    }

    /// The lines kept, and the number of the first one, counted from 0.
    pub fn lines(&self) -> (usize, Vec<LogLine>) {
        self.with(|inner| {
            (
                inner.count - inner.lines.len(),
                inner.lines.iter().cloned().collect(),
            )
        })
    }

    /// The lines from a number on, if they are still kept.
    pub fn since(&self, number: usize) -> Vec<LogLine> {
        self.with(|inner| {
            let gone = inner.count - inner.lines.len();
            inner
                .lines
                .iter()
                .skip(number.saturating_sub(gone))
                .cloned()
                .collect()
        })
    }

    /// Number of lines so far.
    pub fn count(&self) -> usize {
        self.with(|inner| inner.count)
    }

    /// The last line of the solver's standard error.
    pub fn last_printed(&self) -> Option<String> {
        self.with(|inner| {
            let mut lines = inner.lines.iter().rev();
            let printed =
                lines.find(|said| said.how == LogOrigin::Printed && !said.text.trim().is_empty());
            printed.map(|said| said.text.trim().to_owned())
        })
    }

    /// Why the exchange can no longer be stored; returned once.
    pub fn lost(&self) -> Option<String> {
        self.with(|inner| inner.lost.take())
    }

    fn with<T>(&self, with: impl FnOnce(&mut LogContents) -> T) -> T {
        // Even after a panic in another thread, the lines are valid.
        with(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl LogContents {
    fn push(&mut self, how: LogOrigin, line: &str) {
        if self.lines.len() == MOST_LINES {
            self.lines.pop_front();
        }
        let text = shown::cut(&shown::line(&plain(line)), MOST_CHARS);
        self.lines.push_back(LogLine { how, text });
        self.count += 1;
    }

    fn write(&mut self, side: Side, text: &str) {
        let Some(file) = &mut self.kept else {
            return;
        };
        if let Err(error) = file.write_all(TranscriptLine::line(side, text).as_bytes()) {
            self.lost = Some(format!("the exchange is no longer stored: {error}"));
            self.kept = None;
        }
    }
}

/// Removes terminal control sequences such as colours; a tab becomes two spaces.
fn plain(line: &str) -> String {
    let mut text = String::with_capacity(line.len());
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            '\u{1b}' if letters.next_if_eq(&'[').is_some() => {
                // Skip the parameters, up to the final letter of the sequence.
                letters.by_ref().find(|c| ('@'..='~').contains(c));
            }
            '\t' => text.push_str("  "),
            letter => text.push(letter),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_removed_and_other_sequences_escaped() {
        assert_eq!(plain("\u{1b}[1m\u{1b}[31mMax\u{1b}[0m\tend"), "Max  end");
        assert_eq!(plain("\u{1b}]0;title"), "\u{1b}]0;title");
        assert_eq!(plain("cut \u{1b}[3"), "cut ");
    }
}
