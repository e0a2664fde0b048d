//! Limits parallel runs by memory: a run starts only when its estimated memory fits next to the running ones.
//!
//! The need of a run is estimated ([`Estimate`]); the supply is what the machine and the process's groups leave
//! free ([`memory::free`]). A single run may always start: whether it fits was checked when its scene was read.
//! Results do not depend on this.

use std::collections::HashMap;
use std::sync::{Condvar, Mutex, MutexGuard};
use stickslip_core::{Estimate, Model};
use stickslip_scene::memory;

/// Memory in use, and the number of runs.
#[derive(Debug, Default)]
struct MemoryUse {
    bytes: f64,
    runs: usize,
    /// Estimates by number of unknowns, contacts and bodies.
    known: HashMap<[usize; 3], f64>,
}

/// Memory that runs take and return.
#[derive(Debug)]
pub struct MemoryPool {
    free: f64,
    taken: Mutex<MemoryUse>,
    given: Condvar,
}

/// The memory of a run, returned when dropped.
#[derive(Debug)]
pub struct MemoryShare<'a> {
    pool: &'a MemoryPool,
    bytes: f64,
}

impl Default for MemoryPool {
    fn default() -> MemoryPool {
        MemoryPool::new(memory::free())
    }
}

impl MemoryPool {
    /// Memory of this many bytes.
    pub fn new(free: f64) -> MemoryPool {
        MemoryPool {
            free,
            taken: Mutex::default(),
            given: Condvar::new(),
        }
    }

    /// Waits until a run of a model fits.
    pub fn take(&self, model: &Model) -> MemoryShare<'_> {
        let layout = [model.dofs.len(), model.contacts.len(), model.bodies.len()];
        // The lock must be free again where the next lines take it.
        let known = self.taken().known.get(&layout).copied();
        let bytes = known.unwrap_or_else(|| {
            let bytes = Estimate::from_model(model)
                .with(model.settings.solver)
                .0
                .bytes;
            self.taken().known.insert(layout, bytes);
            bytes
        });
        self.wait(bytes)
    }

    fn wait(&self, bytes: f64) -> MemoryShare<'_> {
        let full = |taken: &mut MemoryUse| taken.runs > 0 && taken.bytes + bytes > self.free;
        let mut taken = self
            .given
            .wait_while(self.taken(), full)
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        taken.bytes += bytes;
        taken.runs += 1;
        MemoryShare { pool: self, bytes }
    }

    fn taken(&self) -> MutexGuard<'_, MemoryUse> {
        self.taken
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

impl Drop for MemoryShare<'_> {
    fn drop(&mut self) {
        let mut taken = self.pool.taken();
        taken.bytes -= self.bytes;
        taken.runs -= 1;
        drop(taken);
        self.pool.given.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn parallel_runs_fit_in_memory_and_one_always_runs() {
        for (bytes, most) in [(40.0, 2), (100.0, 1), (1e9, 1)] {
            let pool = MemoryPool::new(100.0);
            let (now, seen) = (AtomicUsize::new(0), AtomicUsize::new(0));
            std::thread::scope(|scope| {
                for _ in 0..6 {
                    scope.spawn(|| {
                        for _ in 0..20 {
                            let place = pool.wait(bytes);
                            let at_work = now.fetch_add(1, Ordering::SeqCst) + 1;
                            seen.fetch_max(at_work, Ordering::SeqCst);
                            std::thread::yield_now();
                            now.fetch_sub(1, Ordering::SeqCst);
                            drop(place);
                        }
                    });
                }
            });
            let seen = seen.load(Ordering::SeqCst);
            assert!((1..=most).contains(&seen), "{bytes}: {seen} at once");
        }
    }
}
