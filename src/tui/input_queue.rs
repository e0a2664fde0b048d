//! The type-ahead queue: while the session is busy, a key that needs it is queued, and so is everything typed after it, in order.
//!
//! Keys that only change the view are handled at once if the queue is empty. Ctrl-C, Ctrl-Z and Ctrl-L are never queued.

use crate::event::KeyEvent;
use crate::keys;
use std::collections::VecDeque;

/// Maximum length of the queue; only a key that is held down exceeds it.
const MOST: usize = 1024;
/// Maximum number of queued inputs that [`Ahead::note`] names.
const NAMED: usize = 3;

/// Queued input.
#[derive(Debug, Clone, PartialEq)]
pub enum QueuedInput {
    /// A key.
    Key(KeyEvent),
    /// A complete line.
    Line(String),
    /// Pasted text.
    Paste(String),
}

stickslip_core::words! {
    /// What the queue waits for.
    pub enum WaitReason, until {
        /// The end of a run.
        Run "until the run stops; Ctrl-C interrupts it",
        /// A file to be loaded.
        Reading "until the file is loaded; Ctrl-C cancels",
        /// The diagnosis of the shown state.
        Finding "until the diagnosis is ready; Ctrl-C cancels",
        /// The trials of all remedies.
        Trying "until all remedies are tried; Ctrl-C stops them",
    }
}

/// The queue, oldest input first.
#[derive(Debug, Clone, Default)]
pub struct Ahead {
    queue: VecDeque<QueuedInput>,
    awaited: Option<WaitReason>,
    full: bool,
}

impl Ahead {
    /// Whether the queue has any input.
    pub fn is_any(&self) -> bool {
        !self.queue.is_empty()
    }

    /// Empties the queue.
    pub fn forget(&mut self) {
        *self = Ahead::default();
    }

    /// Appends an input to the queue.
    pub(super) fn push(&mut self, typed: QueuedInput, awaited: Option<WaitReason>) {
        self.awaited = awaited.or(self.awaited);
        self.full = self.queue.len() >= MOST;
        if !self.full {
            self.queue.push_back(typed);
        }
    }

    /// Takes the whole queue: the first input and the rest.
    pub(super) fn take_first(&mut self) -> Option<(QueuedInput, VecDeque<QueuedInput>)> {
        let first = self.queue.pop_front()?;
        Some((first, std::mem::take(&mut self.queue)))
    }

    /// Appends inputs to the queue again.
    pub(super) fn put_back(&mut self, rest: VecDeque<QueuedInput>) {
        self.queue.extend(rest);
        self.full &= self.queue.len() >= MOST;
    }

    /// One line that names the queued inputs and what they wait for; `None` if the queue is empty.
    pub fn note(&self) -> Option<String> {
        let count = self.queue.len();
        let until = self.awaited.unwrap_or(WaitReason::Run).until();
        if self.full {
            return Some(format!(
                "{count} keys wait {until}; further keys are ignored"
            ));
        }
        let all = count <= NAMED + 1;
        let named = if all { count } else { NAMED };
        let names: Vec<String> = self
            .queue
            .iter()
            .take(named)
            .map(|typed| match typed {
                QueuedInput::Key(key) => keys::name(key).unwrap_or_default(),
                QueuedInput::Line(line) => format!(":{line}"),
                QueuedInput::Paste(_) => "pasted text".into(),
            })
            .collect();
        let names = names.join(", ");
        match count {
            0 => None,
            1 => Some(format!("{names} waits {until}")),
            _ if all => Some(format!("{names} wait {until}")),
            _ => Some(format!("{names} and {} more wait {until}", count - NAMED)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_waits_is_named_and_bounded() {
        let mut ahead = Ahead::default();
        assert_eq!(ahead.note(), None);
        let key = |name| QueuedInput::Key(keys::press(name).unwrap());
        ahead.push(key("d"), Some(WaitReason::Run));
        let until = "until the run stops; Ctrl-C interrupts it";
        assert_eq!(ahead.note(), Some(format!("d waits {until}")));
        ahead.push(QueuedInput::Line("census".into()), None);
        assert_eq!(ahead.note(), Some(format!("d, :census wait {until}")));
        for _ in 0..3 {
            ahead.push(key("s"), None);
        }
        assert_eq!(
            ahead.note(),
            Some(format!("d, :census, s and 2 more wait {until}"))
        );
        for _ in 0..2 * MOST {
            ahead.push(key("s"), None);
        }
        assert_eq!(ahead.queue.len(), MOST);
        assert!(
            ahead
                .note()
                .unwrap()
                .ends_with("; further keys are ignored")
        );
        ahead.forget();
        assert_eq!(ahead.note(), None);
    }
}
