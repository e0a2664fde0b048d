//! `stickslip lesson [NAME|FILE]`: lists the guided lessons, starts one, checks or prints one without a terminal, and collects what
//! students hand in.

use super::base::{Error, Exit, answer, notify, say, usage};
use super::debugger::needs_terminal;
use super::front;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use stickslip_core::counted;
use stickslip_debugger::Lesson;
use stickslip_debugger::teach::play::play;
use stickslip_debugger::teach::progress::{self, Progress};
use stickslip_debugger::teach::tutor::{Paragraph, paragraphs};
use stickslip_debugger::teach::{self, hand_in, lesson};
use stickslip_scene::shown;
use unicode_width::UnicodeWidthStr;

/// Columns of a printed exercise sheet.
const SHEET_WIDTH: usize = 80;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// A lesson file, or a built-in lesson by name or number; NAME@STEP starts at a step. Without one, lists the lessons
    lesson: Option<String>,
    /// Takes the lesson on this scene instead of its own, such as lesson cure on a scene that fails
    #[arg(long, value_name = "SCENE", requires = "lesson")]
    scene: Option<String>,
    /// Plays the lesson with the right keys and answers, and prints its questions, answers, replies and hints
    #[arg(long, requires = "lesson")]
    check: bool,
    /// Prints the questions of the lesson without answers, as an exercise sheet
    #[arg(long, requires = "lesson", conflicts_with = "check")]
    sheet: bool,
    /// Writes your answers, attempts and times in all lessons to a file that you can hand in; its name is yours: ada.work
    #[arg(long, value_name = "FILE", conflicts_with = "lesson")]
    work: Option<PathBuf>,
    /// Overwrites an existing file
    #[arg(long, requires = "work")]
    force: bool,
    /// Prints the table of a class from files that were handed in
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with_all = ["lesson", "work"])]
    collect: Vec<PathBuf>,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    if let Some(to) = &args.work {
        return write_hand_in(to, args.force);
    }
    if !args.collect.is_empty() {
        return collect(&args.collect);
    }
    let Some(name) = &args.lesson else {
        return answer(&list()?);
    };
    let (name, step) = lesson::split_step(name);
    let lesson = match &args.scene {
        Some(scene) => Lesson::open_on(name, scene)?,
        None => Lesson::open(name)?,
    };
    if args.check || args.sheet {
        let text = if args.check {
            check(lesson)?
        } else {
            sheet(lesson)?
        };
        return answer(&text);
    }
    front::ready()?;
    let instead = format!("lesson --check {name}` plays it without one");
    needs_terminal("a lesson", &instead)?;
    front::lesson(lesson, step)?;
    Ok(Exit::Good)
}

/// Writes the user's progress to a file.
fn write_hand_in(to: &Path, force: bool) -> Result<Exit, Error> {
    let own = progress::place()
        .ok_or_else(|| usage!("--work: no folder with your progress: HOME is not set"))?;
    if !own.exists() {
        return Err(usage!(
            "--work: you have not begun a lesson yet: {} does not exist",
            own.display()
        ));
    }
    let own = Progress::read(&own).map_err(Error::usage)?;
    let name = hand_in::write(own, to, force)?;
    notify(&format!("wrote {}, for {name}", to.display()));
    Ok(Exit::Good)
}

/// Prints the table of a class, lessons in teaching order. Files that cannot be read, and copies, are named and left out.
fn collect(files: &[PathBuf]) -> Result<Exit, Error> {
    let (mut class, mut left_out) = (Vec::new(), 0);
    for file in files {
        let read = match Progress::read(file) {
            _ if !file.exists() => Err(usage!("{}: no such file", file.display())),
            Ok(own) if class.contains(&own) => {
                let (file, name) = (file.display(), &own.name);
                Err(usage!(
                    "{file}: the work of {name}, which another file has too"
                ))
            }
            read => read.map_err(Error::usage),
        };
        match read {
            Ok(own) => class.push(own),
            Err(error) => {
                notify(&error.to_string());
                left_out += 1;
            }
        }
    }
    let order: Vec<&str> = teach::list().iter().map(|lesson| lesson.name).collect();
    if !class.is_empty() {
        say(&hand_in::class_table(&class, &order))?;
    }
    match left_out {
        0 => Ok(Exit::Good),
        left_out => Err(usage!("{left_out} of {} files left out", files.len())),
    }
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
            .map(|r| r.words())
            .unwrap_or_default()
    };
    let width = lessons
        .iter()
        .map(|lesson| lesson.name.width())
        .max()
        .unwrap_or(0);
    let column = lessons.iter().map(|lesson| done(lesson).width()).max();
    Ok(lessons
        .iter()
        .enumerate()
        .map(|(index, lesson)| {
            let mut line = format!("{:>2}  {}  ", index + 1, shown::padded(&lesson.name, width));
            // Without any progress there is no column for it.
            if let Some(column @ 1..) = column {
                line += &(shown::padded(&done(lesson), column) + "  ");
            }
            format!("{line}{}\n", lesson.title)
        })
        .collect())
}

fn check(lesson: Lesson) -> Result<String, Error> {
    let lesson = Arc::new(lesson);
    let answers = play(&lesson)?;
    let (steps, questions) = (lesson.steps.len(), answers.len());
    let mut text = format!(
        "{}: sound; {}, {}\n",
        lesson.name,
        counted(steps, "step"),
        counted(questions, "question")
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

/// The questions of a lesson, numbered, with the texts before each.
fn sheet(lesson: Lesson) -> Result<String, Error> {
    let lesson = Arc::new(lesson);
    let mut text = lesson.title.clone() + "\n";
    for (number, asked) in (1..).zip(play(&lesson)?) {
        if !asked.before.is_empty() {
            text += &printed("", &asked.before.join(" "));
        }
        text += &printed(&format!("{number}. "), &asked.question);
        for (option, letter) in asked.options.iter().zip('a'..) {
            text += &indented(&format!("   {letter}) "), option);
        }
    }
    Ok(text)
}

/// A text after an empty line, with its equations on lines of their own.
fn printed(mark: &str, text: &str) -> String {
    let indent = " ".repeat(mark.width());
    let lines = paragraphs(text)
        .into_iter()
        .enumerate()
        .map(|(k, paragraph)| match paragraph {
            Paragraph::Equation(equation) => indented(&format!("{indent}    "), &equation),
            Paragraph::Text(text) if k == 0 => indented(mark, &text),
            Paragraph::Text(text) => indented(&indent, &text),
            _ => String::new(),
        });
    "\n".to_owned() + &lines.collect::<String>()
}

/// A text that begins with a mark, its further lines below the first.
fn indented(mark: &str, text: &str) -> String {
    let indent = " ".repeat(mark.width());
    let lines = shown::wrap(text, SHEET_WIDTH - mark.width());
    lines
        .iter()
        .enumerate()
        .map(|(k, line)| match k {
            0 => format!("{mark}{line}\n"),
            _ => format!("{indent}{line}\n"),
        })
        .collect()
}
