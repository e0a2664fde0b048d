//! The brush: what all panes draw with.

use crate::outside::shown;
use crate::tui::theme::Theme;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::Line;
use ratatui::widgets::{Block, BorderType, Widget};
use unicode_width::{UnicodeWidthChar, UnicodeWidthStr};

/// A pane's border and title; returns what is inside. The focus is a thick border, colour or not.
pub fn frame(buffer: &mut Buffer, area: Rect, title: &str, focused: bool, theme: &Theme) -> Rect {
    let (kind, border, title_style) = match focused {
        true => (BorderType::Thick, theme.focus, theme.focus),
        false => (BorderType::Plain, theme.faint, theme.heading),
    };
    let title = Line::styled(format!(" {} ", shown::line(title)), title_style);
    let block = Block::bordered()
        .border_type(kind)
        .border_style(border)
        .title(title);
    let inner = block.inner(area);
    block.render(area, buffer);
    inner
}

/// Writes lines one under the other as far as they fit.
pub fn lines(buffer: &mut Buffer, area: Rect, lines: &[Line]) {
    for (row, line) in area.rows().zip(lines) {
        line.render(row, buffer);
    }
}

/// A text that fits; what is cut off at the end shows as `…`.
pub fn cut(text: &str, width: usize) -> String {
    let text = shown::line(text);
    if text.width() <= width {
        return text.into_owned();
    }
    let mut room = width.saturating_sub(1);
    let kept = text.chars().take_while(|letter| {
        let wide = letter.width().unwrap_or(0);
        let fits = wide <= room;
        room = room.saturating_sub(wide);
        fits
    });
    let kept: String = kept.collect();
    match width {
        0 => kept,
        _ => format!("{}…", kept.trim_end()),
    }
}

/// Breaks a text into lines at its blanks.
pub fn wrap(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in shown::line(text).split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.into()),
        }
    }
    lines
}
