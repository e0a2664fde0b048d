//! A lesson in progress: a state machine without a terminal.
//!
//! At each step it waits for the user to continue, to perform an action, to answer, or to predict. The owner of
//! the session asks it before every action ([`Tutor::permits`]), reports when the action is done
//! ([`Tutor::settled`]), and draws its text ([`Tutor::page`], [`Tutor::todo`]). Right answers come from a
//! separate solver, which starts from the shown frame.

use super::frame_values::FrameValues;
use super::guess::Guess;
use super::lesson::{self, Answer, Ask, Lesson, LessonStep, Truth};
use super::question::{AnswerKind, TutorQuestion};
use crate::action::{Action, HiddenDecisions};
use crate::refusal::{Refusal, refusal};
use crate::{Command, Frame};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use stickslip_core::Status;

/// What is recorded for a hint.
const HINT: &str = "?";

/// Number of wrong answers after which the right one is shown.
const TRIES: u32 = 2;

/// A lesson in progress.
#[derive(Debug, Clone)]
pub struct Tutor {
    pub(super) lesson: Arc<Lesson>,
    /// Index of the current step; past the last one, the lesson has ended.
    at: usize,
    text: String,
    question: Option<TutorQuestion>,
    /// The reply to the last answer, or the hint that was asked for.
    remark: Option<Paragraph>,
    /// Number of replies in this step.
    answers: u32,
    /// Whether the step is done and waits for the user to continue.
    done: bool,
    /// Whether the action of the step is being executed.
    pending: bool,
    /// A fault in the lesson itself.
    fault: Option<String>,
    guess: Option<Guess>,
    /// The hint of the current task.
    pub(super) task_hint: String,
    /// Seconds since the start of the lesson, as set by its owner.
    clock: u32,
    /// All answers so far.
    given: Vec<GivenAnswer>,
}

/// An answer, a prediction, a task or a request for a hint.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GivenAnswer {
    /// Step of the lesson, from 0.
    pub step: usize,
    /// The answer as typed; `?` for a hint.
    pub word: String,
    /// Whether it is right.
    pub right: bool,
    /// Whether it counts for the score: predictions, and the first answer to a question.
    pub counts: bool,
    /// Seconds since the start of the lesson.
    pub seconds: u32,
}

/// A part of the lesson's page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Paragraph {
    /// Something to read.
    Text(String),
    /// An equation, between dollar signs in the text.
    Equation(String),
    /// A choice, with its number.
    Option(usize, String),
    /// Reply to a right answer.
    Right(String),
    /// Reply to a wrong answer.
    Wrong(String),
    /// A hint that was asked for.
    Hint(String),
}

impl Tutor {
    /// Starts a lesson; `frame` is the start of its scene.
    pub fn new(lesson: Arc<Lesson>, cursor: usize, frame: &Frame) -> Self {
        let mut tutor = Tutor {
            lesson,
            at: 0,
            text: String::new(),
            question: None,
            remark: None,
            answers: 0,
            done: false,
            pending: false,
            fault: None,
            guess: None,
            task_hint: String::new(),
            clock: 0,
            given: Vec::new(),
        };
        tutor.enter(cursor, frame);
        tutor
    }

    /// The lesson.
    pub fn lesson(&self) -> &Lesson {
        &self.lesson
    }

    /// The last reply in this step; empty if there is none.
    pub(super) fn last_reply(&self) -> String {
        match &self.remark {
            Some(Paragraph::Right(text) | Paragraph::Wrong(text)) => text.clone(),
            _ => String::new(),
        }
    }

    /// Index of the current step, from 0; the number of steps when the lesson has ended.
    pub fn at(&self) -> usize {
        self.at
    }

    /// The current step; `None` when the lesson has ended.
    pub fn step(&self) -> Option<&LessonStep> {
        self.lesson.steps.get(self.at)
    }

    /// Number of questions answered right at the first attempt, and of all.
    pub fn score(&self) -> (u32, u32) {
        self.given
            .iter()
            .filter(|given| given.counts)
            .fold((0, 0), |(right, asked), given| {
                (right + u32::from(given.right), asked + 1)
            })
    }

    /// All answers so far.
    pub fn given(&self) -> &[GivenAnswer] {
        &self.given
    }

    /// Continues with the answers of an earlier session in place of those given so far.
    pub(super) fn resume(&mut self, given: Vec<GivenAnswer>) {
        self.clock = given.last().map_or(0, |given| given.seconds);
        self.given = given;
    }

