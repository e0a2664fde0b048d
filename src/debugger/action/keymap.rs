//! Which key does which action: the keys of the table, and those that a file puts in their place.
//!
//! ```ron
//! {
//!     "step": ["j", "F11"],   // the keys of an action, instead of its own
//!     "down": ["Down"],       // `j` is free for the first
//!     "sort": [],             // none; its name is left
//! }
//! ```

use super::table::{ACTIONS, Entry, Group, by_key};
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use std::collections::BTreeMap;
use std::fmt;
use stickslip_scene::format::SceneError;
use stickslip_scene::format::error::{Path, did_you_mean, quoted};
use stickslip_scene::format::locate::{line_and_column, locate};
use stickslip_scene::format::read;

/// Keys that are no letters, as help calls them.
const NAMED: [&str; 15] = [
    "Space",
    "Shift-Tab",
    "Enter",
    "Tab",
    "Esc",
    "Up",
    "Down",
    "Left",
    "Right",
    "Home",
    "End",
    "PageUp",
    "PageDown",
    "Delete",
    "Backspace",
];
/// Actions that keep their keys, whatever else does not answer.
const FIXED: [&str; 3] = ["interrupt", "suspend", "redraw"];
/// Actions without which one cannot go on, or not leave.
const NEEDED: [&str; 4] = ["command", "cancel", "help", "quit"];
/// Most keys of an action.
const MOST: usize = 8;

/// The keys of all actions.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Keymap {
    /// By the action's name, where they are not those of the table.
    changed: BTreeMap<&'static str, Vec<String>>,
}

/// What the file holds, in its order.
struct Written(Vec<(String, Vec<String>)>);

impl<'de> Deserialize<'de> for Written {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        struct Pairs;
        impl<'de> Visitor<'de> for Pairs {
            type Value = Written;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("actions and their keys, { \"step\": [\"s\"], ... }")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Written, A::Error> {
                let mut pairs = Vec::new();
                while let Some(pair) = map.next_entry()? {
                    pairs.push(pair);
                }
                Ok(Written(pairs))
            }
        }
        reader.deserialize_map(Pairs)
    }
}

impl Keymap {
    /// The keys as the text of a file changes them.
    ///
    /// # Errors
    /// If the text is no such file, names an action that there is not or a key that no terminal has, or gives a key to two.
    pub fn read(file: &str, text: &str) -> Result<Keymap, SceneError> {
        let Written(written) = read::value(file, text, "list of keys")?;
        let wrong = |byte: usize, path: &Path, message: String| SceneError {
            file: file.to_owned(),
            at: Some(line_and_column(text, byte)),
            set: None,
            path: path.to_string(),
            message,
        };
        let mut keymap = Keymap::default();
        for (name, keys) in &written {
            let path = Path(vec![name.as_str().into()]);
            let of_keys = locate(text, &path).start;
            // The place of the name itself, which stands before its keys.
            let of_name = text[..of_keys]
                .rfind('"')
                .and_then(|end| text[..end].rfind('"'));
            let of_name = of_name.unwrap_or(of_keys);
            let misnamed = |message| wrong(of_name, &Path::default(), message);
            let names = || ACTIONS.iter().map(|entry| entry.name);
            let entry = ACTIONS.iter().find(|entry| entry.name == name);
            let entry = entry.ok_or_else(|| {
                let near = did_you_mean(name, names());
                misnamed(format!("no action is called {}{near}", quoted(name)))
            })?;
            if FIXED.contains(&entry.name) {
                let key = entry.keys.join(", ");
                return Err(misnamed(format!("{name} is {key} always")));
            }
            if keys.is_empty() && NEEDED.contains(&entry.name) {
                return Err(misnamed(format!("{name} needs a key")));
            }
            if keys.len() > MOST {
                return Err(misnamed(format!("{name} has more than {MOST} keys")));
            }
            for (index, key) in keys.iter().enumerate() {
                let path = path.then(index);
                let byte = locate(text, &path).start;
                check(key).map_err(|message| wrong(byte, &path, message))?;
            }
            if keymap.changed.insert(entry.name, keys.clone()).is_some() {
                return Err(misnamed(format!("{name} stands here twice")));
            }
        }
        // Only now is it known which keys are free.
        for (name, keys) in &written {
            for (index, key) in keys.iter().enumerate() {
                let mut owners = ACTIONS.iter().filter(|entry| {
                    let times = keymap.keys(entry).filter(|own| own == key).count();
                    times > usize::from(entry.name == name)
                });
                if let Some(owner) = owners.next() {
                    let path = Path(vec![name.as_str().into(), index.into()]);
                    let byte = locate(text, &path).start;
                    let message = format!(
                        "{} is a key of {} already; give that others here, too: {:?}: [...]",
                        quoted(key),
                        owner.name,
                        owner.name
                    );
                    return Err(wrong(byte, &path, message));
                }
            }
        }
        let same = |name: &str, keys: &[String]| {
            let entry = ACTIONS.iter().find(|entry| entry.name == name);
            entry.is_some_and(|entry| entry.keys == keys)
        };
        keymap.changed.retain(|name, keys| !same(name, keys));
        Ok(keymap)
    }

