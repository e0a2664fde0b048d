//! The frame of a chart: a vertical axis with labels on the left, a row of labels below, and the plot area between them.

use crate::paint;
use ratatui::buffer::{Buffer, Cell};
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::Line;
use ratatui::widgets::Widget;

/// The layout of a chart.
#[derive(Debug, Clone, Copy)]
pub struct ChartFrame {
    /// The plot area.
    pub field: Rect,
    /// Columns to its left for labels and axis.
    labels: u16,
}

impl ChartFrame {
    /// A frame that fills an area except for one column on the right; `labels` columns hold the labels and the axis.
    pub fn within(area: Rect, labels: u16) -> ChartFrame {
        let field = Rect {
            x: area.x + labels,
            width: area.width - labels - 1,
            height: area.height - 1,
            ..area
        };
        ChartFrame { field, labels }
    }

    /// A frame around a plot area.
    pub fn around(field: Rect, labels: u16) -> ChartFrame {
        ChartFrame { field, labels }
    }

    /// Draws the vertical axis.
    pub fn axis(&self, buffer: &mut Buffer, style: Style) {
        for row in 0..self.field.height {
            self.left(buffer, row, "", '│', style);
        }
    }

    /// Draws a label at the axis, in a row of the plot area.
    pub fn tick(&self, buffer: &mut Buffer, row: u16, label: &str, style: Style) {
        self.left(buffer, row, label, '┤', style);
    }

    fn left(&self, buffer: &mut Buffer, row: u16, label: &str, end: char, style: Style) {
        let width = usize::from(self.labels).saturating_sub(2);
        let place = Rect {
            x: self.field.x - self.labels,
            y: self.field.y + row,
            width: self.labels,
            height: 1,
        };
        Line::styled(format!("{label:>width$} {end}"), style).render(place, buffer);
    }

    /// Writes a label into the row below the plot area from a screen column on, cut off one column past the plot area.
    pub fn below(&self, buffer: &mut Buffer, column: u16, label: &str, style: Style) {
        let room = usize::from((self.field.right() + 1).saturating_sub(column));
        buffer.set_stringn(column, self.field.bottom(), label, room, style);
    }

    /// The cell at a column of the plot area and a height in rows from its top; `None` outside.
    pub fn cell<'a>(
        &self,
        buffer: &'a mut Buffer,
        column: usize,
        height: f64,
    ) -> Option<&'a mut Cell> {
        let x = usize::from(self.field.x) + column;
        let y = f64::from(self.field.y) + height.floor();
        let inside = x < usize::from(self.field.right()) && y < f64::from(self.field.bottom());
        if inside {
            buffer.cell_mut((x as u16, y as u16))
        } else {
            None
        }
    }

    /// Writes a glyph at that cell.
    pub fn mark(&self, buffer: &mut Buffer, at: (usize, f64), glyph: &str, style: Style) {
        if let Some(cell) = self.cell(buffer, at.0, at.1) {
            paint::mark(cell, glyph, style);
        }
    }
}
