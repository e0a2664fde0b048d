//! Detects cycles in any sequence of iterations: minor or major ones, those of an attached solver, or of a finished run of
//! another program.

use std::ops::Range;

/// The iterations of the cycle that closes if iteration `here` starts from the same state as an earlier one: from the last such
/// iteration to the one before `here`. `None` if there is none, if it has fewer than `shortest` iterations, or if not all
/// iterations in between were `elsewhere`.
///
/// `same` and `elsewhere` compare an earlier iteration with this one. There may be differences for which neither is true, for
/// iterations that may still converge.
pub fn closed(
    here: usize,
    shortest: usize,
    same: impl Fn(usize) -> bool,
    elsewhere: impl Fn(usize) -> bool,
) -> Option<Range<usize>> {
    let found = (0..here).rfind(|then| same(*then))?;
    let mut between = found + 1..here;
    (here - found >= shortest && between.all(elsewhere)).then_some(found..here)
}
