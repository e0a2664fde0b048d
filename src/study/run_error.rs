//! Why the runs of a sweep cannot be computed, stored or compared.

use std::io;
use std::path::Path;
use stickslip_scene::SceneError;

/// Why a sweep has no results.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The system reports an error, or a file is in use; another attempt may succeed.
    #[error("{0}")]
    Again(String),
    /// A scene, a log of results or a table is wrong.
    #[error(transparent)]
    File(#[from] SceneError),
    /// The results contradict each other, or cannot be compared.
    #[error("{0}")]
    Incomparable(String),
}

impl RunError {
    /// Converts a system error about a file.
    pub(super) fn system(path: &Path) -> impl Fn(io::Error) -> RunError + Copy + '_ {
        move |source| RunError::Again(format!("{}: {source}", path.display()))
    }
}

/// An error in a file at a line and a column, both from 1.
pub(super) fn error_at(
    file: impl AsRef<Path>,
    at: (usize, usize),
    message: impl Into<String>,
) -> SceneError {
    SceneError {
        at: Some(at),
        ..SceneError::whole(&file.as_ref().to_string_lossy(), message)
    }
}
