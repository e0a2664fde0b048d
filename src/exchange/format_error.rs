//! Errors in files of other programs, with their position.

/// A file that cannot be parsed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct FormatError {
    /// Line and column, both from 1, with columns in characters; `None` for errors in the whole file or in a binary part.
    pub at: Option<(usize, usize)>,
    /// What is wrong and what is expected.
    pub message: String,
}

impl FormatError {
    /// An error at a line and column, both from 1.
    pub fn at(line: usize, column: usize, message: impl Into<String>) -> Self {
        FormatError {
            at: Some((line, column)),
            message: message.into(),
        }
    }

    /// An error in the file as a whole.
    pub fn whole(message: impl Into<String>) -> Self {
        FormatError {
            at: None,
            message: message.into(),
        }
    }
}

impl From<((usize, usize), String)> for FormatError {
    fn from(((line, column), message): ((usize, usize), String)) -> Self {
        FormatError::at(line, column, message)
    }
}

/// Returns an error from a location and a formatted message: `bail!(place, "{name} is defined twice")`.
#[macro_export]
macro_rules! bail {
    ($place:expr, $($message:tt)+) => {
        return Err(($place, format!($($message)+)).into())
    };
}
