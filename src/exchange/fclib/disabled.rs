//! Refuses fclib's files in a build without the feature `fclib`.

use crate::broken::Broken;
use crate::problem::{Local, Problem};

/// Whether this build reads and writes such files.
///
/// # Errors
/// How to build it so that it does.
pub fn ready() -> Result<(), Broken> {
    Err(not_built())
}

/// Refuses the file.
///
/// # Errors
/// Always.
pub fn read(_: Vec<u8>) -> Result<Problem, Broken> {
    Err(not_built())
}

/// Refuses to write.
///
/// # Errors
/// Always.
pub fn write(_: &Local, _: &str) -> Result<Vec<u8>, Broken> {
    Err(not_built())
}

fn not_built() -> Broken {
    Broken::whole("this build has no fclib (HDF5) files; cargo install stickslip --features fclib")
}
