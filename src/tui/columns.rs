//! Columns of iterations, one beside the other, with rules between them: what all timelines draw with.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use std::ops::Range;

/// A visible iteration and where it stands.
#[derive(Debug, Clone, Copy)]
pub struct Column {
    /// Its number, from 0.
    pub at: usize,
    /// Its place on the screen.
    pub x: u16,
}

/// The iterations around the cursor that fit into the room from `left` on: the cursor in the middle where both sides are long.
/// A rule before an iteration takes a column more.
pub fn around(
    count: usize,
    cursor: usize,
    left: u16,
    room: usize,
    ruled: impl Fn(usize) -> bool,
) -> Vec<Column> {
    let width = |at: usize| 1 + usize::from(ruled(at));
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
        x += width(at) as u16 - 1;
        columns.push(Column { at, x });
        x += 1;
    }
    columns
}

/// The rows that are visible of so many, where there is room for `rows`: the selected one in the middle.
pub fn rows_shown(rows: usize, selected: usize, count: usize) -> Range<usize> {
    let top = selected
        .saturating_sub(rows / 2)
        .min(count.saturating_sub(rows));
    top..(top + rows).min(count)
}

/// Headings in two rows over the columns where something begins, where they do not run into each other. An iteration is
/// told by a key for each row, which changes where the row needs a new heading, and the heading.
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

/// A bracket under the columns of a cycle, from one to another, and what it is called on its right, where there is room.
pub fn bracket(
    buffer: &mut Buffer,
    right: u16,
    y: u16,
    (from, to): (u16, u16),
    text: &str,
    style: Style,
) {
    for x in from..=to {
        let stroke = match x {
            _ if from == to => "╵",
            x if x == from => "╰",
            x if x == to => "╯",
            _ => "─",
        };
        buffer.set_string(x, y, stroke, style);
    }
    let room = right.saturating_sub(to + 2);
    if text.len() <= usize::from(room) {
        buffer.set_string(to + 2, y, text, style);
    }
}
