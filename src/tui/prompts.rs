//! Prompts and pages that receive keys before the panes: questions, lists and the input line.

use crate::app::{App, Effect, Overlay, PAGE};
use crate::chooser_state::{Chooser, Group};
use crate::commandline::Purpose;
use crate::event::KeyEvent;
use crate::input_queue::QueuedInput;
use crate::screen;
use crate::scroll::scrolled;
use crate::view::{View, context};
use ratatui::layout::Margin;
use stickslip_core::Mode;
use stickslip_debugger::action::{self, Action, Context, Question};
use stickslip_debugger::teach::question::AnswerKind;
use stickslip_debugger::{Command, Tutor};

impl App {
    pub(super) fn ask(&mut self, question: Question, view: Option<&View>) {
        let has_slaves = view.is_some_and(|view| !view.model.contacts.is_empty());
        match question {
            Question::Mode if !has_slaves => self.complain("this scene has no slave nodes"),
            Question::Mode => self.overlay = Overlay::Mode,
            Question::Increment => self.overlay = Overlay::line(Purpose::Increment, ""),
            Question::Node => self.overlay = Overlay::line(Purpose::Node, ""),
            Question::Scene => self.choose(),
            Question::Break => self.overlay = Overlay::line(Purpose::Command, "break "),
            Question::Lesson => self.overlay = Overlay::line(Purpose::Command, "lesson "),
            Question::Answer => self.ask_answer(view),
        }
    }

    /// Opens the prompt for an answer.
    pub(super) fn ask_answer(&mut self, view: Option<&View>) {
        if let Err(why) = self.learning.check_read(self.lesson_lines(view)) {
            return self.complain(why);
        }
        let asked = self.learning.lesson.as_ref().and_then(Tutor::question);
        let open = view
            .is_some_and(|view| self.learning.guess().is_some() && self.learning.hides_any(view));
        match asked.map(stickslip_debugger::teach::question::TutorQuestion::kind) {
            Some(AnswerKind::Number) => self.overlay = Overlay::line(Purpose::Answer, ""),
            Some(AnswerKind::Mode | AnswerKind::Choice) => self.overlay = Overlay::Answer,
            None if open => self.overlay = Overlay::Answer,
            // Answering shows the error.
            None => self.answer("free", view),
        }
    }

    pub(super) fn answer_key(&mut self, name: &str, view: Option<&View>) -> Option<Effect> {
        self.close(view);
        if name != "Esc" {
            self.answer(name, view);
        }
        None
    }

    pub(super) fn mode_key(&mut self, name: &str, view: Option<&View>) -> Option<Effect> {
        self.close(view);
        let wanted = [Mode::Free, Mode::Sliding, Mode::Fixed]
            .into_iter()
            .find(|mode| action::letter(*mode).eq_ignore_ascii_case(name));
        match wanted {
            Some(mode) => {
                let hold = name.chars().all(char::is_uppercase);
                let force = Command::Force {
                    slave: self.selected,
                    mode,
                    hold,
                };
                self.attempt(Ok(Action::Session(force)), None, view)
            }
            None if name == "Esc" => None,
            None => {
                self.complain(format!(
                    "invalid mode '{name}'; expected f (free), s (sliding) or x (fixed); a capital holds the mode"
                ));
                None
            }
        }
    }

    /// Handles a key in a page over the panes.
    pub(super) fn page_key(&mut self, name: &str, view: Option<&View>) {
        let body = screen::body(&screen::places(self, view, self.area), view);
        // Without the frame.
        let size = body.inner(Margin::new(1, 1));
        let lines: Vec<String> = match &self.overlay {
            Overlay::Text(page) => {
                let context = self.context(view, &[]);
                let (width, keymap) = (size.width.into(), &self.keymap);
                let lines = page
                    .text()
                    .lines(width, &self.theme, keymap, &context, view);
                lines.iter().map(ToString::to_string).collect()
            }
            _ => Vec::new(),
        };
        let stays = match &mut self.overlay {
            Overlay::Text(page) => page.key(name, size.height.into(), &lines),
            Overlay::Chart(page) => page.key(name) || !["Esc", "q", "Enter"].contains(&name),
            _ => true,
        };
        if !stays {
            self.close(view);
        }
    }