    /// The keys of an action.
    pub fn keys<'a>(&'a self, entry: &'a Entry) -> impl Iterator<Item = &'a str> {
        let changed = self.changed.get(entry.name);
        let own = entry
            .keys
            .iter()
            .copied()
            .filter(move |_| changed.is_none());
        changed.into_iter().flatten().map(String::as_str).chain(own)
    }

    /// The action that a key does.
    pub fn by_key(&self, key: &str) -> Option<&'static Entry> {
        let changed = |entry: &&Entry| self.changed.contains_key(entry.name);
        let moved = || {
            let names = self.changed.iter();
            let mut names = names.filter(|(_, keys)| keys.iter().any(|own| own == key));
            let (name, _) = names.next()?;
            ACTIONS.iter().find(|entry| entry.name == *name)
        };
        by_key(key).filter(|entry| !changed(entry)).or_else(moved)
    }

    /// Whether they are not all those of the table.
    pub fn is_changed(&self) -> bool {
        !self.changed.is_empty()
    }

    /// All actions that have a key or could, with their present keys, as a file would have them: a heading, and lines of the
    /// file.
    pub fn listed(&self) -> Vec<(Group, Vec<String>)> {
        let line = |entry: &Entry| {
            let keys: Vec<String> = self.keys(entry).map(|key| format!("{key:?}")).collect();
            let mark = match self.changed.contains_key(entry.name) {
                true => "   // changed",
                false => "",
            };
            format!("{:?}: [{}],{mark}", entry.name, keys.join(", "))
        };
        Group::ALL
            .into_iter()
            .map(|group| {
                let entries = ACTIONS.iter().filter(|entry| entry.group == group);
                let free = entries.filter(|entry| !FIXED.contains(&entry.name));
                (group, free.map(line).collect())
            })
            .collect()
    }

    /// The present keys as the text of a file.
    pub fn text(&self) -> String {
        let groups = self.listed().into_iter().map(|(group, lines)| {
            let lines: String = lines.iter().map(|line| format!("    {line}\n")).collect();
            format!("    // {}\n{lines}", group.title())
        });
        format!("{{\n{}}}\n", groups.collect::<Vec<_>>().join("\n"))
    }
}

