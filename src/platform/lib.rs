//! Operating-system services, and all their differences between systems.
//!
//! - [`clock`]: time.
//! - [`disk`]: files and folders; in a browser files in memory.
//! - [`input`]: reads regular files up to a maximum size, without blocking.
//! - [`files`]: writes files completely or not at all, and overwrites only on request.
//! - [`system`]: locks, private files, processor time, folders; one file per system.
//! - [`task`]: threads, or slices of the only thread.
//! - [`terminal`]: the terminal's size and its answers to queries.

#![forbid(unsafe_code)]

pub mod clock;
pub mod disk;
pub mod files;
pub mod input;
#[cfg(target_family = "wasm")]
pub mod memory_disk;
#[cfg_attr(unix, path = "unix.rs")]
#[cfg_attr(target_family = "wasm", path = "browser.rs")]
pub mod system;
pub mod task;
#[cfg(unix)]
pub mod terminal;
