//! What is typed ahead of the solver: a key that asks something of a session that is at work waits for its turn, and so does
//! whatever is typed after it, so that keys typed at once lead where the same keys lead one after the other.
//!
//! What only looks around is done at once, as long as nothing waits before it. Ctrl-C, Ctrl-Z and Ctrl-L never wait.

use crate::keys;
use crossterm::event::KeyEvent;
use std::collections::VecDeque;

/// Most that waits; more comes only from a key that is held down.
const MOST: usize = 1024;
/// Most of it that is named.
const NAMED: usize = 3;

/// Something that was typed and is not done yet.
#[derive(Debug, Clone, PartialEq)]
pub enum Typed {
    /// A key.
    Key(KeyEvent),
    /// A line that was typed to its end.
    Line(String),
    /// A text that was pasted.
    Paste(String),
}

/// What is waited for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Awaited {
    /// The end of a run.
    Run,
    /// A file that is being read.
    Reading,
    /// The diagnosis of the shown state.
    Finding,
    /// The trials of all remedies.
    Trying,
}

stickslip_core::words! {
    Awaited, until:
    Run "until the run stops; Ctrl-C interrupts it",
    Reading "until the file is read; Ctrl-C gives it up",
    Finding "until the diagnosis is found; Ctrl-C forgets it",
    Trying "until the remedies are tried; Ctrl-C stops that",
}

/// What waits, oldest first.
#[derive(Debug, Clone, Default)]
pub struct Ahead {
    queue: VecDeque<Typed>,
    awaited: Option<Awaited>,
    full: bool,
}

impl Ahead {
    /// Whether anything waits.
    pub fn is_any(&self) -> bool {
        !self.queue.is_empty()
    }

    /// Forgets all of it.
    pub fn forget(&mut self) {
        *self = Ahead::default();
    }

    /// Lets something wait, behind what waits already.
    pub(super) fn push(&mut self, typed: Typed, awaited: Option<Awaited>) {
        self.awaited = awaited.or(self.awaited);
        self.full = self.queue.len() >= MOST;
        if !self.full {
            self.queue.push_back(typed);
        }
    }

    /// Takes the first out, and the rest behind it.
    pub(super) fn take_first(&mut self) -> Option<(Typed, VecDeque<Typed>)> {
        let first = self.queue.pop_front()?;
        Some((first, std::mem::take(&mut self.queue)))
    }

    /// Puts the rest behind what waits again.
    pub(super) fn put_back(&mut self, rest: VecDeque<Typed>) {
        self.queue.extend(rest);
        self.full &= self.queue.len() >= MOST;
    }

    /// What waits and for what, in a line; `None` if nothing does.
    pub fn note(&self) -> Option<String> {
        let count = self.queue.len();
        let until = self.awaited.unwrap_or(Awaited::Run).until();
        if self.full {
            return Some(format!(
                "{count} keys wait {until}; no more are taken before"
            ));
        }
        let name = |typed: &Typed| match typed {
            Typed::Key(key) => keys::name(key).unwrap_or_default(),
            Typed::Line(line) => format!(":{line}"),
            Typed::Paste(_) => "what was pasted".into(),
        };
        let all = count <= NAMED + 1;
        let named = if all { count } else { NAMED };
        let names: Vec<String> = self.queue.iter().take(named).map(name).collect();
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
        let key = |name| Typed::Key(keys::press(name).unwrap());
        ahead.push(key("d"), Some(Awaited::Run));
        let until = "until the run stops; Ctrl-C interrupts it";
        assert_eq!(ahead.note(), Some(format!("d waits {until}")));
        ahead.push(Typed::Line("census".into()), None);
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
                .ends_with("; no more are taken before")
        );
        ahead.forget();
        assert_eq!(ahead.note(), None);
    }
}
