//! Reading a lesson on a screen that is too small for its words: they are turned page by page, and the lesson does not go on
//! before all of them were shown.

use crate::app::{App, Overlay};
use crate::layout::Pane;
use crate::panes::lesson;
use crate::screen;
use crate::view::View;
use stickslip_debugger::teach::refusal::NotNow;

/// What of a lesson's page is to be seen.
struct Shown {
    /// The first line, and the one after the last.
    from: usize,
    to: usize,
    /// All lines.
    all: usize,
}

impl App {
    /// Notes what of the lesson stands on the screen, before a key does anything.
    pub(super) fn note_reading(&mut self, view: Option<&View>) {
        let (Some(shown), Some(tutor)) = (self.lesson_shown(view), &self.lesson) else {
            return;
        };
        let (now, then) = (tutor.edition(), self.reading.edition);
        let before = match now.0 == then.0 {
            true if now.1 == then.1 => self.reading.seen,
            // What stands before an answer was read before the answer was given.
            true => self.reading.seen.min(shown.from),
            false => 0,
        };
        self.reading.edition = tutor.edition();
        self.reading.top = shown.from;
        // A line that was jumped over was not read.
        self.reading.seen = match shown.from <= before {
            true => before.max(shown.to),
            false => before,
        };
    }

    /// Whether the lesson says more than was shown until now.
    pub(super) fn is_unread(&self, view: Option<&View>) -> bool {
        let (Some(shown), Some(tutor)) = (self.lesson_shown(view), &self.lesson) else {
            return false;
        };
        let same = self.reading.edition == tutor.edition();
        let seen = if same { self.reading.seen } else { shown.to };
        seen < shown.all
    }

    /// Shows the next part of what the lesson says; false if all of it was shown.
    pub(super) fn turn_page(&mut self, view: Option<&View>) -> bool {
        self.note_reading(view);
        if !self.is_unread(view) {
            return false;
        }
        let Some(shown) = self.lesson_shown(view) else {
            return false;
        };
        if shown.to == 0 {
            // Where there is one pane at a time, the lesson stands in the place of the table.
            self.zoomed = false;
            self.look_at(Pane::Nodes);
        } else {
            self.reading.top = shown.to.min(self.reading.seen);
        }
        self.note_reading(view);
        true
    }

    /// Shows what the lesson says from its beginning on.
    pub(super) fn reread(&mut self) {
        match &self.lesson {
            Some(_) => self.reading.top = 0,
            None => self.complain("no lesson is being taken; L begins one"),
        }
    }

    /// Refuses what would go on with the lesson before it was read.
    pub(super) fn must_read(&self, view: Option<&View>) -> Result<(), NotNow> {
        match self.is_unread(view) {
            true => Err(NotNow::Unread),
            false => Ok(()),
        }
    }

    /// What of the lesson stands on a screen whose size is known.
    fn lesson_shown(&self, view: Option<&View>) -> Option<Shown> {
        let tutor = self.lesson.as_ref()?;
        let covered = matches!(
            self.overlay,
            Overlay::Help { .. }
                | Overlay::Manual(_)
                | Overlay::Chooser(_)
                | Overlay::Chart(_)
                | Overlay::Solver(_)
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
        let all = lesson::said(tutor, width, &self.theme).len();
        let from = lesson::top(self, tutor, width, room);
        let to = if room == 0 { 0 } else { (from + room).min(all) };
        Some(Shown { from, to, all })
    }
}
