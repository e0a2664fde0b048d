//! Draws a screen as a picture: each cell as in a terminal with the font DejaVu Sans Mono.

use crate::debugger::Debugger;
use crate::screen;
use crate::theme::terminal_number;
use ratatui::buffer::{Buffer, Cell};
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier};
use stickslip_debugger::Colours;
use stickslip_study::drawn::{Colour, Face, PlotError, Shape, TextLine};
use stickslip_study::pen;

/// Size of a cell in pixels; a letter of the font is as wide.
const CELL: (f64, f64) = (10.0, 19.0);
/// Text size ([`Shape::Text`]), and the row of a cell on which its letters are centred.
const SIZE: f64 = 20.6;
const MIDDLE: f64 = 9.4;
/// Margin around the screen.
const MARGIN: f64 = 8.0;
/// Part of the ground in dim text, as in VTE.
const DIM: f64 = 1.0 / 3.0;

/// The colours of a terminal: the ground, plain text, and the first 16 colours.
struct Palette {
    ground: Colour,
    text: Colour,
    named: [Colour; 16],
}

/// A terminal with a dark ground.
const DARK: Palette = Palette {
    ground: (24, 26, 31),
    text: (216, 218, 222),
    named: [
        (24, 26, 31),
        (224, 96, 96),
        (120, 190, 100),
        (222, 190, 90),
        (100, 150, 230),
        (200, 120, 200),
        (90, 190, 200),
        (200, 202, 206),
        (120, 124, 130),
        (255, 120, 120),
        (150, 220, 130),
        (255, 220, 110),
        (130, 180, 255),
        (230, 150, 230),
        (120, 220, 230),
        (255, 255, 255),
    ],
};

/// A terminal with a light ground.
const LIGHT: Palette = Palette {
    ground: (255, 255, 255),
    text: (32, 34, 38),
    named: [
        (32, 34, 38),
        (190, 30, 30),
        (40, 120, 30),
        (150, 110, 0),
        (30, 80, 190),
        (150, 40, 150),
        (0, 120, 130),
        (200, 202, 206),
        (110, 114, 120),
        (220, 40, 40),
        (50, 150, 40),
        (180, 130, 0),
        (50, 110, 230),
        (180, 60, 180),
        (0, 150, 160),
        (255, 255, 255),
    ],
};

/// The screen of a debugger as PNG, in a terminal of this size whose ground suits the colours.
///
/// # Errors
/// If the build cannot draw.
pub fn png(
    debugger: &Debugger,
    (width, height): (u16, u16),
    colours: Colours,
) -> Result<Vec<u8>, PlotError> {
    let area = Rect::new(0, 0, width, height);
    let mut buffer = Buffer::empty(area);
    let view = debugger.view();
    screen::draw(&mut buffer, area, &debugger.app, view.as_ref());
    let (shapes, size) = shapes(&buffer, colours);
    pen::png(&shapes, size, 1.0)
}

/// A screen as shapes, and the size of the picture.
fn shapes(buffer: &Buffer, colours: Colours) -> (Vec<Shape>, (f64, f64)) {
    let palette = match colours {
        Colours::Light => &LIGHT,
        Colours::Dark | Colours::HighContrast | Colours::None => &DARK,
    };
    let area = buffer.area;
    let size = (
        2.0 * MARGIN + CELL.0 * f64::from(area.width),
        2.0 * MARGIN + CELL.1 * f64::from(area.height),
    );
    let mut shapes = vec![rectangle((0.0, 0.0), size, palette.ground)];
    let at = |x: u16, y: u16| {
        (
            MARGIN + CELL.0 * f64::from(x),
            MARGIN + CELL.1 * f64::from(y),
        )
    };
    let all: Vec<_> = (area.top()..area.bottom())
        .flat_map(|y| (area.left()..area.right()).map(move |x| (x, y)))
        .collect();
    for &(x, y) in &all {
        let (_, ground) = palette.colours(&buffer[(x, y)]);
        if ground != palette.ground {
            shapes.push(rectangle(at(x, y), CELL, ground));
        }
    }
    for &(x, y) in &all {
        letter(&mut shapes, at(x, y), &buffer[(x, y)], palette);
    }
    (shapes, size)
}

fn rectangle((x, y): (f64, f64), (width, height): (f64, f64), colour: Colour) -> Shape {
    let (right, low) = (x + width, y + height);
    Shape::Fill {
        corners: vec![(x, y), (right, y), (right, low), (x, low)],
        colour,
    }
}

/// The letter of a cell; bold letters are drawn twice.
fn letter(shapes: &mut Vec<Shape>, (x, y): (f64, f64), cell: &Cell, palette: &Palette) {
    let (colour, _) = palette.colours(cell);
    let has = |modifier| cell.modifier.contains(modifier);
    if has(Modifier::UNDERLINED) {
        shapes.push(rectangle((x, y + CELL.1 - 2.0), (CELL.0, 1.0), colour));
    }
    if cell.symbol().trim().is_empty() {
        return;
    }
    let strokes = if has(Modifier::BOLD) { 2 } else { 1 };
    for stroke in 0..strokes {
        let at = (x + f64::from(stroke), y + MIDDLE);
        shapes.push(Shape::Text(TextLine {
            face: Face::Mono(pen::mono()),
            ..TextLine::new(at, cell.symbol().to_owned(), SIZE, colour)
        }));
    }
}

