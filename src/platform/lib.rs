//! Operating-system services, and their differences between systems.
//!
//! - [`input`]: reads regular files up to a maximum size, without blocking.
//! - [`files`]: writes files completely or not at all, and overwrites only on request.
//! - [`similar`]: suggestions for mistyped names.
//! - [`system`]: locks, private files, clocks and folders.
//! - [`terminal`]: the terminal's size and its answers to queries.

#![forbid(unsafe_code)]

pub mod files;
pub mod input;
pub mod similar;
#[cfg_attr(unix, path = "unix.rs")]
#[cfg_attr(not(unix), path = "unsupported.rs")]
pub mod system;
#[cfg(unix)]
pub mod terminal;
