//! The user's configuration of the debugger: two optional files in the user's configuration folder.
//!
//! `debugger.ron`, and `keys.ron` ([`Keymap`]):
//!
//! ```ron
//! (
//!     colours: light,     // auto (default: as the background), dark, light, high_contrast, none; NO_COLOR wins
//!     mouse: false,       // default: true
//!     dots: octants,      // auto (default: as the terminal), braille, octants
//! )
//! ```

use super::keymap::Keymap;
use super::meaning::Colours;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use stickslip_platform::{input, system};
use stickslip_scene::SceneError;
use stickslip_scene::format::read;

/// Names of the files.
pub const KEYS: &str = "keys.ron";
const DEBUGGER: &str = "debugger.ron";
/// Maximum size of each file in bytes.
const MOST: u64 = 1 << 20;

/// The user's configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct Config {
    /// The keys.
    pub keymap: Keymap,
    /// The colours; `None` follows the terminal's background.
    pub colours: Option<Colours>,
    /// Whether mouse support is on.
    pub mouse: bool,
    /// Signs of pictures.
    pub dots: Dots,
}

/// The signs of which pictures consist, both two dots wide and four high.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Dots {
    /// Octants where the terminal is known to draw them, braille elsewhere.
    #[default]
    Auto,
    /// Braille, which every terminal has.
    Braille,
    /// Octants of Unicode 16, which leave no gaps.
    Octants,
}

impl Default for Config {
    fn default() -> Self {
        Config {
            keymap: Keymap::default(),
            colours: None,
            mouse: true,
            dots: Dots::Auto,
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ConfigFile {
    #[serde(default)]
    colours: ConfigColours,
    #[serde(default = "on")]
    mouse: bool,
    #[serde(default)]
    dots: Dots,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "snake_case")]
enum ConfigColours {
    #[default]
    Auto,
    Dark,
    Light,
    HighContrast,
    None,
}

fn on() -> bool {
    true
}

/// The user's configuration folder, if the system has one.
pub fn folder() -> Option<PathBuf> {
    system::config_folder()
}

impl Config {
    /// Reads the files in the user's folder.
    ///
    /// # Errors
    /// If an existing file cannot be read or is invalid.
    pub fn open() -> Result<Config, SceneError> {
        match folder() {
            Some(folder) => Config::from(&folder),
            None => Ok(Config::default()),
        }
    }

    /// Reads the files in a folder.
    ///
    /// # Errors
    /// If an existing file cannot be read or is invalid.
    pub fn from(folder: &Path) -> Result<Config, SceneError> {
        let mut config = Config::default();
        if let Some((file, text)) = text(&folder.join(DEBUGGER))? {
            let written: ConfigFile = read::value(&file, &text, "configuration")?;
            (config.mouse, config.dots) = (written.mouse, written.dots);
            config.colours = match written.colours {
                ConfigColours::Auto => None,
                ConfigColours::Dark => Some(Colours::Dark),
                ConfigColours::Light => Some(Colours::Light),
                ConfigColours::HighContrast => Some(Colours::HighContrast),
                ConfigColours::None => Some(Colours::None),
            };
        }
        if let Some((file, text)) = text(&folder.join(KEYS))? {
            config.keymap = Keymap::read(&file, &text)?;
        }
        Ok(config)
    }
}

/// Name and text of a file, which may be missing.
fn text(path: &Path) -> Result<Option<(String, String)>, SceneError> {
    let file = path.display().to_string();
    // A dangling link is an error, a missing file is not.
    if !path.exists() && !path.is_symlink() {
        return Ok(None);
    }
    match input::text(path, MOST, "too large for a configuration file") {
        Ok(text) => Ok(Some((file, text))),
        Err(why) => Err(read::unread(
            &file,
            why,
            "a configuration is written in RON",
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_files_change_nothing_and_existing_ones_apply() {
        let folder = tempfile::tempdir().unwrap();
        let config = || Config::from(folder.path());
        assert_eq!(config(), Ok(Config::default()));
        std::fs::write(
            folder.path().join(DEBUGGER),
            "(colours: high_contrast, mouse: false, dots: octants)",
        )
        .unwrap();
        std::fs::write(folder.path().join(KEYS), "{\"copy\": [\"x\"]}").unwrap();
        let config = config().unwrap();
        assert_eq!(
            (config.colours, config.mouse, config.dots),
            (Some(Colours::HighContrast), false, Dots::Octants)
        );
        assert_eq!(config.keymap.by_key("x").map(|e| e.name), Some("copy"));
    }

    #[test]
    fn errors_have_file_line_column_and_a_hint() {
        let folder = tempfile::tempdir().unwrap();
        let describe = |text: &str| {
            std::fs::write(folder.path().join(DEBUGGER), text).unwrap();
            Config::from(folder.path()).unwrap_err().to_string()
        };
        let wrong = describe("(\n  colour: light)");
        assert!(wrong.contains("debugger.ron:2:"), "{wrong}");
        assert!(wrong.contains("did you mean \"colours\"?"), "{wrong}");
        let wrong = describe("(colours: ligth)");
        assert!(wrong.contains("did you mean \"light\"?"), "{wrong}");
        let wrong = describe("");
        assert!(
            wrong.contains("(colours: dark, mouse: false, ...)"),
            "{wrong}"
        );
        let wrong = describe("(mouse: 3)");
        assert!(wrong.contains("it must be true or false"), "{wrong}");
    }
}
