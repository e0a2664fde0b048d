//! Finds out whether the terminal's background is light, from the environment (`COLORFGBG`) or from the terminal (OSC 11), and
//! which terminal it is (XTVERSION).
//!
//! The replies arrive among the keys, where crossterm reports them as Alt-] or Alt-P, letters, and Alt-\\ or Ctrl-G. Nothing waits
//! for them: the screen changes when they arrive, and keys that turn out not to be a reply are passed on.

use crossterm::event::{Event, KeyCode, KeyModifiers};
use std::collections::VecDeque;

/// Asks for the background colour.
pub const QUERY: &str = "\x1b]11;?\x1b\\";

/// Asks for the terminal's name and version.
pub const VERSION_QUERY: &str = "\x1b[>q";

/// Whether `COLORFGBG` (such as `15;0`) names a light background; `None` without it.
pub fn is_light(colorfgbg: Option<&str>) -> Option<bool> {
    let ground: u8 = colorfgbg?.rsplit(';').next()?.parse().ok()?;
    Some(matches!(ground, 7 | 9..=15))
}

/// Separates the replies from the keys.
#[derive(Debug, Default)]
pub struct Reply {
    /// Whether the background colour is expected.
    pub expects_colour: bool,
    /// Whether the terminal's version is expected.
    pub expects_version: bool,
    /// Keys that may be the start of a reply.
    held: Vec<Event>,
    /// Keys that are not.
    keys: VecDeque<Event>,
    /// Whether the background is light, once the reply is complete.
    pub light: Option<bool>,
    /// The terminal's name and version, once the reply is complete: `kitty(0.40.0)`.
    pub version: Option<String>,
}

impl Reply {
    /// Takes an event from the terminal.
    pub fn push(&mut self, event: Event) {
        let expected = [
            (self.expects_colour, COLOUR),
            (self.expects_version, VERSION),
        ];
        if !expected.iter().any(|(expected, _)| *expected) {
            self.keys.push_back(event);
            return;
        }
        self.held.push(event);
        let letters: Option<String> = self.held.iter().map(letter).collect();
        let Some(text) = letters else {
            return self.release();
        };
        match text.strip_suffix(END) {
            Some(reply) if self.take(reply) => self.held.clear(),
            Some(_) => self.release(),
            None => {
                let begins = |start: &str| start.starts_with(&text) || text.starts_with(start);
                if !expected
                    .iter()
                    .any(|(expected, start)| *expected && begins(start))
                {
                    self.release();
                }
            }
        }
    }

    /// Takes a reply without its end; returns false if it is none.
    fn take(&mut self, reply: &str) -> bool {
        if let Some(brightness) = reply.strip_prefix(COLOUR).and_then(brightness) {
            (self.light, self.expects_colour) = (Some(brightness > 0.5), false);
        } else if let Some(version) = reply.strip_prefix(VERSION) {
            (self.version, self.expects_version) = (Some(version.to_owned()), false);
        } else {
            return false;
        }
        true
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

/// Starts of the replies, with `\x1b` for Alt, and their end.
const COLOUR: &str = "\x1b]11;rgb:";
const VERSION: &str = "\x1bP>|";
const END: char = '\x07';

/// A key as the reply's text; `None` if a reply does not contain it.
fn letter(event: &Event) -> Option<String> {
    let key = event.as_key_press_event()?;
    match (key.code, key.modifiers) {
        (KeyCode::Char(letter @ (']' | 'P')), modifiers)
            if modifiers.contains(KeyModifiers::ALT) =>
        {
            Some(format!("\x1b{letter}"))
        }
        (KeyCode::Char('\\'), KeyModifiers::ALT) | (KeyCode::Char('g'), KeyModifiers::CONTROL) => {
            Some(END.into())
        }
        (KeyCode::Char(letter), KeyModifiers::NONE | KeyModifiers::SHIFT) => Some(letter.into()),
        _ => None,
    }
}

/// Brightness from 0 to 1 of a colour such as `ffff/ffff/ffff` (Rec. 709).
fn brightness(colour: &str) -> Option<f64> {
    let parts: Option<Vec<f64>> = colour
        .split('/')
        .map(|text| {
            let most = 16_u32.checked_pow(u32::try_from(text.len()).ok()?)? - 1;
            let value = u32::from_str_radix(text, 16).ok()?;
            Some(f64::from(value) / f64::from(most))
        })
        .collect();
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
            expects_colour: true,
            expects_version: true,
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
        let mut reply = Reply {
            expects_version: true,
            ..Reply::default()
        };
        for key in keys("x\x1bP>|foot(1.20.2)\x1b\\y") {
            reply.push(key);
        }
        assert_eq!(reply.version.as_deref(), Some("foot(1.20.2)"));
        assert_eq!(std::iter::from_fn(|| reply.next()).count(), 2);
        for typed in [
            "\x1bPx",
            "\x1b]1n",
            "\x1b]11;rgb:ff",
            "q",
            "\x1b]11;rgb:x/y/z\x07j",
        ] {
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
