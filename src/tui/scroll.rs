//! Scroll keys of pages and lists.

/// The position in a list with positions up to `last` after a scroll key; `None` for other keys.
pub(super) fn scrolled(at: usize, name: &str, page: usize, last: usize) -> Option<usize> {
    let to = match name {
        "Up" | "k" => at.saturating_sub(1),
        "Down" | "j" => at.saturating_add(1),
        "PageUp" => at.saturating_sub(page),
        "PageDown" | "Space" => at.saturating_add(page),
        "Home" | "g" => 0,
        "End" | "G" => last,
        _ => return None,
    };
    Some(to.min(last))
}
