//! Work on bodies side by side, by whoever has threads to give.
//!
//! The core starts no threads. Who does hands an [`Executor`] in; every part of the work is the same whoever does it, and writes
//! to places of its own, so that the answers have the same bits on one thread and on many.

/// Does two things, side by side or one after the other.
pub trait Executor: Send + Sync {
    /// Returns when both are done.
    fn join(&self, first: &mut (dyn FnMut() + Send), second: &mut (dyn FnMut() + Send));
}

/// One after the other, on the caller's thread.
#[derive(Debug, Clone, Copy)]
pub struct InTurn;

impl Executor for InTurn {
    fn join(&self, first: &mut (dyn FnMut() + Send), second: &mut (dyn FnMut() + Send)) {
        first();
        second();
    }
}

/// Does a job on every item.
pub(crate) fn each<T: Send>(
    executor: &dyn Executor,
    items: &mut [T],
    job: &(dyn Fn(&mut T) + Sync),
) {
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
