//! Tasks on systems without threads: the owner of the only thread runs them in slices ([`turn`]).
//!
//! A task runs until its job ends or returns its rest because the slice is over. [`receive`] and [`nap`] run the other tasks in the
//! meantime.

use super::Next;
use crate::clock::Instant;
use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, RecvError, TryRecvError};
use std::time::Duration;

/// Duration of a slice of a job that can be divided.
const SLICE: Duration = Duration::from_millis(8);
/// Maximum number of steps in a slice, below the capacity of the channels between tasks.
const STEPS: u32 = 256;

/// State of a task after a call.
enum Turn {
    /// It worked.
    Worked,
    /// It waits for a job.
    Idle,
    /// It has ended.
    Ended,
}

thread_local! {
    /// Tasks that are not running.
    static TASKS: RefCell<VecDeque<Box<dyn FnMut() -> Turn>>> = const { RefCell::new(VecDeque::new()) };
    /// Start of the current slice, and steps in it.
    static SLICE_START: Cell<Option<Instant>> = const { Cell::new(None) };
    static SLICE_STEPS: Cell<u32> = const { Cell::new(0) };
}

/// A running task.
pub struct Task;

impl Task {
    /// Does nothing: the task ends when its channel closes.
    pub fn join(self) {}
}

fn start(task: impl FnMut() -> Turn + 'static) {
    TASKS.with_borrow_mut(|tasks| tasks.push_back(Box::new(task)));
}

/// Runs a function as a task.
pub fn spawn(work: impl FnOnce() + Send + 'static) {
    let mut work = Some(work);
    start(move || {
        if let Some(work) = work.take() {
            work();
        }
        Turn::Ended
    });
}

/// Starts a task that answers the jobs of a channel until the channel closes or a job ends the task. `make` builds the function
/// that answers them, in the task.
pub fn serve<J: Send + 'static, H: FnMut(J) -> Next<J> + 'static>(
    jobs: Receiver<J>,
    make: impl FnOnce() -> H + Send + 'static,
) -> Task {
    let (mut make, mut answer, mut rest) = (Some(make), None, None);
    start(move || {
        if let Some(make) = make.take() {
            answer = Some(make());
        }
        let job = match rest.take().map_or_else(|| jobs.try_recv(), Ok) {
            Ok(job) => job,
            Err(TryRecvError::Empty) => return Turn::Idle,
            Err(TryRecvError::Disconnected) => return Turn::Ended,
        };
        match answer.as_mut().map(|answer| answer(job)) {
            Some(Next::Job) => Turn::Worked,
            Some(Next::Rest(left)) => {
                rest = Some(left);
                Turn::Worked
            }
            Some(Next::End) | None => Turn::Ended,
        }
    });
    Task
}

/// Runs one slice of every task that is not running. Returns whether any of them worked.
pub fn turn() -> bool {
    let count = TASKS.with_borrow(VecDeque::len);
    let mut any = false;
    for _ in 0..count {
        // A task that is running is not in the list, so it cannot be entered twice.
        let Some(mut task) = TASKS.with_borrow_mut(VecDeque::pop_front) else {
            break;
        };
        let outer = (SLICE_START.take(), SLICE_STEPS.take());
        SLICE_START.set(Some(Instant::now()));
        let turn = task();
        SLICE_START.set(outer.0);
        SLICE_STEPS.set(outer.1);
        any |= matches!(turn, Turn::Worked);
        if !matches!(turn, Turn::Ended) {
            TASKS.with_borrow_mut(|tasks| tasks.push_back(task));
        }
    }
    any
}

/// Whether a job that can be divided must return its rest; called once per step.
pub fn is_slice_over() -> bool {
    let steps = SLICE_STEPS.get() + 1;
    SLICE_STEPS.set(steps);
    steps >= STEPS
        || SLICE_START
            .get()
            .is_some_and(|start| start.elapsed() >= SLICE)
}

/// The next message of another task, which runs until it sends one.
///
/// # Errors
/// If all senders are gone, or no task can send one.
pub fn receive<T>(messages: &Receiver<T>) -> Result<T, RecvError> {
    loop {
        match messages.try_recv() {
            Ok(message) => return Ok(message),
            Err(TryRecvError::Disconnected) => return Err(RecvError),
            Err(TryRecvError::Empty) if turn() => {}
            Err(TryRecvError::Empty) => return messages.try_recv().map_err(|_| RecvError),
        }
    }
}

/// Lets other tasks run.
pub fn nap(_: Duration) {
    turn();
}
