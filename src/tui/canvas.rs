//! A grid of braille dots: two across and four down in every cell, so that a dot is about square.
//!
//! The library's own canvas knows colours only; this one carries whole styles, so that what is faint stays faint
//! without colour too. The last to draw in a cell gives it its style.

use ratatui::{buffer::Buffer, layout::Rect, style::Style};
use stickslip_debugger::explain::outline::{clip, mix};

/// Dots in a rectangle of cells. The dot (0, 0) is the upper left one.
#[derive(Debug, Clone)]
pub struct Canvas {
    area: Rect,
    cells: Vec<(u8, Style)>,
}

/// A place on the canvas in dots, not necessarily inside it.
pub type Dot = [f64; 2];

impl Canvas {
    /// An empty canvas over these cells.
    pub fn new(area: Rect) -> Self {
        Canvas {
            area,
            cells: vec![(0, Style::new()); area.width as usize * area.height as usize],
        }
    }

    /// Width and height in dots.
    pub fn size(&self) -> [f64; 2] {
        [self.area.width as f64 * 2.0, self.area.height as f64 * 4.0]
    }

    /// A straight line; what lies outside is cut off.
    pub fn line(&mut self, from: Dot, to: Dot, style: Style) {
        let Some((from, to)) = clip(from, to, [0.0; 2], self.size()) else {
            return;
        };
        let steps = (to[0] - from[0])
            .abs()
            .max((to[1] - from[1]).abs())
            .ceil()
            .max(1.0);
        for step in 0..=steps as usize {
            let part = step as f64 / steps;
            self.dot(mix(from, to, part), style);
        }
    }

    /// A chain of straight lines.
    pub fn polyline(&mut self, points: &[Dot], style: Style) {
        for pair in points.windows(2) {
            self.line(pair[0], pair[1], style);
        }
    }

    /// One dot.
    pub fn dot(&mut self, at: Dot, style: Style) {
        let [width, height] = self.size();
        if !(0.0..width).contains(&at[0]) || !(0.0..height).contains(&at[1]) {
            return;
        }
        let (x, y) = (at[0] as usize, at[1] as usize);
        let cell = &mut self.cells[y / 4 * self.area.width as usize + x / 2];
        cell.0 |= BITS[y % 4][x % 2];
        cell.1 = style;
    }

    /// The cells that it covers.
    pub fn area(&self) -> Rect {
        self.area
    }

    /// The cell that holds a place, if it is on the canvas.
    pub fn cell(&self, at: Dot) -> Option<(u16, u16)> {
        let [width, height] = self.size();
        let inside = (0.0..width).contains(&at[0]) && (0.0..height).contains(&at[1]);
        inside.then(|| {
            (
                self.area.x + at[0] as u16 / 2,
                self.area.y + at[1] as u16 / 4,
            )
        })
    }

    /// Puts the dots on the screen; cells without dots stay as they are.
    pub fn render(&self, buffer: &mut Buffer) {
        for (index, (bits, style)) in self
            .cells
            .iter()
            .enumerate()
            .filter(|(_, cell)| cell.0 != 0)
        {
            let x = self.area.x + (index % self.area.width as usize) as u16;
            let y = self.area.y + (index / self.area.width as usize) as u16;
            let glyph = char::from_u32(0x2800 + *bits as u32).unwrap_or(' ');
            if let Some(cell) = buffer.cell_mut((x, y)) {
                cell.set_char(glyph).set_style(*style);
            }
        }
    }
}

/// Unicode's numbering of the braille dots, by row and column.
const BITS: [[u8; 2]; 4] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(lines: &[(Dot, Dot)]) -> Vec<String> {
        let area = Rect::new(0, 0, 4, 2);
        let mut canvas = Canvas::new(area);
        for (from, to) in lines {
            canvas.line(*from, *to, Style::new());
        }
        let mut buffer = Buffer::empty(area);
        canvas.render(&mut buffer);
        (0..2)
            .map(|y| (0..4).map(|x| buffer[(x, y)].symbol()).collect())
            .collect()
    }

    #[test]
    fn lines_are_cut_at_the_border() {
        assert_eq!(drawn(&[([-100.0, 1.0], [100.0, 1.0])]), ["⠒⠒⠒⠒", "    "]);
        assert_eq!(drawn(&[([0.0, -1e9], [0.0, 1e9])]), ["⡇   ", "⡇   "]);
    }

    #[test]
    fn what_is_outside_or_no_number_draws_nothing() {
        let blank = ["    ", "    "];
        assert_eq!(drawn(&[([-5.0, -5.0], [-1.0, 20.0])]), blank);
        assert_eq!(drawn(&[([f64::NAN, 0.0], [1.0, 1.0])]), blank);
        assert_eq!(drawn(&[([0.0, 0.0], [f64::INFINITY, 1.0])]), blank);
    }
}