    pub(super) fn chooser_key(&mut self, name: &str, view: Option<&View>) -> Option<Effect> {
        let Overlay::Chooser(chooser) = &mut self.overlay else {
            return None;
        };
        let left = chooser.left(&self.offers).len();
        let fresh = chooser.typed.is_empty();
        match name {
            "Enter" => {
                let offer = chooser.selected(&self.offers)?;
                let seen = self.preview.as_ref().filter(|seen| seen.name == offer.name);
                let is_lesson = match seen.map(|seen| &seen.what) {
                    Some(Ok(glance)) => glance.is_lesson,
                    _ => offer.group == Group::Lessons,
                };
                let name = offer.name.clone();
                return Some(if is_lesson {
                    Effect::Lesson(name)
                } else {
                    Effect::Open(name)
                });
            }
            "q" if fresh && view.is_none() => return Some(Effect::Quit),
            "q" if fresh => self.overlay = Overlay::None,
            "Esc" if !fresh => *chooser = Chooser::default(),
            "Esc" if view.is_some() => self.overlay = Overlay::None,
            "Esc" => self.say("no scene is open; press q to quit"),
            ":" if fresh => self.overlay = Overlay::line(Purpose::Command, "open "),
            "Backspace" => chooser.type_text(""),
            "Space" if !fresh => chooser.type_text(" "),
            _ if name.chars().count() == 1 => chooser.type_text(name),
            _ => {
                let last = left.saturating_sub(1);
                let to = scrolled(chooser.at, name, PAGE as usize, last);
                chooser.at = to.unwrap_or(chooser.at.min(last));
            }
        }
        None
    }

    pub(super) fn line_key(
        &mut self,
        key: &KeyEvent,
        name: &str,
        view: Option<&View>,
    ) -> Option<Effect> {
        let scenes = self.scenes();
        let context = Context {
            keymap: Some(&self.keymap),
            ..context(view, self.selected, &scenes)
        };
        let Overlay::Line(line) = &mut self.overlay else {
            return None;
        };
        match name {
            "Esc" => self.close(view),
            "Backspace" if line.text().is_empty() => self.close(view),
            "Tab" => line.complete(1, &context),
            "Shift-Tab" => line.complete(-1, &context),
            "Up" => line.recall(1, &self.history),
            "Down" => line.recall(-1, &self.history),
            "Enter" => return self.enter(view),
            _ => line.edit(key),
        }
        None
    }

    /// Carries out the line.
    pub(super) fn enter(&mut self, view: Option<&View>) -> Option<Effect> {
        let Overlay::Line(line) = &self.overlay else {
            return None;
        };
        let (purpose, text) = (line.purpose, line.text().trim().to_string());
        self.close(view);
        if purpose == Purpose::Node {
            return self.seek(text, view);
        }
        let line = match purpose {
            Purpose::Answer if text.is_empty() => {
                self.complain("no answer was typed; press a to answer, H for a hint");
                return None;
            }
            _ if text.is_empty() => return None,
            Purpose::Command | Purpose::Node => text,
            Purpose::Increment => format!("increment {text}"),
            Purpose::Answer => format!("answer {text}"),
        };
        self.remember(&line);
        self.take_line(&line, view)
    }

    /// Stores a line in the history.
    pub(super) fn remember(&mut self, line: &str) {
        self.history.retain(|old| old != line);
        self.history.push(line.into());
    }

    /// Carries out a line, or queues it.
    pub(super) fn take_line(&mut self, line: &str, view: Option<&View>) -> Option<Effect> {
        self.say("");
        let scenes = self.scenes();
        let action = action::parse(line, &self.context(view, &scenes));
        if let Some(awaited) = action.as_ref().ok().and_then(|a| self.awaits(a, view)) {
            self.ahead
                .push(QueuedInput::Line(line.into()), Some(awaited));
            return None;
        }
        self.attempt(action, None, view)
    }
}
