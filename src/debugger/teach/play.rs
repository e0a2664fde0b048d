//! Plays a lesson automatically, to check that every step can be reached and every question has one answer.

use super::lesson::{Lesson, LessonStep};
use super::progress::{LessonProgress, ProgressStore};
use super::question::{AnswerKind, TutorQuestion};
use super::tutor::Tutor;
use crate::action::Action;
use crate::explain::report;
use crate::recorded::exchange;
use crate::refusal::{Refusal, refusal};
use crate::{Command, Recording, Session, Unit};
use std::sync::Arc;
use stickslip_core::counted;
use stickslip_scene::{SceneError, shortest, sig4};

/// Maximum number of minor iterations that provide the predictions of a step.
const MOST_STEPS: u32 = 1000;

/// A question with the solver's answer and the replies, numbers filled in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AnsweredQuestion {
    /// Index of the step, from 0.
    pub step: usize,
    /// The texts since the previous question.
    pub before: Vec<String>,
    /// The question.
    pub question: String,
    /// The choices, if there are any.
    pub options: Vec<String>,
    /// The right answer, as typed.
    pub answer: String,
    /// The reply to the right answer.
    pub then: String,
    /// The reply to a wrong answer.
    pub hint: String,
}

/// Plays a lesson with the right keys and answers.
///
/// # Errors
/// For the first step that cannot be completed, with its line and column.
pub fn play(lesson: &Arc<Lesson>) -> Result<Vec<AnsweredQuestion>, SceneError> {
    let mut session = session(lesson);
    let mut tutor = Tutor::new(lesson.clone(), session.cursor(), session.frame());
    advance(&mut tutor, &mut session, lesson.steps.len())
}

/// Starts a lesson at a step (from 0), or else where the user left it. The steps before it are played with the right
/// answers; if one of them cannot be played, the lesson starts at its beginning.
pub fn begin(lesson: Lesson, step: Option<usize>, progress: &ProgressStore) -> (Tutor, Session) {
    let reached = match step {
        Some(_) => LessonProgress::default(),
        None => progress.of(&lesson.name).unwrap_or_default(),
    };
    let at = step.unwrap_or_else(|| reached.resumes_at(lesson.steps.len()));
    let lesson = Arc::new(lesson);
    let fresh = || {
        let session = session(&lesson);
        let tutor = Tutor::new(lesson.clone(), session.cursor(), session.frame());
        (tutor, session)
    };
    let (mut tutor, mut session) = fresh();
    if at > 0 {
        if advance(&mut tutor, &mut session, at).is_err() {
            return fresh();
        }
        tutor.resume(reached.given);
    }
    (tutor, session)
}

/// A session at the start of a lesson's scene, or of its recorded exchange.
fn session(lesson: &Lesson) -> Session {
    let recorded = lesson.recorded.as_deref();
    let opened = recorded.and_then(|(name, text)| exchange::open(name, text).ok());
    match opened {
        Some(opened) => Session::recorded(Recording::Exchange(Box::new(opened))),
        None => Session::new(lesson.scene.clone()),
    }
}

/// Plays the steps before `to`.
fn advance(
    tutor: &mut Tutor,
    session: &mut Session,
    to: usize,
) -> Result<Vec<AnsweredQuestion>, SceneError> {
    let lesson = tutor.lesson.clone();
    let (mut answered, mut before) = (Vec::new(), Vec::new());
    while let Some(step) = lesson.steps.get(tutor.at()).filter(|_| tutor.at() < to) {
        let at = tutor.at();
        let fault = |why: Refusal| lesson.fault(at, why.to_string());
        if let Some(message) = tutor.fault() {
            return Err(lesson.fault(at, message.to_owned()));
        }
        match step {
            LessonStep::Text(_) => before.push(tutor.text().to_owned()),
            LessonStep::Press { action, .. } => {
                before.push(tutor.text().to_owned());
                tutor
                    .permits(action, session.cursor(), session.frame())
                    .map_err(fault)?;
                perform(action, session).map_err(fault)?;
                tutor.settled(session.shown_frames());
                continue;
            }
            LessonStep::Reach(task) => {
                let answer = tutor.todo();
                for action in &task.solution {
                    perform(action, session).map_err(fault)?;
                    tutor.settled(session.shown_frames());
                }
                answered.push(AnsweredQuestion {
                    step: at,
                    before: std::mem::take(&mut before),
                    question: tutor.text().to_owned(),
                    options: Vec::new(),
                    answer,
                    then: tutor.last_reply(),
                    hint: tutor.task_hint.clone(),
                });
                if !tutor.is_read() {
                    let frame = session.frame();
                    let event = frame.event.as_ref();
                    let end = event.map_or_else(String::new, |event| {
                        let load = shortest(event.load_factor);
                        format!("load {load}, {}", report::outcome(session.model(), event))
                    });
                    return Err(fault(refusal!(
                        "the solution does not reach the goal; it ends at {end} {}",
                        tutor.last_reply()
                    )));
                }
            }
            LessonStep::Ask(_) => {
                let word = tutor.solution().unwrap_or_default();
                let question = tutor.question();
                answered.push(AnsweredQuestion {
                    step: at,
                    before: std::mem::take(&mut before),
                    question: tutor.text().to_owned(),
                    options: question
                        .map(|question| question.options.clone())
                        .unwrap_or_default(),
                    answer: readable(tutor, &word),
                    then: question
                        .map(TutorQuestion::reply_to_right)
                        .unwrap_or_default(),
                    hint: question
                        .map(|question| question.reply_to_wrong(""))
                        .unwrap_or_default(),
                });
                tutor
                    .answer(&word, 0, session.cursor(), session.frame())
                    .map_err(fault)?;
            }
            LessonStep::Predict { right, .. } => {
                predict(*right, tutor, session).map_err(fault)?;
            }
        }
        tutor.on(session.cursor(), session.frame()).map_err(fault)?;
    }
    Ok(answered)
}

/// Executes the action of a step; actions of the screen need no session.
fn perform(action: &Action, session: &mut Session) -> Result<(), Refusal> {
    if let Action::Session(command) = action {
        session.submit(command.clone())?;
        session.wait();
    }
    Ok(())
}

/// Predicts what Table 2 decides until enough predictions were right.
fn predict(right: u32, tutor: &mut Tutor, session: &mut Session) -> Result<(), Refusal> {
    let step = Action::Session(Command::Forward {
        unit: Unit::Minor,
        count: 1,
    });
    for _ in 0..MOST_STEPS {
        tutor.permits(&step, session.cursor(), session.frame())?;
        let before = session.cursor();
        perform(&step, session)?;
        if session.cursor() == before {
            break;
        }
        let next = session
            .frame()
            .event
            .as_ref()
            .and_then(|event| event.nodes.first());
        if let Some(node) = next {
            let word = node.decision.next.word();
            tutor.answer(word, 0, session.cursor(), session.frame())?;
        }
        if tutor.guess().is_some_and(|guess| guess.right >= right) {
            return Ok(());
        }
    }
    Err(refusal!(
        "the history has fewer than {} to predict",
        counted(right, "iteration")
    ))
}

/// An answer as listed by the check.
fn readable(tutor: &Tutor, word: &str) -> String {
    match tutor.question() {
        Some(question) if question.kind() == AnswerKind::Choice => {
            let index = word.parse::<usize>().unwrap_or(1) - 1;
            let text = question.options.get(index).map_or("", String::as_str);
            format!("{word} ({text})")
        }
        Some(question) if question.kind() == AnswerKind::Number => {
            word.parse().map_or(word.to_owned(), sig4)
        }
        _ => word.to_owned(),
    }
}
