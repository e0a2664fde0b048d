//! What is typed ahead of the solver: a key that asks something of a session that is at work waits for its turn, and so does
//! whatever is typed after it, so that keys typed at once lead where the same keys lead one after the other.
//!
//! What only looks around is done at once, as long as nothing waits before it. Ctrl-C, Ctrl-Z and Ctrl-L never wait.

use crate::action::{Action, Page, Question, Step, Ui};
use crate::record::command::Command;
use crate::tui::app::{App, Effect, Opens, Overlay};
use crate::tui::keys;
use crate::tui::layout::Pane;
use crate::tui::view::View;
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

impl Awaited {
    /// Until when it is waited, and what Ctrl-C does about it.
    fn until(self) -> &'static str {
        match self {
            Awaited::Run => "until the run stops; Ctrl-C interrupts it",
            Awaited::Reading => "until the file is read; Ctrl-C gives it up",
            Awaited::Finding => "until the diagnosis is found; Ctrl-C forgets it",
            Awaited::Trying => "until the remedies are tried; Ctrl-C stops that",
        }
    }
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
        let names: Vec<String> = self.queue.iter().take(NAMED).map(name).collect();
        let names = names.join(", ");
        match count {
            0 => None,
            1 => Some(format!("{names} waits {until}")),
            2..=NAMED => Some(format!("{names} wait {until}")),
            _ => Some(format!("{names} and {} more wait {until}", count - NAMED)),
        }
    }
}

impl App {
    /// What any key waits for, whatever it means: a page that is about to come is the one that it is meant for.
    pub(super) fn awaits_all(&self) -> Option<Awaited> {
        let replaced = match (self.loading, &self.overlay) {
            (Some(Opens::Page), _) => true,
            (Some(Opens::Scene), overlay) => matches!(overlay, Overlay::Chooser { .. }),
            (None, _) => false,
        };
        replaced.then_some(Awaited::Reading)
    }

    /// What an action waits for at this moment; `None` if it can be done at once.
    pub(super) fn awaits(&self, action: &Action, view: Option<&View>) -> Option<Awaited> {
        if self.loading.is_some() && !outlives_the_scene(action) {
            return Some(Awaited::Reading);
        }
        let view = view?;
        if view.running && (asks(action) || self.goes_along(action)) {
            return Some(Awaited::Run);
        }
        let chooses = matches!(action, Action::Ui(Ui::Move(_) | Ui::Repeat));
        let remedies = match action {
            Action::Ui(Ui::Apply(_)) => true,
            // Those that are being tried from here are shown at once.
            Action::Ui(Ui::Page(Page::Remedies)) => !view.tries_here(),
            _ => chooses && self.focus == Pane::Remedies,
        };
        if view.is_trying() && remedies {
            return Some(Awaited::Trying);
        }
        let finding = matches!(view.examination(), Some(None));
        let diagnosis = matches!(action, Action::Ui(Ui::StartFrom(_)))
            || (chooses && self.focus == Pane::Diagnosis);
        (finding && diagnosis).then_some(Awaited::Finding)
    }

    /// Whether an action goes along the timeline, which is the session's to do.
    fn goes_along(&self, action: &Action) -> bool {
        let along = !matches!(action, Action::Ui(Ui::Move(Step::Up | Step::Down)));
        self.focus == Pane::Timeline && matches!(action, Action::Ui(Ui::Move(_))) && along
    }

    /// Lets a key wait that has a meaning, behind its count.
    pub(super) fn put_off_key(&mut self, name: &str, count: Option<u32>, awaited: Awaited) {
        let digits = count.map_or(String::new(), |count| count.to_string());
        let names = digits.chars().map(String::from).chain([name.to_owned()]);
        for key in names.filter_map(|name| keys::press(&name)) {
            self.ahead.push(Typed::Key(key), Some(awaited));
        }
    }

    /// Does the first of what waits. `None` if nothing waits, or if it still must.
    pub fn resume(&mut self, view: Option<&View>) -> Option<Option<Effect>> {
        if self.awaits_all().is_some() {
            return None;
        }
        let first = self.ahead.queue.pop_front()?;
        let rest = std::mem::take(&mut self.ahead.queue);
        let said = self.message.clone();
        let effect = match first {
            Typed::Key(key) => self.take_key(&key, view),
            Typed::Line(line) => self.take_line(&line, view),
            Typed::Paste(text) => {
                self.take_paste(&text);
                None
            }
        };
        let waits = self.ahead.is_any();
        self.ahead.queue.extend(rest);
        self.ahead.full &= self.ahead.queue.len() >= MOST;
        if waits {
            self.message = said;
            return None;
        }
        Some(effect)
    }
}

/// Whether an action asks something of the session, or changes it.
fn asks(action: &Action) -> bool {
    match action {
        Action::Session(_) => true,
        Action::Ui(ui) => matches!(
            ui,
            Ui::Repeat
                | Ui::Page(Page::Diagnosis | Page::Remedies)
                | Ui::StartFrom(_)
                | Ui::Apply(_)
                | Ui::Chart(_)
                | Ui::Open(_)
                | Ui::Lesson(_)
                | Ui::On
                | Ui::Answer(_)
                | Ui::Predict(_)
                | Ui::Ask(Question::Mode | Question::Increment | Question::Answer)
        ),
    }
}

/// Whether an action means the same before another scene is shown and after.
fn outlives_the_scene(action: &Action) -> bool {
    match action {
        Action::Session(command) => matches!(command, Command::Journal(None)),
        Action::Ui(ui) => matches!(
            ui,
            Ui::NextPane
                | Ui::PreviousPane
                | Ui::Zoom
                | Ui::Explain
                | Ui::Page(Page::Timeline)
                | Ui::Sort(_)
                | Ui::SortBackward
                | Ui::Filter(_)
                | Ui::Ask(Question::Node | Question::Break | Question::Lesson)
                | Ui::CommandLine
                | Ui::Help
                | Ui::Keys
                | Ui::Colours(_)
                | Ui::Mouse(_)
                | Ui::Manual(_)
                | Ui::Cancel
                | Ui::Interrupt
                | Ui::Redraw
                | Ui::Suspend
                | Ui::Quit
        ),
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
