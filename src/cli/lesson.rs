//! `stickslip lesson [NAME|FILE]`: lists the guided lessons, starts one, or checks one without a terminal.

use super::base::{Error, Exit, say};
use super::debugger::needs_terminal;
use super::front;
use std::fmt::Write;
use std::sync::Arc;
use stickslip_debugger::teach::play::play;
use stickslip_debugger::teach::progress::{self, Progress};
use stickslip_debugger::teach::{self, Lesson, lesson};
use stickslip_scene::shown;
use unicode_width::UnicodeWidthStr;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// A lesson file, or a built-in lesson by name or number; NAME@STEP starts at a step. Without one, lists the lessons
    lesson: Option<String>,
    /// Plays the lesson with the right keys and answers, and prints its questions, answers, replies and hints
    #[arg(long, requires = "lesson")]
    check: bool,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let Some(name) = &args.lesson else {
        say(&list()?)?;
        return Ok(Exit::Good);
    };
    let (name, step) = lesson::split_step(name);
    let lesson = Lesson::open(name)?;
    if args.check {
        say(&check(lesson)?)?;
        return Ok(Exit::Good);
    }
    front::ready()?;
    let instead = format!("lesson --check {name}` plays it without one");
    needs_terminal("a lesson", &instead)?;
    front::lesson(lesson, step)?;
    Ok(Exit::Good)
}

/// The built-in lessons, one per line, with the user's progress.
fn list() -> Result<String, Error> {
    let progress = match progress::place() {
        Some(file) => Progress::read(&file).map_err(Error::usage)?,
        None => Progress::default(),
    };
    let lessons: Vec<_> = teach::list()
        .iter()
        .filter_map(|lesson| Lesson::from_text(lesson.name, lesson.text).ok())
        .collect();
    let done = |lesson: &Lesson| {
        progress
            .of(&lesson.name)
            .map_or(String::new(), |r| r.words())
    };
    let names = lessons.iter().map(|lesson| lesson.name.width());
    let width = names.max().unwrap_or(0);
    let column = lessons.iter().map(|lesson| done(lesson).width()).max();
    let line = |(index, lesson): (usize, &Lesson)| {
        let mut line = format!("{:>2}  {}  ", index + 1, shown::padded(&lesson.name, width));
        // Without any progress there is no column for it.
        if let Some(column @ 1..) = column {
            line += &(shown::padded(&done(lesson), column) + "  ");
        }
        format!("{line}{}: {}\n", lesson.title, lesson.about)
    };
    Ok(lessons.iter().enumerate().map(line).collect())
}

fn check(lesson: Lesson) -> Result<String, Error> {
    let lesson = Arc::new(lesson);
    let answers = play(&lesson)?;
    let (steps, questions) = (lesson.steps.len(), answers.len());
    let mut text = format!(
        "{}: sound; {steps} steps, {questions} questions\n",
        lesson.name
    );
    for answered in &answers {
        let step = answered.step + 1;
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "  step {step}: {}\n    → {}\n    ✓ {}\n    ✗ {}",
            answered.question, answered.answer, answered.then, answered.hint
        );
    }
    Ok(text)
}
