//! Lessons and prediction mode: what is allowed, what is hidden, how answers are handled, and which text has been read. A lesson
//! continues only after all of its text has been shown.

use crate::view::View;
use stickslip_debugger::Tutor;
use stickslip_debugger::action::{Action, HiddenDecisions};
use stickslip_debugger::recorded::calculix::words::{NO_MODES, READ_ONLY};
use stickslip_debugger::refusal::Refusal;
use stickslip_debugger::teach::Guess;

/// Why lesson keys do nothing without a lesson.
pub(super) const NO_LESSON: &str = "no lesson is open; press L to start one";

/// How far the current lesson page has been read.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Reading {
    /// The lesson page ([`Tutor::edition`]).
    pub edition: (usize, u32),
    /// The first visible line, from 0.
    pub top: usize,
    /// Lines shown so far, counted from the first.
    pub seen: usize,
}

/// The visible part of a lesson page.
#[derive(Debug, Clone, Copy)]
pub(super) struct VisibleLines {
    /// The first visible line, and the one after the last.
    pub from: usize,
    pub to: usize,
    /// Number of lines.
    pub all: usize,
}

/// The current lesson, and prediction mode.
#[derive(Debug, Clone, Default)]
pub struct Learning {
    /// The lesson.
    pub lesson: Option<Tutor>,
    /// How far its current page has been read.
    pub reading: Reading,
    /// Prediction mode, outside lessons.
    pub guess: Option<Guess>,
}

impl Learning {
    /// Starts a lesson.
    pub(super) fn new(lesson: Tutor) -> Learning {
        Learning {
            lesson: Some(lesson),
            ..Learning::default()
        }
    }

    /// Notes that the action that the lesson asked for was not completed.
    pub(super) fn fail(&mut self) {
        if let Some(tutor) = &mut self.lesson {
            tutor.failed();
        }
    }

    /// Shows the hint of the lesson's question or task.
    pub(super) fn hint(&mut self, visible: Option<VisibleLines>) -> Result<String, Refusal> {
        self.check_read(visible)?;
        let tutor = self
            .lesson
            .as_mut()
            .ok_or_else(|| Refusal::new(NO_LESSON))?;
        tutor.hint().map(|()| String::new())
    }

    /// Answers the lesson's question, or checks a prediction.
    pub(super) fn answer(
        &mut self,
        word: &str,
        selected: usize,
        view: &View,
    ) -> Result<String, Refusal> {
        let (cursor, frame) = (view.cursor, view.frame());
        match (&mut self.lesson, &mut self.guess) {
            (_, Some(guess)) => guess
                .predict(view.model, cursor, frame, selected, word)
                .map(|(_, text)| text),
            (Some(tutor), None) => tutor
                .answer(word, selected, cursor, frame)
                .map(|()| String::new()),
            (None, None) => Err(Refusal::new(
                "there is no question; press p to hide decisions until you predict them",
            )),
        }
    }

    /// Switches prediction mode.
    pub(super) fn predict(
        &mut self,
        whose: Option<HiddenDecisions>,
        view: &View,
    ) -> Result<String, String> {
        if view.is_finished() {
            return Err(format!("{READ_ONLY}: {NO_MODES}"));
        }
        if self
            .lesson
            .as_ref()
            .is_some_and(|tutor| tutor.step().is_some())
        {
            return Err("prediction mode is off in lessons, which ask their own questions".into());
        }
        let toggled = match self.guess {
            Some(_) => HiddenDecisions::Off,
            None => HiddenDecisions::Selected,
        };
        match (whose.unwrap_or(toggled), self.guess.take()) {
            (HiddenDecisions::Off, Some(guess)) => Ok(format!(
                "predicted: {} right, {} wrong",
                guess.right, guess.wrong
            )),
            (HiddenDecisions::Off, None) => Err("prediction mode is off".into()),
            (whose, _) => {
                self.guess = Some(Guess::new(whose, view.cursor));
                Ok(
                    "decisions are hidden until you predict them: step, then press a and f, s or x"
                        .into(),
                )
            }
        }
    }

    /// Whether the lesson or prediction mode allows an action; `true` if the lesson asks for it.
    pub(super) fn permits(
        &mut self,
        action: &Action,
        view: &View,
        visible: Option<VisibleLines>,
    ) -> Result<bool, Refusal> {
        if self.guess.is_none()
            && self
                .lesson
                .as_ref()
                .is_some_and(|tutor| tutor.wants(action))
        {
            self.check_read(visible)?;
        }
        match (&mut self.lesson, &mut self.guess) {
            (Some(tutor), None) => tutor.permits(action, view.cursor, view.frame()),
            (_, Some(guess)) => {
                guess.permits(action, view.cursor, view.frame())?;
                Ok(false)
            }
            (None, None) => Ok(false),
        }
    }

    /// Prediction mode, in a lesson or outside.
    pub fn guess(&self) -> Option<&Guess> {
        let lesson = self.lesson.as_ref().and_then(Tutor::guess);
        lesson.or(self.guess.as_ref())
    }

    /// Whether to hide a decision of the shown frame, or the judge's verdict.
    pub fn hides_any(&self, view: &View) -> bool {
        view.event().is_some()
            && (self
                .lesson
                .as_ref()
                .is_some_and(|tutor| tutor.hides() || tutor.hides_verdict())
                || self
                    .guess()
                    .is_some_and(|guess| guess.is_open(view.cursor, view.frame())))
    }

    /// Whether to hide the judge's verdict.
    pub fn hides_verdict(&self) -> bool {
        self.lesson.as_ref().is_some_and(Tutor::hides_verdict)
    }

    /// Whether to hide the decision on this slave node.
    pub fn hides(&self, view: &View, slave: usize) -> bool {
        view.record(slave).is_some()
            && (self.lesson.as_ref().is_some_and(Tutor::hides)
                || self
                    .guess()
                    .is_some_and(|guess| guess.hides(view.cursor, view.frame(), slave)))
    }

    /// Records which lines are visible, before a key is handled.
    pub(super) fn note(&mut self, visible: Option<VisibleLines>) {
        let (Some(visible), Some(tutor)) = (visible, &self.lesson) else {
            return;
        };
        let (now, then) = (tutor.edition(), self.reading.edition);
        let before = match now.0 == then.0 {
            true if now.1 == then.1 => self.reading.seen,
            // Text above an answer has been read.
            true => self.reading.seen.min(visible.from),
            false => 0,
        };
        self.reading = Reading {
            edition: now,
            top: visible.from,
            // Lines that were skipped have not been read.
            seen: if visible.from <= before {
                before.max(visible.to)
            } else {
                before
            },
        };
    }

    /// Whether the lesson has text that has not been shown.
    pub(super) fn is_unread(&self, visible: Option<VisibleLines>) -> bool {
        let (Some(visible), Some(tutor)) = (visible, &self.lesson) else {
            return false;
        };
        let same = self.reading.edition == tutor.edition();
        let seen = if same { self.reading.seen } else { visible.to };
        seen < visible.all
    }

    /// Rejects actions that continue the lesson until its text has been shown.
    pub(super) fn check_read(&self, visible: Option<VisibleLines>) -> Result<(), Refusal> {
        if self.is_unread(visible) {
            Err(Refusal::new(
                "the lesson text continues; press Space for the next page",
            ))
        } else {
            Ok(())
        }
    }
}
