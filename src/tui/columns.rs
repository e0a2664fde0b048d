//! Columns of iterations with rules between them, shared by all timelines.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};
use std::ops::Range;

/// A visible iteration and its screen column.
#[derive(Debug, Clone, Copy)]
pub struct Column {
    /// Index of the iteration.
    pub at: usize,
    /// Screen column.
    pub x: u16,
}

/// Maximum width of an iteration.
const WIDEST: usize = 16;

/// The iterations around the cursor that fit between `left` and the right edge, with the cursor in the middle if there are enough
/// on both sides. A rule before an iteration takes one more column. Iterations that leave room are set apart.
pub fn around(
    count: usize,
    cursor: usize,
    left: u16,
    room: usize,
    ruled: impl Fn(usize) -> bool,
) -> Vec<Column> {
    let (few, rules) = if count <= room {
        (count.max(1), (0..count).filter(|at| ruled(*at)).count())
    } else {
        (room.max(1), 0)
    };
    let pitch = (room.saturating_sub(rules) / few).clamp(1, WIDEST);
    let width = |at: usize| pitch + usize::from(ruled(at));
    let (mut first, mut after) = (cursor, cursor + 1);
    let mut used = width(cursor);
    let back = |first: &mut usize, used: &mut usize, most: usize| {
        while *first > 0 && *used + width(*first - 1) <= most {
            *first -= 1;
            *used += width(*first);
        }
    };
    back(&mut first, &mut used, room / 2);
    while after < count && used + width(after) <= room {
        used += width(after);
        after += 1;
    }
    back(&mut first, &mut used, room);
    let mut x = left;
    let mut columns = Vec::with_capacity(after - first);
    for at in first..after {
        x += u16::from(ruled(at));
        columns.push(Column { at, x });
        x += pitch as u16;
    }
    columns
}

/// The range of `count` rows that is visible in `rows` rows, with the selected row in the middle if possible.
pub fn rows_shown(rows: usize, selected: usize, count: usize) -> Range<usize> {
    let top = selected
        .saturating_sub(rows / 2)
        .min(count.saturating_sub(rows));
    top..(top + rows).min(count)
}

/// Headings in two rows above the columns, left out where they would overlap. `heading` gives, for each of the two rows, a key and
/// a text; a new heading starts where the key changes.
pub fn headings<K: PartialEq>(
    buffer: &mut Buffer,
    inner: Rect,
    columns: &[Column],
    style: Style,
    heading: impl Fn(usize) -> [(K, String); 2],
) {
    let mut free = [inner.x; 2];
    let mut before: Option<[(K, String); 2]> = None;
    for column in columns {
        let now = heading(column.at);
        for (row, (key, text)) in now.iter().enumerate() {
            let wanted = before.as_ref().is_none_or(|before| before[row].0 != *key);
            let fits = column.x >= free[row] && column.x + text.len() as u16 <= inner.right();
            if wanted && fits {
                buffer.set_string(column.x, inner.y + row as u16, text, style);
                free[row] = column.x + text.len() as u16 + 1;
            }
        }
        before = Some(now);
    }
}

/// Draws a bracket under the columns of a cycle, with its label on the right if it fits.
pub fn bracket(
    buffer: &mut Buffer,
    right: u16,
    y: u16,
    (from, to): (u16, u16),
    text: &str,
    style: Style,
) {
    // Reversed, the bracket would be a bar.
    let line = style.remove_modifier(Modifier::REVERSED);
    for x in from..=to {
        let stroke = match x {
            _ if from == to => "╵",
            x if x == from => "╰",
            x if x == to => "╯",
            _ => "─",
        };
        buffer.set_string(x, y, stroke, line);
    }
    let room = right.saturating_sub(to + 2);
    if text.len() <= usize::from(room) {
        buffer.set_string(to + 2, y, text, style);
    }
}
