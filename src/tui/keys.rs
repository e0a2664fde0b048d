//! Names of terminal keys, as in the table of actions.

use crate::event::{KeyCode, KeyEvent, Modifiers};
use KeyCode::*;

/// The table's name of a key press: `s`, `S`, `F10`, `Shift-F11`, `Ctrl-c`, `PageDown`. `None` for keys without a name in the table.
pub fn name(key: &KeyEvent) -> Option<String> {
    if key.modifiers.alt {
        return None;
    }
    let Modifiers { control, shift, .. } = key.modifiers;
    let name = match key.code {
        Char(letter) if control && letter != ' ' => format!("Ctrl-{}", letter.to_lowercase()),
        Char(letter) if letter != ' ' => letter.into(),
        F(number) if shift => format!("Shift-F{number}"),
        // Many terminals send Shift-F11 as F23, which is F11 plus 12.
        F(number @ 13..=24) => format!("Shift-F{}", number - 12),
        F(number) => format!("F{number}"),
        Tab if shift => "Shift-Tab".into(),
        other => NAMED.iter().find(|(code, _)| *code == other)?.1.into(),
    };
    Some(name)
}

/// Splits one report into key presses: Esc followed by a letter arrives as Alt and the letter, which no action uses.
pub fn apart(key: &KeyEvent) -> impl Iterator<Item = KeyEvent> {
    let modifiers = Modifiers {
        alt: false,
        ..key.modifiers
    };
    let alone = KeyEvent::new(key.code, modifiers);
    let together = key.modifiers.alt;
    together
        .then(|| KeyEvent::new(Esc, Modifiers::NONE))
        .into_iter()
        .chain([alone])
}

/// The key press of a name, the inverse of [`name`]; for tests and scripts.
pub fn press(name: &str) -> Option<KeyEvent> {
    let (modifiers, rest) = match name {
        _ if name.starts_with("Ctrl-") => (Modifiers::CONTROL, &name[5..]),
        _ if name.starts_with("Shift-F") => (Modifiers::SHIFT, &name[6..]),
        _ => (Modifiers::NONE, name),
    };
    let mut letters = rest.chars();
    let code = match (letters.next()?, letters.as_str()) {
        (letter, "") => Char(letter),
        ('F', number) if number.parse::<u8>().is_ok() => F(number.parse().ok()?),
        _ => NAMED.iter().find(|(_, name)| *name == rest)?.0,
    };
    Some(KeyEvent::new(code, modifiers))
}

/// The key presses of names separated by blanks. A longer word that begins with `:` or `/` and the words after it, up to Enter, Tab or
/// Esc, are typed letter by letter; so are counts.
///
/// # Errors
/// The first word that is no key.
pub fn presses(names: &str) -> Result<Vec<KeyEvent>, String> {
    let mut pressed = Vec::new();
    let mut types = false;
    for word in names.split_whitespace() {
        let ends = ["Enter", "Tab", "Esc"].contains(&word);
        match press(word) {
            Some(key) if ends || !types => {
                types &= word == "Tab";
                pressed.push(key);
            }
            None if !types && word.bytes().all(|byte| byte.is_ascii_digit()) => {
                pressed.extend(word.chars().filter_map(|digit| press(&digit.to_string())));
            }
            None if !types && !word.starts_with([':', '/']) => return Err(word.to_owned()),
            _ => {
                let blank = if types { " " } else { "" };
                let letters = blank.chars().chain(word.chars());
                pressed.extend(letters.map(|c| KeyEvent::new(Char(c), Modifiers::NONE)));
                types = true;
            }
        }
    }
    Ok(pressed)
}

/// Names of the keys that type no visible letter.
const NAMED: [(KeyCode, &str); 15] = [
    (Char(' '), "Space"),
    (BackTab, "Shift-Tab"),
    (Enter, "Enter"),
    (Tab, "Tab"),
    (Esc, "Esc"),
    (Up, "Up"),
    (Down, "Down"),
    (Left, "Left"),
    (Right, "Right"),
    (Home, "Home"),
    (End, "End"),
    (PageUp, "PageUp"),
    (PageDown, "PageDown"),
    (Backspace, "Backspace"),
    (Delete, "Delete"),
];

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip_debugger::action::ACTIONS;

    #[test]
    fn every_key_of_the_table_can_be_pressed() {
        for key in ACTIONS.iter().flat_map(|entry| entry.keys) {
            let pressed = press(key).unwrap_or_else(|| panic!("no key is called {key}"));
            assert_eq!(name(&pressed).as_deref(), Some(*key));
        }
    }

    #[test]
    fn command_lines_are_typed_letter_by_letter() {
        let names = |keys: &str| {
            let pressed = presses(keys)?;
            Ok::<_, String>(
                pressed
                    .iter()
                    .filter_map(name)
                    .collect::<Vec<_>>()
                    .join(" "),
            )
        };
        assert_eq!(names("3 s Tab").unwrap(), "3 s Tab");
        assert_eq!(names("c :go 3 Enter d").unwrap(), "c : g o Space 3 Enter d");
        assert_eq!(names(": /a").unwrap(), ": / a");
        assert_eq!(names("20 f").unwrap(), "2 0 f");
        assert_eq!(names("s Enetr").unwrap_err(), "Enetr");
    }

    #[test]
    fn function_keys_beyond_f12() {
        let key = KeyEvent::new(KeyCode::F(23), Modifiers::NONE);
        assert_eq!(name(&key).as_deref(), Some("Shift-F11"));
    }

    #[test]
    fn escape_and_a_letter_in_one_report_are_two_keys() {
        let names = |key: KeyEvent| apart(&key).filter_map(|key| name(&key)).collect::<Vec<_>>();
        let with = |modifiers| KeyEvent::new(KeyCode::Char('c'), modifiers);
        let alt = Modifiers {
            alt: true,
            ..Modifiers::NONE
        };
        assert_eq!(names(with(alt)), ["Esc", "c"]);
        assert_eq!(names(with(Modifiers::NONE)), ["c"]);
        let both = Modifiers {
            control: true,
            ..alt
        };
        assert_eq!(names(with(both)), ["Esc", "Ctrl-c"]);
    }
}
