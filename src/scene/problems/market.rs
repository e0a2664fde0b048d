//! Interface problems in Matrix Market files, each of which contains one matrix:
//!
//! ```text
//! NAME_W.mtx   or NAME.mtx: W, a compliance     u = q + W (f + r)
//! NAME_K.mtx   instead: K, a stiffness          K (u − q) = f + r
//! NAME_mu.mtx  friction coefficients            m numbers
//! NAME_q.mtx   displacements under no force     2 m numbers
//! NAME_f.mtx   loads on the contacts            2 m numbers; where it is missing there are none
//! ```
//!
//! In space W and q have 3 m rows, and there is neither K nor f; the number of friction coefficients decides.
//!
//! The components are those of [`super::siconos`]. The user names the matrix file; the others are next to it. For a stiffness, q
//! may be missing if f is given.

use super::siconos::{coefficient, contacts, settings};
use super::{compliance, entries_fit, fits};
use crate::SceneError;
use crate::format::condensed::{Matrix, Problem};
use crate::format::read;
use crate::joined;
use std::path::{Path, PathBuf};
use stickslip_core::counted;
use stickslip_exchange::matrix_market;
use stickslip_exchange::problem::Local;
use stickslip_platform::input;

/// Files of a problem besides the matrix.
const PARTS: [&str; 3] = ["q", "mu", "f"];

/// The file names of a problem.
struct MarketNames {
    folder: PathBuf,
    /// The part before `_W.mtx`.
    stem: String,
    stiffness: bool,
}

impl MarketNames {
    fn from_file(file: &Path) -> Result<MarketNames, String> {
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        if let Some(part) = PARTS
            .iter()
            .find(|part| stem.ends_with(&format!("_{part}")))
        {
            let matrix = stem.trim_end_matches(&format!("_{part}"));
            return Err(format!(
                "this is {part} of a problem; name its matrix instead: {matrix}_W.mtx, a compliance, or {matrix}_K.mtx, a stiffness"
            ));
        }
        let plain = stem.strip_suffix("_W").or_else(|| stem.strip_suffix("_K"));
        Ok(MarketNames {
            folder: file.parent().unwrap_or(Path::new("")).to_owned(),
            stiffness: stem.ends_with("_K"),
            stem: plain.unwrap_or(&stem).to_owned(),
        })
    }

    fn part(&self, part: &str) -> PathBuf {
        self.folder.join(format!("{}_{part}.mtx", self.stem))
    }
}

/// The problem of a matrix that has been read, with the files next to it.
///
/// # Errors
/// If one of the files has errors or is missing.
pub fn read(file: &str, text: &str, memory: Option<f64>) -> Result<Problem, SceneError> {
    let whole = |why: String| SceneError::whole(file, why);
    let names = MarketNames::from_file(Path::new(file)).map_err(whole)?;
    let matrix = matrix_market::read(text).map_err(|broken| read::of_file(file, broken))?;
    let size = matrix.rows;
    let divided = size.is_multiple_of(2) || size.is_multiple_of(3);
    if size == 0 || size != matrix.columns || !divided {
        return Err(whole(format!(
            "the matrix has {} and {}; it must be square, with two rows per contact, normal and tangential, or three in space",
            counted(matrix.rows, "row"),
            counted(matrix.columns, "column")
        )));
    }
    if names.stiffness {
        fits(size / 2, memory)
    } else {
        entries_fit(size / 2, matrix.entries.len() as f64, memory)
    }
    .map_err(whole)?;
    let mu = column(&names, "mu", &[size / 2, size / 3])?;
    let missing = |part: &str| {
        let path = names.part(part);
        whole(format!(
            "{}, a column of {part}, is missing next to it",
            path.file_name().unwrap_or_default().to_string_lossy()
        ))
    };
    let mu = mu.ok_or_else(|| missing("mu"))?;
    for mu in &mu {
        let file = || names.part("mu").display().to_string();
        coefficient(*mu).map_err(|why| SceneError::whole(&file(), why))?;
    }
    let tangents = size / mu.len() - 1;
    let f = column(&names, "f", &[size])?;
    let q = column(&names, "q", &[size])?;
    if (tangents == 2 && (names.stiffness || f.is_some())) || (1 + tangents) * mu.len() != size {
        return Err(whole(format!(
            "the matrix has {} for {}; a problem in space has three per contact, and is given by W and q",
            counted(size, "row"),
            counted(mu.len(), "contact")
        )));
    }
    if q.is_none() && !(names.stiffness && f.is_some()) {
        return Err(missing("q"));
    }
    let (contacts, free) = (contacts(&mu, &f.unwrap_or_default()), q.unwrap_or_default());
    let matrix = if names.stiffness {
        Matrix::Stiffness(matrix.dense())
    } else {
        compliance(matrix)
    };
    Ok(Problem {
        about: "An interface problem from Matrix Market files.".to_owned(),
        tangents,
        settings: settings(mu.len()),
        ..Problem::new(&super::title(file), contacts, matrix, free)
    })
}

