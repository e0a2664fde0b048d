//! Friction problems in the HDF5 files of the library fclib (Acary & al., INRIA technical report 444), in the plane.
//!
//! The feature `fclib` reads and writes them (`hdf5.rs`); a build without it refuses them (`disabled.rs`).

#[cfg_attr(feature = "fclib", path = "hdf5.rs")]
#[cfg_attr(not(feature = "fclib"), path = "disabled.rs")]
mod files;

pub use files::{read, ready, write};

/// How every HDF5 file begins.
pub const MARK: &[u8] = b"\x89HDF\r\n\x1a\n";