/// Whether a terminal has a key of this name, and it is free for an action.
fn check(key: &str) -> Result<(), String> {
    let mut letters = key.chars();
    let number = |text: &str| text.parse::<u8>().is_ok_and(|n| (1..=12).contains(&n));
    let function = key.strip_prefix("Shift-").unwrap_or(key);
    let known = match (letters.next(), letters.as_str()) {
        (Some(letter), "") if letter.is_ascii_digit() && letter != '0' => {
            return Err("digits are counts".into());
        }
        (Some(letter), "") => !letter.is_whitespace() && !letter.is_control(),
        _ if function.strip_prefix('F').is_some_and(number) => true,
        _ => match key.strip_prefix("Ctrl-") {
            Some("c" | "z" | "l") => {
                return Err(format!("{key} does what it does always"));
            }
            Some("i" | "m" | "h" | "j") => {
                return Err(format!("a terminal sends another key for {key}"));
            }
            Some(letter) => letter.len() == 1 && letter.chars().all(|c| c.is_ascii_lowercase()),
            None => NAMED.contains(&key),
        },
    };
    match known {
        true => Ok(()),
        false => Err(format!(
            "no key is called {}{}; a letter is, F1 to F12, Shift-F1, Ctrl-a, {}",
            quoted(key),
            did_you_mean(key, NAMED),
            NAMED.join(", ")
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> String {
        Keymap::read("keys.ron", text).unwrap_err().to_string()
    }

    #[test]
    fn a_file_gives_actions_other_keys_and_frees_their_own() {
        let text =
            "// mine\n{\"step\": [\"j\", \"F11\"], \"down\": [\"Down\", \"Ctrl-n\"], \"sort\": []}";
        let keymap = Keymap::read("keys.ron", text).unwrap();
        let name = |key| keymap.by_key(key).map(|entry| entry.name);
        assert_eq!(name("j"), Some("step"));
        assert_eq!(name("F11"), Some("step"));
        assert_eq!(name("s"), None);
        assert_eq!(name("Ctrl-n"), Some("down"));
        assert_eq!(name(">"), None);
        assert_eq!(name("c"), Some("continue"));
        // What it prints is read again, to the same keys.
        let again = Keymap::read("keys.ron", &keymap.text()).unwrap();
        for entry in ACTIONS {
            assert!(again.keys(entry).eq(keymap.keys(entry)), "{}", entry.name);
        }
        assert_eq!(Keymap::read("keys.ron", "{}").unwrap(), Keymap::default());
    }

    #[test]
    fn what_a_file_has_wrong_is_told_with_its_place_and_what_would_be_right() {
        for (text, wanted) in [
            (
                "{\n  \"stepp\": [\"j\"],\n}",
                "keys.ron:2:3: no action is called \"stepp\"; did you mean \"step\"?",
            ),
            (
                "{\"step\": [\"s\"], \"next\": [\n \"d\"]}",
                "keys.ron:2:2: next[0]: \"d\" is a key of diagnosis already; give that others",
            ),
            (
                "{\"step\": [\"x\"], \"next\": [\"x\"]}",
                "keys.ron:1:11: step[0]: \"x\" is a key of next already",
            ),
            (
                "{\"step\": [\"x\", \"x\"]}",
                "keys.ron:1:11: step[0]: \"x\" is a key of step already",
            ),
            (
                "{\"step\": [\"Pageup\"]}",
                "keys.ron:1:11: step[0]: no key is called \"Pageup\"; did you mean \"PageUp\"?",
            ),
            (
                "{\"step\": [\"3\"]}",
                "keys.ron:1:11: step[0]: digits are counts",
            ),
            (
                "{\"step\": [\"Ctrl-c\"]}",
                "keys.ron:1:11: step[0]: Ctrl-c does what it does always",
            ),
            (
                "{\"interrupt\": [\"x\"]}",
                "keys.ron:1:2: interrupt is Ctrl-c always",
            ),
            ("{\"quit\": []}", "keys.ron:1:2: quit needs a key"),
            (
                "{\"step\": [\"x\"], \"step\": [\"j\"]}",
                "step stands here twice",
            ),
            (
                "{\"step\": \"x\"}",
                "keys.ron:1:10: step: \"x\" is not valid; it must be a list",
            ),
            ("{\"step\": [\"x\"]", "keys.ron:1:"),
            ("[]", "keys.ron:1:"),
        ] {
            let told = refused(text);
            assert!(told.contains(wanted), "{text}\n{told}\n{wanted}");
        }
    }
}