/// The numbers in a file next to the matrix; `None` if it does not exist.
fn column(
    names: &MarketNames,
    part: &str,
    sizes: &[usize],
) -> Result<Option<Vec<f64>>, SceneError> {
    let path = names.part(part);
    if !path.exists() {
        return Ok(None);
    }
    let file = path.display().to_string();
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let path = input::path_in_folder(&names.part("W"), &name)
        .map_err(|why| SceneError::whole(&file, why))?;
    let text = super::text(&path)?;
    let read = matrix_market::read(&text).map_err(|broken| read::of_file(&file, broken))?;
    let size = read.rows.max(read.columns);
    if read.rows.min(read.columns) != 1 || !sizes.contains(&size) {
        let sizes = joined(sizes, " or ");
        let why = format!(
            "{part} has {} and {}; it must be a column of {} numbers",
            counted(read.rows, "row"),
            counted(read.columns, "column"),
            sizes
        );
        return Err(SceneError::whole(&file, why));
    }
    let mut numbers = vec![0.0; size];
    for (i, j, value) in read.entries {
        numbers[i + j] += value;
    }
    Ok(Some(numbers))
}

/// The files for writing a problem whose compliance matrix has this name: the matrix, q and mu.
///
/// # Errors
/// If the name is that of a stiffness or of another file of a problem.
pub fn parts(file: &Path) -> Result<[PathBuf; 3], String> {
    let names = MarketNames::from_file(file)?;
    if names.stiffness {
        return Err(format!(
            "the matrix is a compliance, but {} would be read as a stiffness; end the name with _W.mtx",
            file.display()
        ));
    }
    Ok([file.to_owned(), names.part("q"), names.part("mu")])
}

/// The contents of these files.
pub fn texts(local: &Local, title: &str) -> [String; 3] {
    let of_w = "W of u = q + W r; rows along n and t of each contact in turn";
    let column = |numbers: &[f64], what: &str| matrix_market::write_column(numbers, &[what, title]);
    [
        matrix_market::write(&local.w, &[of_w, title]),
        column(&local.q, "q of u = q + W r"),
        column(&local.mu, "friction coefficients of the contacts"),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_matrix_name_determines_its_kind_and_the_other_files() {
        let of = |name: &str| {
            MarketNames::from_file(Path::new(name)).map(|n| (n.part("q"), n.stiffness))
        };
        assert_eq!(of("a/b_W.mtx"), Ok((PathBuf::from("a/b_q.mtx"), false)));
        assert_eq!(of("b_K.mtx"), Ok((PathBuf::from("b_q.mtx"), true)));
        assert_eq!(of("b.mtx"), Ok((PathBuf::from("b_q.mtx"), false)));
        assert!(of("b_mu.mtx").unwrap_err().contains("b_W.mtx"));
    }
}
