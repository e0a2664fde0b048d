//! Everything that differs between operating systems.
//!
//! - [`input`]: the one way in which files are read: regular ones only, never waiting, never more than a stated size.
//! - [`files`]: the one way in which files are written: whole or not at all, and never over another one unasked.
//! - [`system`]: locks, private files, clocks and folders.
//! - [`terminal`]: what the terminal is, and what it says when it is asked.

#![forbid(unsafe_code)]

pub mod files;
pub mod input;
#[cfg_attr(unix, path = "unix.rs")]
#[cfg_attr(not(unix), path = "unsupported.rs")]
pub mod system;
#[cfg(unix)]
pub mod terminal;
