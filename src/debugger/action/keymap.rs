//! The key bindings: the defaults of the table, and the changes of a file.
//!
//! ```ron
//! {
//!     "step": ["j", "F11"],   // the keys of an action, instead of its own
//!     "down": ["Down"],       // `j` is free for the first
//!     "sort": [],             // none; its name is left
//! }
//! ```

use super::table::{ACTIONS, ActionEntry, Group, by_key, named};
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use std::collections::BTreeMap;
use std::fmt;
use stickslip_scene::format::error::{Path, did_you_mean, quoted};
use stickslip_scene::format::locate::{line_and_column, locate};
use stickslip_scene::format::read;
use stickslip_scene::{SceneError, joined};

/// Names of keys other than letters.
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
/// Actions whose keys cannot change, because they must always work.
const FIXED: [&str; 3] = ["interrupt", "suspend", "redraw"];
/// Actions that need at least one key.
const NEEDED: [&str; 4] = ["command", "cancel", "help", "quit"];
/// Maximum number of keys per action.
const MOST: usize = 8;

/// The keys of all actions.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Keymap {
    /// Changed keys by action name.
    changed: BTreeMap<&'static str, Vec<String>>,
}

/// The entries of the file, in order.
struct KeysFile(Vec<(String, Vec<String>)>);

impl<'de> Deserialize<'de> for KeysFile {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        struct Pairs;
        impl<'de> Visitor<'de> for Pairs {
            type Value = KeysFile;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a map from actions to keys, { \"step\": [\"s\"], ... }")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<KeysFile, A::Error> {
                let mut pairs = Vec::new();
                while let Some(pair) = map.next_entry()? {
                    pairs.push(pair);
                }
                Ok(KeysFile(pairs))
            }
        }
        reader.deserialize_map(Pairs)
    }
}

impl Keymap {
    /// Reads the key bindings from the text of a file.
    ///
    /// # Errors
    /// If the text cannot be parsed, an action or key is unknown, or two actions share a key.
    pub fn read(file: &str, text: &str) -> Result<Keymap, SceneError> {
        let KeysFile(written) = read::value(file, text, "list of keys")?;
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
            // Position of the action's name, which precedes its keys.
            let of_name = text[..of_keys]
                .rfind('"')
                .and_then(|end| text[..end].rfind('"'))
                .unwrap_or(of_keys);
            let misnamed = |message| wrong(of_name, &Path::default(), message);
            let names = || ACTIONS.iter().map(|entry| entry.name);
            let entry = named(name).ok_or_else(|| {
                let near = did_you_mean(name, names());
                misnamed(format!("unknown action {}{near}", quoted(name)))
            })?;
            if FIXED.contains(&entry.name) {
                let key = entry.keys.join(", ");
                return Err(misnamed(format!("{name} is always {key}")));
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
                return Err(misnamed(format!("{name} occurs twice")));
            }
        }
        // Keys freed by other entries are known only now.
        for (name, keys) in &written {
            for (index, key) in keys.iter().enumerate() {
                let mut owners = ACTIONS.iter().filter(|entry| {
                    let times = keymap.keys(entry).filter(|own| own == key).count();
                    times > usize::from(entry.name == name)
                });
                if let Some(owner) = owners.next() {
                    let path = Path(vec![name.as_str().into(), index.into()]);
                    let byte = locate(text, &path).start;
                    let (key, other) = (quoted(key), owner.name);
                    let message = if other == name {
                        format!("{key} is given twice")
                    } else {
                        format!(
                            "{key} is already a key of {other}; give that action other keys: {other:?}: [...]"
                        )
                    };
                    return Err(wrong(byte, &path, message));
                }
            }
        }
        keymap
            .changed
            .retain(|name, keys| named(name).is_none_or(|entry| entry.keys != keys));
        Ok(keymap)
    }

    /// The keys of an action.
    pub fn keys<'a>(&'a self, entry: &'a ActionEntry) -> impl Iterator<Item = &'a str> {
        let changed = self.changed.get(entry.name);
        let own = entry
            .keys
            .iter()
            .copied()
            .filter(move |_| changed.is_none());
        changed.into_iter().flatten().map(String::as_str).chain(own)
    }

    /// The action of a key.
    pub fn by_key(&self, key: &str) -> Option<&'static ActionEntry> {
        let changed = |entry: &&ActionEntry| self.changed.contains_key(entry.name);
        by_key(key).filter(|entry| !changed(entry)).or_else(|| {
            let (name, _) = self
                .changed
                .iter()
                .find(|(_, keys)| keys.iter().any(|own| own == key))?;
            named(name)
        })
    }

    /// Whether any key differs from the table.
    pub fn is_changed(&self) -> bool {
        !self.changed.is_empty()
    }

    /// All actions that have or can have a key, with their current keys, in the format of the file: a heading
    /// and lines for each group.
    pub fn listed(&self) -> Vec<(Group, Vec<String>)> {
        let line = |entry: &ActionEntry| {
            let keys: Vec<String> = self.keys(entry).map(|key| format!("{key:?}")).collect();
            let mark = if self.changed.contains_key(entry.name) {
                "   // changed"
            } else {
                ""
            };
            format!("{:?}: [{}],{mark}", entry.name, keys.join(", "))
        };
        Group::ALL
            .into_iter()
            .map(|group| {
                let free = ACTIONS
                    .iter()
                    .filter(|entry| entry.group == group)
                    .filter(|entry| !FIXED.contains(&entry.name));
                (group, free.map(line).collect())
            })
            .collect()
    }

    /// The current keys in the format of the file.
    pub fn text(&self) -> String {
        let groups = self.listed().into_iter().map(|(group, lines)| {
            let lines: String = lines.iter().map(|line| format!("    {line}\n")).collect();
            format!("    // {}\n{lines}", group.title())
        });
        format!("{{\n{}}}\n", joined(groups, "\n"))
    }
}

