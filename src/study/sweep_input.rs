//! What a file of kept results is of, part by part, so that results of different sweeps are told apart, and why.

use super::shard::{Key, Shard};
use serde::{Deserialize, Serialize};
use stickslip_scene::shown;

/// What a file of results is of.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Input {
    /// The subcommand: `map`, `study` or `chart`, or what it does beside its usual work.
    what: String,
    /// All that its results depend on: what it is called, and its value.
    parts: Vec<(String, String)>,
    /// The shard that was asked for, K and N.
    shard: (u64, u64),
    /// The kind of machine.
    machine: String,
}

/// Most characters of a value that a message has.
const SHOWN: usize = 80;

impl Input {
    /// What a shard is of.
    pub fn new(what: &str, parts: Vec<(String, String)>) -> Input {
        Input {
            what: what.to_owned(),
            parts,
            shard: (1, 1),
            machine: super::origin::processor(),
        }
    }

    /// The same for a shard.
    pub fn with(mut self, shard: Shard) -> Input {
        self.shard = (shard.number(), shard.of().get());
        self
    }

    /// The shard that was asked for; `None` where the numbers are none of a shard.
    pub fn shard(&self) -> Option<Shard> {
        Shard::new(self.shard.0, self.shard.1)
    }

    /// The kind of machine that it was computed on.
    pub fn machine(&self) -> &str {
        &self.machine
    }

    /// In what another one differs, as a sentence about it; `None` where its results are ours.
    pub fn difference(&self, theirs: &Input) -> Option<String> {
        if theirs.what.ends_with(", as sums") {
            let message = "it has the sums of `--aggregate`, which are no longer read; run its shards again with --csv (`help cluster`)";
            return Some(message.to_owned());
        }
        if self.what != theirs.what {
            return Some(format!(
                "its results are those of {}, and not of {}",
                theirs.what, self.what
            ));
        }
        let pairs = self.parts.iter().zip(&theirs.parts);
        let other = pairs.into_iter().find(|(ours, theirs)| ours != theirs);
        let cut = |text: &str| shown::cut(text, SHOWN).to_string();
        if let Some(((name, ours), (their_name, theirs))) = other {
            return Some(match name == their_name {
                true => format!(
                    "its results are of another {name}: {}, and not {}",
                    cut(theirs),
                    cut(ours)
                ),
                false => format!("its results have a {their_name} where these have a {name}"),
            });
        }
        (self.parts.len() != theirs.parts.len())
            .then(|| "its results are of more or fewer scenes or series".to_owned())
    }
}

/// A text in a part, where only whether it is the same counts.
pub fn digest(text: &str) -> String {
    Key::of([text]).to_string()
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
    fn the_first_part_that_differs_is_told() {
        let ours = input("map", "20");
        assert_eq!(ours.difference(&ours), None);
        let shard = Shard::new(3, 7).unwrap();
        assert_eq!(ours.difference(&ours.clone().with(shard)), None);
        let told = ours.difference(&input("map", "30")).unwrap();
        assert!(told.contains("another friction.angle: 30, and not 20"));
        let told = ours.difference(&input("study", "20")).unwrap();
        assert!(told.contains("those of study, and not of map"), "{told}");
        let mut fewer = input("map", "20");
        fewer.parts.pop();
        assert!(ours.difference(&fewer).is_some());
    }
}