    /// Sets the number of seconds since the start of the lesson.
    pub fn set_clock(&mut self, seconds: u32) {
        self.clock = seconds;
    }

    /// Seconds since the start of the lesson.
    pub fn clock(&self) -> u32 {
        self.clock
    }

    /// Records an answer; the first one in a step counts for the score, and every prediction does.
    fn note(&mut self, word: &str, right: bool) {
        let is_first = !self.given.iter().any(|given| given.step == self.at);
        self.given.push(GivenAnswer {
            step: self.at,
            word: word.to_owned(),
            right,
            counts: is_first || self.guess.is_some(),
            seconds: self.clock,
        });
        self.answers += 1;
    }

    /// The open question.
    pub fn question(&self) -> Option<&TutorQuestion> {
        self.question.as_ref().filter(|_| !self.done)
    }

    /// A fault in the lesson: a question without an answer, or an unknown number.
    pub fn fault(&self) -> Option<&str> {
        self.fault.as_deref()
    }

    /// The predictions, if this is a step of free mode.
    pub fn guess(&self) -> Option<&Guess> {
        self.guess.as_ref()
    }

    fn enter(&mut self, cursor: usize, frame: &Frame) {
        self.question = None;
        self.remark = None;
        self.answers = 0;
        self.guess = None;
        self.fault = None;
        self.done = false;
        let lesson = self.lesson.clone();
        let look = self.values(frame);
        let (text, question) = match lesson.steps.get(self.at) {
            None => return self.text = self.farewell(),
            Some(LessonStep::Text(text) | LessonStep::Press { text, .. }) => (text, None),
            Some(LessonStep::Reach(task)) => {
                self.task_hint = task.hint.fill(&look, "").unwrap_or_default();
                (&task.text, None)
            }
            Some(LessonStep::Predict { text, .. }) => {
                self.guess = Some(Guess::new(HiddenDecisions::Selected, cursor));
                (text, None)
            }
            Some(LessonStep::Ask(ask)) => (&ask.text, Some(ask)),
        };
        let filled = text.fill(&look, "…");
        let question = question
            .map(|ask| TutorQuestion::new(ask, &look))
            .transpose();
        match (filled, question) {
            (Ok(text), Ok(question)) => (self.text, self.question) = (text, question),
            (Err(why), _) | (_, Err(why)) => {
                let message = why.to_string();
                self.text = format!("This step of the lesson does not work: {message}.");
                self.fault = Some(message);
                self.done = true;
            }
        }
    }

    fn farewell(&self) -> String {
        let score = match self.score() {
            (_, 0) => String::new(),
            (right, asked) if right == asked => {
                format!(" All {asked} answers were right at the first attempt.")
            }
            (right, asked) => {
                format!(" {right} of {asked} answers were right at the first attempt.")
            }
        };
        format!("This is the end of the lesson.{score} You can continue to explore the scene.")
    }

