//! What is wrong with a file of another program, and where.

/// A file that cannot be read as what it should be.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct Broken {
    /// Line and column, both from 1, columns counted in characters; `None` for what is wrong with a file as a whole, or in a
    /// part of it that has no lines.
    pub at: Option<(usize, usize)>,
    /// What is wrong, and what would be right.
    pub message: String,
}

impl Broken {
    /// Something wrong at a line and a column, both from 1.
    pub fn at(line: usize, column: usize, message: impl Into<String>) -> Self {
        Broken {
            at: Some((line, column)),
            message: message.into(),
        }
    }

    /// Something wrong with a file as a whole.
    pub fn whole(message: impl Into<String>) -> Self {
        Broken {
            at: None,
            message: message.into(),
        }
    }
}
