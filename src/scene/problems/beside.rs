//! Files that another one names: they lie beside it, or in a folder below.

use crate::format::{SceneError, read};
use crate::outside::input;
use std::path::{Component, Path, PathBuf};

/// Where a file is that another one names.
///
/// # Errors
/// If it would lie elsewhere than beside that one or below.
pub fn path(of: &str, name: &str) -> Result<PathBuf, String> {
    let named = Path::new(name);
    let below = named
        .components()
        .all(|part| matches!(part, Component::Normal(_)));
    if !below || name.is_empty() {
        return Err(format!(
            "the file {} will not do; it must lie beside this one, or in a folder below",
            crate::format::error::quoted(name)
        ));
    }
    Ok(Path::new(of).parent().unwrap_or(Path::new("")).join(named))
}

/// The text of a file.
///
/// # Errors
/// If it cannot be read, is too large, or is no text.
pub fn text(path: &Path) -> Result<String, SceneError> {
    let file = path.display().to_string();
    let large = "no interface problem has more";
    input::text(path, read::FILE_BYTES as u64, large).map_err(|why| {
        let at = match &why {
            input::Unreadable::NoText { line, column } => Some((*line, *column)),
            _ => None,
        };
        SceneError {
            at,
            ..SceneError::whole(&file, why.to_string())
        }
    })
}
