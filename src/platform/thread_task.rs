//! Tasks as threads of the operating system.

use super::Next;
use std::sync::mpsc::{Receiver, RecvError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// A running task.
pub struct Task(JoinHandle<()>);

impl Task {
    /// Waits for the end of the task. A panic counts as its end.
    pub fn join(self) {
        let _ = self.0.join();
    }
}

/// Runs a function as a task.
pub fn spawn(work: impl FnOnce() + Send + 'static) {
    thread::spawn(work);
}

/// Starts a task that answers the jobs of a channel until the channel closes or a job ends the task. `make` builds the function
/// that answers them, in the task.
pub fn serve<J: Send + 'static, H: FnMut(J) -> Next<J>>(
    jobs: Receiver<J>,
    make: impl FnOnce() -> H + Send + 'static,
) -> Task {
    Task(thread::spawn(move || {
        let mut answer = make();
        while let Ok(mut job) = jobs.recv() {
            loop {
                match answer(job) {
                    Next::Job => break,
                    Next::Rest(rest) => job = rest,
                    Next::End => return,
                }
            }
        }
    }))
}

/// False: the system shares the processor between tasks.
pub fn is_slice_over() -> bool {
    false
}

/// The next message of another task; blocks.
///
/// # Errors
/// If all senders are gone.
pub fn receive<T>(messages: &Receiver<T>) -> Result<T, RecvError> {
    messages.recv()
}

/// Lets other tasks run for some time.
pub fn nap(time: Duration) {
    thread::sleep(time);
}
