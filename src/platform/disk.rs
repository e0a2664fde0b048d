//! Files: the system's, or files in memory where there are none.

#[cfg(not(target_family = "wasm"))]
pub use std::fs::{
    DirEntry, File, FileType, Metadata, OpenOptions, create_dir_all, metadata, read_dir,
    remove_file,
};

#[cfg(target_family = "wasm")]
pub use crate::memory_disk::{
    DirEntry, File, FileType, Metadata, OpenOptions, create_dir_all, metadata, read_dir,
    remove_file,
};
