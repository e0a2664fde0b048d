//! A grid of braille dots, two across and four down in each cell, so that dots are about square.
//!
//! The canvas of ratatui supports only colours; this one stores full styles, so that dim lines stay dim without colour. The last
//! drawing operation in a cell sets its style.

use crate::paint;
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
        self.dotted(from, to, style, 1);
    }

    /// Draws every dot of a straight line whose number, from its start, is a multiple of `every`.
    pub fn dotted(&mut self, from: Dot, to: Dot, style: Style, every: usize) {
        let Some((from, to)) = clip(from, to, [0.0; 2], self.size()) else {
            return;
        };
        // Most elements of a fine mesh are smaller than a dot.
        if from.map(|x| x as u32) == to.map(|x| x as u32) {
            return self.dot(from, style);
        }
        let length = (to[0] - from[0]).abs().max((to[1] - from[1]).abs());
        // Steps of exactly one dot could skip one by round-off.
        let steps = (length + 1e-6).ceil();
        for step in (0..=steps as usize).step_by(every) {
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

    /// The dots of points whose coordinates fill the canvas in these ranges, y upwards.
    pub fn scale(&self, x: [f64; 2], y: [f64; 2]) -> impl Fn([f64; 2]) -> Dot + use<> {
        let [width, height] = self.size();
        let part = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
        move |at| {
            [
                0.5 + part(at[0], x) * (width - 1.0),
                height - 0.5 - part(at[1], y) * (height - 1.0),
            ]
        }
    }

    /// Writes a glyph into the cell at a position, in this style alone.
    pub fn mark(&self, buffer: &mut Buffer, at: Dot, glyph: &str, style: Style) {
        if let Some(cell) = self.cell(at).and_then(|at| buffer.cell_mut(at)) {
            paint::mark(cell, glyph, style);
        }
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
        let place: usize = BITS
            .as_flattened()
            .iter()
            .enumerate()
            .filter(|(_, bit)| bits & u32::from(**bit) != 0)
            .map(|(k, _)| 1 << k)
            .sum();
        cell.set_char(OCTANTS[place]);
    }
}

/// Terminals that draw octants themselves, with the first version that does, as they answer XTVERSION. Sources: kitty's changelog of
/// 0.40.0; VTE's commit 38064959, first in 0.78.0; notcurses, which relies on them in foot from 1.20 on; Ghostty's release 1.2.
/// Others have them in some fonts only, which a program cannot find out. Sextants would be coarser than braille: three rows of dots
/// instead of four.
const OCTANT_TERMINALS: [(&str, [u32; 2]); 4] = [
    ("foot", [1, 20]),
    ("ghostty", [1, 2]),
    ("kitty", [0, 40]),
    ("VTE", [7800, 0]),
];

/// Whether a terminal with this name and version, such as `kitty(0.40.0)`, draws octants.
pub fn has_octants(version: &str) -> bool {
    let (name, version) = version
        .split_once([' ', '('])
        .unwrap_or((version, Default::default()));
    let mut parts = version.split(|c: char| !c.is_ascii_digit());
    let mut part = || parts.next().and_then(|part| part.parse().ok()).unwrap_or(0);
    let version = [part(), part()];
    let known = OCTANT_TERMINALS.iter().find(|(own, _)| *own == name);
    known.is_some_and(|(_, first)| version >= *first)
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
        for version in [
            "ghostty 1.2.0",
            "kitty(0.40.0)",
            "foot(1.20.2)",
            "VTE(7802)",
        ] {
            assert!(has_octants(version), "{version}");
        }
        for version in [
            "ghostty 1.1.3",
            "kitty(0.39.1)",
            "VTE(7602)",
            "tmux 3.5a",
            "kitty",
            "",
        ] {
            assert!(!has_octants(version), "{version}");
        }
    }

    #[test]
    fn points_outside_or_nan_draw_nothing() {
        let blank = ["    ", "    "];
        assert_eq!(drawn(&[([-5.0, -5.0], [-1.0, 20.0])]), blank);
        assert_eq!(drawn(&[([f64::NAN, 0.0], [1.0, 1.0])]), blank);
        assert_eq!(drawn(&[([0.0, 0.0], [f64::INFINITY, 1.0])]), blank);
    }
}
