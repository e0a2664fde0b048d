//! What an attached solver said besides: its messages, and its standard error; and the whole exchange in a file, where it is kept.

use std::collections::VecDeque;
use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use stickslip_exchange::attach::conversation::SEALED_HEAD;
use stickslip_exchange::attach::message::Level;
use stickslip_exchange::attach::{Kept, Side};
use stickslip_scene::shown;

/// Most lines that are kept to be shown.
const MOST_LINES: usize = 10_000;
/// Most characters of a line that are shown.
const MOST_CHARS: usize = 2_000;

/// A line of the log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Said {
    /// How it was said.
    pub how: How,
    /// The line, in what a terminal can be given.
    pub text: String,
}

/// How something was said.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum How {
    /// On its standard error.
    Printed,
    /// In a message.
    Told(Level),
    /// By this program: it was started, gone back, lost.
    Noted,
}

impl How {
    /// A word for it, as the page `:log` has it.
    pub fn word(self) -> &'static str {
        match self {
            How::Printed => "stderr",
            How::Told(Level::Info) => "info",
            How::Told(Level::Warning) => "warning",
            How::Told(Level::Error) => "error",
            How::Noted => "note",
        }
    }
}

/// A handle of the log; all handles are of one.
#[derive(Debug, Clone, Default)]
pub struct Log(Arc<Mutex<Inner>>);

#[derive(Debug, Default)]
struct Inner {
    lines: VecDeque<Said>,
    /// Lines that there were, those that are gone included.
    count: usize,
    kept: Option<File>,
    /// Why the exchange is kept no more although it should be.
    lost: Option<String>,
}

impl Log {
    /// Keeps the exchange in a file from now on.
    ///
    /// # Errors
    /// If it exists and may not be overwritten, or cannot be written.
    pub fn keep(&self, path: &Path, overwrite: bool) -> std::io::Result<()> {
        let mut options = File::options();
        options.write(true).append(!overwrite).truncate(overwrite);
        match overwrite {
            true => options.create(true),
            false => options.create_new(true),
        };
        let mut file = options.open(path)?;
        file.write_all(format!("{SEALED_HEAD}\n").as_bytes())?;
        self.with(|inner| inner.kept = Some(file));
        Ok(())
    }

    /// A line of the exchange, as it went.
    pub fn exchanged(&self, side: Side, text: &str) {
        self.with(|inner| inner.write(side, text));
    }

    /// A line of its standard error.
    pub fn printed(&self, line: &str) {
        self.with(|inner| {
            inner.write(Side::Logged, line);
            inner.push(How::Printed, line);
        });
    }

    /// A message of it.
    pub fn told(&self, level: Level, text: &str) {
        self.with(|inner| {
            text.lines()
                .for_each(|line| inner.push(How::Told(level), line))
        });
    }

    /// Something that happened.
    pub fn noted(&self, text: &str) {
        self.with(|inner| {
            inner.write(Side::Noted, text);
            inner.push(How::Noted, text);
        });
    }

    /// The lines that are left, and the number of the first of them, from 0.
    pub fn lines(&self) -> (usize, Vec<Said>) {
        self.with(|inner| {
            (
                inner.count - inner.lines.len(),
                inner.lines.iter().cloned().collect(),
            )
        })
    }

    /// The lines from a number on, as far as they are left.
    pub fn since(&self, number: usize) -> Vec<Said> {
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

    /// How many lines there have been.
    pub fn count(&self) -> usize {
        self.with(|inner| inner.count)
    }

    /// The last line of its standard error.
    pub fn last_printed(&self) -> Option<String> {
        self.with(|inner| {
            let mut lines = inner.lines.iter().rev();
            let printed =
                lines.find(|said| said.how == How::Printed && !said.text.trim().is_empty());
            printed.map(|said| said.text.trim().to_owned())
        })
    }

    /// Why the exchange is kept no more although it should be; once.
    pub fn lost(&self) -> Option<String> {
        self.with(|inner| inner.lost.take())
    }

    fn with<T>(&self, with: impl FnOnce(&mut Inner) -> T) -> T {
        // No thread panics while it holds the lock; were it so, lines are lines all the same.
        with(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Inner {
    fn push(&mut self, how: How, line: &str) {
        if self.lines.len() == MOST_LINES {
            self.lines.pop_front();
        }
        let text = shown::cut(&shown::line(&plain(line)), MOST_CHARS);
        self.lines.push_back(Said { how, text });
        self.count += 1;
    }

    fn write(&mut self, side: Side, text: &str) {
        let Some(file) = &mut self.kept else {
            return;
        };
        if let Err(error) = file.write_all(Kept::line(side, text).as_bytes()) {
            self.lost = Some(format!("the exchange is not kept any more: {error}"));
            self.kept = None;
        }
    }
}

/// A line without what was meant for a terminal: colours and the like are left out, a tab is two blanks.
fn plain(line: &str) -> String {
    let mut text = String::with_capacity(line.len());
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            '\u{1b}' if letters.next_if_eq(&'[').is_some() => {
                // Parameters, up to the letter that says what they are of.
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
    fn colours_are_left_out_and_other_orders_are_shown() {
        assert_eq!(plain("\u{1b}[1m\u{1b}[31mMax\u{1b}[0m\tend"), "Max  end");
        assert_eq!(plain("\u{1b}]0;title"), "\u{1b}]0;title");
        assert_eq!(plain("cut \u{1b}[3"), "cut ");
    }
}