impl Palette {
    /// Text and ground of a cell.
    fn colours(&self, cell: &Cell) -> (Colour, Colour) {
        let (mut text, mut ground) = (
            self.colour(cell.fg).unwrap_or(self.text),
            self.colour(cell.bg).unwrap_or(self.ground),
        );
        if cell.modifier.contains(Modifier::REVERSED) {
            (text, ground) = (ground, text);
        }
        if cell.modifier.contains(Modifier::DIM) {
            text = mixed(text, ground, DIM);
        }
        (text, ground)
    }

    /// A colour of the terminal; `None` for the default.
    fn colour(&self, colour: Color) -> Option<Colour> {
        let number = match colour {
            Color::Reset => return None,
            Color::Rgb(r, g, b) => return Some((r, g, b)),
            Color::Indexed(number) => number,
            named => terminal_number(named)?,
        };
        Some(match number {
            0..16 => self.named[usize::from(number)],
            16..232 => {
                let level = |k: u8| if k == 0 { 0 } else { 55 + 40 * k };
                let cube = number - 16;
                (level(cube / 36), level(cube / 6 % 6), level(cube % 6))
            }
            232.. => {
                let grey = 8 + 10 * (number - 232);
                (grey, grey, grey)
            }
        })
    }
}

fn mixed(a: Colour, b: Colour, part: f64) -> Colour {
    let mix = |a: u8, b: u8| (f64::from(a) + part * (f64::from(b) - f64::from(a))).round() as u8;
    (mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::theme::Theme;
    use ratatui::style::Style;
    use stickslip_core::model::Mode;

    #[test]
    fn a_cell_has_the_colours_of_its_style() {
        let cell = |style: Style| {
            let mut cell = Cell::default();
            cell.set_style(style);
            DARK.colours(&cell)
        };
        assert_eq!(cell(Style::new()), (DARK.text, DARK.ground));
        let reversed = Style::new().fg(Color::Red).add_modifier(Modifier::REVERSED);
        assert_eq!(cell(reversed), (DARK.ground, DARK.named[1]));
        // The orange and the blue of the modes, in the cube of xterm.
        assert_eq!(cell(Style::new().fg(Color::Indexed(172))).0, (215, 135, 0));
        assert_eq!(cell(Style::new().fg(Color::Indexed(32))).0, (0, 135, 215));
        let (dim, ground) = cell(Style::new().add_modifier(Modifier::DIM));
        assert!(dim.0 < DARK.text.0 && dim.0 > ground.0);
    }

    /// The contrast of two colours as WCAG 2.2 defines it, which asks for 4.5 for text.
    fn contrast(a: Colour, b: Colour) -> f64 {
        let light = |(r, g, b): Colour| {
            let linear = |part: u8| match f64::from(part) / 255.0 {
                part if part <= 0.04045 => part / 12.92,
                part => ((part + 0.055) / 1.055).powf(2.4),
            };
            0.05 + 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b)
        };
        let (a, b) = (light(a), light(b));
        a.max(b) / a.min(b)
    }

    #[test]
    fn all_text_stands_out_from_its_ground() {
        for (colours, palette) in [
            (Colours::Light, LIGHT),
            (Colours::Dark, DARK),
            (Colours::HighContrast, DARK),
        ] {
            let theme = Theme::new(colours);
            let modes = [Mode::Free, Mode::Sliding, Mode::Fixed].map(|mode| theme.mode(mode));
            let others = [
                theme.text,
                theme.faint,
                theme.selected,
                theme.good,
                theme.bad,
                theme.warning,
            ];
            for style in modes.into_iter().chain(others) {
                let mut cell = Cell::default();
                cell.set_style(theme.ground).set_style(style);
                let (text, ground) = palette.colours(&cell);
                let contrast = contrast(text, ground);
                assert!(contrast >= 4.5, "{} {style:?}: {contrast}", colours.word());
            }
        }
    }

    #[test]
    fn only_letters_and_coloured_grounds_are_drawn() {
        let mut buffer = Buffer::empty(Rect::new(0, 0, 4, 2));
        buffer.set_string(0, 0, "ab", Style::new());
        buffer.set_string(2, 1, "c ", Style::new().add_modifier(Modifier::BOLD));
        buffer[(3, 1)].set_style(Style::new().add_modifier(Modifier::REVERSED));
        let (shapes, size) = shapes(&buffer, Colours::Light);
        assert_eq!(size, (56.0, 54.0));
        // The ground, one reversed cell, two letters, and a bold one.
        assert_eq!(shapes.len(), 1 + 1 + 2 + 2);
    }
}
