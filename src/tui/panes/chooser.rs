//! The list of built-in scenes: what there is to see when no scene was named, and for `open`.

use crate::tui::app::App;
use crate::tui::paint;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};
use unicode_width::UnicodeWidthStr;

/// Draws the list with one scene selected.
pub fn draw(buffer: &mut Buffer, area: Rect, at: usize, app: &App) {
    let theme = &app.theme;
    let inner = paint::frame(buffer, area, "Choose a scene", true, theme);
    let width = app
        .offers
        .iter()
        .map(|offer| offer.name.width())
        .max()
        .unwrap_or(0);
    let top = (at + 1).saturating_sub(inner.height as usize);
    let lines: Vec<Line> = app
        .offers
        .iter()
        .enumerate()
        .skip(top)
        .map(|(index, offer)| {
            let (mark, style) = if index == at {
                ("▸", theme.selected)
            } else {
                (" ", theme.text)
            };
            Line::from(vec![
                Span::styled(format!(" {mark} "), theme.focus),
                Span::styled(format!("{:<width$}", offer.name), style),
                Span::styled(format!("   {}", offer.title), theme.faint),
            ])
        })
        .collect();
    paint::lines(buffer, inner, &lines);
}
