//! Lessons and prediction mode: what is allowed, what is hidden, and how answers are handled.

use crate::app::App;
use crate::view::View;
use stickslip_debugger::action::{Action, Whose};
use stickslip_debugger::recorded::calculix::words::{NO_MODES, READ_ONLY};
use stickslip_debugger::teach::refusal::NotNow;
use stickslip_debugger::teach::{Guess, Tutor};

impl App {
    /// Continues the lesson.
    pub(super) fn go_on(&mut self, view: Option<&View>) {
        if self.turn_page(view) {
            return self.say("");
        }
        let (Some(tutor), Some(view)) = (&mut self.lesson, view) else {
            return self.complain("no lesson is open; press L to start one");
        };
        match tutor.on(view.cursor, view.frame()) {
            Ok(()) => self.say(""),
            Err(message) => self.complain(message),
        }
    }

    /// Answers the lesson's question, or checks a prediction.
    pub(super) fn answer(&mut self, word: &str, view: Option<&View>) {
        let Some(view) = view else {
            return self.complain("open a scene first");
        };
        if let Err(why) = self.must_read(Some(view)) {
            return self.complain(why);
        }
        let (cursor, frame, selected) = (view.cursor, view.frame(), self.selected);
        let told = match (&mut self.lesson, &mut self.guess) {
            (_, Some(guess)) => guess
                .predict(view.model, cursor, frame, selected, word)
                .map(|(_, text)| text),
            (Some(tutor), None) => tutor
                .answer(word, selected, cursor, frame)
                .map(|()| String::new()),
            (None, None) => {
                return self.complain(
                    "there is no question; press p to hide decisions until you predict them",
                );
            }
        };
        match told {
            Ok(text) => self.say(text),
            Err(message) => self.complain(message),
        }
    }

    /// Switches prediction mode.
    pub(super) fn predict(&mut self, whose: Option<Whose>, view: Option<&View>) {
        let Some(view) = view else {
            return self.complain("open a scene first");
        };
        if view.model.finished.is_some() {
            return self.complain(format!("{READ_ONLY}: {NO_MODES}"));
        }
        if self
            .lesson
            .as_ref()
            .is_some_and(|tutor| tutor.step().is_some())
        {
            return self
                .complain("prediction mode is off in lessons, which ask their own questions");
        }
        let toggled = match self.guess {
            Some(_) => Whose::Off,
            None => Whose::Selected,
        };
        match (whose.unwrap_or(toggled), &self.guess) {
            (Whose::Off, Some(guess)) => {
                let told = format!("predicted: {} right, {} wrong", guess.right, guess.wrong);
                self.guess = None;
                self.say(told);
            }
            (Whose::Off, None) => self.complain("prediction mode is off"),
            (whose, _) => {
                self.guess = Some(Guess::new(whose, view.cursor));
                self.say(
                    "decisions are hidden until you predict them: step, then press a and f, s or x",
                );
            }
        }
    }

    /// Whether the lesson or prediction mode allows an action; `true` if the lesson asks for it.
    pub(super) fn permits(&mut self, action: &Action, view: Option<&View>) -> Result<bool, NotNow> {
        let Some(view) = view else { return Ok(false) };
        let goes_on = |tutor: &Tutor| tutor.wants(action);
        if self.guess.is_none() && self.lesson.as_ref().is_some_and(goes_on) {
            self.must_read(Some(view))?;
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
    pub fn guessing(&self) -> Option<&Guess> {
        let lesson = self.lesson.as_ref().and_then(Tutor::guess);
        lesson.or(self.guess.as_ref())
    }

    /// Whether to hide a decision of the shown frame, or the judge's verdict.
    pub fn hides_any(&self, view: &View) -> bool {
        let frame = view.frame();
        let lesson = |tutor: &Tutor| tutor.hides() || tutor.hides_verdict();
        view.event().is_some()
            && (self.lesson.as_ref().is_some_and(lesson)
                || self
                    .guessing()
                    .is_some_and(|guess| guess.is_open(view.cursor, frame)))
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
                    .guessing()
                    .is_some_and(|guess| guess.hides(view.cursor, view.frame(), slave)))
    }
}
