//! A lesson in progress: a state machine without a terminal.
//!
//! At each step it waits for the user to continue, to perform an action, to answer, or to predict. The owner of
//! the session asks it before every action ([`Tutor::permits`]), reports when the action is done
//! ([`Tutor::settled`]), and draws its text ([`Tutor::page`], [`Tutor::todo`]). Right answers come from a
//! separate solver, which starts from the shown frame.

use super::frame_values::FrameValues;
use super::guess::Guess;
use super::lesson::{self, Answer, Ask, Lesson, LessonStep, Truth};
use super::quantity::Template;
use super::refusal::{LessonError, LessonRefusal};
use crate::action::{self, Action, HiddenDecisions};
use crate::explain::names::{self, MODES, TABLE_2};
use crate::explain::report;
use crate::explain::tested;
use crate::history::frame::Frame;
use crate::record::command::Command;
use std::sync::Arc;
use stickslip_core::contact::table2::{Decision, Rule, Test};
use stickslip_core::model::Mode;
use stickslip_core::step::state::Status;
use stickslip_scene::number::sig4;

/// Number of wrong answers after which the right one is shown.
const TRIES: u32 = 2;

/// Relative difference below which numbers count as about the same.
const CLOSE: f64 = 0.05;

/// A lesson in progress.
#[derive(Debug, Clone)]
pub struct Tutor {
    lesson: Arc<Lesson>,
    /// Index of the current step; past the last one, the lesson has ended.
    at: usize,
    text: String,
    question: Option<TutorQuestion>,
    remark: Option<Remark>,
    /// Number of answers and predictions in this step.
    given: u32,
    /// Whether the step is done and waits for the user to continue.
    done: bool,
    /// Whether the action of the step is being executed.
    pending: bool,
    /// A fault in the lesson itself.
    fault: Option<String>,
    guess: Option<Guess>,
    /// Number of answers and predictions right at the first attempt, and of all.
    right: u32,
    asked: u32,
}

/// An open question, with its answer.
#[derive(Debug, Clone)]
pub struct TutorQuestion {
    /// How it is answered.
    pub kind: AnswerKind,
    /// The choices, if there are any.
    pub options: Vec<String>,
    right: RightAnswer,
    /// The decision at the node in question, if any, and whether there is friction.
    node: Option<(usize, Decision, bool)>,
    /// Whether the decision is in a later iteration.
    is_ahead: bool,
    hint: String,
    then: String,
    tries: u32,
}

/// How a question is answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnswerKind {
    /// By a mode.
    Mode,
    /// By the number of an option.
    Choice,
    /// By a number.
    Number,
}

#[derive(Debug, Clone, PartialEq)]
enum RightAnswer {
    Mode(Mode),
    Choice(usize),
    Number { value: f64, tolerance: f64 },
}

/// The reply to the last answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Remark {
    /// The text.
    pub text: String,
    /// Whether the answer was right.
    pub good: bool,
}

