//! Describes what the results in a log depend on, part by part, so that results of different sweeps are
//! detected and the difference is reported.

use super::shard::{Key, Shard};
use serde::{Deserialize, Serialize};
use stickslip_scene::shown;

/// What the results in a log depend on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Input {
    /// The subcommand: `map`, `study` or `chart`, or its variant.
    what: String,
    /// Everything that the results depend on: names and values.
    parts: Vec<(String, String)>,
    /// The requested shard, K and N.
    shard: (u64, u64),
    /// The machine.
    machine: String,
}

/// Maximum number of characters of a value in a message.
const SHOWN: usize = 80;

impl Input {
    /// The input of all shards.
    pub fn new(what: &str, parts: Vec<(String, String)>) -> Input {
        Input {
            what: what.to_owned(),
            parts,
            shard: (1, 1),
            machine: super::origin::processor(),
        }
    }

    /// The input of one shard.
    pub fn with(mut self, shard: Shard) -> Input {
        self.shard = (shard.number(), shard.of().get());
        self
    }

    /// The requested shard; `None` if the numbers are invalid.
    pub fn shard(&self) -> Option<Shard> {
        Shard::new(self.shard.0, self.shard.1)
    }

    /// The machine that computed the results.
    pub fn machine(&self) -> &str {
        &self.machine
    }

    /// How another input differs, as a sentence; `None` if its results can be used.
    pub fn difference(&self, theirs: &Input) -> Option<String> {
        if theirs.what.ends_with(", as sums") {
            let message = "it contains sums of `--aggregate`, which are no longer supported; run its shards again with --csv (`help cluster`)";
            return Some(message.to_owned());
        }
        if self.what != theirs.what {
            return Some(format!(
                "its results belong to {}, not to {}",
                theirs.what, self.what
            ));
        }
        let other = self
            .parts
            .iter()
            .zip(&theirs.parts)
            .into_iter()
            .find(|(ours, theirs)| ours != theirs);
        let cut = |text: &str| shown::cut(text, SHOWN);
        if let Some(((name, ours), (their_name, theirs))) = other {
            return Some(if name == their_name {
                format!(
                    "its results have a different {name}: {} instead of {}",
                    cut(theirs),
                    cut(ours)
                )
            } else {
                format!("its results have {their_name} instead of {name}")
            });
        }
        (self.parts.len() != theirs.parts.len())
            .then(|| "its results have a different number of scenes or series".to_owned())
    }
}

/// Digest of a text in a part, of which only equality matters.
pub fn digest(text: &str) -> String {
    Key::from_parts([text]).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input(what: &str, angle: &str) -> Input {
        let part = |name: &str, value: &str| (name.to_owned(), value.to_owned());
        Input::new(
            what,
            vec![part("scene", "a"), part("friction.angle", angle)],
        )
    }

    #[test]
    fn the_first_different_part_is_reported() {
        let ours = input("map", "20");
        assert_eq!(ours.difference(&ours), None);
        let shard = Shard::new(3, 7).unwrap();
        assert_eq!(ours.difference(&ours.clone().with(shard)), None);
        let text = ours.difference(&input("map", "30")).unwrap();
        assert!(text.contains("a different friction.angle: 30 instead of 20"));
        let text = ours.difference(&input("study", "20")).unwrap();
        assert!(text.contains("belong to study, not to map"), "{text}");
        let mut fewer = input("map", "20");
        fewer.parts.pop();
        assert!(ours.difference(&fewer).is_some());
    }
}