    /// The lesson after this one, when it has ended.
    pub fn next_lesson(&self) -> Option<&'static str> {
        lesson::list()
            .iter()
            .map(|lesson| lesson.name)
            .skip_while(|name| *name != self.lesson.name)
            .nth(1)
            .filter(|_| self.step().is_none())
    }

    /// Checks whether an action is allowed now. Returns whether it is the one that the lesson waits for; then
    /// [`Tutor::settled`] or [`Tutor::failed`] must follow.
    ///
    /// # Errors
    /// If the lesson waits for something else.
    pub fn permits(
        &mut self,
        action: &Action,
        cursor: usize,
        frame: &Frame,
    ) -> Result<bool, Refusal> {
        match self.step() {
            None => return Ok(false),
            Some(LessonStep::Press { action: wanted, .. }) if action == wanted && !self.pending => {
                self.pending = true;
                return Ok(true);
            }
            Some(LessonStep::Reach(_) | LessonStep::Ask(Ask { explores: true, .. })) => {
                return Ok(false);
            }
            _ => {}
        }
        let Action::Session(command) = action else {
            return Ok(false);
        };
        let moves = matches!(command, Command::Forward { .. } | Command::Back { .. });
        match (command, self.step()) {
            (Command::Snapshot { .. } | Command::Export { .. } | Command::Journal(_), _) => {
                Ok(false)
            }
            (_, Some(LessonStep::Predict { .. })) if moves && !self.done => match &mut self.guess {
                Some(guess) => guess.permits(action, cursor, frame).map(|()| false),
                None => Ok(false),
            },
            _ => Err(refusal!("the lesson waits: {}", self.todo())),
        }
    }

    /// Reports that an action is done; `frames` are those up to the shown one.
    pub fn settled(&mut self, frames: &[Frame]) {
        let Some((frame, cursor)) = frames.last().zip(frames.len().checked_sub(1)) else {
            return;
        };
        if std::mem::take(&mut self.pending) {
            self.at += 1;
            self.enter(cursor, frame);
            return;
        }
        let lesson = self.lesson.clone();
        let Some(LessonStep::Reach(task)) = lesson.steps.get(self.at).filter(|_| !self.done) else {
            return;
        };
        let (text, good) = match task.check(frames, &self.values(frame)) {
            Ok(None) => return,
            Ok(Some(text)) => (text, true),
            Err(why) => (why, false),
        };
        self.remark = Some(reply(good, text));
        self.done = good;
        if good {
            self.note("done", true)
        } else {
            self.answers += 1
        }
    }

    fn values(&self, frame: &Frame) -> FrameValues {
        FrameValues {
            model: self.lesson.model.clone(),
            frame: frame.clone(),
            runs: self.lesson.runs.clone(),
        }
    }

    /// Reports that the permitted action failed.
    pub fn failed(&mut self) {
        self.pending = false;
    }

    /// Whether the step only waits for the user to continue.
    pub fn is_read(&self) -> bool {
        self.done || matches!(self.step(), Some(LessonStep::Text(_)))
    }

    /// Continues, if the step only waits for that.
    ///
    /// # Errors
    /// If the lesson waits for something else.
    pub fn on(&mut self, cursor: usize, frame: &Frame) -> Result<(), Refusal> {
        match self.step() {
            None => Err(refusal!(
                "the lesson has ended; q quits, :lesson starts another"
            )),
            Some(_) if self.is_read() => {
                self.at += 1;
                self.enter(cursor, frame);
                Ok(())
            }
            Some(_) => Err(refusal!("the lesson waits: {}", self.todo())),
        }
    }

    /// Takes an answer, or a prediction for the selected node.
    ///
    /// # Errors
    /// If there is no open question, or the word cannot be an answer.
    pub fn answer(
        &mut self,
        word: &str,
        selected: usize,
        cursor: usize,
        frame: &Frame,
    ) -> Result<(), Refusal> {
        if let (Some(guess), false) = (&mut self.guess, self.done) {
            let model = &self.lesson.model;
            let (good, text) = guess.predict(model, cursor, frame, selected, word)?;
            let wanted = match self.lesson.steps.get(self.at) {
                Some(LessonStep::Predict { right, .. }) => *right,
                _ => 0,
            };
            let enough = guess.right >= wanted;
            // There is nothing to predict after the last iteration.
            let over = frame.state.status == Status::Finished && !guess.is_open(cursor, frame);
            self.done = enough || over;
            let mut text = format!("{} ({} of {wanted})", capital(&text), guess.right);
            if over && !enough {
                text += " The history ends here, so there are no more predictions.";
            }
            self.remark = Some(reply(good, text));
            self.note(word, good);
            return Ok(());
        }
        if self.done {
            return Err(refusal!(
                "the question has been answered; press Space to continue"
            ));
        }
        let question = self
            .question
            .as_mut()
            .ok_or_else(|| refusal!("there is no open question"))?;
        let good = question.is_right(word)?;
        question.tries += 1;
        self.done = good || question.tries >= TRIES;
        let text = match (good, self.done) {
            (true, _) => question.reply_to_right(),
            (false, true) => format!("No. It is {}", question.explained()),
            (false, false) => question.reply_to_wrong(word),
        };
        self.remark = Some(reply(good, text));
        self.note(word, good);
        Ok(())
    }

    /// Shows the hint of the question or task. It counts as a wrong answer.
    ///
    /// # Errors
    /// If there is none.
    pub fn hint(&mut self) -> Result<(), Refusal> {
        let text = match (self.lesson.steps.get(self.at), &mut self.question) {
            _ if self.done => {
                return Err(refusal!(
                    "the question has been answered; press Space to continue"
                ));
            }
            (_, Some(question)) => {
                question.tries += 1;
                question.help()
            }
            (Some(LessonStep::Reach(_)), None) => self.task_hint.clone(),
            _ => return Err(refusal!("there is no open question")),
        };
        self.remark = Some(Paragraph::Hint(text));
        self.note(HINT, false);
        Ok(())
    }

    /// Whether this is the action that the step waits for.
    pub fn wants(&self, action: &Action) -> bool {
        matches!(self.step(), Some(LessonStep::Press { action: wanted, .. }) if action == wanted)
    }

    /// Identifies the page: the step, and the number of answers given in it. The text changes with either.
    pub fn edition(&self) -> (usize, u32) {
        (self.at, self.answers)
    }

    /// Whether decisions must be hidden at all nodes: a question about them is open, or comes before the next
    /// action.
    pub fn hides(&self) -> bool {
        self.asks_about(|ask| {
            let becomes = |(_, truth): &(_, Truth)| matches!(truth, Truth::Becomes(..));
            let decides = match &ask.answer {
                Answer::Mode(_) | Answer::Rule(_) => true,
                Answer::Choice(choices) => choices.iter().any(becomes),
                Answer::Number(..) => false,
            };
            ask.ahead == 0 && decides
        })
    }

    /// Whether the judge's verdict must be hidden, for the same reasons.
    pub fn hides_verdict(&self) -> bool {
        let judges = |(_, truth): &(_, Truth)| matches!(truth, Truth::Obeys | Truth::Breaks(_));
        self.asks_about(|ask| match &ask.answer {
            Answer::Choice(choices) => ask.ahead == 0 && choices.iter().any(judges),
            _ => false,
        })
    }

    /// Whether such a question is open or comes before the next action.
    fn asks_about(&self, about: impl Fn(&Ask) -> bool) -> bool {
        if self.done && self.question.is_some() {
            return false;
        }
        let begin = match self.step() {
            Some(LessonStep::Press { .. }) if self.pending => self.at + 1,
            Some(LessonStep::Press { .. } | LessonStep::Predict { .. }) | None => return false,
            Some(_) => self.at,
        };
        self.lesson.steps[begin..]
            .iter()
            .take_while(|step| matches!(step, LessonStep::Text(_) | LessonStep::Ask(_)))
            .any(|step| matches!(step, LessonStep::Ask(ask) if about(ask)))
    }

    /// The text of the step.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The contents of the page.
    pub fn page(&self) -> Vec<Paragraph> {
        let mut page = paragraphs(&self.text);
        if let Some(question) = &self.question {
            let options = question.options.iter().enumerate();
            page.extend(options.map(|(k, text)| Paragraph::Option(k + 1, text.clone())));
        }
        page.extend(self.remark.clone());
        page
    }

    /// What to do next, in a few words.
    pub fn todo(&self) -> String {
        let on = "Space continues".to_owned();
        match (self.step(), self.question.as_ref().map(TutorQuestion::kind)) {
            (None, _) => match self.next_lesson() {
                Some(next) => format!("Space opens the next lesson, {next}"),
                None => "the lesson has ended".into(),
            },
            (Some(_), _) if self.done => on,
            (Some(LessonStep::Text(_)), _) => on,
            (Some(LessonStep::Press { how, .. }), _) => how.clone(),
            (Some(LessonStep::Reach(task)), _) => task.todo(),
            (Some(LessonStep::Predict { .. }), _) => {
                "s steps; then a, and f free, s sliding, x fixed".into()
            }
            (Some(LessonStep::Ask(_)), Some(AnswerKind::Mode)) => {
                "answer: a, then f free, s sliding, x fixed".into()
            }
            (Some(LessonStep::Ask(_)), Some(AnswerKind::Choice)) => {
                "answer: a, then the number".into()
            }
            (Some(LessonStep::Ask(Ask { explores: true, .. })), _) => {
                "find it with any keys, then a, the number and Enter; H hint".into()
            }
            (Some(LessonStep::Ask(_)), _) => "answer: a, then a number and Enter".into(),
        }
    }

    /// The right answer, as typed; used to play lessons automatically.
    pub fn solution(&self) -> Option<String> {
        self.question().map(TutorQuestion::solution)
    }
}

/// The reply to an answer.
fn reply(good: bool, text: String) -> Paragraph {
    if good {
        Paragraph::Right(text)
    } else {
        Paragraph::Wrong(text)
    }
}

/// A text and its equations, which are between dollar signs.
pub fn paragraphs(text: &str) -> Vec<Paragraph> {
    text.split('$')
        .map(str::trim)
        .enumerate()
        .filter(|(_, part)| !part.is_empty())
        .map(|(index, part)| match index % 2 {
            0 => Paragraph::Text(part.to_owned()),
            _ => Paragraph::Equation(part.to_owned()),
        })
        .collect()
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    match letters.next() {
        Some(first) => first.to_uppercase().chain(letters).collect(),
        None => String::new(),
    }
}
