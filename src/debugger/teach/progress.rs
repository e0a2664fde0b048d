//! How far the user came in which lesson: a small file in RON, kept where journals are.

use super::tutor::Tutor;
use crate::record::journal;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use stickslip_platform::files::{self, FileError};
use stickslip_platform::input::{self, Unreadable};
use stickslip_scene::format::notation;

/// The format that this program writes, and the only one that it reads.
pub const FORMAT: u32 = 1;
/// More bytes than any such file has.
const BYTES: u64 = 1 << 20;

/// How far the user came in a lesson.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reached {
    /// Steps that were done, the farthest that ever was.
    pub steps: usize,
    /// Steps that the lesson has.
    pub of: usize,
    /// How often it was taken to its end.
    pub ended: u32,
    /// Questions answered right at once, the best of all times that it was taken to its end.
    pub right: u32,
    /// Questions asked then.
    pub asked: u32,
}

/// How far the user came in all lessons, by their names.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Progress {
    format: u32,
    lessons: BTreeMap<String, Reached>,
}

impl Default for Progress {
    fn default() -> Self {
        let (format, lessons) = (FORMAT, BTreeMap::new());
        Progress { format, lessons }
    }
}

/// Why progress cannot be read or kept.
#[derive(Debug, thiserror::Error)]
pub enum ProgressError {
    /// It cannot be read.
    #[error("{}: what was done of the lessons cannot be read: {why}", file.display())]
    Unread {
        /// The file.
        file: PathBuf,
        /// Why.
        why: Unreadable,
    },
    /// It is no such file.
    #[error("{}:{line}: what was done of the lessons cannot be read: {message}; delete the file to begin anew", file.display())]
    Damaged {
        /// The file.
        file: PathBuf,
        /// From 1.
        line: usize,
        /// What is wrong there.
        message: String,
    },
    /// It is of another format than this program knows.
    #[error("{}: it has format {found}, and this program knows only format {FORMAT}", file.display())]
    Format {
        /// The file.
        file: PathBuf,
        /// Its format.
        found: u32,
    },
    /// It cannot be written.
    #[error("what was done of the lesson cannot be kept: {0}")]
    Unwritten(#[from] FileError),
}

/// The file in which progress is kept; `None` where the system names no home directory.
pub fn place() -> Option<PathBuf> {
    Some(journal::home().ok()?.join("lessons.ron"))
}

impl Progress {
    /// Reads a file; where there is none, nothing was done yet.
    ///
    /// # Errors
    /// If it is there and cannot be read.
    pub fn read(file: &Path) -> Result<Progress, ProgressError> {
        if !file.exists() {
            return Ok(Progress::default());
        }
        let unread = |why| ProgressError::Unread {
            file: file.to_owned(),
            why,
        };
        let text = input::text(file, BYTES, "delete it to begin anew").map_err(unread)?;
        let read: Progress = notation::read(&text).map_err(|e| ProgressError::Damaged {
            file: file.to_owned(),
            line: e.span.start.line,
            message: e.code.to_string(),
        })?;
        match read.format {
            FORMAT => Ok(read),
            found => Err(ProgressError::Format {
                file: file.to_owned(),
                found,
            }),
        }
    }

    /// What was done of a lesson.
    pub fn of(&self, lesson: &str) -> Option<Reached> {
        self.lessons.get(lesson).copied()
    }

    /// Takes in where a lesson stands. Returns whether that is farther than ever before.
    fn take(&mut self, tutor: &Tutor) -> bool {
        let (lesson, (right, asked)) = (tutor.lesson(), tutor.score());
        let reached = self.lessons.entry(lesson.name.clone()).or_default();
        let before = *reached;
        // A lesson that was changed since is counted as it is now.
        if reached.of != lesson.steps.len() {
            *reached = Reached::default();
        }
        reached.of = lesson.steps.len();
        reached.steps = reached.steps.max(tutor.at());
        if tutor.step().is_none() {
            reached.ended += 1;
            // The first time there is nothing to be better than.
            if reached.ended == 1 || right > reached.right {
                (reached.right, reached.asked) = (right, asked);
            }
        }
        *reached != before
    }
}

impl Reached {
    /// Whether the lesson was finished.
    pub fn is_done(&self) -> bool {
        self.ended > 0
    }

    /// A short description: `done, 4/4 right`, or `step 3 of 13` for the next step.
    pub fn told(&self) -> String {
        match (self.ended, self.asked) {
            (0, _) => format!("step {} of {}", (self.steps + 1).min(self.of), self.of),
            (_, 0) => "done".into(),
            (_, asked) => format!("done, {}/{asked} right", self.right),
        }
    }
}

/// Keeps progress while a lesson is taken.
#[derive(Debug, Clone, Default)]
pub struct Keeper {
    /// The file; `None` if nothing is kept.
    file: Option<PathBuf>,
    /// The lesson and its step that were kept last.
    kept: Option<(String, usize)>,
}

impl Keeper {
    /// Keeps it in this file.
    pub fn new(file: Option<PathBuf>) -> Keeper {
        Keeper { file, kept: None }
    }

    /// Keeps where a lesson stands, if that is another step than before.
    ///
    /// # Errors
    /// As [`keep`]; nothing is tried any more then, since once is enough to be told.
    pub fn follow(&mut self, tutor: &Tutor) -> Result<(), ProgressError> {
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

/// Keeps where a lesson stands, if that is farther than ever before; other sessions may have written in the meantime.
///
/// # Errors
/// If the file cannot be read or written. It is written whole, or stays as it was.
pub fn keep(file: &Path, tutor: &Tutor) -> Result<(), ProgressError> {
    let mut progress = Progress::read(file)?;
    if !progress.take(tutor) {
        return Ok(());
    }
    let layout = ron::ser::PrettyConfig::new();
    let text = notation::lines(&progress, layout);
    let text = text.map_err(|e| ProgressError::Damaged {
        file: file.to_owned(),
        line: 1,
        message: e.to_string(),
    })?;
    if let Some(folder) = file.parent() {
        std::fs::create_dir_all(folder).map_err(|source| FileError::Failed {
            path: folder.to_owned(),
            source,
        })?;
    }
    Ok(files::write(file, &text, true)?)
}
