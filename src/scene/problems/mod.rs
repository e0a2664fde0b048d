//! Reads interface problems of other programs as scenes.
//!
//! - [`siconos`]: friction problems of Siconos (text) and fclib (HDF5), condensed to their contacts, including global ones;
//!   [`market`]: problems in Matrix Market files.
//! - [`stored`]: a stiffness stored by CalculiX, with contacts named by their nodes.
//! - `opened`: selects the format of a file. [`condense`]: static condensation of unknowns that no contact involves.
//!
//! [`stickslip_exchange`] reads and writes the files; this module interprets their numbers.

pub mod condense;
pub mod market;
pub(super) mod opened;
pub mod siconos;
pub mod stored;

use super::limits;
use crate::format::{SceneError, error, read};
use std::path::Path;
use stickslip_platform::input;

/// Rejects a matrix of this many contacts if it does not fit into memory.
fn fits(contacts: usize, memory: Option<f64>) -> Result<(), String> {
    let entries = 4.0 * (contacts as f64).powi(2);
    limits::memory(entries * limits::ENTRY_BYTES, memory)
        .map_err(|why| format!("the problem has {contacts} contacts; its matrix needs {why}"))
}

/// The text of a file named in another one.
fn text(path: &Path) -> Result<String, SceneError> {
    let file = path.display().to_string();
    let large = "no interface problem is larger";
    input::text(path, read::FILE_BYTES as u64, large).map_err(|why| read::not_read(&file, &why))
}

/// Title for a file without one: its name.
fn title(file: &str) -> String {
    let name = Path::new(file).file_name();
    let name = name.map_or_else(|| file.into(), |name| name.to_string_lossy());
    error::shortened(&name)
}
