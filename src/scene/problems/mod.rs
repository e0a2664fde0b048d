//! Interface problems that other programs have written, as scenes.
//!
//! - [`siconos`]: friction problems condensed to their contacts, of Siconos (text) and fclib (HDF5), and what becomes of
//!   global ones; [`market`]: those of files of the Matrix Market.
//! - [`stored`]: a stiffness that CalculiX has stored, with contacts named by their nodes.
//! - `opened`: which of these a file is. [`condense`]: unknowns that no contact sees, eliminated.
//!
//! How their files are read and written is for [`stickslip_exchange`]; what the numbers mean is said here.

pub mod condense;
pub mod market;
pub(super) mod opened;
pub mod siconos;
pub mod stored;

use super::limits;
use crate::format::{SceneError, error, read};
use std::path::Path;
use stickslip_platform::input;

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
    input::text(path, read::FILE_BYTES as u64, large).map_err(|why| read::not_read(&file, &why))
}

/// The title of a file that has none: its name.
fn title(file: &str) -> String {
    let name = Path::new(file).file_name();
    let name = name.map_or_else(|| file.into(), |name| name.to_string_lossy());
    error::shortened(&name)
}
