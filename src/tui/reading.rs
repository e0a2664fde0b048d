//! Paging through lesson text that does not fit on the screen; the lesson continues only after all of it has been shown.

use crate::app::{App, Overlay};
use crate::layout::Pane;
use crate::panes::lesson;
use crate::screen;
use crate::view::View;
use stickslip_debugger::teach::refusal::NotNow;

/// The visible part of a lesson page.
struct Shown {
    /// The first visible line, and the one after the last.
    from: usize,
    to: usize,
    /// Number of lines.
    all: usize,
}

impl App {
    /// Records which lines are visible, before a key is handled.
    pub(super) fn note_reading(&mut self, view: Option<&View>) {
        let (Some(shown), Some(tutor)) = (self.lesson_shown(view), &self.lesson) else {
            return;
        };
        let (now, then) = (tutor.edition(), self.reading.edition);
        let before = match now.0 == then.0 {
            true if now.1 == then.1 => self.reading.seen,
            // Text above an answer has been read.
            true => self.reading.seen.min(shown.from),
            false => 0,
        };
        self.reading.edition = tutor.edition();
        self.reading.top = shown.from;
        // Lines that were skipped have not been read.
        self.reading.seen = match shown.from <= before {
            true => before.max(shown.to),
            false => before,
        };
    }

    /// Whether the lesson has text that has not been shown.
    pub(super) fn is_unread(&self, view: Option<&View>) -> bool {
        let (Some(shown), Some(tutor)) = (self.lesson_shown(view), &self.lesson) else {
            return false;
        };
        let same = self.reading.edition == tutor.edition();
        let seen = if same { self.reading.seen } else { shown.to };
        seen < shown.all
    }

    /// Shows the next part of the text; returns false if all of it has been shown.
    pub(super) fn turn_page(&mut self, view: Option<&View>) -> bool {
        self.note_reading(view);
        if !self.is_unread(view) {
            return false;
        }
        let Some(shown) = self.lesson_shown(view) else {
            return false;
        };
        if shown.to == 0 {
            // On a tiny screen the lesson replaces the table.
            self.zoomed = false;
            self.look_at(Pane::Nodes);
        } else {
            self.reading.top = shown.to.min(self.reading.seen);
        }
        self.note_reading(view);
        true
    }

    /// Shows the lesson text from the top.
    pub(super) fn reread(&mut self) {
        match &self.lesson {
            Some(_) => self.reading.top = 0,
            None => self.complain("no lesson is open; press L to start one"),
        }
    }

    /// Rejects actions that continue the lesson until its text has been shown.
    pub(super) fn must_read(&self, view: Option<&View>) -> Result<(), NotNow> {
        match self.is_unread(view) {
            true => Err(NotNow::Unread),
            false => Ok(()),
        }
    }

    /// The visible part of the lesson, if the screen size is known.
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
