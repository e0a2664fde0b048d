//! A grid of braille dots, two across and four down in each cell, so that dots are about square.
//!
//! The canvas of ratatui supports only colours; this one stores full styles, so that dim lines stay dim without colour. The last
//! drawing operation in a cell sets its style.

use ratatui::symbols::pixel::OCTANTS;
use ratatui::{buffer::Buffer, layout::Rect, style::Style};
use stickslip_debugger::explain::outline::{clip, mix};

/// Dots in a rectangle of cells. Dot (0, 0) is at the top left.
#[derive(Debug, Clone)]
pub struct Canvas {
    area: Rect,
    cells: Vec<(u8, Style)>,
}

/// A position in dots, which may lie outside the canvas.
pub type Dot = [f64; 2];

impl Canvas {
    /// An empty canvas over an area.
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

    /// Draws a straight line, clipped to the canvas.
    pub fn line(&mut self, from: Dot, to: Dot, style: Style) {
        let Some((from, to)) = clip(from, to, [0.0; 2], self.size()) else {
            return;
        };
        let length = (to[0] - from[0]).abs().max((to[1] - from[1]).abs());
        // Steps of exactly one dot could skip one by round-off.
        let steps = (length + 1e-6).ceil();
        for step in 0..=steps as usize {
            let part = step as f64 / steps;
            self.dot(mix(from, to, part), style);
        }
    }

    /// Draws a polyline.
    pub fn polyline(&mut self, points: &[Dot], style: Style) {
        for pair in points.windows(2) {
            self.line(pair[0], pair[1], style);
        }
    }

    /// Draws one dot.
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

    /// The cells of the canvas.
    pub fn area(&self) -> Rect {
        self.area
    }

    /// The cell at a position; `None` outside the canvas.
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

    /// Writes the dots into the buffer; cells without dots are unchanged.
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

/// Replaces braille by the octants of Unicode 16, which have the same dots without gaps.
pub fn use_octants(buffer: &mut Buffer) {
    for cell in &mut buffer.content {
        let sign = cell.symbol().chars().next().map_or(0, u32::from);
        let Some(bits) = sign.checked_sub(0x2800).filter(|bits| *bits < 256) else {
            continue;
        };
        let rows = BITS.as_flattened().iter().enumerate();
        let set = rows.filter(|(_, bit)| bits & u32::from(**bit) != 0);
        let place: usize = set.map(|(k, _)| 1 << k).sum();
        cell.set_char(OCTANTS[place]);
    }
}

/// Whether the environment names a terminal that draws octants: Ghostty from version 1.2 on.
pub fn has_octants(variable: impl Fn(&str) -> Option<String>) -> bool {
    let version = variable("TERM_PROGRAM_VERSION").unwrap_or_default();
    let mut parts = version.split('.').map(|part| part.parse::<u32>().ok());
    let version = (parts.next().flatten(), parts.next().flatten());
    variable("TERM_PROGRAM").as_deref() == Some("ghostty") && version >= (Some(1), Some(2))
}

/// Bits of the braille dots in Unicode, by row and column.
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
    fn octants_have_the_dots_of_braille_and_other_signs_stay() {
        let mut buffer = Buffer::with_lines(["⠁⠈⡇⢸⠉⣀⣿a "]);
        use_octants(&mut buffer);
        let signs: String = buffer.content.iter().map(|cell| cell.symbol()).collect();
        assert_eq!(signs, "𜺨𜺫▌▐🮂▂█a ");
    }

    #[test]
    fn only_a_terminal_known_to_draw_octants_has_them() {
        let on = |program: &'static str, version: &'static str| {
            has_octants(move |name| match name {
                "TERM_PROGRAM" => Some(program.to_owned()),
                _ => Some(version.to_owned()),
            })
        };
        assert!(on("ghostty", "1.2.0") && on("ghostty", "2.0"));
        assert!(!on("ghostty", "1.1.3") && !on("ghostty", "") && !on("tmux", "3.5"));
        assert!(!has_octants(|_| None));
    }

    #[test]
    fn points_outside_or_nan_draw_nothing() {
        let blank = ["    ", "    "];
        assert_eq!(drawn(&[([-5.0, -5.0], [-1.0, 20.0])]), blank);
        assert_eq!(drawn(&[([f64::NAN, 0.0], [1.0, 1.0])]), blank);
        assert_eq!(drawn(&[([0.0, 0.0], [f64::INFINITY, 1.0])]), blank);
    }
}
