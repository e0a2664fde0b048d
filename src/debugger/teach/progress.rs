//! The user's progress in the lessons, saved in a small RON file next to the journals.

use super::lesson;
use super::tutor::{GivenAnswer, Tutor};
use crate::record::journal;
use crate::refusal::{Refusal, refusal};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use stickslip_platform::disk;
use stickslip_platform::files::{self, FileError};
use stickslip_platform::input;
use stickslip_scene::format::{notation, read};
use stickslip_scene::readers::FileKind;

/// Format version written by this program, and the only one it reads.
pub const FORMAT: u32 = 1;
/// Maximum size of the file.
const BYTES: u64 = 1 << 20;

/// Progress in a lesson.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LessonProgress {
    /// The largest number of steps completed so far.
    pub steps: usize,
    /// Number of steps of the lesson.
    pub of: usize,
    /// How often the lesson was finished.
    pub ended: u32,
    /// Questions answered right at the first attempt, in the best finished run.
    pub right: u32,
    /// Number of questions in that run.
    pub asked: u32,
    /// The answers of the best finished run, or of the current one while there is none.
    #[serde(default)]
    pub given: Vec<GivenAnswer>,
    /// Seconds that this run took.
    #[serde(default)]
    pub seconds: u32,
}

/// Progress in all lessons, by name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Progress {
    format: u32,
    /// Who handed it in; empty in the user's own file.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    pub(super) lessons: BTreeMap<String, LessonProgress>,
}

impl Default for Progress {
    fn default() -> Self {
        Progress {
            format: FORMAT,
            name: String::new(),
            lessons: BTreeMap::new(),
        }
    }
}

/// Path of the file; `None` if the system has no home directory.
pub fn place() -> Option<PathBuf> {
    Some(journal::home().ok()?.join("lessons.ron"))
}

impl Progress {
    /// Reads a file; a missing file means no progress.
    ///
    /// # Errors
    /// If the file exists and cannot be read.
    pub fn read(file: &Path) -> Result<Progress, Refusal> {
        if !disk::exists(file) {
            return Ok(Progress::default());
        }
        let at = file.display();
        let text = input::text(file, BYTES, "delete it to start again")
            .map_err(|why| refusal!("{at}: lesson progress cannot be read: {why}"))?;
        let read: Progress = notation::read(&text).map_err(|e| {
            let line = e.span.start.line;
            let why = match FileKind::from_text(&text) {
                Some(kind) => format!("this is {}", kind.name()),
                None => read::plainly(&e.code),
            };
            let next = match place().is_some_and(|own| own == file) {
                true => "delete the file to start again",
                false => "`stickslip lesson --work FILE` writes a file to hand in",
            };
            refusal!("{at}:{line}: lesson progress cannot be read: {why}; {next}")
        })?;
        match read.format {
            FORMAT => Ok(read.renamed()),
            found => Err(refusal!(
                "{at}: the file has format {found}, but this program reads only format {FORMAT}"
            )),
        }
    }

    /// The progress with the current names of lessons. If a file has both names, the finished lesson counts.
    fn renamed(mut self) -> Progress {
        for (name, reached) in std::mem::take(&mut self.lessons) {
            let name = lesson::current_name(&name).to_owned();
            let kept = self.lessons.entry(name).or_default();
            if (reached.ended, reached.right) >= (kept.ended, kept.right) {
                *kept = reached;
            }
        }
        self
    }

    /// Progress in a lesson.
    pub fn of(&self, lesson: &str) -> Option<LessonProgress> {
        self.lessons.get(lesson).cloned()
    }

    /// Writes it to a file; `overwrite` allows replacing an existing one.
    ///
    /// # Errors
    /// If the file cannot be written, or exists and must stay.
    pub(super) fn write(&self, file: &Path, overwrite: bool) -> Result<(), FileError> {
        let text = notation::lines(self, ron::ser::PrettyConfig::new());
        let text = text.map_err(|error| FileError::Failed {
            path: file.to_owned(),
            source: io::Error::other(error),
        })?;
        files::write(file, &text, overwrite)
    }

    /// Updates the progress from the state of a lesson. Returns whether anything improved.
    fn take(&mut self, tutor: &Tutor) -> bool {
        let (lesson, (right, asked)) = (tutor.lesson(), tutor.score());
        let reached = self.lessons.entry(lesson.name.clone()).or_default();
        let before = reached.clone();
        // If the number of steps has changed, only whether the lesson was finished still counts.
        if reached.of != lesson.steps.len() {
            reached.steps = 0;
        }
        reached.of = lesson.steps.len();
        reached.steps = reached.steps.max(tutor.at());
        let has_ended = tutor.step().is_none();
        // The first result is always the best one.
        if reached.ended == 0 || (has_ended && right > reached.right) {
            reached.given = tutor.given().to_vec();
            reached.seconds = tutor.clock();
            if has_ended {
                (reached.right, reached.asked) = (right, asked);
            }
        }
        reached.ended += u32::from(has_ended);
        *reached != before
    }
}

impl LessonProgress {
    /// Whether the lesson has been finished.
    pub fn is_done(&self) -> bool {
        self.ended > 0
    }

    /// The step (from 0) at which a lesson with this number of steps resumes: 0 if it was finished or has changed.
    pub fn resumes_at(&self, steps: usize) -> usize {
        if self.ended == 0 && self.of == steps {
            self.steps.min(steps.saturating_sub(1))
        } else {
            0
        }
    }

    /// A short description: `done, 4/4 right`, or `step 3 of 13` for the next step.
    pub fn words(&self) -> String {
        match (self.ended, self.asked) {
            (0, _) => format!("step {} of {}", (self.steps + 1).min(self.of), self.of),
            (_, 0) => "done".into(),
            (_, asked) => format!("done, {}/{asked} right", self.right),
        }
    }
}

/// Saves progress during a lesson.
#[derive(Debug, Clone, Default)]
pub struct ProgressStore {
    /// The file; `None` if nothing is saved.
    file: Option<PathBuf>,
    /// The lesson and step saved last.
    kept: Option<(String, usize)>,
}

impl ProgressStore {
    /// Saves to this file.
    pub fn new(file: Option<PathBuf>) -> ProgressStore {
        ProgressStore { file, kept: None }
    }

    /// The progress in a lesson; `None` if there is none, or if it cannot be read.
    pub fn of(&self, lesson: &str) -> Option<LessonProgress> {
        Progress::read(self.file.as_deref()?).ok()?.of(lesson)
    }

    /// Saves the state of a lesson if its step has changed.
    ///
    /// # Errors
    /// As [`keep`]. After an error nothing more is saved, so that it is reported only once.
    pub fn follow(&mut self, tutor: &Tutor) -> Result<(), Refusal> {
        let here = Some((tutor.lesson().name.clone(), tutor.at()));
        let Some(file) = &self.file else {
            return Ok(());
        };
        if self.kept == here {
            return Ok(());
        }
        let kept = keep(file, tutor);
        self.kept = here;
        if kept.is_err() {
            self.file = None;
        }
        kept
    }
}

/// Saves the state of a lesson if it improved. Reads the file first, because other sessions may have changed
/// it.
///
/// # Errors
/// If the file cannot be read or written. The file is replaced completely or stays unchanged.
pub fn keep(file: &Path, tutor: &Tutor) -> Result<(), Refusal> {
    let mut progress = Progress::read(file)?;
    if !progress.take(tutor) {
        return Ok(());
    }
    let folder = file.parent().map_or(Ok(()), files::create_folder);
    folder
        .and_then(|()| progress.write(file, true))
        .map_err(|why| refusal!("lesson progress cannot be saved: {why}"))
}
