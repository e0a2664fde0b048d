//! Recorded states (being written).

use crate::scene::Scene;
use crate::solve::{Event, Intervention, State};
use std::path::Path;

/// An intervention and the number of minor iterations that had been done before it.
#[derive(Debug, Clone, PartialEq)]
pub struct Applied {
    pub step: u64,
    pub intervention: Intervention,
}

/// A recorded state.
pub struct Snapshot;

impl Snapshot {
    /// Takes one.
    pub fn take(_: &Scene, _: &[Applied], _: u64, _: &State, _: Option<&Event>) -> Self {
        Snapshot
    }

    /// Writes it.
    pub fn write(&self, _: &Path, _: bool) -> Result<(), String> {
        Err("snapshots are not there yet".into())
    }
}
