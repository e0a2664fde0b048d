//! Finds out whether the terminal's background is light, from the environment (`COLORFGBG`) or from the terminal (OSC 11).
//!
//! The terminal's reply arrives among the keys, where crossterm reports it as Alt-], letters, and Alt-\\ or Ctrl-G. Nothing waits for
//! it: the screen changes its colours when it arrives, and keys that turn out not to be a reply are passed on.

use crossterm::event::{Event, KeyCode, KeyModifiers};
use std::collections::VecDeque;

/// Asks for the background colour.
pub const QUERY: &str = "\x1b]11;?\x1b\\";

/// Whether `COLORFGBG` (such as `15;0`) names a light background; `None` without it.
pub fn is_light(colorfgbg: Option<&str>) -> Option<bool> {
    let ground: u8 = colorfgbg?.rsplit(';').next()?.parse().ok()?;
    Some(matches!(ground, 7 | 9..=15))
}

/// Separates the reply from the keys.
#[derive(Debug, Default)]
pub struct Reply {
    /// Whether a reply is expected.
    pub expected: bool,
    /// Keys that may be the start of a reply.
    held: Vec<Event>,
    /// Keys that are not.
    keys: VecDeque<Event>,
    /// Whether the background is light, once the reply is complete.
    pub light: Option<bool>,
}

impl Reply {
    /// Takes an event from the terminal.
    pub fn push(&mut self, event: Event) {
        if !self.expected {
            self.keys.push_back(event);
            return;
        }
        self.held.push(event);
        let letters: Option<String> = self.held.iter().map(letter).collect();
        let Some(text) = letters else {
            return self.release();
        };
        match text.strip_suffix(END) {
            Some(reply) => match reply.strip_prefix(START).and_then(brightness) {
                Some(brightness) => {
                    (self.light, self.expected) = (Some(brightness > 0.5), false);
                    self.held.clear();
                }
                None => self.release(),
            },
            None if START.starts_with(&text) || text.starts_with(START) => {}
            None => self.release(),
        }
    }

    /// Passes on what was held back, since the reply would have continued.
    pub fn release(&mut self) {
        self.keys.extend(self.held.drain(..));
    }

    /// The next event that is not part of a reply.
    pub fn next(&mut self) -> Option<Event> {
        self.keys.pop_front()
    }
}

/// Start of a reply, with `\x1b` for Alt, and its end.
const START: &str = "\x1b]11;rgb:";
const END: char = '\x07';

/// A key as the reply's text; `None` if a reply does not contain it.
fn letter(event: &Event) -> Option<String> {
    let key = event.as_key_press_event()?;
    match (key.code, key.modifiers) {
        (KeyCode::Char(']'), KeyModifiers::ALT) => Some("\x1b]".into()),
        (KeyCode::Char('\\'), KeyModifiers::ALT) | (KeyCode::Char('g'), KeyModifiers::CONTROL) => {
            Some(END.into())
        }
        (KeyCode::Char(letter), KeyModifiers::NONE | KeyModifiers::SHIFT) => Some(letter.into()),
        _ => None,
    }
}

/// Brightness from 0 to 1 of a colour such as `ffff/ffff/ffff` (Rec. 709).
fn brightness(colour: &str) -> Option<f64> {
    let part = |text: &str| {
        let most = 16_u32.checked_pow(u32::try_from(text.len()).ok()?)? - 1;
        let value = u32::from_str_radix(text, 16).ok()?;
        Some(f64::from(value) / f64::from(most))
    };
    let parts: Option<Vec<f64>> = colour.split('/').map(part).collect();
    match parts?.as_slice() {
        [red, green, blue] => Some(0.2126 * red + 0.7152 * green + 0.0722 * blue),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crossterm::event::KeyEvent;

    fn keys(text: &str) -> Vec<Event> {
        let mut keys = Vec::new();
        let mut alt = false;
        for letter in text.chars() {
            let (code, modifiers) = match letter {
                '\x1b' => {
                    alt = true;
                    continue;
                }
                '\x07' => (KeyCode::Char('g'), KeyModifiers::CONTROL),
                letter if alt => (KeyCode::Char(letter), KeyModifiers::ALT),
                letter => (KeyCode::Char(letter), KeyModifiers::NONE),
            };
            alt = false;
            keys.push(Event::Key(KeyEvent::new(code, modifiers)));
        }
        keys
    }

    fn passed(text: &str) -> (Vec<Event>, Option<bool>) {
        let mut reply = Reply {
            expected: true,
            ..Reply::default()
        };
        keys(text).into_iter().for_each(|key| reply.push(key));
        reply.release();
        (std::iter::from_fn(|| reply.next()).collect(), reply.light)
    }

    #[test]
    fn a_reply_is_found_among_keys_and_keys_are_never_swallowed() {
        for (reply, light) in [
            ("\x1b]11;rgb:ffff/ffff/dddd\x1b\\", true),
            ("\x1b]11;rgb:00/2b/36\x07", false),
        ] {
            assert_eq!(passed(reply), (vec![], Some(light)));
            let among = format!("ab{reply}c");
            assert_eq!(passed(&among), (keys("abc"), Some(light)));
        }
        for typed in ["\x1b]1n", "\x1b]11;rgb:ff", "q", "\x1b]11;rgb:x/y/z\x07j"] {
            assert_eq!(passed(typed), (keys(typed), None), "{typed:?}");
        }
    }

    #[test]
    fn the_environment_names_light_and_dark_backgrounds() {
        assert_eq!(is_light(Some("0;15")), Some(true));
        assert_eq!(is_light(Some("15;default;0")), Some(false));
        assert_eq!(is_light(Some("0;default")), None);
        assert_eq!(is_light(None), None);
    }
}
