//! A sweep in pieces: `--shard`, `--log` and `--merge`, and what is told of them.

use super::base::{Error, Exit, quoted, tell};
use super::outputs::OutputArgs;
use crate::study::log::LogError;
use crate::study::merge::{Keeping, Kept, Missing};
use crate::study::origin;
use crate::study::run::RunError;
use crate::study::shard::{NoShard, Shard, ranges};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::PathBuf;

/// Which part of a sweep is done, and where its results are.
#[derive(Debug, clap::Args)]
pub struct PartArgs {
    /// Does only the cells whose hash falls to shard K of N, the same for ever (page cluster)
    #[arg(long, value_name = "K/N", value_parser = shard, requires = "log")]
    shard: Option<Shard>,
    /// Keeps each result of this sweep in this file as it comes, and goes on with what is there
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    /// Runs nothing, and puts the logs of all shards together, in any order
    #[arg(long, value_name = "LOG", num_args = 1.., conflicts_with_all = ["log", "shard"])]
    merge: Vec<PathBuf>,
}

fn shard(text: &str) -> Result<Shard, NoShard> {
    text.parse()
}

impl PartArgs {
    /// Where results are kept.
    ///
    /// # Errors
    /// If files are wanted that a part of a sweep does not make.
    pub fn keeping(&self, out: &OutputArgs) -> Result<Keeping, Error> {
        let shard = self.shard.unwrap_or(Shard::WHOLE);
        if shard.of().get() > 1 && out.writes() {
            return Err(Error::Usage(format!(
                "--shard {shard} does a part of the cells, which is neither a table nor a picture; --merge makes both of all logs"
            )));
        }
        Ok(match &self.log {
            Some(log) => Keeping::Shard(log.clone(), shard),
            None if !self.merge.is_empty() => Keeping::Merge(self.merge.clone()),
            None => Keeping::Nowhere,
        })
    }

    /// Whether any of it is asked for.
    pub fn any(&self) -> bool {
        self.log.is_some() || !self.merge.is_empty()
    }

    /// Whether what is done is a part only.
    pub fn is_part(&self) -> bool {
        self.shard.is_some_and(|shard| shard.of().get() > 1)
    }

    /// How the program ends after a part, and tells it. `done` says of each cell whether its result is there.
    pub fn end<T>(&self, kept: &Kept<T>, done: impl Fn(usize) -> bool, quiet: bool) -> Exit
    where
        T: Serialize + DeserializeOwned + Clone,
    {
        let own = kept.own().count();
        let left = kept.own().filter(|&k| !done(k)).count();
        let shard = self.shard.unwrap_or(Shard::WHOLE);
        let (there, unit) = (kept.there(), kept.unit());
        if left > 0 {
            let done = own - left;
            tell(&format!(
                "interrupted; {done} of {own} {unit} of shard {shard} are done; the same command goes on"
            ));
            return Exit::Interrupted;
        }
        if !quiet {
            tell(&format!(
                "shard {shard}: {own} {unit}, {there} of which were there"
            ));
        }
        Exit::Good
    }

    /// Tells what is missing to a whole, and what does it; that nothing is, is no end.
    pub fn whole<T>(&self, kept: &Kept<T>) -> Option<Exit>
    where
        T: Serialize + DeserializeOwned + Clone,
    {
        let Some(missing) = kept.missing() else {
            self.tell_machines(kept);
            return None;
        };
        tell_missing(&missing, kept.len(), kept.unit());
        Some(Exit::Incomplete)
    }

    /// Bits are those of the machine, which tables and pictures name: that of other kinds is said.
    fn tell_machines<T>(&self, kept: &Kept<T>)
    where
        T: Serialize + DeserializeOwned + Clone,
    {
        let here = origin::processor();
        let others: Vec<&str> = kept.machines().filter(|other| *other != here).collect();
        if !others.is_empty() {
            tell(&format!(
                "computed on {}, put together on {here}, which tables and pictures name; last bits may be other ones there",
                others.join("; ")
            ));
        }
    }
}

/// An error of a sweep; what another try may get past is told from what it will not.
pub fn failed(error: RunError) -> Error {
    match error {
        RunError::Log(LogError::Busy(_) | LogError::File { .. }) | RunError::Threads(_) => {
            Error::Again(error.to_string())
        }
        _ => Error::Usage(error.to_string()),
    }
}

/// Ranges of numbers, and commands, that a message has at most.
const MOST: usize = 8;

fn tell_missing(missing: &Missing, all: usize, unit: &str) {
    let count = missing.cells.len();
    tell(&format!(
        "{count} of {all} {unit} are missing (numbers from 0, in the order of the table): {}",
        ranges(&missing.cells, MOST)
    ));
    let given: Vec<String> = std::env::args().skip(1).collect();
    let sweep = words(&given);
    tell("This does them; merge again then, with its logs too:");
    for (shard, file) in missing.shards.iter().take(MOST) {
        let (number, of) = (shard.number(), shard.of());
        let file = file.as_ref().map(|file| file.display().to_string());
        let file = file.unwrap_or_else(|| format!("shard-{number}-of-{of}.log"));
        let part = match of.get() {
            1 => String::new(),
            _ => format!(" --shard {shard}"),
        };
        tell(&format!(
            "  stickslip {sweep}{part} --log {}",
            quoted(&file)
        ));
    }
    if missing.shards.len() > MOST {
        let numbers = missing.shards.iter().skip(MOST);
        let numbers: Vec<usize> = numbers.map(|(s, _)| s.number() as usize).collect();
        tell(&format!(
            "  likewise shards {}",
            ranges(&numbers, usize::MAX)
        ));
    }
}

/// The words of a command line that say what is swept: without where results come from and go to.
fn words(given: &[String]) -> String {
    const WITH_VALUE: [&str; 7] = [
        "--csv",
        "--svg",
        "--png",
        "--failing",
        "--jobs",
        "--log",
        "--shard",
    ];
    const ALONE: [&str; 3] = ["--force", "--quiet", "-q"];
    let (mut words, mut left_out) = (Vec::new(), 0);
    for word in given {
        let option = word.split('=').next().unwrap_or_default();
        if word.starts_with('-') && word != "-" {
            left_out = 0;
        }
        if left_out > 0 {
            left_out -= 1;
        } else if option == "--merge" {
            left_out = if word == option { usize::MAX } else { 0 };
        } else if WITH_VALUE.contains(&option) {
            left_out = usize::from(word == option);
        } else if !ALONE.contains(&word.as_str()) {
            words.push(quoted(word));
        }
    }
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sweep_is_typed_again_without_what_it_makes() {
        let given = "map a.ron --over x=1,2 --merge b.log c.log --csv - -q --over y=1 --jobs=3 --set z=it's";
        let given: Vec<String> = given.split(' ').map(str::to_owned).collect();
        assert_eq!(
            words(&given),
            "map a.ron --over x=1,2 --over y=1 --set 'z=it'\\''s'"
        );
    }
}
