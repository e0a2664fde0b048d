//! Colours and text styles. Letters, words and glyphs carry the meaning; colour only repeats it.
//!
//! Only a few of the terminal's own colours are used, so that text stays legible on light and dark terminals and projectors.
//! Secondary text is dim, not grey, since some palettes hide grey in the background. Modes have the same hues in all themes and in
//! pictures, which colour-blind people can distinguish: none for free, orange for sliding, blue for fixed. Red and green mean failure
//! and success.

use ratatui::style::{Color, Modifier, Style};
use stickslip_core::Mode;
use stickslip_debugger::Colours;

/// The 16 colours of a terminal, in the order of their numbers.
const TERMINAL: [Color; 16] = [
    Color::Black,
    Color::Red,
    Color::Green,
    Color::Yellow,
    Color::Blue,
    Color::Magenta,
    Color::Cyan,
    Color::Gray,
    Color::DarkGray,
    Color::LightRed,
    Color::LightGreen,
    Color::LightYellow,
    Color::LightBlue,
    Color::LightMagenta,
    Color::LightCyan,
    Color::White,
];

/// The number of one of the terminal's 16 colours; `None` for any other.
pub fn terminal_number(colour: Color) -> Option<u8> {
    match colour {
        Color::Indexed(number) => Some(number).filter(|number| *number < 16),
        named => (0..16).find(|&number| TERMINAL[usize::from(number)] == named),
    }
}

/// The styles of the screen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Theme {
    /// The background.
    pub ground: Style,
    /// Ordinary text.
    pub text: Style,
    /// Headings and pane titles.
    pub heading: Style,
    /// Borders, captions, secondary text.
    pub faint: Style,
    /// Border and title of the pane with the focus.
    pub focus: Style,
    /// Changes, and everything that must be noticed.
    pub strong: Style,
    /// The selected row or node.
    pub selected: Style,
    /// Keys in the footer and on the help page.
    pub key: Style,
    /// Success.
    pub good: Style,
    /// Failure.
    pub bad: Style,
    /// Ties, limits, interventions.
    pub warning: Style,
    free: Style,
    sliding: Style,
    fixed: Style,
}

impl Theme {
    /// The theme for a choice of colours.
    pub fn new(colours: Colours) -> Self {
        match colours {
            Colours::Dark => Theme::colour(),
            Colours::Light => Theme::light(),
            Colours::HighContrast => Theme::high_contrast(),
            Colours::None => Theme::mono(),
        }
    }

    /// For light backgrounds, on which yellow and cyan are hard to see; orange and blue are darker there.
    fn light() -> Self {
        let colour = |colour| Style::new().fg(colour);
        Theme {
            sliding: colour(Color::Indexed(130)),
            fixed: colour(Color::Indexed(25)),
            warning: colour(Color::Magenta).add_modifier(Modifier::BOLD),
            ..Theme::colour()
        }
    }

    /// Bright on black, whatever the terminal's background, without dim text.
    fn high_contrast() -> Self {
        let colour = |colour| Style::new().fg(colour).add_modifier(Modifier::BOLD);
        Theme {
            ground: Style::new().fg(Color::White).bg(Color::Black),
            faint: Style::new(),
            good: colour(Color::LightGreen),
            bad: colour(Color::LightRed).add_modifier(Modifier::REVERSED),
            warning: colour(Color::LightYellow).add_modifier(Modifier::UNDERLINED),
            free: Style::new(),
            sliding: colour(Color::Indexed(214)),
            fixed: colour(Color::Indexed(39)),
            ..Theme::mono()
        }
    }

    /// The terminal's own colours, for dark backgrounds.
    pub fn colour() -> Self {
        let colour = |colour| Style::new().fg(colour);
        let mono = Theme::mono();
        Theme {
            good: colour(Color::Green),
            bad: colour(Color::Red).add_modifier(Modifier::BOLD),
            warning: colour(Color::Yellow).add_modifier(Modifier::BOLD),
            sliding: colour(Color::Indexed(172)),
            fixed: colour(Color::Indexed(32)),
            ..mono
        }
    }

    /// No colours: only bold, dim, underlined and reversed.
    pub fn mono() -> Self {
        let plain = Style::new();
        let bold = plain.add_modifier(Modifier::BOLD);
        Theme {
            ground: plain,
            text: plain,
            heading: bold,
            faint: plain.add_modifier(Modifier::DIM),
            focus: bold,
            strong: bold,
            selected: bold.add_modifier(Modifier::REVERSED),
            key: bold,
            good: plain,
            bad: bold.add_modifier(Modifier::REVERSED),
            warning: bold.add_modifier(Modifier::UNDERLINED),
            free: plain,
            sliding: plain,
            fixed: plain,
        }
    }

    /// The theme for a choice of colours, unless the environment asks for none.
    pub fn chosen(colours: Colours) -> Self {
        if wants_no_colour() {
            Theme::mono()
        } else {
            Theme::new(colours)
        }
    }

    /// Style of a mode.
    pub fn mode(&self, mode: Mode) -> Style {
        match mode {
            Mode::Free => self.free,
            Mode::Sliding => self.sliding,
            Mode::Fixed => self.fixed,
        }
    }

    /// Style of the cell of Table 2 that fired.
    pub fn lit(&self, mode: Mode) -> Style {
        self.mode(mode)
            .add_modifier(Modifier::REVERSED | Modifier::BOLD)
    }
}

/// Whether the environment asks for no colours: <https://no-color.org>.
pub fn wants_no_colour() -> bool {
    std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty())
}
