//! Recognises interface problems of other programs by file name or text.

use super::siconos;
use super::title;
use crate::SceneError;
use crate::format::condensed::Problem;
use crate::format::read;
use std::path::Path;
use stickslip_exchange::fclib;
use stickslip_platform::input;

/// The problem in a binary file; `None` if the file is not one, and not named like one.
///
/// # Errors
/// If it is one, but invalid.
pub(crate) fn from_file(
    name: &str,
    overrides: &[(String, String)],
) -> Option<Result<Problem, SceneError>> {
    let start = input::start(Path::new(name), fclib::MARK.len() as u64).ok()?;
    if start != fclib::MARK {
        let extension = Path::new(name).extension();
        let is_named = extension.is_some_and(|own| own == "h5" || own == "hdf5");
        let why = "invalid HDF5 file: it does not begin with the signature of one";
        return is_named.then(|| Err(SceneError::whole(name, why)));
    }
    let problem = || {
        let large = "no interface problem is larger";
        let bytes = input::bytes(Path::new(name), read::FILE_BYTES as u64, large)
            .map_err(|why| SceneError::whole(name, why.to_string()))?;
        let problem = fclib::read(bytes).map_err(|broken| read::of_file(name, broken))?;
        let local = siconos::local(problem, memory(overrides))
            .map_err(|why| SceneError::whole(name, why))?;
        let mut problem = siconos::problem(local, &title(name));
        problem.about = "A friction problem from an fclib file: u = W r + q.".to_owned();
        Ok(problem)
    };
    Some(problem())
}

/// A problem in Siconos' format.
///
/// # Errors
/// If it is invalid.
pub(crate) fn siconos(name: &str, text: &str, memory: Option<f64>) -> Result<Problem, SceneError> {
    match siconos::read(text, memory) {
        Ok(local) => {
            let mut problem = siconos::problem(local, &title(name));
            problem.settings.matrix_accuracy = stickslip_exchange::siconos::accuracy(text);
            Ok(problem)
        }
        Err(broken) => Err(SceneError {
            at: Some(broken.at.unwrap_or((1, 1))),
            ..SceneError::whole(name, broken.message)
        }),
    }
}

/// The value of `settings.memory` set from outside.
pub(crate) fn memory(overrides: &[(String, String)]) -> Option<f64> {
    let set = overrides
        .iter()
        .rev()
        .find(|(path, _)| path == "settings.memory");
    set.and_then(|(_, value)| value.parse().ok())
}
