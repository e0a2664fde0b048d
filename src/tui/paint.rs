//! Drawing helpers shared by all panes.

use crate::theme::Theme;
use ratatui::buffer::{Buffer, Cell};
use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, BorderType, Clear, Widget};
use stickslip_scene::shown;
pub use stickslip_scene::shown::wrap;
use unicode_width::{UnicodeWidthChar, UnicodeWidthStr};

/// Draws a pane's border and title, and returns the area inside. A focused pane has a thick border, with or without colour.
pub fn frame(buffer: &mut Buffer, area: Rect, title: &str, focused: bool, theme: &Theme) -> Rect {
    let (kind, border, title_style) = if focused {
        (BorderType::Thick, theme.focus, theme.focus)
    } else {
        (BorderType::Plain, theme.faint, theme.heading)
    };
    let title = cut(title, usize::from(area.width.saturating_sub(4)));
    let title = Line::styled(format!(" {title} "), title_style);
    let block = Block::bordered()
        .border_type(kind)
        .border_style(border)
        .title(title);
    let inner = block.inner(area);
    block.render(area, buffer);
    inner
}

/// Writes lines from top to bottom; lines that do not fit are dropped, and the end of a long one becomes `…`.
pub fn lines(buffer: &mut Buffer, area: Rect, lines: &[Line]) {
    for (row, line) in area.rows().zip(lines) {
        line.render(row, buffer);
        let is_cut = line.width() > usize::from(row.width)
            && line.to_string().trim_end().width() > usize::from(row.width);
        if is_cut && let Some(cell) = buffer.cell_mut((row.right().saturating_sub(1), row.y)) {
            cell.set_symbol("…");
        }
    }
}

/// Writes a text in place of missing content.
pub fn note(buffer: &mut Buffer, area: Rect, text: &str, theme: &Theme) {
    lines(buffer, area, &wrapped(text, area.width.into(), theme.faint));
}

/// A text cut to a width, with `…` in place of the rest.
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

/// A text cut to a column of this width, and the blanks that fill the column.
pub fn cell(text: &str, width: usize, style: Style) -> [Span<'static>; 2] {
    let text = cut(text, width);
    let blank = " ".repeat(width.saturating_sub(text.width()));
    [Span::styled(text, style), Span::raw(blank)]
}

/// Lines of text with styles.
pub type Lines = Vec<Line<'static>>;

/// The mark before an entry of a list.
pub fn cursor(selected: bool, theme: &Theme) -> Span<'static> {
    Span::styled(if selected { "▸" } else { " " }, theme.focus)
}

/// Writes lines over existing content.
pub fn over(buffer: &mut Buffer, area: Rect, lines: &[Line], theme: &Theme) {
    for (row, line) in area.rows().zip(lines) {
        Clear.render(row, buffer);
        buffer.set_style(row, theme.ground);
        line.render(row, buffer);
    }
}

/// Writes a text at a point, in this style alone, whatever was there before.
pub fn label(buffer: &mut Buffer, (x, y): (u16, u16), text: &str, style: Style, theme: &Theme) {
    let area = Rect::new(x, y, text.width() as u16, 1).intersection(buffer.area);
    Clear.render(area, buffer);
    buffer.set_style(area, theme.ground);
    buffer.set_stringn(x, y, text, usize::from(area.width), style);
}

/// Writes a glyph into a cell in this style alone: without the dim or bold of a line below it.
pub fn mark(cell: &mut Cell, glyph: &str, style: Style) {
    cell.modifier = Modifier::empty();
    cell.set_symbol(glyph).set_style(style);
}

/// Wraps a text into lines of this width, with a blank on either side.
pub fn wrapped(text: &str, width: usize, style: Style) -> Lines {
    wrap(text, width.saturating_sub(2))
        .into_iter()
        .map(|line| Line::styled(format!(" {line}"), style))
        .collect()
}

/// Wraps a text behind a lead into lines of this width; under the lead the further lines are blank.
pub fn hanging(lead: &[Span<'static>], text: &str, width: usize, style: Style) -> Lines {
    let line = |(row, words): (usize, String)| {
        let lead = lead.iter().map(|span| match row {
            0 => span.clone(),
            _ => Span::styled(" ".repeat(span.width()), span.style),
        });
        Line::from_iter(lead.chain([Span::styled(words, style)]))
    };
    wrap(text, width)
        .into_iter()
        .enumerate()
        .map(line)
        .collect()
}
