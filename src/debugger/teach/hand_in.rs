//! What students hand in, and the table of a class.
//!
//! A hand-in is the file of lesson progress ([`super::progress`]) with a name: answers, attempts and times, as the program
//! recorded them. It is a plain file that its owner can edit.

use super::progress::{LessonProgress, Progress};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use stickslip_platform::files::FileError;
use stickslip_scene::shown;

/// Writes the user's progress as a hand-in, named as the file without its extension. Returns the name.
///
/// # Errors
/// If the file cannot be written, or exists and `overwrite` is false.
pub fn write(mut progress: Progress, to: &Path, overwrite: bool) -> Result<String, FileError> {
    progress.name = to
        .file_stem()
        .map(|stem| stem.to_string_lossy().into_owned())
        .unwrap_or_default();
    progress.write(to, overwrite)?;
    Ok(progress.name)
}

/// The table of a class: one row per hand-in, and one per lesson with the question that most students missed. `order` lists the
/// lessons that come first.
pub fn class_table(class: &[Progress], order: &[&str]) -> String {
    let mut students = vec![row(["student", "finished", "right", "minutes"])];
    students.extend(class.iter().map(student));
    let mut lessons = vec![row([
        "lesson",
        "finished",
        "right",
        "minutes",
        "most missed",
    ])];
    lessons.extend(taken(class, order).into_iter().map(|name| {
        let taken = class.iter().filter_map(|student| student.lessons.get(name));
        lesson(name, class.len(), &taken.collect::<Vec<_>>())
    }));
    let lines = |table: &[Vec<String>]| shown::aligned(table, 1).join("\n");
    format!("{}\n\n{}\n", lines(&students), lines(&lessons))
}

/// The lessons of a class: those of `order` first, others by name.
fn taken<'a>(class: &'a [Progress], order: &[&'a str]) -> Vec<&'a str> {
    let names: BTreeSet<&str> = class
        .iter()
        .flat_map(|student| student.lessons.keys().map(String::as_str))
        .collect();
    let first = order.iter().filter(|name| names.contains(**name)).copied();
    let others = names.iter().filter(|name| !order.contains(name)).copied();
    first.chain(others).collect()
}

fn row<const N: usize>(cells: [&str; N]) -> Vec<String> {
    cells.map(String::from).to_vec()
}

/// The row of a student.
fn student(progress: &Progress) -> Vec<String> {
    let taken: Vec<_> = progress.lessons.values().collect();
    let name = match progress.name.as_str() {
        "" => "without a name".into(),
        name => name.to_owned(),
    };
    let done = taken.iter().filter(|lesson| lesson.is_done()).count();
    vec![name, done.to_string(), right(&taken), minutes(&taken)]
}

/// The row of a lesson that these students took.
fn lesson(name: &str, students: usize, taken: &[&LessonProgress]) -> Vec<String> {
    let done = taken.iter().filter(|lesson| lesson.is_done()).count();
    let missed = most_missed(taken)
        .map(|(step, wrong)| format!("step {}, by {wrong} of {}", step + 1, taken.len()))
        .unwrap_or_default();
    vec![
        name.to_owned(),
        format!("{done} of {students}"),
        right(taken),
        minutes(taken),
        missed,
    ]
}

/// Answers that were right at the first attempt, of those given.
fn right(taken: &[&LessonProgress]) -> String {
    let (right, all) = taken
        .iter()
        .flat_map(|lesson| &lesson.given)
        .filter(|given| given.counts)
        .fold((0, 0), |(right, all), given| {
            (right + usize::from(given.right), all + 1)
        });
    format!("{right}/{all}")
}

/// The total time of these runs in minutes, rounded up.
fn minutes(taken: &[&LessonProgress]) -> String {
    let seconds: u64 = taken.iter().map(|lesson| u64::from(lesson.seconds)).sum();
    (seconds.div_ceil(60)).to_string()
}

/// The step whose first answer was wrong most often, and how often; `None` if all were right.
fn most_missed(taken: &[&LessonProgress]) -> Option<(usize, usize)> {
    let mut wrong: BTreeMap<usize, usize> = BTreeMap::new();
    for given in taken
        .iter()
        .flat_map(|lesson| &lesson.given)
        .filter(|given| given.counts && !given.right)
    {
        *wrong.entry(given.step).or_default() += 1;
    }
    // The first of several.
    wrong
        .into_iter()
        .max_by_key(|(step, count)| (*count, std::cmp::Reverse(*step)))
}
