//! Colours and weights. Colour never carries meaning alone: letters, words and glyphs come first.
//!
//! Only the terminal's own colours are used, and few of them, so that light and dark terminals and a lecture hall's
//! projector all keep the contrast that their owner chose; what stands back is dim, not grey, since some palettes
//! hide their grey in the background. Cyan, yellow and magenta tell the modes apart for
//! colour-blind eyes too; red and green are left to failure and success.

use ratatui::style::{Color, Modifier, Style};
use stickslip_core::model::Mode;
use stickslip_debugger::action::Colours;

/// The styles that the panes draw with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Theme {
    /// What lies under all of it.
    pub ground: Style,
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
    /// With these colours.
    pub fn of(colours: Colours) -> Self {
        match colours {
            Colours::Dark => Theme::colour(),
            Colours::Light => Theme::light(),
            Colours::HighContrast => Theme::high_contrast(),
            Colours::None => Theme::mono(),
        }
    }

    /// For light grounds, on which yellow and cyan are hardly seen.
    fn light() -> Self {
        let colour = |colour| Style::new().fg(colour);
        Theme {
            warning: colour(Color::Magenta).add_modifier(Modifier::BOLD),
            free: colour(Color::Blue),
            sliding: colour(Color::Magenta),
            fixed: Style::new().add_modifier(Modifier::BOLD),
            ..Theme::colour()
        }
    }

    /// Bright on black, whatever the terminal's ground is, and nothing dim.
    fn high_contrast() -> Self {
        let colour = |colour| Style::new().fg(colour).add_modifier(Modifier::BOLD);
        Theme {
            ground: Style::new().fg(Color::White).bg(Color::Black),
            faint: Style::new(),
            good: colour(Color::LightGreen),
            bad: colour(Color::LightRed).add_modifier(Modifier::REVERSED),
            warning: colour(Color::LightYellow).add_modifier(Modifier::UNDERLINED),
            free: colour(Color::LightCyan),
            sliding: colour(Color::LightYellow),
            fixed: colour(Color::LightMagenta),
            ..Theme::mono()
        }
    }

    /// With the terminal's own colours, for dark grounds.
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

    /// With these colours, unless the user's environment wants none.
    pub fn chosen(colours: Colours) -> Self {
        match wants_no_colour() {
            true => Theme::mono(),
            false => Theme::of(colours),
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

/// Whether the user's environment wants no colours: <https://no-color.org>.
pub fn wants_no_colour() -> bool {
    std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty())
}

/// A mode in a letter, the one that `m` takes.
pub fn letter(mode: Mode) -> &'static str {
    match mode {
        Mode::Free => "f",
        Mode::Sliding => "s",
        Mode::Fixed => "x",
    }
}
