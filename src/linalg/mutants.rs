//! Selects a fault of the mutation bench (`tests/mutants/run.py`). Only a build with `--cfg mutants` contains this module and
//! the faults.

use std::sync::OnceLock;

/// Whether this process runs with this fault, which the environment variable STICKSLIP_MUTANT names.
pub fn is_active(fault: &str) -> bool {
    static SELECTED: OnceLock<Option<String>> = OnceLock::new();
    let selected = SELECTED.get_or_init(|| std::env::var("STICKSLIP_MUTANT").ok());
    selected.as_deref() == Some(fault)
}

/// A value, or what takes its place where this process runs with the fault.
pub fn pick<T>(fault: &str, right: T, wrong: T) -> T {
    if is_active(fault) { wrong } else { right }
}