/// A part of the lesson's page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Paragraph {
    /// Something to read.
    Text(String),
    /// A choice, with its number.
    Option(usize, String),
    /// Reply to a right answer.
    Right(String),
    /// Reply to a wrong answer.
    Wrong(String),
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
            given: 0,
            done: false,
            pending: false,
            fault: None,
            guess: None,
            right: 0,
            asked: 0,
        };
        tutor.enter(cursor, frame);
        tutor
    }

    /// The lesson.
    pub fn lesson(&self) -> &Lesson {
        &self.lesson
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
        (self.right, self.asked)
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
        self.given = 0;
        self.guess = None;
        self.fault = None;
        self.done = false;
        let lesson = self.lesson.clone();
        let look = FrameValues {
            model: lesson.model.clone(),
            frame: frame.clone(),
            runs: lesson.runs.clone(),
        };
        let (text, question) = match lesson.steps.get(self.at) {
            None => return self.text = self.farewell(),
            Some(LessonStep::Text(text) | LessonStep::Press { text, .. }) => (text, None),
            Some(LessonStep::Predict { text, .. }) => {
                self.guess = Some(Guess::new(HiddenDecisions::Selected, cursor));
                (text, None)
            }
            Some(LessonStep::Ask(ask)) => (&ask.text, Some(ask)),
        };
        let filled = text.fill(&look, "…");
        let question = question
            .map(|ask| TutorQuestion::ask(ask, &look))
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
        let score = match (self.right, self.asked) {
            (_, 0) => String::new(),
            (right, asked) if right == asked => {
                format!(" All {asked} answers were right at the first attempt.")
            }
            (right, asked) => {
                format!(" {right} of {asked} answers were right at the first attempt.")
            }
        };
        let names = lesson::list().iter().map(|lesson| lesson.name);
        let next = match names.skip_while(|name| *name != self.lesson.name).nth(1) {
            Some(next) => format!(" The next lesson is {next} (:lesson {next})."),
            None => String::new(),
        };
        format!(
            "This is the end of the lesson.{score} You can continue to explore the scene.{next}"
        )
    }

    /// Checks whether an action is allowed now. Returns whether it is the one that the lesson waits for; then
    /// [`Tutor::settled`] or [`Tutor::failed`] must follow.
    ///
    /// # Errors If the lesson waits for something else.
    pub fn permits(
        &mut self,
        action: &Action,
        cursor: usize,
        frame: &Frame,
    ) -> Result<bool, LessonRefusal> {
        match self.step() {
            None => return Ok(false),
            Some(LessonStep::Press { action: wanted, .. }) if action == wanted && !self.pending => {
                self.pending = true;
                return Ok(true);
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
            _ => Err(LessonRefusal::Waits(self.todo())),
        }
    }

    /// Reports that the permitted action is done; `frame` is now shown.
    pub fn settled(&mut self, cursor: usize, frame: &Frame) {
        if std::mem::take(&mut self.pending) {
            self.at += 1;
            self.enter(cursor, frame);
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
    /// # Errors If the lesson waits for something else.
    pub fn on(&mut self, cursor: usize, frame: &Frame) -> Result<(), LessonRefusal> {
        match self.step() {
            None => Err(LessonRefusal::Over),
            Some(_) if self.is_read() => {
                self.at += 1;
                self.enter(cursor, frame);
                Ok(())
            }
            Some(_) => Err(LessonRefusal::Waits(self.todo())),
        }
    }

    /// Takes an answer, or a prediction for the selected node.
    ///
    /// # Errors If there is no open question, or the word cannot be an answer.
    pub fn answer(
        &mut self,
        word: &str,
        selected: usize,
        cursor: usize,
        frame: &Frame,
    ) -> Result<(), LessonRefusal> {
        if let (Some(guess), false) = (&mut self.guess, self.done) {
            let model = &self.lesson.model;
            let (good, text) = guess.predict(model, cursor, frame, selected, word)?;
            self.asked += 1;
            self.right += u32::from(good);
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
            self.remark = Some(Remark { text, good });
            self.given += 1;
            return Ok(());
        }
        if self.done {
            return Err(LessonRefusal::Answered);
        }
        let question = self.question.as_mut().ok_or(LessonRefusal::NothingAsked)?;
        let good = question.is_right(word)?;
        question.tries += 1;
        self.done = good || question.tries >= TRIES;
        self.asked += u32::from(question.tries == 1);
        self.right += u32::from(good && question.tries == 1);
        let text = match (good, self.done) {
            (true, _) => question.reply_to_right(),
            (false, true) => format!("No. It is {}", question.explained()),
            (false, false) => question.reply_to_wrong(),
        };
        self.remark = Some(Remark { text, good });
        self.given += 1;
        Ok(())
    }

    /// Whether this is the action that the step waits for.
    pub fn wants(&self, action: &Action) -> bool {
        matches!(self.step(), Some(LessonStep::Press { action: wanted, .. }) if action == wanted)
    }

    /// Identifies the page: the step, and the number of answers given in it. The text changes with either.
    pub fn edition(&self) -> (usize, u32) {
        (self.at, self.given)
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
        let mut page = vec![Paragraph::Text(self.text.clone())];
        if let Some(question) = &self.question {
            let options = question.options.iter().enumerate();
            page.extend(options.map(|(k, text)| Paragraph::Option(k + 1, text.clone())));
        }
        if let Some(Remark { text, good }) = &self.remark {
            page.push(match good {
                true => Paragraph::Right(text.clone()),
                false => Paragraph::Wrong(text.clone()),
            });
        }
        page
    }

    /// What to do next, in a few words.
    pub fn todo(&self) -> String {
        let on = "Space continues".to_owned();
        match (
            self.step(),
            self.question.as_ref().map(|question| question.kind),
        ) {
            (None, _) => "the lesson has ended".into(),
            (Some(_), _) if self.done => on,
            (Some(LessonStep::Text(_)), _) => on,
            (Some(LessonStep::Press { how, .. }), _) => how.clone(),
            (Some(LessonStep::Predict { .. }), _) => {
                "s steps; then a, and f free, s sliding, x fixed".into()
            }
            (Some(LessonStep::Ask(_)), Some(AnswerKind::Mode)) => {
                "answer: a, then f free, s sliding, x fixed".into()
            }
            (Some(LessonStep::Ask(_)), Some(AnswerKind::Choice)) => {
                "answer: a, then the number".into()
            }
            (Some(LessonStep::Ask(_)), _) => "answer: a, then a number and Enter".into(),
        }
    }

    /// The right answer, as typed; used to play lessons automatically.
    pub fn solution(&self) -> Option<String> {
        self.question().map(|question| match question.right {
            RightAnswer::Mode(mode) => names::mode(mode).into(),
            RightAnswer::Choice(index) => (index + 1).to_string(),
            RightAnswer::Number { value, .. } => value.to_string(),
        })
    }
}

impl TutorQuestion {
    /// Gets the right answer from the solver. Texts shown before the answer are filled from the current state
    /// `now`.
    fn ask(ask: &Ask, now: &FrameValues) -> Result<TutorQuestion, LessonError> {
        let look = now.ahead(ask.ahead)?;
        let found = |slave: usize| -> Result<_, LessonError> {
            let record = look.record(slave)?;
            Ok((slave, record.decision, record.t_max != 0.0))
        };
        let (kind, options, right, node) = match &ask.answer {
            Answer::Mode(slave) => {
                let node = found(*slave)?;
                (
                    AnswerKind::Mode,
                    Vec::new(),
                    RightAnswer::Mode(node.1.next),
                    Some(node),
                )
            }
            Answer::Rule(slave) => {
                let node = found(*slave)?;
                let (options, right) = cells(&node.1)?;
                (
                    AnswerKind::Choice,
                    options,
                    RightAnswer::Choice(right),
                    Some(node),
                )
            }
            Answer::Number(quantity, tolerance) => {
                let value = quantity.number(&look)?;
                if !value.is_finite() {
                    return Err(LessonError::NotFinite);
                }
                let tolerance = *tolerance;
                (
                    AnswerKind::Number,
                    Vec::new(),
                    RightAnswer::Number { value, tolerance },
                    None,
                )
            }
            Answer::Choice(choices) => {
                let texts = choices.iter().map(|(text, _)| text.fill(now, "…"));
                let options = texts.collect::<Result<_, _>>()?;
                (
                    AnswerKind::Choice,
                    options,
                    RightAnswer::Choice(chosen(choices, &look)?),
                    None,
                )
            }
        };
        let mut question = TutorQuestion {
            kind,
            options,
            right,
            node,
            is_ahead: ask.ahead > 0,
            hint: ask.hint.fill(now, "…")?,
            then: String::new(),
            tries: 0,
        };
        let words = question.words();
        question.then = ask.then.fill(&look, &words)?;
        Ok(question)
    }

    fn is_right(&self, word: &str) -> Result<bool, LessonRefusal> {
        let word = word.trim();
        match &self.right {
            RightAnswer::Mode(right) => match action::mode(word) {
                Some(mode) => Ok(mode == *right),
                None => Err(LessonRefusal::NoMode(word.into())),
            },
            RightAnswer::Choice(right) => match word.parse::<usize>() {
                Ok(number) if (1..=self.options.len()).contains(&number) => {
                    Ok(number - 1 == *right)
                }
                _ => Err(LessonRefusal::NoOption(word.into(), self.options.len())),
            },
            RightAnswer::Number { value, tolerance } => {
                // Accept typographic minus signs and decimal commas.
                let plain = word.replace('−', "-").replace(',', ".");
                let given: f64 = plain
                    .parse()
                    .map_err(|_| LessonRefusal::NoNumber(word.into()))?;
                Ok((given - value).abs() <= tolerance * value.abs())
            }
        }
    }

    /// The right answer in words.
    fn words(&self) -> String {
        match &self.right {
            RightAnswer::Mode(mode) => names::mode(*mode).into(),
            RightAnswer::Choice(index) => format!("{}", index + 1),
            RightAnswer::Number { value, .. } => sig4(*value),
        }
    }

    /// The reply to the right answer.
    pub(super) fn reply_to_right(&self) -> String {
        format!("Right: {}", self.explained())
    }

    /// The reply to a wrong answer that allows another attempt.
    pub(super) fn reply_to_wrong(&self) -> String {
        format!("No. {}", self.help())
    }

    /// The right answer with the reason.
    fn explained(&self) -> String {
        let mut text = self.words() + ".";
        if let Some((_, decision, friction)) = &self.node {
            text += &format!(
                " {}. {}",
                compared(decision),
                report::reason(decision, *friction)
            );
        }
        if !self.then.is_empty() {
            text += &format!(" {}", self.then);
        }
        text
    }

    /// A hint without the answer: the row of Table 2, and the numbers of the decision.
    fn help(&self) -> String {
        let mut text = match &self.node {
            Some((_, decision, _)) if !self.is_ahead => format!(
                "Look at row {} of Table 2: {}.",
                names::mode(decision.before),
                compared(decision)
            ),
            _ => String::new(),
        };
        text += if text.is_empty() || self.hint.is_empty() {
            ""
        } else {
            " "
        };
        text += &self.hint;
        if text.is_empty() {
            "Try again.".into()
        } else {
            text
        }
    }
}

/// Cells of Table 2 in the row of the node's mode, and the index of the one that applied.
fn cells(decision: &Decision) -> Result<(Vec<String>, usize), LessonError> {
    if matches!(decision.rule, Rule::Held | Rule::OffSurface) {
        return Err(LessonError::NoCell);
    }
    let place = |mode: Mode| MODES.iter().position(|m| *m == mode).unwrap_or(0);
    let cell = |(column, mode): (usize, &Mode)| {
        let [first, second] = TABLE_2[place(decision.before)][column];
        let and = if second.is_empty() { "" } else { " and " };
        format!("{first}{and}{second}: {}", names::mode(*mode))
    };
    let options = MODES.iter().enumerate().map(cell).collect();
    Ok((options, place(decision.next)))
}

/// The only right choice.
fn chosen(choices: &[(Template, Truth)], look: &FrameValues) -> Result<usize, LessonError> {
    let mut right = Vec::new();
    for (index, (_, truth)) in choices.iter().enumerate() {
        let holds = match truth {
            Truth::Known(known) => *known,
            Truth::Cycles => look.end()?.cycle.is_some(),
            Truth::Accepted => look.end()?.accepted,
            Truth::Answers(count) => look.answers()? == *count,
            Truth::Becomes(slave, mode) => look.record(*slave)?.decision.next == *mode,
            Truth::Quadratic(wanted) => look.end()?.is_quadratic()? == *wanted,
            Truth::Obeys => look.verdict()?.broken().next().is_none(),
            Truth::Breaks(law) => look.verdict()?.broken().any(|found| found.law == *law),
            Truth::Less(a, b) => a.number(look)? < (1.0 - CLOSE) * b.number(look)?,
            Truth::Close(a, b) => {
                let (a, b) = (a.number(look)?, b.number(look)?);
                (a - b).abs() <= CLOSE * a.abs().max(b.abs())
            }
            Truth::Cheapest(settings, error) => look.runs()?.is_cheapest(settings, *error)?,
        };
        right.extend(holds.then_some(index));
    }
    match right[..] {
        [index] => Ok(index),
        [] => Err(LessonError::NoneTrue),
        _ => Err(LessonError::SeveralTrue),
    }
}

/// The inequalities tested, with their numbers.
fn compared(decision: &Decision) -> String {
    let side = |test: &Test| {
        let sign = match test.value.partial_cmp(&test.bound) {
            _ if test.tie => "ties with",
            Some(std::cmp::Ordering::Less) => "<",
            Some(std::cmp::Ordering::Greater) => ">",
            _ => "=",
        };
        let (name, bound) = tested::sides(test.tested);
        let bound = bound.map_or("0".into(), |bound| {
            format!("{bound} = {}", sig4(test.bound))
        });
        format!("{name} = {} {sign} {bound}", sig4(test.value))
    };
    let tests: Vec<String> = decision.tests.iter().flatten().map(side).collect();
    tests.join(", and ")
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    match letters.next() {
        Some(first) => first.to_uppercase().chain(letters).collect(),
        None => String::new(),
    }
}
