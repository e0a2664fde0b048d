//! The lesson on the screen: paging through text that does not fit, and answering its questions.

use crate::app::{App, Effect, Overlay};
use crate::layout::Pane;
use crate::learning::NO_LESSON;
use crate::learning::VisibleLines;
use crate::panes::lesson;
use crate::screen;
use crate::view::View;
use stickslip_debugger::Tutor;
use stickslip_debugger::action::HiddenDecisions;
use stickslip_debugger::refusal::Refusal;

impl App {
    /// Shows the next part of the lesson's text, or continues if all of it has been shown: with the next step, or after the last one
    /// with the next lesson.
    pub(super) fn continue_lesson(&mut self, view: Option<&View>) -> Option<Effect> {
        let visible = self.lesson_lines(view);
        self.learning.note(visible);
        if let Some(lines) = visible.filter(|_| self.learning.is_unread(visible)) {
            if lines.to == 0 {
                // On a tiny screen the lesson replaces the table.
                self.panes.zoomed = false;
                self.panes.look_at(Pane::Nodes);
            } else {
                let reading = &mut self.learning.reading;
                reading.top = lines.to.min(reading.seen);
            }
            let visible = self.lesson_lines(view);
            self.learning.note(visible);
            self.say("");
            return None;
        }
        let next = self.learning.lesson.as_ref().and_then(Tutor::next_lesson);
        if let Some(next) = next {
            return Some(Effect::Lesson(next.into()));
        }
        let continued = match (&mut self.learning.lesson, view) {
            (Some(tutor), Some(view)) => tutor.on(view.cursor, view.frame()),
            _ => Err(Refusal::new(NO_LESSON)),
        };
        self.report(continued.map(|()| String::new()));
        None
    }

    /// Shows the lesson text from the top.
    pub(super) fn reread(&mut self) {
        match &self.learning.lesson {
            Some(_) => self.learning.reading.top = 0,
            None => self.complain(NO_LESSON),
        }
    }

    /// Answers the lesson's question, or checks a prediction.
    pub(super) fn answer(&mut self, word: &str, view: Option<&View>) {
        let Some(view) = view else {
            return self.complain("open a scene first");
        };
        if let Err(why) = self.learning.check_read(self.lesson_lines(Some(view))) {
            return self.complain(why);
        }
        let answered = self.learning.answer(word, self.selected, view);
        self.report(answered);
    }

    /// Switches prediction mode.
    pub(super) fn predict(&mut self, whose: Option<HiddenDecisions>, view: Option<&View>) {
        let switched = match view {
            Some(view) => self.learning.predict(whose, view),
            None => Err("open a scene first".into()),
        };
        self.report(switched);
    }

    /// The visible part of the lesson, if the screen size is known.
    pub(super) fn lesson_lines(&self, view: Option<&View>) -> Option<VisibleLines> {
        let tutor = self.learning.lesson.as_ref()?;
        let covered = matches!(
            self.overlay,
            Overlay::Text(_) | Overlay::Chooser(_) | Overlay::Chart(_)
        );
        if self.area.is_empty() || covered {
            return None;
        }
        let places = screen::places(self, view, self.area);
        let place = places.panes.iter().find(|(pane, _)| *pane == Pane::Lesson);
        let (width, room) = match place {
            Some((_, area)) => lesson::room(*area, tutor, &self.theme),
            None => (usize::from(self.area.width.saturating_sub(2)), 0),
        };
        let all = lesson::tutor_lines(tutor, width, &self.theme).len();
        let from = lesson::top(self, tutor, width, room);
        let to = if room == 0 { 0 } else { (from + room).min(all) };
        Some(VisibleLines { from, to, all })
    }
}
