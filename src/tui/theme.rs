//! Colours and weights. Colour never carries meaning alone: letters, words and glyphs come first.
//!
//! Only the terminal's own colours are used, and few of them, so that light and dark terminals and a lecture hall's
//! projector all keep the contrast that their owner chose; what stands back is dim, not grey, since some palettes
//! hide their grey in the background. Cyan, yellow and magenta tell the modes apart for
//! colour-blind eyes too; red and green are left to failure and success.

use crate::model::Mode;
use ratatui::style::{Color, Modifier, Style};

/// The styles that the panes draw with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Theme {
    /// Ordinary text.
    pub text: Style,
    /// Headings and pane titles.
    pub heading: Style,
    /// Borders, captions, what stands back.
    pub faint: Style,
    /// Border and title of the pane with the focus.
    pub focus: Style,
    /// What changed, and what a reader must not miss.
    pub strong: Style,
    /// The selected row or node.
    pub selected: Style,
    /// Keys in the footer and on the help page.
    pub key: Style,
    /// What went well.
    pub good: Style,
    /// What failed.
    pub bad: Style,
    /// Ties, limits, interventions.
    pub warning: Style,
    free: Style,
    sliding: Style,
    fixed: Style,
}

impl Theme {
    /// With colour.
    pub fn colour() -> Self {
        let colour = |colour| Style::new().fg(colour);
        let mono = Theme::mono();
        Theme {
            good: colour(Color::Green),
            bad: colour(Color::Red).add_modifier(Modifier::BOLD),
            warning: colour(Color::Yellow).add_modifier(Modifier::BOLD),
            free: colour(Color::Cyan),
            sliding: colour(Color::Yellow),
            fixed: colour(Color::Magenta),
            ..mono
        }
    }

    /// Without colour: bold, dim, underlined and reversed only.
    pub fn mono() -> Self {
        let plain = Style::new();
        let bold = plain.add_modifier(Modifier::BOLD);
        Theme {
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

    /// As the user's environment asks: <https://no-color.org>.
    pub fn from_environment() -> Self {
        match std::env::var_os("NO_COLOR") {
            Some(value) if !value.is_empty() => Theme::mono(),
            _ => Theme::colour(),
        }
    }

    /// How a mode is written.
    pub fn mode(&self, mode: Mode) -> Style {
        match mode {
            Mode::Free => self.free,
            Mode::Sliding => self.sliding,
            Mode::Fixed => self.fixed,
        }
    }

    /// The cell of Table 2 that fired.
    pub fn lit(&self, mode: Mode) -> Style {
        self.mode(mode)
            .add_modifier(Modifier::REVERSED | Modifier::BOLD)
    }
}

/// A mode in a word.
pub fn word(mode: Mode) -> &'static str {
    match mode {
        Mode::Free => "free",
        Mode::Sliding => "sliding",
        Mode::Fixed => "fixed",
    }
}

/// A mode in a letter, the one that `m` takes.
pub fn letter(mode: Mode) -> &'static str {
    match mode {
        Mode::Free => "f",
        Mode::Sliding => "s",
        Mode::Fixed => "x",
    }
}
