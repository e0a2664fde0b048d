//! Parallel work on bodies and on parts of one.
//!
//! Neither this package nor the core starts threads. A caller that has threads passes an [`Executor`]; every part of the work is the
//! same with any executor and writes to separate memory, so the results are bit-identical on one thread and on many.

/// Runs two tasks, in parallel or in sequence.
pub trait Executor: Send + Sync {
    /// Returns when both are done.
    fn join(&self, first: &mut (dyn FnMut() + Send), second: &mut (dyn FnMut() + Send));
}

/// Runs tasks in sequence on the caller's thread.
#[derive(Debug, Clone, Copy)]
pub struct SequentialExecutor;

impl Executor for SequentialExecutor {
    fn join(&self, first: &mut (dyn FnMut() + Send), second: &mut (dyn FnMut() + Send)) {
        first();
        second();
    }
}

/// Does a job on every item.
pub fn each<T: Send>(executor: &dyn Executor, items: &mut [T], job: &(dyn Fn(&mut T) + Sync)) {
    match items {
        [] => {}
        [item] => job(item),
        _ => {
            let (first, second) = items.split_at_mut(items.len() / 2);
            executor.join(&mut || each(executor, &mut *first, job), &mut || {
                each(executor, &mut *second, job)
            });
        }
    }
}

/// Starts a thread for every first task, in tests.
#[cfg(test)]
pub(crate) struct Threads;

#[cfg(test)]
impl Executor for Threads {
    fn join(&self, first: &mut (dyn FnMut() + Send), second: &mut (dyn FnMut() + Send)) {
        std::thread::scope(|scope| {
            scope.spawn(first);
            second();
        });
    }
}
