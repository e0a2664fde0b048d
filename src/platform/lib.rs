//! Operating-system services, and all their differences between systems.
//!
//! - [`clock`]: the current time, and time that has passed.
//! - [`disk`]: files and folders; in a browser files in memory.
//! - [`input`]: reads regular files up to a maximum size, without blocking.
//! - [`files`]: writes files completely or not at all, and overwrites only on request.
//! - [`similar`]: suggestions for mistyped names.
//! - `process`: processes started by the program; `local_socket`: sockets between them; `random`: random bytes; `signals`: Ctrl-C,
//!   suspending, hang-ups; `terminal`: the terminal's size and its answers to queries. A browser has none of them.
//! - [`system`]: locks, private files, processor time, folders.
//! - [`task`]: threads, or slices of the only thread.
//!
//! Each of the last three kinds has one file per system.

#![forbid(unsafe_code)]

pub mod clock;
pub mod disk;
pub mod files;
pub mod input;
#[cfg(not(target_family = "wasm"))]
#[cfg_attr(unix, path = "unix_local_socket.rs")]
#[cfg_attr(windows, path = "windows_local_socket.rs")]
pub mod local_socket;
#[cfg(target_family = "wasm")]
pub mod memory_disk;
#[cfg(not(target_family = "wasm"))]
#[cfg_attr(unix, path = "unix_process.rs")]
#[cfg_attr(windows, path = "windows_process.rs")]
pub mod process;
#[cfg(not(target_family = "wasm"))]
pub mod random;
#[cfg(not(target_family = "wasm"))]
#[cfg_attr(unix, path = "unix_signals.rs")]
#[cfg_attr(windows, path = "windows_signals.rs")]
pub mod signals;
pub mod similar;
#[cfg_attr(unix, path = "unix.rs")]
#[cfg_attr(windows, path = "windows.rs")]
#[cfg_attr(target_family = "wasm", path = "browser.rs")]
pub mod system;
pub mod task;
#[cfg(not(target_family = "wasm"))]
pub mod terminal;
