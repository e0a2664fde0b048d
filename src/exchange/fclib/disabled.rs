//! Replacement in a build without the feature `fclib`: rejects fclib files.

use crate::FormatError;
use crate::problem::{Local, Problem};

/// Whether this build reads and writes such files.
///
/// # Errors
/// How to build a version that does.
pub fn ready() -> Result<(), FormatError> {
    Err(not_built())
}

/// Always fails.
///
/// # Errors
/// Always.
pub fn read(_: Vec<u8>) -> Result<Problem, FormatError> {
    Err(not_built())
}

/// Always fails.
///
/// # Errors
/// Always.
pub fn write(_: &Local, _: &str) -> Result<Vec<u8>, FormatError> {
    Err(not_built())
}

fn not_built() -> FormatError {
    FormatError::whole(
        "this build has no fclib (HDF5) support; cargo install --path . --features fclib",
    )
}
