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
use crate::SceneError;
use crate::format::condensed::Matrix;
use crate::format::{error, read};
use std::path::Path;
use stickslip_core::counted;
use stickslip_core::linear::estimate::sparse_bytes;
use stickslip_core::linear::sparse_contacts::FEW;
use stickslip_exchange::problem;
use stickslip_platform::input;

/// Rejects a matrix with all entries of this many contacts if it does not fit into memory.
fn fits(contacts: usize, memory: Option<f64>) -> Result<(), String> {
    let entries = 4.0 * (contacts as f64).powi(2);
    limits::memory(entries * limits::ENTRY_BYTES, memory).map_err(|why| {
        format!(
            "the problem has {}; its matrix needs {why}",
            counted(contacts, "contact")
        )
    })
}

/// Rejects a compliance of this many contacts if its entries do not fit into memory.
fn entries_fit(contacts: usize, entries: f64, memory: Option<f64>) -> Result<(), String> {
    if contacts <= FEW {
        return fits(contacts, memory);
    }
    limits::memory(sparse_bytes(contacts as f64, entries), memory).map_err(|why| {
        format!(
            "the problem has {}; it needs {why}",
            counted(contacts, "contact")
        )
    })
}

/// Rejects this many contacts if not even the diagonal of their matrix fits into memory.
fn blocks_fit(contacts: usize, memory: Option<f64>) -> Result<(), String> {
    entries_fit(contacts, 4.0 * contacts as f64, memory)
}

/// A compliance as it is stored in a scene: few contacts have all rows, many the entries.
fn compliance(w: problem::Matrix) -> Matrix {
    if w.rows > 2 * FEW {
        Matrix::Entries(w.merged().entries)
    } else {
        Matrix::Compliance(w.dense())
    }
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
