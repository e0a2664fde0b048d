//! Plane friction problems in the HDF5 files of the library fclib (Acary et al., INRIA technical report 444).
//!
//! With the feature `fclib`, `hdf5.rs` reads and writes them; otherwise `disabled.rs` rejects them.

#[cfg_attr(feature = "fclib", path = "hdf5.rs")]
#[cfg_attr(not(feature = "fclib"), path = "disabled.rs")]
mod files;

pub use files::{read, ready, write};

/// First bytes of every HDF5 file.
pub const MARK: &[u8] = b"\x89HDF\r\n\x1a\n";
