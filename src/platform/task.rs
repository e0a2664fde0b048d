//! Tasks next to the caller: threads where the system has them, slices of the only thread elsewhere. And the messages of their
//! panics.

use std::sync::{Mutex, PoisonError};

#[cfg_attr(not(target_family = "wasm"), path = "thread_task.rs")]
#[cfg_attr(target_family = "wasm", path = "sliced_task.rs")]
mod system;

pub use system::*;

/// What a task does after a call with a job.
pub enum Next<J> {
    /// It waits for the next job.
    Job,
    /// It continues with the rest of the job, since the slice is over ([`is_slice_over`]).
    Rest(J),
    /// It ends.
    End,
}

/// The message of a panic in a task, which must not write to the screen.
static PANIC: Mutex<Option<String>> = Mutex::new(None);

/// Stores the message of a panic in a task.
pub fn store_panic(message: String) {
    *PANIC.lock().unwrap_or_else(PoisonError::into_inner) = Some(message);
}

/// Takes the message of a panic in a task.
pub fn take_panic() -> Option<String> {
    PANIC.lock().unwrap_or_else(PoisonError::into_inner).take()
}
