//! Values computed from shared data, kept for the last data only, and found by their address.

use std::collections::VecDeque;
use std::sync::{Arc, Weak};

/// Number of values that are kept.
const KEPT: usize = 64;

/// Values by the data that they were computed from, latest last.
#[derive(Debug)]
pub(crate) struct Memo<T, V>(VecDeque<(Weak<T>, V)>);

impl<T, V> Default for Memo<T, V> {
    fn default() -> Self {
        Memo(VecDeque::new())
    }
}

impl<T, V: Copy> Memo<T, V> {
    /// The value of data; `None` if it is not known.
    pub fn find(&self, of: &Arc<T>) -> Option<V> {
        let known = |(data, _): &&(Weak<T>, V)| data.as_ptr() == Arc::as_ptr(of);
        self.0.iter().rev().find(known).map(|(_, value)| *value)
    }

    /// Stores the value of data.
    pub fn keep(&mut self, of: &Arc<T>, value: V) {
        self.0.retain(|(data, _)| data.as_ptr() != Arc::as_ptr(of));
        self.0.push_back((Arc::downgrade(of), value));
        if self.0.len() > KEPT {
            self.0.pop_front();
        }
    }

    /// The value of data, computed if it is not known.
    pub fn find_or(&mut self, of: &Arc<T>, compute: impl FnOnce(&T) -> V) -> V {
        self.find(of).unwrap_or_else(|| {
            let value = compute(of);
            self.keep(of, value);
            value
        })
    }
}
