//! Which kind of interface problem a file is, and its scene.

use super::siconos::{self, Friction2d};
use super::{market, stored, title};
use crate::format::condensed::Problem;
use crate::format::{self, SceneError, locate, read};
use crate::outside::input;
use std::path::Path;
use stickslip_exchange::{fclib, matrix_market};

/// A file that is no text: its problem, if it is one.
///
/// # Errors
/// If it is one, and unsound.
pub(in crate::scene) fn from_file(
    name: &str,
    overrides: &[(String, String)],
) -> Option<Result<Problem, SceneError>> {
    let start = input::start(Path::new(name), fclib::MARK.len() as u64).ok()?;
    if start != fclib::MARK {
        return None;
    }
    let problem = || {
        let large = "no interface problem has more";
        let bytes = input::bytes(Path::new(name), read::FILE_BYTES as u64, large)
            .map_err(|why| SceneError::whole(name, why.to_string()))?;
        let problem = fclib::read(bytes).map_err(|broken| read::of_file(name, broken))?;
        let problem = Friction2d::condensed(problem, memory(overrides))
            .map_err(|why| SceneError::whole(name, why))?;
        let mut problem = problem.problem(&title(name));
        problem.about = "A friction problem from a file of fclib: u = W r + q.".to_owned();
        Ok(problem)
    };
    Some(problem())
}

/// The problem of a text, if it is one of another program.
///
/// # Errors
/// If it is one, and unsound.
pub(in crate::scene) fn from_text(
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
