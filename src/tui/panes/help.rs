//! The `?` page: every action with its keys, from the table, and what the marks on the screen mean.

use crate::action::{ACTIONS, Group};
use crate::tui::paint;
use crate::tui::theme::Theme;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};

/// What the glyphs mean.
const MARKS: &[(&str, &str)] = &[
    ("f s x", "free, sliding, fixed"),
    ("*", "the mode changes"),
    (
        "~",
        "T_max has not settled: the next minor iteration is solved with another",
    ),
    ("◇ ◆", "you forced the mode once; you hold it"),
    (
        "◀ ◁",
        "the cell of Table 2 that fired; the one that would have, had you not held the mode",
    ),
    (
        "margin",
        "distance of the tested inequality from switching; negative has switched",
    ),
    ("a tie", "closer to switching than the tolerance"),
];

/// Draws the page from line `top` on.
pub fn draw(buffer: &mut Buffer, area: Rect, top: usize, theme: &Theme) {
    let inner = paint::frame(buffer, area, "Help", true, theme);
    let lines = page(inner.width as usize, theme);
    let top = top.min(lines.len().saturating_sub(inner.height as usize));
    paint::lines(buffer, inner, &lines[top..]);
}

/// Width of the columns of keys and of names.
const KEYS: usize = 14;
const NAMES: usize = 23;

/// The whole page. On a narrow screen the help goes on in further lines.
pub fn page(width: usize, theme: &Theme) -> Vec<Line<'static>> {
    let mut lines = Vec::new();
    for group in Group::ALL {
        lines.push(Line::styled(format!(" {}", group.title()), theme.heading));
        for entry in ACTIONS.iter().filter(|entry| entry.group == group) {
            let name = format!("{} {}", entry.name, entry.arguments);
            let room = width.saturating_sub(3 + KEYS + NAMES + 1).max(20);
            for (index, help) in paint::wrap(entry.help, room).into_iter().enumerate() {
                let (keys, name) = if index == 0 {
                    (entry.keys.join(" "), name.as_str())
                } else {
                    Default::default()
                };
                lines.push(Line::from(vec![
                    Span::styled(format!("   {keys:<KEYS$}"), theme.key),
                    Span::raw(format!("{name:<NAMES$}")),
                    Span::styled(help, theme.text),
                ]));
            }
        }
        lines.push(Line::default());
    }
    lines.push(Line::styled(" Marks", theme.heading));
    for (mark, meaning) in MARKS {
        for (index, meaning) in paint::wrap(meaning, width.saturating_sub(3 + KEYS + 1).max(20))
            .into_iter()
            .enumerate()
        {
            let mark = if index == 0 { mark } else { "" };
            lines.push(Line::from(vec![
                Span::styled(format!("   {mark:<KEYS$}"), theme.key),
                Span::raw(meaning),
            ]));
        }
    }
    lines
}
