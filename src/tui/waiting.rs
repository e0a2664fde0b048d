//! Decides which keys and lines are queued while the session is busy, and handles the queue.

use crate::app::{App, Effect, LoadTarget, Overlay};
use crate::input_queue::{QueuedInput, WaitReason};
use crate::keys;
use crate::layout::Pane;
use crate::view::View;
use stickslip_debugger::action::{Action, Page, Step, Ui};

impl App {
    /// What every key waits for, whatever its action: a page that is about to open is meant to receive it.
    pub(super) fn awaits_all(&self) -> Option<WaitReason> {
        let replaced = match (self.loading, &self.overlay) {
            (Some(LoadTarget::Page), _) => true,
            (Some(LoadTarget::Scene), overlay) => matches!(overlay, Overlay::Chooser(_)),
            (None, _) => false,
        };
        replaced.then_some(WaitReason::Reading)
    }

    /// What an action waits for now; `None` if it can be carried out at once.
    pub(super) fn awaits(&self, action: &Action, view: Option<&View>) -> Option<WaitReason> {
        if self.loading.is_some() && !action.outlives_the_scene() {
            return Some(WaitReason::Reading);
        }
        let view = view?;
        // The session moves along the timeline.
        let goes_along = self.panes.focus == Pane::Timeline
            && matches!(action, Action::Ui(Ui::Move(step)) if !matches!(step, Step::Up | Step::Down));
        if view.running && (action.asks() || goes_along) {
            return Some(WaitReason::Run);
        }
        let chooses = matches!(action, Action::Ui(Ui::Move(_) | Ui::Repeat));
        let remedies = match action {
            Action::Ui(Ui::Apply(_)) => true,
            // Trials that start from the shown state are visible at once.
            Action::Ui(Ui::Page(Page::Remedies)) => !view.tries_here(),
            _ => chooses && self.panes.focus == Pane::Remedies,
        };
        if view.is_trying() && remedies {
            return Some(WaitReason::Trying);
        }
        let found = view.examination()?;
        let scrolls = matches!(action, Action::Ui(Ui::Move(Step::PageUp | Step::PageDown)));
        let awaited = match action {
            Action::Ui(Ui::StartFrom(_)) => found.is_none(),
            // Trials change the order of the lines of Try.
            _ if chooses && !scrolls && self.panes.focus == Pane::Diagnosis => {
                found.is_none_or(|page| !page.is_complete())
            }
            _ => false,
        };
        awaited.then_some(WaitReason::Finding)
    }

    /// Queues a bound key after its count.
    pub(super) fn put_off_key(&mut self, name: &str, count: Option<u32>, awaited: WaitReason) {
        let digits = count.map(|count| count.to_string()).unwrap_or_default();
        for key in digits
            .chars()
            .map(String::from)
            .chain([name.to_owned()])
            .filter_map(|name| keys::press(&name))
        {
            self.ahead.push(QueuedInput::Key(key), Some(awaited));
        }
    }

    /// Handles the first queued input. `None` if the queue is empty or still has to wait.
    pub fn resume(&mut self, view: Option<&View>) -> Option<Option<Effect>> {
        if self.awaits_all().is_some() {
            return None;
        }
        let (first, rest) = self.ahead.take_first()?;
        let said = self.message.clone();
        let effect = match first {
            QueuedInput::Key(key) => self.take_key(&key, view),
            QueuedInput::Line(line) => self.take_line(&line, view),
            QueuedInput::Paste(text) => {
                self.take_paste(&text);
                None
            }
        };
        let waits = self.ahead.is_any();
        self.ahead.put_back(rest);
        if waits {
            self.message = said;
            return None;
        }
        Some(effect)
    }
}
