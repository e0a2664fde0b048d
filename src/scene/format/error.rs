//! Errors in a scene, with their location.

use crate::shown;
use crate::shown::first_of;
use std::fmt;
pub use stickslip_exchange::words::quoted;
pub(crate) use stickslip_platform::similar::nearest;
pub use stickslip_platform::similar::{did_you_mean, did_you_mean_file};

/// One step from a value of the scene file to a value inside it.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Step {
    /// A field of a struct, or a key of a map.
    Key(String),
    /// An element of a list or of a tuple, from 0.
    Index(usize),
}

impl From<&str> for Step {
    fn from(key: &str) -> Self {
        Step::Key(key.to_owned())
    }
}

impl From<usize> for Step {
    fn from(index: usize) -> Self {
        Step::Index(index)
    }
}

/// The path from the root of a scene file to a value: `slaves[0].nodes[1]`. Enum variant names are not steps.
#[derive(Debug, Clone, Default, PartialEq, Eq, Hash)]
pub struct Path(pub Vec<Step>);

impl Path {
    /// This path with one step appended.
    pub fn then(&self, step: impl Into<Step>) -> Path {
        let mut steps = self.0.clone();
        steps.push(step.into());
        Path(steps)
    }

    /// Whether `other` is this value or inside it.
    pub fn contains(&self, other: &Path) -> bool {
        other.0.starts_with(&self.0)
    }
}

impl From<&Path> for Path {
    fn from(path: &Path) -> Self {
        path.clone()
    }
}

impl fmt::Display for Path {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, step) in self.0.iter().enumerate() {
            match step {
                Step::Index(index) => write!(f, "[{index}]")?,
                Step::Key(key) if k == 0 => f.write_str(&shortened(key))?,
                Step::Key(key) => write!(f, ".{}", shortened(key))?,
            }
        }
        Ok(())
    }
}

/// A [`Path`] from keys and indices: `at!["slaves", 0, "nodes", 1]`.
#[macro_export]
macro_rules! at {
    ($($step:expr),* $(,)?) => {
        $crate::format::error::Path(vec![$($crate::format::error::Step::from($step)),*])
    };
}
pub use at;
pub use stickslip_exchange::bail;

/// A [`Fault`] from a path and a formatted message: `fault!(here, "{} is negative", x)`.
#[macro_export]
macro_rules! fault {
    ($path:expr, $($message:tt)+) => {
        $crate::format::error::Fault::new($path, format!($($message)+))
    };
}
pub use fault;

/// Reasons why a scalar of a scene cannot be set.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SetError {
    /// No scalar has this path; the message suggests similar ones.
    #[error("{0}")]
    NoScalar(String),
    /// The value has the wrong kind.
    #[error("{value} is not valid; it must be {kind}")]
    NoValue {
        /// The typed text, in quotes.
        value: String,
        /// The accepted kind: "a number", "one of lagged, consistent".
        kind: String,
    },
}

/// An error at a path of a [`Spec`](super::Spec), not yet resolved to a line.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// Path of the value.
    pub path: Path,
    /// Error message.
    pub message: String,
}

impl Fault {
    /// Creates a fault from its path and message.
    pub fn new(path: impl Into<Path>, message: impl Into<String>) -> Self {
        let (path, message) = (path.into(), message.into());
        Fault { path, message }
    }
}

/// Adds a path to an error.
pub trait AtPath<T> {
    /// The result, with the error as a fault of this value.
    ///
    /// # Errors
    /// The same error, at the path.
    fn at(self, path: impl Into<Path>) -> Result<T, Fault>;
}

impl<T, E: fmt::Display> AtPath<T> for Result<T, E> {
    fn at(self, path: impl Into<Path>) -> Result<T, Fault> {
        self.map_err(|why| Fault::new(path, why.to_string()))
    }
}

impl<P: Into<Path>> From<(P, String)> for Fault {
    fn from((path, message): (P, String)) -> Self {
        Fault::new(path, message)
    }
}

/// An invalid scene: one message, with its location in the file if known.
///
/// Displayed as one line, `file:line:column: path: message`. For a value set from outside, the setting is shown instead of a
/// line.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub struct SceneError {
    /// Path of the file, or name of the built-in scene.
    pub file: String,
    /// Line and column, from 1; columns count characters.
    pub at: Option<(usize, usize)>,
    /// The external setting that caused the error, e.g. `friction.angle=95`.
    pub set: Option<String>,
    /// Path of the value, e.g. `slaves[0].nodes[1]`; empty if no single value is wrong.
    pub path: String,
    /// What is wrong and what is expected.
    pub message: String,
}

impl SceneError {
    /// An error about the whole file.
    pub fn whole(file: &str, message: impl Into<String>) -> Self {
        SceneError {
            file: file.to_owned(),
            at: None,
            set: None,
            path: String::new(),
            message: message.into(),
        }
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&shown::cut(&self.file, LONGEST_NAME))?;
        if let Some((line, column)) = self.at {
            write!(f, ":{line}:{column}")?;
        }
        f.write_str(": ")?;
        if let Some(set) = &self.set {
            write!(f, "--set {set}: ")?;
        } else if !self.path.is_empty() {
            write!(f, "{}: ", self.path)?;
        }
        f.write_str(&shown::cut(&self.message, LONGEST_MESSAGE))
    }
}

/// The message that a `what` does not exist, with similar and some known names; `known` is the plural of `what`.
pub(crate) fn none_called<'a>(
    what: &str,
    name: &str,
    known: &str,
    names: impl Iterator<Item = &'a str> + Clone,
) -> String {
    format!(
        "no {what} called {}{} ({known}: {})",
        quoted(name),
        did_you_mean(name, names.clone()),
        some_of(names)
    )
}

/// Some of the names for a message, in quotes; the others are only counted.
pub fn some_of<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let quoted = names.into_iter().map(|name| format!("{name:?}"));
    match first_of(quoted, 8, ", ") {
        none if none.is_empty() => "none".into(),
        some => some,
    }
}

/// Maximum number of characters of a message; lists of choices get half of that.
const LONGEST_MESSAGE: usize = 1500;
/// Maximum number of characters of a file name in a message.
const LONGEST_NAME: usize = 300;
/// Maximum number of characters quoted from external text.
const MOST: usize = 60;

/// External text on one line, shortened.
pub fn shortened(text: &str) -> String {
    shown::cut(text, MOST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_reads_like_the_file() {
        assert_eq!(
            at!["slaves", 0, "nodes", 1].to_string(),
            "slaves[0].nodes[1]"
        );
        assert_eq!(Path::default().to_string(), "");
    }
}
