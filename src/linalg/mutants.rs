//! Switches for the faults of the mutation bench (`tests/mutants/run.py`). This module and the faults exist only in builds with
//! `--cfg mutants`.

use std::sync::OnceLock;

/// Whether the environment variable STICKSLIP_MUTANT selects this fault.
pub fn is_active(fault: &str) -> bool {
    static SELECTED: OnceLock<Option<String>> = OnceLock::new();
    let selected = SELECTED.get_or_init(|| std::env::var("STICKSLIP_MUTANT").ok());
    selected.as_deref() == Some(fault)
}

/// Returns `wrong` if the fault is selected, otherwise `right`.
pub fn pick<T>(fault: &str, right: T, wrong: T) -> T {
    if is_active(fault) { wrong } else { right }
}
