//! Interface problems that other programs have written, as scenes.
//!
//! - [`siconos`]: friction problems condensed to their contacts, of Siconos (text) and fclib (HDF5), and what becomes of
//!   global ones; [`market`]: those of files of the Matrix Market.
//! - [`stored`]: a stiffness that CalculiX has stored, with contacts named by their nodes.
//! - [`condense`]: unknowns that no contact sees, eliminated.
//!
//! How their files are read and written is for [`stickslip_exchange`]; what the numbers mean is said here.

pub mod condense;
pub mod market;
pub mod siconos;
pub mod stored;

use super::limits;
use crate::format::condensed::Problem;
use crate::format::{self, SceneError, error, locate, read};
use crate::outside::input;
use siconos::Friction2d;
use std::path::Path;
use stickslip_exchange::broken::Broken;
use stickslip_exchange::{fclib, matrix_market};

/// A file that is no text: its problem, if it is one.
///
/// # Errors
/// If it is one, and unsound.
pub(super) fn from_file(
    name: &str,
    overrides: &[(String, String)],
) -> Option<Result<Problem, SceneError>> {
    let start = input::start(Path::new(name), fclib::MARK.len() as u64).ok()?;
    if start != fclib::MARK {
        return None;
    }
    let read = || {
        let large = "no interface problem has more";
        let bytes = input::bytes(Path::new(name), read::FILE_BYTES as u64, large)
            .map_err(|why| SceneError::whole(name, why.to_string()))?;
        let problem = fclib::read(bytes).map_err(|broken| of_file(name, broken))?;
        let problem = Friction2d::condensed(problem, memory(overrides))
            .map_err(|why| SceneError::whole(name, why))?;
        let mut problem = problem.problem(&title(name));
        problem.about = "A friction problem from a file of fclib: u = W r + q.".to_owned();
        Ok(problem)
    };
    Some(read())
}

/// The problem of a text, if it is one of another program.
///
/// # Errors
/// If it is one, and unsound.
pub(super) fn from_text(
    name: &str,
    text: &str,
    overrides: &[(String, String)],
) -> Option<Result<Problem, SceneError>> {
    let memory = memory(overrides);
    if text.starts_with(matrix_market::MARK) {
        return Some(market::read(name, text, memory));
    }
    if locate::head(text) == Some(format::stored::HEAD) {
        return Some(stored::read(name, text, memory));
    }
    if !siconos::is_one(text) {
        return None;
    }
    let read = siconos::read_within(text, memory);
    Some(match read {
        Ok(problem) => Ok(problem.problem(&title(name))),
        Err(broken) => Err(SceneError {
            at: Some((broken.line, broken.column)),
            ..SceneError::whole(name, broken.message)
        }),
    })
}

/// What `settings.memory` is set to from outside.
fn memory(overrides: &[(String, String)]) -> Option<f64> {
    let set = overrides
        .iter()
        .rev()
        .find(|(path, _)| path == "settings.memory");
    set.and_then(|(_, value)| value.parse().ok())
}

/// Refuses a matrix of so many contacts that takes more memory than there is.
fn fits(contacts: usize, memory: Option<f64>) -> Result<(), String> {
    let entries = 4.0 * (contacts as f64).powi(2);
    limits::memory(entries * limits::ENTRY_BYTES, memory)
        .map_err(|why| format!("the problem has {contacts} contacts; its matrix takes {why}"))
}

/// The text of a file that another one names.
fn text(path: &Path) -> Result<String, SceneError> {
    let file = path.display().to_string();
    let large = "no interface problem has more";
    input::text(path, read::FILE_BYTES as u64, large).map_err(|why| SceneError {
        at: match &why {
            input::Unreadable::NoText { line, column } => Some((*line, *column)),
            _ => None,
        },
        ..SceneError::whole(&file, why.to_string())
    })
}

/// What is wrong with a file, as scenes tell it.
fn of_file(file: &str, broken: Broken) -> SceneError {
    SceneError {
        at: broken.at,
        ..SceneError::whole(file, broken.message)
    }
}

/// The title of a file that has none: its name.
fn title(file: &str) -> String {
    let name = Path::new(file).file_name();
    let name = name.map_or_else(|| file.into(), |name| name.to_string_lossy());
    error::shortened(&name)
}
