//! The round that a sequence of iterations closes, whatever an iteration is: those of the solver's own, or of a run that
//! another program did.

use std::ops::Range;

/// The iterations of the round that closes where iteration `here` starts from the same as an earlier one: from the last
/// such one on, up to before `here`. `None` where nothing returns, or the iterations in between were not all elsewhere.
///
/// `same` and `elsewhere` compare an earlier iteration with this one. Between the two there may be a gap: there, an
/// iteration may still converge.
pub fn closed(
    here: usize,
    same: impl Fn(usize) -> bool,
    elsewhere: impl Fn(usize) -> bool,
) -> Option<Range<usize>> {
    let found = (0..here).rfind(|then| same(*then))?;
    let mut between = found + 1..here;
    (!between.is_empty() && between.all(elsewhere)).then_some(found..here)
}