/// Checks that terminals have a key with this name and that it can be assigned.
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
                return Err(format!("{key} cannot be reassigned"));
            }
            Some("i" | "m" | "h" | "j") => {
                return Err(format!(
                    "terminals cannot distinguish {key} from another key"
                ));
            }
            Some(letter) => letter.len() == 1 && letter.chars().all(|c| c.is_ascii_lowercase()),
            None => NAMED.contains(&key),
        },
    };
    if known {
        Ok(())
    } else {
        Err(format!(
            "unknown key {}{}; keys: a letter, F1 to F12, Shift-F1, Ctrl-a, {}",
            quoted(key),
            did_you_mean(key, NAMED),
            NAMED.join(", ")
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> String {
        Keymap::read("keys.ron", text).unwrap_err().to_string()
    }

    #[test]
    fn a_file_changes_keys_and_frees_the_defaults() {
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
        // The printed file has to give the same keys.
        let again = Keymap::read("keys.ron", &keymap.text()).unwrap();
        for entry in ACTIONS {
            assert!(again.keys(entry).eq(keymap.keys(entry)), "{}", entry.name);
        }
        assert_eq!(Keymap::read("keys.ron", "{}").unwrap(), Keymap::default());
    }

    #[test]
    fn errors_in_a_file_have_a_location_and_a_hint() {
        for (text, wanted) in [
            (
                "{\n  \"stepp\": [\"j\"],\n}",
                "keys.ron:2:3: unknown action \"stepp\"; did you mean \"step\"?",
            ),
            (
                "{\"step\": [\"s\"], \"next\": [\n \"d\"]}",
                "keys.ron:2:2: next[0]: \"d\" is already a key of diagnosis; give that action other keys",
            ),
            (
                "{\"step\": [\"x\"], \"next\": [\"x\"]}",
                "keys.ron:1:11: step[0]: \"x\" is already a key of next",
            ),
            (
                "{\"step\": [\"x\", \"x\"]}",
                "keys.ron:1:11: step[0]: \"x\" is given twice",
            ),
            (
                "{\"step\": [\"Pageup\"]}",
                "keys.ron:1:11: step[0]: unknown key \"Pageup\"; did you mean \"PageUp\"?",
            ),
            (
                "{\"step\": [\"3\"]}",
                "keys.ron:1:11: step[0]: digits are counts",
            ),
            (
                "{\"step\": [\"Ctrl-c\"]}",
                "keys.ron:1:11: step[0]: Ctrl-c cannot be reassigned",
            ),
            (
                "{\"interrupt\": [\"x\"]}",
                "keys.ron:1:2: interrupt is always Ctrl-c",
            ),
            ("{\"quit\": []}", "keys.ron:1:2: quit needs a key"),
            (
                "{\"step\": [\"x\"], \"step\": [\"j\"]}",
                "step occurs twice",
            ),
            (
                "{\"step\": \"x\"}",
                "keys.ron:1:10: step: \"x\" is not valid; it must be a list",
            ),
            ("{\"step\": [\"x\"]", "keys.ron:1:"),
            ("[]", "keys.ron:1:"),
        ] {
            let words = refused(text);
            assert!(words.contains(wanted), "{text}\n{words}\n{wanted}");
        }
    }
}
